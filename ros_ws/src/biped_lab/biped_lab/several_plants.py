"""The walk learned on one plant, and on plants drawn anew for every walk.

    python -m biped_lab.several_plants --seeds 20

Learns with the same seeds on PyBullet, on MuJoCo, on either in turns of chance, and on
either with friction drawn as well; then walks what was learned, frozen, on each plant.
Prints a table in Markdown: episodes to the learned walk (inf: not learned), and how
many walks were completed.
"""

from __future__ import annotations

import argparse
import math
import statistics
import sys
from collections.abc import Sequence
from contextlib import closing
from typing import Final

import numpy as np

from biped_bringup.run_settings import (
    PRESETS,
    RunSettings,
    changed_settings,
    load_settings,
)
from biped_bringup.walker import Responder, Walker
from biped_common.command_line import positive
from biped_common.seeds import robot_stream
from biped_lab import markdown
from learner_node.methods import make_learner
from learner_node.walking.session import LearningSession
from msgs_json.episode_result import EpisodeResult

MOST_EPISODES: Final = 1000
PLANTS: Final = {
    "PyBullet": ("sim.engine=pybullet",),
    "MuJoCo": ("sim.engine=mujoco",),
    "kinematic": ("sim.engine=kinematic",),
    "PyBullet, friction 0.5": (
        "sim.engine=pybullet",
        "sim.disturbances.friction=0.5",
    ),
    "MuJoCo, friction 0.5": ("sim.engine=mujoco", "sim.disturbances.friction=0.5"),
}
LEARNED_ON: Final = {
    "PyBullet": ("PyBullet",),
    "MuJoCo": ("MuJoCo",),
    "either, drawn": ("PyBullet", "MuJoCo"),
    "either, friction 0.5 or 0.9, drawn": (
        "PyBullet",
        "MuJoCo",
        "PyBullet, friction 0.5",
        "MuJoCo, friction 0.5",
    ),
}


class DrawnPlantWalker(Walker):
    """Walks every walk on one of several plants, drawn at random."""

    def __init__(self, plants: Sequence[RunSettings], rng: np.random.Generator) -> None:
        """Build all plants; nothing but `sim` may differ between their settings."""
        super().__init__(plants[0], rng)
        others = [Walker(settings, rng).biped for settings in plants[1:]]
        self._bipeds = [self.biped, *others]
        self._rng = rng

    def walk(self, responder: Responder) -> EpisodeResult:
        """Draw a plant, and walk on it until the responder gives a result."""
        self.biped = self._bipeds[self._rng.integers(len(self._bipeds))]
        return super().walk(responder)

    def close(self) -> None:
        """End all worlds."""
        for biped in self._bipeds:
            biped.close()


def on(settings: RunSettings, plant: str) -> RunSettings:
    """Return the settings of a walk on a plant."""
    return changed_settings(settings, changes=PLANTS[plant])


def learn(
    settings: RunSettings, seed: int, plants: Sequence[str]
) -> LearningSession | None:
    """Return who has learned the walk on plants, None where that takes too long."""
    rng = np.random.default_rng(robot_stream(seed))
    walker = DrawnPlantWalker([on(settings, plant) for plant in plants], rng)
    with closing(walker):
        session = LearningSession(
            settings.learner, walker.walk_ticks, seed, make_learner
        )
        while not session.learned and session.episodes < MOST_EPISODES:
            walker.walk(session)
    return session if session.learned else None


def completed(session: LearningSession, settings: RunSettings, plant: str) -> bool:
    """Walk what was learned once, frozen; return whether it came to the end."""
    with closing(Walker(on(settings, plant), np.random.default_rng(0))) as walker:
        return walker.walk(session.greedy()).completed


def main() -> int:
    """Learn, walk and print."""
    parser = argparse.ArgumentParser(
        prog="python -m biped_lab.several_plants", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--preset", choices=PRESETS, default="directed")
    parser.add_argument("--seeds", type=positive, default=20, metavar="N")
    parser.add_argument("--first", type=positive, default=7101, metavar="SEED")
    options = parser.parse_args()
    settings = load_settings(options.preset)
    seeds = range(options.first, options.first + options.seeds)
    columns = ["learned on", "learned", "episodes, median", "by seed"]
    columns += [f"walks on {plant}" for plant in PLANTS]
    print(markdown.head(columns))
    for name, plants in LEARNED_ON.items():
        found = [learn(settings, seed, plants) for seed in seeds]
        print(_row(name, found, settings), flush=True)
    return 0


def _row(
    name: str,
    found: Sequence[LearningSession | None],
    settings: RunSettings,
) -> str:
    learned = [session for session in found if session is not None]
    # Those that did not learn took longer than any that did.
    episodes = [session.episodes if session else math.inf for session in found]
    cells = [
        name,
        f"{len(learned)} of {len(found)}",
        f"{statistics.median(episodes):g}",
        ", ".join(f"{n:g}" for n in episodes),
    ]
    return markdown.row(
        cells
        + [
            str(sum(completed(session, settings, plant) for session in learned))
            for plant in PLANTS
        ]
    )


if __name__ == "__main__":
    sys.exit(main())
