"""Tables in Markdown, whole or row by row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


def head(cells: Sequence[str]) -> str:
    """Return the head of a table; all columns but the first are aligned right."""
    return row(cells) + "\n" + row(("---", *["---:"] * (len(cells) - 1)))


def row(cells: Sequence[str]) -> str:
    """Return a row of a table."""
    escaped = (cell.replace("|", r"\|") for cell in cells)
    return f"| {' | '.join(escaped)} |"


@dataclass(frozen=True)
class Table:
    """Text in rows."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def markdown(self) -> str:
        """Return the table in Markdown."""
        return "".join(line + "\n" for line in (head(self.head), *map(row, self.rows)))
