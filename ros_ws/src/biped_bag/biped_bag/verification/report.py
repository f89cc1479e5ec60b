"""What verifying a bag found, walk by walk."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Any

from biped_bag.verification.cost import CostCheck
from msgs_json.observation import Observation


class Verdict(StrEnum):
    """What the checks of all walks come to."""

    VERIFIED = "verified"
    """There are corrections, all came out again, and nothing differs."""
    AS_FAR_AS_RECORDED = "verified as far as recorded"
    """The same, but a walk's end and result are not in the bag."""
    NOT_VERIFIED = "not verified"


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
    refused: int = 0
    """Corrections that the trajectory refuses, since they are for no observation, out
    of range, or beside the learner's; they change nothing."""
    not_checked: str | None = None
    """Why some or all corrections were not compared."""
    cost: CostCheck | None = None

    @property
    def cut_short(self) -> bool:
        """Whether the learner answered, but the walk's end is not in the bag.

        A walk that nobody answered has only been offered: there is nothing to miss.
        """
        return self.learning is None and self.corrections > 0

    def differ(
        self,
        place: Observation,
        what: str,
        recorded: Any,
        recomputed: Any,
        ticks_later: int = 0,
    ) -> None:
        """Take note of a difference, at an observation or so many ticks later."""
        self.differences += 1
        if self.first_difference is None:
            self.first_difference = Difference(
                place.clock_ticks + ticks_later,
                place.control_tick + ticks_later,
                what,
                recorded,
                recomputed,
            )


@dataclass(frozen=True)
class Verification:
    """All walks of a bag, checked."""

    walks: tuple[WalkCheck, ...]
    not_understood: Mapping[str, int] = field(default_factory=dict)
    """Messages that no node understands, by topic; they change nothing."""

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
    def verdict(self) -> Verdict:
        """What all this comes to."""
        if not 0 < self.corrections == self.identical or self.differences:
            return Verdict.NOT_VERIFIED
        if any(walk.cut_short for walk in self.walks):
            return Verdict.AS_FAR_AS_RECORDED
        return Verdict.VERIFIED

    def as_mapping(self) -> dict[str, Any]:
        """Return everything as plain values, for JSON."""
        return {
            "verdict": self.verdict,
            "corrections": self.corrections,
            "identical": self.identical,
            "differences": self.differences,
            "not_understood": dict(self.not_understood),
            "walks": [asdict(walk) for walk in self.walks],
        }
