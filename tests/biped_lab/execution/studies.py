"""Small studies, ways to carry them out, and what came of them."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

from biped_lab.execution import Driver, Failure, OpenExecutor, new_stop_file
from biped_lab.results import RUNS, plan_study, read_results
from biped_lab.study import study_of

WALKS = {
    "title": "one step",
    "preset": "quick",
    "settings": {
        "gait.steps": 1,
        "learner.schedule.successes_per_subtask": 2,
    },
    "goal": "greedy",
    "most_episodes": 25,
    "seeds": {"first": 1, "count": 1},
    "arms": {
        "fixed": None,
        "free": {"settings": {"learner.xol.fixed_mode.strategy": "none"}},
    },
}
"""Two runs of a dozen episodes each, of 0.5 to 1 s of processor time."""
COSTS = ["computed_s", "replayed_s", "cpu_s", "sittings"]

here = partial(ThreadPoolExecutor, 1)
"""One worker, in this process."""


def odd(seeds: int = 1, **kinds: str) -> dict[str, Any]:
    """A study of contestants that misbehave; arms by name."""
    return {
        "title": "odd",
        "preset": "quick",
        "contestant": "odd",
        "most_episodes": 5,
        "seeds": {"first": 1, "count": seeds},
        "arms": {name: {"options": {"kind": kind}} for name, kind in kinds.items()},
    }


def planned(folder: Path, values: dict[str, Any]) -> list[Path]:
    """The folders of a study's runs."""
    return plan_study(folder, study_of("small", values))


def carried_out(
    folder: Path,
    values: dict[str, Any],
    open_executor: OpenExecutor = here,
    stop_asked: Callable[[], bool] = lambda: False,
    watch: Callable[[], None] = lambda: None,
    checkpoint_every_s: float = 0.0,
    per_job: int = 1,
) -> list[Failure]:
    """Carry out a study; return what failed."""
    return Driver(
        open_executor,
        new_stop_file(folder),
        stop_asked,
        watch,
        per_job,
        checkpoint_every_s,
    ).carry_out_all(planned(folder, values))


def what_came_of(folder: Path) -> dict[str, bytes]:
    """What runs and tables must have in common, however they were carried out."""
    files = [
        run / name
        for run in (folder / RUNS).iterdir()
        for name in ("run.json", "end.json", "episodes.parquet")
    ]
    runs = read_results(folder, "small").runs.drop(columns=COSTS)
    return {
        "small/runs": runs.to_csv().encode(),
        **{str(file.relative_to(folder)): file.read_bytes() for file in files},
    }


def left_behind(folder: Path) -> list[str]:
    """Files that nobody needs any more."""
    return [path.name for path in folder.rglob(".*")]
