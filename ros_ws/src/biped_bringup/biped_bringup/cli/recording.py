"""What `biped up` records: options, the recorder's parameters, the summary."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from biped_bag.errors import BagError
from biped_bag.recorder.settings import RecorderSettings
from biped_bag.records import COMPLETE, LOST_KEY, STATE_KEY
from biped_bag.storage.layout import holds_bag
from biped_bag.storage.metadata import read_metadata
from biped_bringup.supervisor.supervisor import RECORDER, Supervisor
from biped_common.command_line import CommandError
from biped_common.settings import to_mapping
from biped_ros.parameters import flattened

NOWHERE = "none"


def add_recording_options(parser: argparse.ArgumentParser) -> None:
    """Add --record and --record-split."""
    group = parser.add_argument_group("recording")
    group.add_argument(
        "--record",
        metavar="DIR",
        help="bag to record every topic to, MCAP in the layout of rosbag2 "
        f"(default: a fresh bag_TIME in --out); {NOWHERE}: do not record",
    )
    group.add_argument(
        "--record-split",
        metavar="HOW",
        type=_split,
        default={},
        help="begin a new file of the bag at size=MB, or after episodes=N",
    )


def bag_folder(options: argparse.Namespace, names: list[str]) -> Path | None:
    """Return where to record to, None for nowhere.

    Args:
        options: with `record` and `out`.
        names: of the nodes to start.

    Raises:
        CommandError: a bag is there already, or no recorder is to be started.
    """
    if options.record == NOWHERE:
        return None
    if RECORDER not in names:
        if options.record is not None:
            raise CommandError(
                f"--record {options.record}: needs the recorder among --nodes"
            )
        return None
    if options.record is None:
        now = datetime.now(timezone.utc)
        return Path(options.out).resolve() / f"bag_{now:%Y%m%dT%H%M%SZ}"
    folder = Path(options.record).resolve()
    if holds_bag(folder):
        raise CommandError(f"--record {folder}: is a bag already; take another name")
    return folder


def recorder_parameters(
    folder: Path,
    run: Mapping[str, str],
    memory_file: Path | None,
    split: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the recorder's parameters, by name.

    Args:
        folder: of the bag.
        run: kept in the bag as biped.run.
        memory_file: kept in the bag, what the learner goes on from.
        split: the settings that --record-split stands for.
    """
    settings = RecorderSettings(
        folder=str(folder),
        number_if_taken=True,  # a recorder that is started again begins a bag anew
        expect_biped=True,
        make_tf=True,
        run=json.dumps(dict(run)),
        attachment="" if memory_file is None else str(memory_file),
        **split,
    )
    return flattened(to_mapping(settings))


def bags_of(folder: Path, supervisor: Supervisor) -> list[Path]:
    """Return the bags of the run: a recorder that died began another one."""
    starts = supervisor.children[RECORDER].starts
    further = [folder.with_name(f"{folder.name}_{n}") for n in range(2, starts + 1)]
    return [bag for bag in (folder, *further) if holds_bag(bag)]


def bag_line(folder: Path) -> str:
    """Return how much is in a bag."""
    try:
        metadata = read_metadata(folder)
    except BagError as error:
        return f"bag     {error}"
    if STATE_KEY not in metadata.custom:
        return f"bag     {folder}: cut off; biped bag recover makes it whole"
    return (
        f"bag     {folder}: {metadata.message_count} messages, "
        f"{metadata.custom.get(LOST_KEY, 'unknown')} lost"
    )


def not_recorded(folder: Path, supervisor: Supervisor) -> list[str]:
    """Return why the recording is not complete, if it is not."""
    recorder = supervisor.children[RECORDER]
    reason = supervisor.done_without.get(RECORDER)
    bags = bags_of(folder, supervisor)
    # One that was interrupted before its bag was there has left nothing out.
    if reason is None and recorder.exit_status and bags:
        reason = recorder.last_line
    if reason is not None:
        return [f"the rest of the bag: {reason}"]
    return [
        f"the rest of {bag}: {state}"
        for bag in bags
        if (state := _state(bag)) != COMPLETE
    ]


def _state(folder: Path) -> str:
    """Return how the recording of a bag ended."""
    try:
        return read_metadata(folder).custom.get(STATE_KEY, "cut off")
    except BagError as error:
        return str(error)


def _split(text: str) -> dict[str, Any]:
    kind, _, number = text.partition("=")
    settings = {
        "size": ("size", "max_file_mb"),
        "episodes": ("episode", "episodes_per_file"),
    }
    if kind not in settings or not number.isdecimal() or int(number) < 1:
        raise argparse.ArgumentTypeError(f"{text}: must be size=MB or episodes=N")
    split, key = settings[kind]
    return {"split": split, key: int(number)}
