"""`biped lab run`: carry out a study, or what is missing of it."""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console

from biped_common.command_line import (
    DONE,
    INTERRUPTED,
    NODE_FAILURE,
    positive,
    writable_folder,
)
from biped_common.signals import stop_requests
from biped_lab.execution import OpenExecutor, carry_out_all, dask, processes
from biped_lab.progress import StudyProgress
from biped_lab.results import plan_study
from biped_lab.study import load_study, study_names

DEFAULT_OUT = Path("bags/lab")


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
        "--out",
        type=Path,
        default=DEFAULT_OUT,
        metavar="DIR",
        help=f"the laboratory's folder, for all studies (default {DEFAULT_OUT})",
    )
    parser.add_argument(
        "--workers",
        type=positive,
        default=os.cpu_count(),
        metavar="N",
        help="processes on this machine, one run and one thread each (default: one "
        "per core)",
    )
    parser.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="carry out on a Dask cluster that sees the same files, instead",
    )
    parser.add_argument(
        "--per-job",
        type=positive,
        default=1,
        metavar="N",
        help="runs that one job carries out, one after the other (default 1)",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Carry out the study."""
    study = load_study(options.study, reduced=options.reduced)
    folder = writable_folder(options.out)
    folders = plan_study(folder, study)
    console = Console(stderr=True)
    began = time.monotonic()
    with (
        stop_requests() as stops,
        StudyProgress(folder, study.name, console, options.workers) as progress,
    ):
        failures = carry_out_all(
            folders,
            _executor(options),
            stop_file=folder / f".stop-{os.getpid()}",
            stop_asked=lambda: bool(stops),
            watch=progress.update,
            per_job=options.per_job,
        )
    for failure in failures:
        console.print(f"{failure.folder.name}: {failure.reason}", markup=False)
    if stops:
        console.print("interrupted; all episodes so far are kept; the same goes on")
        return INTERRUPTED
    print(
        f"{study.name}: {len(folders) - len(failures)} of {len(folders)} runs done, "
        f"after {time.monotonic() - began:.0f} s\n"
        f"report it with      biped lab report {folder}"
    )
    return NODE_FAILURE if failures else DONE


def _executor(options: argparse.Namespace) -> OpenExecutor:
    if options.dask is not None:
        return partial(dask, options.dask)
    return partial(processes, options.workers)
