"""The learning schedule (Section 5.1): from the first step to the whole walk."""

from __future__ import annotations

from biped_common.timing import (
    LEARNING_PERIOD_US,
    TICKS_PER_LEARNING_TICK,
    microseconds,
)
from learner_node.walking.settings import ScheduleSettings


class LearningSchedule:
    """Target walking time t_f, extended after LT successes.

    T_step is not a whole number of learning ticks, and the learner sees the walk at
    learning ticks only: targets are rounded up to the next one, but never beyond the
    walk's own end.
    """

    def __init__(self, settings: ScheduleSettings, walk_ticks: int) -> None:
        """Lay out the subtasks.

        Args:
            settings: LT, first target and extension.
            walk_ticks: control ticks of the whole walk, the last target.
        """
        self._settings = settings
        first_us = microseconds(settings.first_target_s)
        extension_us = microseconds(settings.extension_s)
        targets: list[int] = []
        while not targets or targets[-1] < walk_ticks:
            target_us = first_us + len(targets) * extension_us
            learning_ticks = -(-target_us // LEARNING_PERIOD_US)
            targets.append(min(learning_ticks * TICKS_PER_LEARNING_TICK, walk_ticks))
        self.targets = tuple(targets)
        """Control ticks to walk, per subtask."""
        self.subtask = 0
        self.successes = 0
        self.complete = False

    @property
    def target_ticks(self) -> int:
        """Control ticks to walk in the present subtask."""
        return self.targets[self.subtask]

    def count_success(self) -> bool:
        """Count one RWDforSuc; return whether that finished a subtask.

        Once all subtasks are finished the schedule is complete, and the last one is
        repeated for as long as learning goes on.
        """
        self.successes += 1
        if self.successes < self._settings.successes_per_subtask:
            return False
        self.successes = 0
        if self.subtask == len(self.targets) - 1:
            self.complete = True
        else:
            self.subtask += 1
        return True
