"""What `biped bag recover` saved and what it could not, for people and for scripts."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any


@dataclass
class Loss:
    """What was saved of a topic, and what is lost of it."""

    recovered: int = 0
    lost: int = 0
    exact: bool = True
    """Whether exactly so many were lost; at least so many if not."""
    lost_s: float = 0.0
    """Summed over all holes: from the last message before it to the first behind."""

    @property
    def touched(self) -> bool:
        """Whether messages were lost, or may have been."""
        return self.lost > 0 or not self.exact

    def add(self, other: Loss) -> None:
        """Add those of another file."""
        self.recovered += other.recovered
        self.lost += other.lost
        self.exact = self.exact and other.exact
        self.lost_s += other.lost_s

    def settle(self, held: int) -> None:
        """Take note of how many messages there were, from a source that is sure."""
        self.lost, self.exact = max(0, held - self.recovered), True
        self.lost_s = self.lost_s if self.lost else 0.0

    def text(self) -> str:
        """Return what was lost, for people."""
        if self.exact:
            count = f"{self.lost} of {self.recovered + self.lost} messages"
        elif self.lost:
            count = f"{self.lost} messages or more"
        else:
            count = "an unknown number of messages, if any"
        return f"{count}, {self.lost_s:.3f} s"


@dataclass
class RecoveryReport:
    """A broken bag and what became of it."""

    bag: str
    out: str
    topics: dict[str, Loss] = field(default_factory=dict)
    damage: list[str] = field(default_factory=list)
    """Places that are not what was written."""
    end_known: bool = True
    """Whether anything tells how the recording ended."""
    duration_s: float = 0.0
    """From the first to the last message recovered."""

    def topic(self, name: str) -> Loss:
        """Return that of a topic."""
        return self.topics.setdefault(name, Loss())

    @property
    def recovered(self) -> int:
        """Messages saved."""
        return sum(topic.recovered for topic in self.topics.values())

    @property
    def lost(self) -> int:
        """Messages known to be lost."""
        return sum(topic.lost for topic in self.topics.values())

    @property
    def nothing_lost(self) -> bool:
        """Whether the bag was recovered as it was recorded, for certain."""
        return (
            self.end_known
            and not self.damage
            and not any(topic.touched for topic in self.topics.values())
        )

    def as_mapping(self) -> dict[str, Any]:
        """Return the report for scripts."""
        return {
            **dataclasses.asdict(self),
            "recovered": self.recovered,
            "lost": self.lost,
            "nothing_lost": self.nothing_lost,
        }

    def text(self) -> str:
        """Return the report for people."""
        lines = [
            f"recovered {self.recovered} messages, {self.duration_s:.3f} s, "
            f"in {self.out}"
        ]
        lines += [f"damaged: {place}" for place in self.damage]
        if not self.end_known:
            lines.append(
                "the end is missing: what the recorder had not written yet is lost, too"
            )
        lines += [
            f"lost: {name}: {topic.text()}"
            for name, topic in sorted(self.topics.items())
            if topic.touched
        ]
        if self.nothing_lost:
            lines.append("nothing was lost")
        return "\n".join(lines)
