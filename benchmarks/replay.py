"""Learning with and without replay: CPU time, memory, and that nothing else differs.

    python -m benchmarks.replay --seeds 801-805

learns to the schedule's end with every seed and setting: an hour or two of CPU time.
`python -m benchmarks replay` takes a few minutes of it. The two runs of a seed go on in
turns, episode by episode, so that a drift of the machine's speed cancels out, and must
agree in what they learn and walk.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from multiprocessing import get_context

from benchmarks.report import Figure
from biped_bringup.replay import DEFAULT_MEMORY_BYTES, ReplayingWalker
from biped_bringup.run_settings import RunSettings, load_settings
from biped_bringup.training import TrainingRun

_MEGABYTE = 1_000_000
_FIXED_MODE = "learner.xol.fixed_mode"
_ARMS = {
    "paper, K = 15": (),
    "paper, K = 1": (f"{_FIXED_MODE}.rewards_to_fix=1",),
    "paper, no fixed mode": (f"{_FIXED_MODE}.strategy=none",),
}
# How many times less CPU time replay must take in the median over the seeds.
_LESS_CPU = {"paper, K = 15": 3.0, "paper, K = 1": 20.0, "paper, no fixed mode": 0.95}
_TICK_BOUND_US = 30.0
_MEMORY_FACTOR = 1.2

_SHORT_SEED = 801
_LITTLE_PRACTICE = "learner.schedule.successes_per_subtask=3"
_SHORT_LESS_CPU = {"paper, K = 1": 4.0, "paper, no fixed mode": 0.95}
_SHORT_EPISODES = 100
_SHORT_BYTES = 20 * _MEGABYTE


@dataclass(frozen=True)
class Pair:
    """One seed, learned without and with replay."""

    seed: int
    episodes: int
    found: float
    """Share of the control ticks that was known from earlier walks."""
    computed_s: float
    replayed_s: float
    """CPU time without and with replay."""
    replayed_tick_us: float
    """CPU time per learning tick of episodes without any physics, learner included."""
    tree_mb: float
    """What the tree took at most, by its own account."""
    resident_mb: float
    """By how much the process grew."""

    @property
    def less_cpu(self) -> float:
        """How many times less CPU time replay took."""
        return self.computed_s / self.replayed_s

    def line(self) -> str:
        """Return the pair for people."""
        return (
            f"  seed {self.seed}  episodes {self.episodes:5d}  "
            f"found {100 * self.found:5.1f} %  "
            f"CPU {self.computed_s:6.1f} -> {self.replayed_s:6.1f} s  "
            f"{self.less_cpu:5.2f} times less  "
            f"replayed tick {self.replayed_tick_us:5.1f} us  "
            f"tree {self.tree_mb:4.0f} MB, process + {self.resident_mb:4.0f} MB"
        )


def learned_twice(
    settings: RunSettings, seed: int, most_episodes: int, replay_bytes: int
) -> Pair:
    """Learn to the schedule's end, or for so many episodes, both ways.

    Raises:
        RuntimeError: the two runs differ.
    """
    with (
        closing(TrainingRun(settings, seed, replay_bytes=0)) as computed,
        closing(TrainingRun(settings, seed, replay_bytes)) as replayed,
    ):
        walker = replayed.walker
        assert isinstance(walker, ReplayingWalker)
        resident = _resident_bytes()
        tree = 0
        pure_s, pure_ticks = 0.0, 0
        while computed.episodes < most_episodes and not computed.learned:
            computed.episode()
            before, ticks_before = replayed.cpu_s, dict(vars(walker.ticks))
            replayed.episode()
            tree = max(tree, walker.used_bytes)
            if walker.ticks.computed == ticks_before["computed"]:
                pure_s += replayed.cpu_s - before
                pure_ticks += walker.ticks.replayed - ticks_before["replayed"]
            if computed.tally != replayed.tally:
                raise RuntimeError(f"seed {seed}: not the same with replay")
            if computed.tally.schedule_episodes is not None:
                break
        if computed.session.memory_sha256() != replayed.session.memory_sha256():
            raise RuntimeError(f"seed {seed}: another memory with replay")
        return Pair(
            seed,
            computed.episodes,
            walker.ticks.replayed / computed.walker.ticks.computed,
            computed.cpu_s,
            replayed.cpu_s,
            1e7 * pure_s / max(1, pure_ticks),
            tree / _MEGABYTE,
            (_resident_bytes() - resident) / _MEGABYTE,
        )


def measure() -> Iterator[Figure]:
    """Yield the figures of the short form: one seed with little practice."""
    pairs = {}
    for arm, at_least in _SHORT_LESS_CPU.items():
        settings = load_settings("paper", None, (*_ARMS[arm], _LITTLE_PRACTICE))
        (pair,) = _pairs(settings, [_SHORT_SEED], _SHORT_EPISODES, _SHORT_BYTES)
        less = f"replay, {arm}, LT = 3: times less CPU"
        yield Figure(less, pair.less_cpu, "", at_least=at_least)
        pairs[arm] = pair
    yield Figure(
        "replayed learning tick, learner included",
        pairs["paper, K = 1"].replayed_tick_us,
        "us",
        _TICK_BOUND_US,
    )
    yield Figure(
        f"replay within {_SHORT_BYTES // _MEGABYTE} MB: growth of the process",
        pairs["paper, no fixed mode"].resident_mb,
        "MB",
        _MEMORY_FACTOR * _SHORT_BYTES / _MEGABYTE,
    )


def _pairs(
    settings: RunSettings, seeds: list[int], most_episodes: int, replay_bytes: int
) -> Iterator[Pair]:
    """Learn in a process of its own per seed, whose memory is that of nobody else."""
    with ProcessPoolExecutor(
        1, mp_context=get_context("spawn"), max_tasks_per_child=1
    ) as pool:
        for seed in seeds:
            yield pool.submit(
                learned_twice, settings, seed, most_episodes, replay_bytes
            ).result()


def _resident_bytes() -> int:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


def main() -> int:
    """Measure the whole."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.replay", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--seeds", default="801-805", metavar="FIRST-LAST")
    parser.add_argument("--episodes", type=int, default=1_500, help="at most")
    parser.add_argument("--arm", action="append", choices=list(_ARMS))
    parser.add_argument(
        "--replay-mb", type=int, default=DEFAULT_MEMORY_BYTES // _MEGABYTE
    )
    options = parser.parse_args()
    first, _, last = options.seeds.partition("-")
    seeds = list(range(int(first), int(last or first) + 1))
    kept = True
    for arm in options.arm or _ARMS:
        print(arm, flush=True)
        pairs = []
        settings = load_settings("paper", None, _ARMS[arm])
        for pair in _pairs(
            settings, seeds, options.episodes, options.replay_mb * _MEGABYTE
        ):
            print(pair.line(), flush=True)
            pairs.append(pair)
        figure = Figure(
            "  times less CPU, median over the seeds",
            statistics.median(pair.less_cpu for pair in pairs),
            "",
            at_least=_LESS_CPU[arm],
        )
        print(figure.line(), flush=True)
        kept = kept and figure.kept
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
