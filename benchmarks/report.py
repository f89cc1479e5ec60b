"""One line per figure, and whether it keeps its bound."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """A measured figure and the bound it must stay under, if any."""

    name: str
    value: float
    unit: str
    bound: float | None = None

    @property
    def kept(self) -> bool:
        """Whether the bound is kept."""
        return self.bound is None or self.value <= self.bound

    def line(self) -> str:
        """Return the figure for people."""
        bound = "" if self.bound is None else f"  (bound {self.bound:g} {self.unit})"
        verdict = "" if self.kept else "  MISSED"
        return f"{self.name:<58} {self.value:10.2f} {self.unit}{bound}{verdict}"
