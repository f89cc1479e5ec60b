"""Walks where robot, floor or senses are not as planned, at test or in learning too.

    python -m biped_lab.robustness --seeds 20
    python -m biped_lab.robustness --seeds 20 --while-learning

Learns the walk with XoL beyond the paper, with the same but for fixed-mode states, with
XoL by Strategy 2, and by a search over plans, which answers no observation, on the same
seeds; undisturbed, or under each disturbance. Then walks what was learned, frozen,
under each disturbance, some walks per seed; and so the optimal plan, which is known to
the one who knows the undisturbed plant. Prints a table in Markdown: how many walks were
completed, of those whose learning came to its end, and how long learning took. Needs
the extra `mujoco`.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from functools import partial
from statistics import median
from typing import Final, NamedTuple

import numpy as np

from biped_bringup.replay import ReplayingWalker
from biped_bringup.run_settings import (
    PRESETS,
    RunSettings,
    changed_settings,
    load_settings,
)
from biped_bringup.training import TrainingRun
from biped_bringup.walker import Walker
from biped_common.command_line import positive
from biped_common.seeds import learner_stream, robot_stream, trial_stream
from biped_common.settings import to_mapping
from biped_lab.markdown import Table
from biped_lab.searches.linear_programming import optimum
from biped_lab.searches.plan import PlanSpace
from biped_lab.searches.search_contestant import PlannedWalk, planned_task
from biped_lab.searches.searcher import Walked
from biped_lab.searches.tail_search import TailSearch, TailSearchOptions
from learner_node.walking.walks import FrozenWalk
from sim_node.settings import SensorSettings

MOST_EPISODES = 400
SENSED = "sim.observations=sensors"


def sensor_noise(times: float) -> tuple[str, ...]:
    """Return changes that make all noise so many times that of the settings."""
    return tuple(
        f"sim.sensors.{name}={times * value:.6f}"
        for name, value in to_mapping(SensorSettings()).items()
        if "_noise_" in name
    )


DISTURBANCES: Final = {
    "none": (),
    "friction 0.5 instead of 0.9": ("sim.disturbances.friction=0.5",),
    "masses, 5 % std. dev. a link": ("sim.disturbances.mass_error=0.05",),
    "masses, 15 %": ("sim.disturbances.mass_error=0.15",),
    "a push of 5 N for 0.1 s": ("sim.disturbances.push_force_n=5",),
    "a push of 20 N": ("sim.disturbances.push_force_n=20",),
    "waist position, 2 mm noise": ("sim.disturbances.position_noise_m=0.002",),
    "ZMP, 2 mm noise": ("sim.disturbances.zmp_noise_m=0.002",),
    "acceleration, 0.1 m/s^2 noise": ("sim.disturbances.acceleration_noise_m_s2=0.1",),
    "sensors that are one tick late": (
        SENSED, *sensor_noise(0.0), "sim.sensors.delay_ticks=1",
    ),
    "the engine without contact": ("sim.engine=kinematic",),
    "MuJoCo instead of PyBullet": ("sim.engine=mujoco",),
}  # fmt: skip


class Learned(NamedTuple):
    """What came of learning."""

    episodes: int
    walk: Callable[[], FrozenWalk | PlannedWalk]
    """Returns the walk that was learned, to be walked from its beginning."""


Way = Callable[[RunSettings, int], Learned | None]
"""Learns with settings and a seed; None where that takes too long."""


def learn(settings: RunSettings, seed: int) -> Learned | None:
    """Return the greedy walk that a learner learns, None where it does not in time."""
    with closing(TrainingRun(settings, seed)) as run:
        run.run(MOST_EPISODES, False, lambda _: True)
        return Learned(run.episodes, run.session.greedy) if run.learned else None


def search(settings: RunSettings, seed: int) -> Learned | None:
    """Return the walk that tail search finds, None where it does not in time."""
    space = PlanSpace.of_knots(settings)
    searching, disturbing = (
        np.random.default_rng(stream(seed)) for stream in (learner_stream, robot_stream)
    )
    searcher = TailSearch(TailSearchOptions(), space, searching)
    task = planned_task(settings)
    # Where chance has a part in the walks, none is like another.
    kind = Walker if settings.sim.random else ReplayingWalker
    with closing(kind(settings, disturbing)) as walker:
        for episode in range(MOST_EPISODES):
            chosen = space.nearest(searcher.ask(space.points))
            result = walker.walk(PlannedWalk(task, space, chosen))
            if result.completed:
                walk = partial(PlannedWalk, task, space, chosen)
                return Learned(episode + 1, walk)
            cost = math.inf if result.cost is None else result.cost.total
            searcher.tell(Walked(result.control_ticks, result.completed, cost))
    return None


def solve(settings: RunSettings, _: int) -> Learned:
    """Return the optimal plan of the linear model, which is the undisturbed plant's."""
    space = PlanSpace.of_learning_ticks(settings)
    chosen = space.nearest(optimum(settings, space).plan_m)
    return Learned(0, partial(PlannedWalk, planned_task(settings), space, chosen))


def contestants(
    preset: str,
) -> Iterator[tuple[str, RunSettings, Way]]:
    """Yield name, settings and way to learn of each.

    Args:
        preset: of the one beyond the paper; gait and correction of all are as in it.
    """
    beyond = load_settings(preset)
    paper = load_settings(
        changes=[
            "learner.xol.fixed_mode.strategy=strategy2",
            "learner.schedule.successes_per_subtask=3",
        ]
    )
    paper = replace(paper, gait=beyond.gait, correction=beyond.correction)
    yield f"XoL, preset {preset}", beyond, learn
    explores = changed_settings(
        beyond, changes=["learner.xol.fixed_mode.strategy=none"]
    )
    yield "the same, no fixed mode", explores, learn
    yield "XoL, Strategy 2, LT = 3", paper, learn
    yield "tail search", beyond, search
    yield "linear programming", beyond, solve


def completed(
    learned: Learned, settings: RunSettings, seed: int, walks: int = 1
) -> int:
    """Walk what was learned; return how many walks came to the end."""
    walker = Walker(settings, np.random.default_rng(trial_stream(seed)))
    with closing(walker):
        return sum(walker.walk(learned.walk()).completed for _ in range(walks))


def column(
    settings: RunSettings, way: Way, seeds: range, walks: int, while_learning: bool
) -> Iterator[str]:
    """Yield a cell for each disturbance: walks completed, episodes of learning."""
    found: dict[int, Learned | None] = {}
    for changes in DISTURBANCES.values():
        disturbed = changed_settings(settings, changes=changes)
        if while_learning or not found:
            found = {n: way(disturbed, n) for n in seeds}
        learned = {n: walk for n, walk in found.items() if walk is not None}
        held = sum(completed(w, disturbed, n, walks) for n, w in learned.items())
        of = f"{held} of {walks * len(learned)}"
        # Those that did not learn took longer than any that did.
        episodes = median(w.episodes if w else math.inf for w in found.values())
        yield f"{of}; {len(learned)} learned, {episodes:g}" if while_learning else of


def main() -> int:
    """Learn, walk and print."""
    parser = argparse.ArgumentParser(
        prog="python -m biped_lab.robustness", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--preset", choices=PRESETS, default="directed")
    parser.add_argument("--seeds", type=positive, default=20, metavar="N")
    parser.add_argument("--first", type=positive, default=7001, metavar="SEED")
    parser.add_argument(
        "--walks", type=positive, default=1, metavar="N", help="per seed (default 1)"
    )
    parser.add_argument(
        "--columns",
        type=int,
        choices=range(1, 6),
        nargs="+",
        metavar="N",
        help="only these, of the five: 1 beyond the paper, 2 without fixed mode, "
        "3 Strategy 2, 4 plan that was searched, 5 optimal plan",
    )
    parser.add_argument(
        "--while-learning",
        action="store_true",
        help="disturbances are there while learning, too; a cell then also says how "
        "many seeds learned, and the median of their episodes",
    )
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
    columns: dict[str, list[str]] = {}
    for n, (name, settings, way) in enumerate(contestants(options.preset), 1):
        if options.columns is not None and n not in options.columns:
            continue
        columns[name] = list(
            column(settings, way, seeds, options.walks, options.while_learning)
        )
        print(f"{name}: walked", file=sys.stderr, flush=True)
    rows = zip(DISTURBANCES, *columns.values(), strict=True)
    print(Table(("disturbance", *columns), tuple(rows)).markdown(), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
