"""Who learns the walk in the laboratory: XoL and its rivals behind one face.

A contestant walks one learning episode after the other, on the same plant, with the
same states, actions, rewards and schedule, and counts its own milestones:

    schedule    episodes when the schedule's last subtask was passed (Section 5.1)
    greedy      episodes when a frozen greedy walk of the whole walk first succeeded

Contestants are entry points of the group `biped.contestants`, each an `Entry`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from biped_bringup.run_settings import RunSettings
from biped_bringup.walker import WalkedTicks
from biped_common.entry_points import entry_points
from biped_common.settings import Settings
from learner_node.walking.episode_log import EpisodeLog
from msgs_json.end_cause import EndCause

GROUP = "biped.contestants"
MILESTONES = ("schedule", "greedy")

AnyOptions = TypeVar("AnyOptions", bound=Settings)
_CAUSES = np.array([str(cause) for cause in EndCause])


class UnknownContestantError(LookupError):
    """No entry point of this name."""


class Contestant(Protocol):
    """Learns the walk, episode by episode."""

    @property
    def ticks(self) -> WalkedTicks:
        """Where the control ticks of all walks came from."""

    @property
    def cpu_s(self) -> float:
        """Processor time of all episodes."""

    @property
    def episodes(self) -> int:
        """Learning episodes so far."""

    def episode(self) -> None:
        """Walk one more learning episode, and the frozen trial where one is due."""

    def milestone(self, name: str) -> int | None:
        """Return the number of episodes when one of MILESTONES was reached."""

    def table(self) -> dict[str, NDArray[Any]]:
        """Return one row per episode, by column.

        Always there: control_ticks and target_ticks (int64), end_cause (text), t_err
        and peak_zmp_error_m (float64); besides, whatever its memory's figures are, such
        as basis_states, fixed_states and penalty_states (float64), after each episode.
        """

    def figures(self) -> dict[str, Any]:
        """Return what else there is to say, such as hashes; the same in every run.

        Always there: simulated_ticks (of learning episodes), evaluation_ticks (of
        frozen trials), memory_sha256, trajectory_sha256.
        """

    def save(self, path: Path) -> None:
        """Write atomically all that is needed to go on bit for bit."""

    def close(self) -> None:
        """End the world."""


@dataclass(frozen=True)
class NoOptions(Settings):
    """Of a contestant whose constants all stand in the settings of the run."""


@dataclass(frozen=True)
class Entry(Generic[AnyOptions]):
    """How a contestant is made."""

    options: type[AnyOptions]
    """Its own constants, beside the settings of the run."""
    begin: Callable[[RunSettings, AnyOptions, int], Contestant]
    """From nothing: settings, options, seed of every random draw."""
    resume: Callable[[Path, RunSettings, AnyOptions, int], Contestant]
    """From what it saved."""
    module: str
    """The code of its own: what it imports is part of a run's identity."""


@cache
def entry(name: str) -> Entry[Any]:
    """Return a contestant by its name.

    Raises:
        UnknownContestantError: there is none.
    """
    found = entry_points(GROUP)
    if name not in found:
        raise UnknownContestantError(
            f"contestant {name!r}: must be one of {', '.join(sorted(found))}"
        )
    made: Entry[Any] = found[name].load()
    return made


def log_table(log: EpisodeLog) -> dict[str, NDArray[Any]]:
    """Return the columns of a log as `Contestant.table` has them."""
    columns = log.arrays()
    columns["end_cause"] = _CAUSES[columns["end_cause"]]
    return columns
