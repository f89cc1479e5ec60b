"""One area that was examined: what was found wrong, and a report of how it is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from biped_common.terminal_text import printable

_NARROWEST = 8
_GAP = 4


@dataclass
class Area:
    """Errors, warnings and report items of one area."""

    name: str
    """As it is named among the failed modules."""
    title: str
    """Of the report."""
    items: list[tuple[str, str]] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def item(self, name: str, value: object) -> None:
        """Add a line to the report."""
        self.items.append((name, str(value)))

    def failed(self, *, include_warnings: bool) -> bool:
        """Return whether the area is not as it should be."""
        return bool(self.errors or (include_warnings and self.warnings))


def complaints(areas: Iterable[Area]) -> list[str]:
    """Return one line for each warning and error."""
    return [
        printable(f"UserWarning: {text}")
        for area in areas
        for text in (*area.warnings, *(f"ERROR: {error}" for error in area.errors))
    ]


def summary(areas: Sequence[Area], *, include_warnings: bool) -> str:
    """Return how many checks passed, and the names of those that did not."""
    failed = [
        area.name for area in areas if area.failed(include_warnings=include_warnings)
    ]
    if not failed:
        return f"\nAll {len(areas)} checks passed\n"
    return (
        f"\n{len(failed)}/{len(areas)} checks failed\n\n"
        f"Failed modules: {' '.join(failed)}\n"
    )


def report(area: Area) -> str:
    """Return the report: a title, and names and values in two columns."""
    width = max((len(name) for name, _ in area.items), default=0)
    width = width + _GAP if width >= _NARROWEST else _NARROWEST
    lines = [printable(f"{name:{width}}: {value}") for name, value in area.items]
    return "\n".join([f"\n   {area.title}", *lines])
