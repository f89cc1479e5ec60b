"""What verifying a bag found, walk by walk."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from biped_bringup.bag.recomputed_cost import CostCheck


@dataclass(frozen=True)
class Difference:
    """Where recording and learner part."""

    clock_ticks: int
    """Of the observation concerned."""
    control_tick: int
    """The same, since the walk began."""
    what: str
    recorded: Any
    """Plain values; None where there is nothing."""
    recomputed: Any

    def __str__(self) -> str:
        """Return place and both values."""
        return (
            f"control tick {self.control_tick} (clock tick {self.clock_ticks}), "
            f"{self.what}: recorded {self.recorded}, recomputed {self.recomputed}"
        )


@dataclass
class WalkCheck:
    """One walk of the bag, checked."""

    number: int
    """1 for the bag's first."""
    episode: int
    """As the simulation counts."""
    learning: bool | None
    """None where the walk's end is not in the bag."""
    corrections: int
    """Recorded."""
    identical: int = 0
    """Those that came out bit for bit."""
    differences: int = 0
    first_difference: Difference | None = None
    not_checked: str | None = None
    """Why some or all corrections were not compared."""
    cost: CostCheck | None = None

    def differ(self, difference: Difference) -> None:
        """Take note of a difference."""
        self.differences += 1
        if self.first_difference is None:
            self.first_difference = difference


@dataclass(frozen=True)
class Verification:
    """All walks of a bag, checked."""

    walks: tuple[WalkCheck, ...]

    @property
    def corrections(self) -> int:
        """Corrections recorded."""
        return sum(walk.corrections for walk in self.walks)

    @property
    def identical(self) -> int:
        """Corrections that came out bit for bit."""
        return sum(walk.identical for walk in self.walks)

    @property
    def differences(self) -> int:
        """Differences of all kinds."""
        return sum(walk.differences for walk in self.walks)

    @property
    def verified(self) -> bool:
        """There are corrections, all were compared, and nothing differs."""
        return 0 < self.corrections == self.identical and self.differences == 0

    def as_mapping(self) -> dict[str, Any]:
        """Return everything as plain values, for JSON."""
        return {
            "verified": self.verified,
            "corrections": self.corrections,
            "identical": self.identical,
            "differences": self.differences,
            "walks": [asdict(walk) for walk in self.walks],
        }
