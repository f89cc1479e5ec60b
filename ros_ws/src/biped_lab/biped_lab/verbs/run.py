"""`biped lab run`: carry out a study, or what is missing of it."""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console

from biped_common.command_line import (
    DONE,
    INTERRUPTED,
    NODE_FAILURE,
    CommandError,
    duration_s,
    positive,
    writable_folder,
)
from biped_common.signals import stop_requests
from biped_lab.execution import (
    Driver,
    Failure,
    OpenExecutor,
    new_stop_file,
    processes,
)
from biped_lab.progress import StudyProgress
from biped_lab.results import plan_study
from biped_lab.run_folder import CHECKPOINT_EVERY_S
from biped_lab.study import load_study, study_names

DEFAULT_OUT = Path("bags/lab")
_PER_SLURM_JOB = 8
_SLURM_MINUTES = 120


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "run",
        help="carry out a study, or what is missing of it",
        description="Carry out the runs of a study. A run that is done is never run "
        "again; one that was interrupted or killed goes on bit for bit. Ctrl-C ends "
        "all runs after their present episode, with everything kept. Exit status 0 "
        "when all runs are done, 3 when some could not be carried out, 130 when "
        "interrupted.",
    )
    parser.add_argument(
        "study",
        help=f"one of {', '.join(study_names())}; or a YAML file",
    )
    parser.add_argument(
        "--reduced", action="store_true", help="the smaller form of the study"
    )
    parser.add_argument(
        "--seeds",
        type=positive,
        metavar="N",
        help="no more than the first N seeds of each arm; the rest can follow at any "
        "time (default: all)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=DEFAULT_OUT,
        metavar="DIR",
        help=f"the laboratory's folder, for all studies (default {DEFAULT_OUT})",
    )
    parser.add_argument(
        "--checkpoint-every",
        type=duration_s,
        default=CHECKPOINT_EVERY_S,
        metavar="S",
        help="what a run loses at most when its worker is killed "
        f"[s] (default {CHECKPOINT_EVERY_S:g})",
    )
    parser.add_argument(
        "--per-job",
        type=positive,
        metavar="N",
        help="runs that one job carries out, one after the other (default 1; "
        f"{_PER_SLURM_JOB} with --slurm)",
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--workers",
        type=positive,
        default=len(os.sched_getaffinity(0)),
        metavar="N",
        help="processes on this machine, one run and one thread each (default: one "
        "per core)",
    )
    where.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="carry out on a Dask cluster that sees the same files, instead; start its "
        "workers with --nthreads 1",
    )
    where.add_argument(
        "--slurm",
        action="store_true",
        help="carry out as jobs of the SLURM cluster of this machine, instead; its "
        "nodes must see the same files; logs are in DIR/slurm",
    )
    parser.add_argument(
        "--slurm-partition", metavar="NAME", help="default: the cluster's"
    )
    parser.add_argument(
        "--slurm-minutes",
        type=positive,
        default=_SLURM_MINUTES,
        metavar="N",
        help="time limit of a job [min]; what does not end in it goes on in another "
        f"one (default {_SLURM_MINUTES})",
    )
    parser.add_argument(
        "--slurm-option",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="an option of sbatch, such as account=biped or mem=2G; as often as needed",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Carry out the study."""
    study = load_study(options.study, reduced=options.reduced)
    folder = writable_folder(options.out).absolute()  # workers may be elsewhere
    open_executor = _executor(options, folder)
    here = not (options.dask or options.slurm)
    folders = plan_study(folder, study, options.seeds)
    console = Console(stderr=True)
    began = time.monotonic()
    with (
        stop_requests() as stops,
        StudyProgress(
            folder, study.name, console, options.workers if here else None
        ) as progress,
    ):
        failures = Driver(
            open_executor,
            new_stop_file(folder),
            stop_asked=lambda: bool(stops),
            watch=progress.update,
            per_job=options.per_job or (_PER_SLURM_JOB if options.slurm else 1),
            checkpoint_every_s=options.checkpoint_every,
        ).carry_out_all(folders)
        progress.update()
    for reason, failed in _by_reason(failures).items():
        console.print(f"{failed}: {reason}", markup=False, soft_wrap=True)
    if stops:
        console.print("interrupted; all episodes so far are kept; the same goes on")
        return INTERRUPTED
    print(
        f"{study.name}: {len(folders) - len(failures)} of {len(folders)} runs done, "
        f"after {time.monotonic() - began:.0f} s\n"
        f"report it with      biped lab report {options.out}"
    )
    return NODE_FAILURE if failures else DONE


def _executor(options: argparse.Namespace, folder: Path) -> OpenExecutor:
    if options.dask is not None:
        with _extra("dask"):
            from biped_lab.dask_cluster import dask
        return partial(dask, options.dask)
    if options.slurm:
        with _extra("slurm"):
            from biped_lab.slurm_cluster import slurm
        return partial(
            slurm,
            folder / "slurm",
            options.slurm_partition,
            options.slurm_minutes,
            dict(map(_name_and_value, options.slurm_option)),
        )
    return partial(processes, options.workers)


@contextmanager
def _extra(name: str) -> Iterator[None]:
    try:
        yield
    except ImportError as error:
        raise CommandError(
            f"--{name}: {error.name} is not installed; the extra {name!r} of this "
            "package brings it"
        ) from None


def _name_and_value(option: str) -> tuple[str, str]:
    name, equals, value = option.partition("=")
    if not (name and equals):
        raise CommandError(f"--slurm-option {option}: must be NAME=VALUE")
    return name, value


def _by_reason(failures: Sequence[Failure]) -> dict[str, str]:
    """Return which runs failed, in words, by why."""
    runs: dict[str, list[str]] = {}
    for failure in failures:
        runs.setdefault(failure.reason, []).append(failure.folder.name)
    return {
        reason: names[0] + (f" and {len(names) - 1} more" if names[1:] else "")
        for reason, names in runs.items()
    }
