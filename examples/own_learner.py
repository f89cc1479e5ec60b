"""A learner of one's own, led through the walk: one correction per support phase.

    python examples/own_learner.py [SEED]

Chance moves all corrections before each walk, by a step at most; what walks as far as
any walk before is kept. Seeds 11 to 30 complete a walk after 4 to 65, in the median 21.
"""

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_bringup.run_settings import load_settings
from biped_bringup.walker import Walker
from biped_common.timing import seconds
from learner_node.learner import Inputs, Learner
from learner_node.walking.task import WalkTask
from learner_node.walking.walks import LearningWalk

Table = NDArray[np.int64]


class Climber(Learner):
    """Alternatives by right support, double support and component."""

    def __init__(self, alternatives: tuple[int, ...], rng: np.random.Generator) -> None:
        self.rng = rng
        self._last = np.array(alternatives) - 1
        self._best: Table = np.tile(self._last // 2, (2, 2, 1))
        self._record = 0

    def begin_episode(self, inputs: Inputs) -> None:
        moved = self._best + self.rng.integers(-1, 2, self._best.shape)
        self._tried: Table = np.clip(moved, 0, self._last)
        self._decisions, self._inputs = 0, inputs

    def choose(self) -> Table:
        self._decisions += 1
        return _row(self._tried, self._inputs)

    def advance(self, inputs: Inputs) -> None:
        self._inputs = inputs

    # How far it walked says enough.
    def reward(self, value: float, counts: bool, *_: Any) -> None: ...
    def penalise(self, penalty: int, *_: Any) -> None: ...
    def finish_subtask(self) -> None: ...

    # Nothing is kept before an episode's end.
    def give_up_episode(self) -> None: ...

    def finish_episode(self) -> None:
        if self._decisions >= self._record:
            self._best, self._record = self._tried, self._decisions

    def greedy(self, inputs: Inputs) -> Table:
        return _row(self._best, inputs)

    def figures(self) -> dict[str, float]:
        return {"record": self._record}

    def memory(self) -> dict[str, NDArray[Any]]:
        return {"best": self._best, "record": np.array(self._record)}

    def restore(self, memory: Any) -> None:
        self._best, self._record = memory["best"], int(memory["record"])


def _row(table: Table, inputs: Inputs) -> Table:
    return np.asarray(table[tuple((inputs[:2] > 0.0).astype(int))])


def main(seed: int = 14) -> int:
    """Walk until a walk is completed; exit status 1 if none of 100 is."""
    settings = load_settings(changes=["learner.schedule.first_target_s=11.25"])
    walker = Walker(settings, np.random.default_rng(0))
    task = WalkTask(settings.learner, walker.walk_ticks)
    alternatives, rng = task.problem.space.alternatives, np.random.default_rng(seed)
    walk = LearningWalk(task, Climber(alternatives, rng))
    for number in range(1, 101):
        result = walker.walk(walk)
        print(f"walk {number}: {result.end_cause}, {seconds(result.control_ticks):g} s")
        if result.completed:
            break
    walker.close()
    return 0 if result.completed else 1


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
