"""Options that several verbs share."""

from __future__ import annotations

import argparse
from pathlib import Path

from biped_bringup.memory_settings import with_changes
from biped_bringup.replay import DEFAULT_MEMORY_BYTES
from biped_bringup.run_settings import (
    DEFAULT_PRESET,
    PRESETS,
    RunSettings,
    load_settings,
)
from biped_bringup.training import TrainingRun
from biped_common.command_line import CommandError, natural

_MEGABYTE = 1_000_000


def add_settings_options(parser: argparse.ArgumentParser) -> None:
    """Add --preset, --config and --set."""
    group = parser.add_argument_group("settings")
    group.add_argument(
        "--preset",
        choices=PRESETS,
        help="paper: 20 ms decisions, 15 successes per subtask; coarse: 100 ms "
        "decisions; quick: few successes per subtask, for demonstrations "
        f"(default: {DEFAULT_PRESET})",
    )
    group.add_argument(
        "--config",
        type=Path,
        metavar="YAML",
        help="settings laid over the preset's, in the same form",
    )
    group.add_argument(
        "--set",
        dest="changes",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="change one setting, e.g. learner.schedule.successes_per_subtask=5 or "
        "gait.double_support_s=1.0 [s]; repeatable; `biped check --show` lists all. Of "
        "a memory's settings, those in sim can be changed, and to learn on those in "
        "learner.schedule",
    )


def add_replay_options(parser: argparse.ArgumentParser) -> None:
    """Add --no-replay and --replay-mb."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "--replay-mb",
        type=natural,
        default=DEFAULT_MEMORY_BYTES // _MEGABYTE,
        metavar="N",
        help="memory for the walks so far, in MB (default %(default)s)",
    )
    group.add_argument(
        "--no-replay",
        dest="replay_mb",
        action="store_const",
        const=0,
        help="compute every walk to its end, also where it was walked before; the "
        "results are the same to the last bit",
    )


def replay_bytes_of(options: argparse.Namespace) -> int:
    """Return the memory that the options give to the replay of walks."""
    return int(options.replay_mb) * _MEGABYTE


def settings_of(options: argparse.Namespace) -> RunSettings:
    """Return the settings that the options describe."""
    return load_settings(preset_of(options), options.config, options.changes)


def preset_of(options: argparse.Namespace) -> str:
    """Return the name of the preset that the options choose."""
    return options.preset or DEFAULT_PRESET


def gone_on_with(
    options: argparse.Namespace,
    memory_file: Path,
    replay_bytes: int = DEFAULT_MEMORY_BYTES,
    *,
    learns: bool,
) -> TrainingRun:
    """Return the run of a memory, under the settings that the options change.

    Args:
        options: of the command.
        memory_file: what the run goes on with.
        replay_bytes: memory for the replay of walks, 0 to compute them all.
        learns: learning goes on; else one walk is walked, greedily.

    Raises:
        CheckpointError: the file is no memory.
        CommandError, SettingsError: an option changes what belongs to the memory.
    """
    if options.preset is not None:
        raise CommandError(
            f"--preset {options.preset}: a memory brings its own settings; --set and "
            "--config change them"
        )
    if learns and options.seed is not None:
        raise CommandError(f"--seed {options.seed}: a memory brings its own seed")
    run = TrainingRun.load(memory_file, replay_bytes)
    try:
        settings = with_changes(
            run.settings, options.config, options.changes, learns=learns
        )
        if settings == run.settings:
            return run
        changed = run.under(settings, replay_bytes)
    except BaseException:
        run.close()
        raise
    run.close()
    return changed
