"""`biped learn`: learn the walk in this process, on the full physics."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from biped_bringup.cli.figures import figures_text
from biped_bringup.cli.options import (
    add_replay_options,
    add_settings_options,
    gone_on_with,
    replay_bytes_of,
    settings_of,
)
from biped_bringup.cli.progress import TrainingProgress
from biped_bringup.training import TrainingRun
from biped_common.atomic_file import atomic_file
from biped_common.command_line import (
    DONE,
    INTERRUPTED,
    NOT_ACHIEVED,
    CommandError,
    add_json_option,
    duration_s,
    natural,
    positive,
    print_json,
    writable_folder,
)
from biped_common.exclusive_folder import exclusive_folder
from biped_common.signals import stop_requests
from learner_node.walking.episode_log import EpisodeLog
from msgs_json.episode_result import EpisodeResult

MEMORY_FILE = "memory.npz"
LOG_FILE = "episodes.csv"
_DEFAULT_OUT = Path("bags/learned")


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "learn",
        help="learn the walk, until a frozen greedy walk succeeds",
        description="Learn the walk in this process. Ends when the schedule is "
        "complete and a frozen greedy walk of the whole walk succeeds. Ctrl-C ends it "
        "after the running episode, with everything saved. Exit status 0 when learned, "
        "1 when the episodes ran out, 130 when interrupted.",
    )
    parser.add_argument(
        "--seed", type=natural, metavar="N", help="of every random draw (default 0)"
    )
    parser.add_argument(
        "--episodes", type=positive, metavar="N", help="give up after N episodes in all"
    )
    parser.add_argument(
        "--stop-at-schedule",
        action="store_true",
        help="end when the schedule is complete, as the paper does, whether or not a "
        "frozen greedy walk succeeds",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help=f"folder for {MEMORY_FILE} (all that was learned, and all that is needed "
        f"to go on) and {LOG_FILE} (default {_DEFAULT_OUT}; with --resume, the "
        "folder of that file)",
    )
    parser.add_argument(
        "--resume",
        type=Path,
        metavar="FILE",
        help=f"go on from a {MEMORY_FILE}, with its settings and seed, bit for bit as "
        "if never interrupted; with --set or --config, as another run under other "
        "settings",
    )
    parser.add_argument(
        "--fresh", action="store_true", help=f"replace a {MEMORY_FILE} in --out"
    )
    parser.add_argument(
        "--checkpoint-every",
        type=duration_s,
        default=20.0,
        metavar="S",
        help="seconds of real time between saves (default 20)",
    )
    add_replay_options(parser)
    add_settings_options(parser)
    add_json_option(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Learn and report."""
    training = _training(options)
    folder = options.out or (
        options.resume.parent if options.resume is not None else _DEFAULT_OUT
    )
    memory_file = folder / MEMORY_FILE
    try:
        nothing = training.nothing_to_do(options.episodes, options.stop_at_schedule)
        if nothing is not None:
            summary = report_nothing(
                training, nothing, options.resume, json=options.json
            )
            return _status(summary, options)
        if options.resume is None and memory_file.exists() and not options.fresh:
            raise CommandError(
                f"{memory_file}: is there already; give --resume {memory_file} to go "
                "on with it, --fresh to replace it, or another --out"
            )
        with exclusive_folder(writable_folder(folder)):
            return _learn(options, training, folder)
    finally:
        training.close()


def _learn(options: argparse.Namespace, training: TrainingRun, folder: Path) -> int:
    memory_file = folder / MEMORY_FILE
    console = Console(stderr=True)
    if training.version_changes:
        changes = ", ".join(training.version_changes)
        console.print(f"going on with other versions, not bit for bit: {changes}")
    if training.setting_changes:
        changes = training.setting_changes
        console.print(
            f"going on under other settings, not bit for bit: {changes}", soft_wrap=True
        )
    with stop_requests() as stops, TrainingProgress(training, console) as progress:
        saved = time.monotonic()

        def after_episode(_: EpisodeResult) -> bool:
            nonlocal saved
            progress.update()
            if time.monotonic() - saved >= options.checkpoint_every:
                training.save(memory_file)
                saved = time.monotonic()
            return not stops

        training.run(options.episodes, options.stop_at_schedule, after_episode)
        training.save(memory_file)
        write_log(training.log, folder)
    summary = training.summary(memory_file)
    if options.json:
        print_json(summary)
    else:
        _print(summary, folder, interrupted=bool(stops))
    return INTERRUPTED if stops else _status(summary, options)


def write_log(log: EpisodeLog, folder: Path) -> Path:
    """Write the table of episodes into a folder; return the file.

    Raises:
        OSError: it cannot be written.
    """
    path = folder / LOG_FILE
    with atomic_file(path) as file:
        file.write(log.csv_text().encode())
    return path


def _training(options: argparse.Namespace) -> TrainingRun:
    if options.resume is None:
        seed = 0 if options.seed is None else options.seed
        return TrainingRun(settings_of(options), seed, replay_bytes_of(options))
    if options.fresh:
        raise CommandError("--fresh: learns anew, which --resume does not")
    return gone_on_with(options, options.resume, replay_bytes_of(options), learns=True)


def _status(summary: dict[str, Any], options: argparse.Namespace) -> int:
    done = "schedule_complete" if options.stop_at_schedule else "completed"
    return DONE if summary[done] else NOT_ACHIEVED


def report_nothing(
    training: TrainingRun, reason: str, memory_file: Path, *, json: bool
) -> dict[str, Any]:
    """Say that a resumed run has come to its end already; return its summary."""
    summary = training.summary(memory_file)
    if json:
        print_json(summary)
    else:
        print(f"nothing to do with {memory_file}: {reason}")
    return summary


def _print(summary: dict[str, Any], folder: Path, interrupted: bool) -> None:
    if interrupted:
        print("interrupted; all episodes so far are saved")
    elif summary["completed"]:
        print("learned: a frozen greedy walk completes the whole walk")
    else:
        print("not learned yet")
    replay = (
        f"{summary['replayed_ticks']:,} control ticks, "
        f"{summary['computed_ticks']:,} computed"
        if summary["replay_off"] is None
        else f"off: {summary['replay_off']}"
    )
    print(
        f"episodes             {summary['episodes']}"
        f" (schedule complete after {summary['schedule_episodes'] or '-'},"
        f" greedy walk after {summary['greedy_episodes'] or '-'})\n"
        f"target time          {summary['target_time_s']:g} s\n"
        f"simulated            {summary['simulated_s']:.1f} s in "
        f"{summary['cpu_s']:.1f} CPU s\n"
        f"replay               {replay}\n"
        f"learner              {figures_text(summary['figures'])}\n"
        f"memory               {summary['memory_file']}\n"
        f"episode log          {folder / LOG_FILE}"
    )
    if not summary["completed"]:
        print(f"go on with           biped learn --resume {summary['memory_file']}")
