"""One line per figure, and whether it keeps its bound."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """A measured figure and the bounds it must keep, if any."""

    name: str
    value: float
    unit: str
    bound: float | None = None
    """Upper bound."""
    at_least: float | None = None

    @property
    def kept(self) -> bool:
        """Whether the bounds are kept."""
        return (self.bound is None or self.value <= self.bound) and (
            self.at_least is None or self.value >= self.at_least
        )

    def line(self) -> str:
        """Return the figure for people."""
        bounds = "".join(
            f"  ({word} {limit:g} {self.unit})"
            for word, limit in (("bound", self.bound), ("at least", self.at_least))
            if limit is not None
        )
        verdict = "" if self.kept else "  MISSED"
        return f"{self.name:<58} {self.value:10.2f} {self.unit}{bounds}{verdict}"
