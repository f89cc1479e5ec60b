"""Walks where robot, floor or senses are not as planned, at test or in learning too.

    python -m biped_lab.robustness --seeds 20
    python -m biped_lab.robustness --seeds 20 --while-learning
    python -m biped_lab.robustness --seeds 20 --learning-limit 0.045
    python -m biped_lab.robustness --seeds 20 --tighten

Learns the walk with XoL beyond the paper, with XoL by the paper's rules (Strategy 2),
with each of them but without fixed-mode states, and by a search over plans, which
answers no observation, on the same seeds; undisturbed, or under each disturbance; with
the limit of the ZMP error that is walked with, or stricter ones. Then walks what was
learned, frozen, under each disturbance, some walks per seed; and so the optimal plan,
which is known to the one who knows the undisturbed plant. Prints a table in Markdown:
how many walks were completed, of those whose learning came to its end, and how long
learning took. Needs the extra `mujoco`.
"""

from __future__ import annotations

import argparse
import itertools
import math
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
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
from biped_common.settings import SettingsError, to_mapping
from biped_lab.execution import processes
from biped_lab.markdown import Table
from biped_lab.searches.linear_programming import optimum
from biped_lab.searches.plan import PlanSpace
from biped_lab.searches.search_contestant import PlannedWalk, planned_task
from biped_lab.searches.searcher import Walked
from biped_lab.searches.tail_search import TailSearch, TailSearchOptions
from learner_node.walking.walks import FrozenWalk
from sim_node.settings import SensorSettings

MOST_EPISODES = 400
TIGHTENING_M: Final = 0.0025
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


def limited(settings: RunSettings, limit_m: float) -> RunSettings:
    """Return settings with another limit of the ZMP error [m].

    Raises:
        SettingsError: it is out of range.
    """
    return changed_settings(settings, changes=[f"sim.limits.zmp_error_m={limit_m:.6g}"])


def learn(settings: RunSettings, seed: int) -> Learned | None:
    """Return the greedy walk that a learner learns, None where it does not in time."""
    with closing(TrainingRun(settings, seed)) as run:
        run.run(MOST_EPISODES, False, lambda _: True)
        return Learned(run.episodes, run.session.greedy) if run.learned else None


def tighten(settings: RunSettings, seed: int) -> Learned | None:
    """Return the walk with the widest margin that a learner learns in time.

    When a frozen walk has come to the end, the learner goes on with what it knows under
    a limit of the ZMP error that is 2.5 mm stricter, and so on. Its episodes are those
    until the last limit that it mastered.
    """
    widest = None
    run = TrainingRun(settings, seed)
    for stricter in itertools.count(1):
        with closing(run):
            run.run(MOST_EPISODES, False, lambda _: True)
        if not run.learned:
            break
        widest = Learned(run.episodes, run.session.greedy)
        limit_m = settings.sim.limits.zmp_error_m - stricter * TIGHTENING_M
        run = run.under(limited(settings, limit_m))
    return widest


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


def contestants(preset: str) -> dict[str, tuple[str, RunSettings, Way]]:
    """Return name, settings and way to learn of each.

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
    return {
        "beyond": (f"XoL, preset {preset}", beyond, learn),
        "beyond-explores": ("the same, no fixed mode", exploring(beyond), learn),
        "paper": ("XoL, Strategy 2, LT = 3", paper, learn),
        "paper-explores": ("Strategy none, LT = 3", exploring(paper), learn),
        "search": ("tail search", beyond, search),
        "optimum": ("linear programming", beyond, solve),
    }


def exploring(settings: RunSettings) -> RunSettings:
    """Return settings of a learner without fixed-mode states."""
    return changed_settings(settings, changes=["learner.xol.fixed_mode.strategy=none"])


def within(limit_m: float, way: Way) -> Way:
    """Return a way to learn that keeps the ZMP error below a limit of its own [m]."""

    def learn_within(settings: RunSettings, seed: int) -> Learned | None:
        return way(limited(settings, limit_m), seed)

    return learn_within


def completed(
    learned: Learned, settings: RunSettings, seed: int, walks: int = 1
) -> int:
    """Walk what was learned; return how many walks came to the end."""
    walker = Walker(settings, np.random.default_rng(trial_stream(seed)))
    with closing(walker):
        return sum(walker.walk(learned.walk()).completed for _ in range(walks))


class Outcome(NamedTuple):
    """What came of one seed under one disturbance."""

    episodes: int | None
    """Of learning; None: not learned in time."""
    completed: int
    """Of the walks of what was learned."""


@dataclass(frozen=True)
class Trial:
    """Learning and walking under each disturbance, by one contestant."""

    preset: str
    who: str
    """Of the `contestants`."""
    walks: int = 1
    """Per seed and disturbance."""
    while_learning: bool = False
    """Disturbances are there while learning, too."""
    learning_limit_m: float | None = None
    """Of the ZMP error while learning, if not that of the preset."""
    tightens: bool = False
    """Who learns goes on under ever stricter limits."""

    def outcomes(self, seed: int) -> list[Outcome]:
        """Learn and walk with a seed; return what came of it, by disturbance."""
        _, settings, way = contestants(self.preset)[self.who]
        if self.tightens and way is learn:
            way = tighten
        if self.learning_limit_m is not None:
            way = within(self.learning_limit_m, way)
        outcomes: list[Outcome] = []
        for changes in DISTURBANCES.values():
            disturbed = changed_settings(settings, changes=changes)
            if self.while_learning or not outcomes:
                learned = way(disturbed, seed)
            held = 0 if learned is None else completed(
                learned, disturbed, seed, self.walks
            )  # fmt: skip
            episodes = None if learned is None else learned.episodes
            outcomes.append(Outcome(episodes, held))
        return outcomes

    def cells(self, of_seeds: Sequence[Sequence[Outcome]]) -> Iterator[str]:
        """Yield for each disturbance how many walks were completed, of how many.

        How long learning took is said where it is not the same as in the cell before.
        """
        for row, of_row in enumerate(zip(*of_seeds, strict=True)):
            learned = sum(each.episodes is not None for each in of_row)
            held = sum(each.completed for each in of_row)
            cell = f"{held} of {self.walks * learned}"
            if self.while_learning or row == 0:
                # Those that did not learn took longer than any that did.
                took = median(
                    math.inf if each.episodes is None else each.episodes
                    for each in of_row
                )
                cell += f"; {learned} learned, {took:g}"
            yield cell


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
    everybody = contestants(PRESETS[0])
    parser.add_argument(
        "--columns",
        choices=tuple(everybody),
        default=tuple(everybody),
        nargs="+",
        metavar="WHO",
        help=f"only these, of {', '.join(everybody)}",
    )
    limits = parser.add_mutually_exclusive_group()
    limits.add_argument(
        "--learning-limit",
        type=float,
        metavar="M",
        help="of the ZMP error while learning [m]; walks have the one of the preset",
    )
    limits.add_argument(
        "--tighten",
        action="store_true",
        help="learners go on under a limit that is 2.5 mm stricter each time, for 400 "
        "episodes in all",
    )
    parser.add_argument(
        "--while-learning",
        action="store_true",
        help="disturbances are there while learning, too; every cell then says how "
        "many seeds learned, and the median of their episodes",
    )
    parser.add_argument(
        "--workers",
        type=positive,
        default=len(os.sched_getaffinity(0)),
        metavar="N",
        help="processes, each with a seed at a time (default: the cores there are)",
    )
    options = parser.parse_args()
    if options.learning_limit is not None:
        try:
            limited(load_settings(options.preset), options.learning_limit)
        except SettingsError as error:
            parser.error(f"--learning-limit {error.value}: {error.allowed}")
    seeds = range(options.first, options.first + options.seeds)
    columns: dict[str, list[str]] = {}
    with processes(options.workers) as pool:
        for who, (name, _, _) in contestants(options.preset).items():
            if who not in options.columns:
                continue
            trial = Trial(
                options.preset,
                who,
                options.walks,
                options.while_learning,
                options.learning_limit,
                options.tighten,
            )
            of_seeds = []
            for seed, outcomes in zip(
                seeds, pool.map(trial.outcomes, seeds), strict=True
            ):
                of_seeds.append(outcomes)
                walked = ", ".join(f"{n} after {took}" for took, n in outcomes)
                print(f"{name}, seed {seed}: {walked}", file=sys.stderr, flush=True)
            columns[name] = list(trial.cells(of_seeds))
    rows = zip(DISTURBANCES, *columns.values(), strict=True)
    print(Table(("disturbance", *columns), tuple(rows)).markdown(), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
