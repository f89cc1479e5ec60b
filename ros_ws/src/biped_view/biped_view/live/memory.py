"""What a memory file tells of the learner: figures, T_err by episode, states."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from biped_bringup.run_settings import RunSettings
from biped_common.errors import BipedError
from biped_common.settings import from_mapping
from biped_common.timing import seconds
from biped_view.live.moment import Episodes, LearnerFigures
from biped_view.live.page import Page
from learner_node.checkpoint import read_checkpoint, taking_over
from learner_node.walking.session import LearningSession
from learner_node.walking.waist_plane import LearnedStates, learned_states
from msgs_json.end_cause import EndCause
from msgs_json.learner_status import LearnerStatus

_LOOK_S: Final = 2.0


class Memory(NamedTuple):
    """A memory file, as far as it is shown."""

    figures: LearnerFigures
    episodes: Episodes
    states: LearnedStates


def read_memory(path: Path) -> Memory:
    """Return what a memory file tells.

    Raises:
        CheckpointError: the file is no usable checkpoint.
    """
    header, arrays = read_checkpoint(path)
    with taking_over(path):
        settings = from_mapping(RunSettings, header["settings"])
        session = LearningSession(
            settings.learner, settings.gait.walk_ticks, header["seed"]
        )
        session.restore(header, arrays)
        walked = header.get("walked_ticks", {})
        log = session.log.arrays()
        figures = figures_of(
            session.status("file"),
            settings.gait.duration_s,
            computed_s=seconds(int(walked["computed"])) if walked else None,
            replayed_s=seconds(int(walked["replayed"])) if walked else None,
        )
    completed = list(EndCause).index(EndCause.COMPLETED)
    episodes = Episodes(
        np.arange(1.0, len(session.log) + 1.0),
        log["t_err"],
        log["end_cause"] == completed,
    )
    return Memory(figures, episodes, learned_states(session))


def figures_of(
    status: LearnerStatus,
    walk_time_s: float | None,
    computed_s: float | None = None,
    replayed_s: float | None = None,
) -> LearnerFigures:
    """Return a learner's status as it is shown."""
    return LearnerFigures(
        state=(
            "Frozen: greedy walks"
            if status.frozen
            else "Learned"
            if status.learned
            else "Schedule complete"
            if status.schedule_complete
            else "Learning"
        ),
        target_time_s=status.target_time_s,
        walk_time_s=walk_time_s,
        subtask=status.subtask,
        subtasks=status.subtasks,
        successes=status.successes,
        episodes=status.episodes,
        survival=status.survival,
        memory=status.figures,
        t_err_estimate=status.t_err_estimate,
        simulated_s=status.simulated_s,
        computed_s=computed_s,
        replayed_s=replayed_s,
        given_up=sum(status.given_up.values()),
    )


def show_memory(page: Page, path: Path) -> None:
    """Show all that a memory file tells of its learner.

    Raises:
        CheckpointError: the file is no usable checkpoint.
    """
    memory = read_memory(path)
    page.show_learner(memory.figures)
    page.show_episodes(memory.episodes)
    show_states(page, memory, "As in the memory file")


def show_states(page: Page, memory: Memory, as_of: str) -> None:
    """Show the states of a memory, and how old they are."""
    episodes = memory.figures.episodes
    page.show_map(memory.states, f"{as_of}, after {episodes:,} episodes.")


class MemoryFile:
    """A memory file that is written again and again, beside a running learner."""

    def __init__(self, path: Path) -> None:
        """Read nothing yet."""
        self._path = path
        self._looked_at = -_LOOK_S
        self._seen: tuple[int, int] | None = None

    def look(self) -> Memory | None:
        """Return what the file tells, if it has been written anew."""
        if time.monotonic() - self._looked_at < _LOOK_S:
            return None
        self._looked_at = time.monotonic()
        try:
            found = self._path.stat()
            if (found.st_mtime_ns, found.st_ino) == self._seen:
                return None
            self._seen = found.st_mtime_ns, found.st_ino
            return read_memory(self._path)
        except (OSError, BipedError):  # not written yet, or just being replaced
            return None
