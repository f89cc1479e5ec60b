"""What an episode changes, kept so that it can be taken back."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Tables = Iterable[NDArray[Any]]


class RowJournal:
    """Rows of a learner's tables as they were before an episode visited their states.

    An episode changes the rows of the states that it visits, and few others, which are
    told as visited before they change. What this costs grows with the episode, not with
    all that is known.
    """

    def __init__(self) -> None:
        """Start before the first episode."""
        self._rows: dict[int, list[Any]] = {}

    def begin(self) -> None:
        """Begin an episode: what the last one changed stays."""
        self._rows.clear()

    def visit(self, state: int, tables: Tables) -> None:
        """Keep the rows of a state, unless this episode has been there before.

        Args:
            state: row of the tables.
            tables: that are indexed by state, always in the same order.
        """
        if state not in self._rows:
            self._rows[state] = [np.copy(table[state]) for table in tables]

    def undo(self, tables: Tables) -> None:
        """Put back all rows that were kept; those of new states become unused ones."""
        for column, table in enumerate(tables):
            for state, rows in self._rows.items():
                table[state] = rows[column]
        self._rows.clear()
