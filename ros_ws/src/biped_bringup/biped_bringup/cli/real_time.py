"""What helps `biped up` to keep real time: pace, look-ahead, share of the machine."""

from __future__ import annotations

import argparse
from typing import Any

from biped_ros.processor import ProcessorSettings
from sim_node.settings import SimNodeSettings
from trajectory_node.settings import TrajectorySettings


def add_real_time_options(parser: argparse.ArgumentParser) -> None:
    """Add --factor, --look-ahead, --fifo, --nice, --cores and --lock-memory."""
    group = parser.add_argument_group(
        "real time",
        "For the three nodes in the loop. What the machine does not permit is said in "
        "one line, and the run goes on without.",
    )
    group.add_argument(
        "--factor",
        type=float,
        default=SimNodeSettings.realtime_factor,
        metavar="F",
        help="simulated seconds per second (default 1; 0.5 gives everybody twice the "
        "time)",
    )
    group.add_argument(
        "--look-ahead",
        type=int,
        default=TrajectorySettings.look_ahead_ticks,
        metavar="TICKS",
        help="control ticks of reference beyond a segment (default 50); fewer than 10 "
        "shorten the deadline",
    )
    group.add_argument(
        "--fifo",
        type=int,
        default=ProcessorSettings.fifo_priority,
        metavar="N",
        help="SCHED_FIFO with priority N, 1 to 99 (default 0: off)",
    )
    group.add_argument(
        "--nice",
        type=int,
        default=ProcessorSettings.nice,
        metavar="N",
        help="-20 (first) to 19 (last); default 0: as it was started",
    )
    group.add_argument(
        "--cores",
        type=_cores,
        default=ProcessorSettings.cores,
        metavar="A,B",
        help="run on these processor cores only",
    )
    group.add_argument(
        "--lock-memory",
        action="store_true",
        help="keep all memory in RAM (mlockall)",
    )


def real_time_parameters(options: argparse.Namespace) -> dict[str, Any]:
    """Return what the options say, as arguments of `node_parameters`.

    Raises:
        SettingsError: a number is out of range.
    """
    return {
        "realtime_factor": options.factor,
        "look_ahead_ticks": options.look_ahead,
        "processor": ProcessorSettings(
            fifo_priority=options.fifo,
            nice=options.nice,
            lock_memory=options.lock_memory,
            cores=options.cores,
        ),
    }


def _cores(text: str) -> tuple[int, ...]:
    try:
        return tuple(int(word) for word in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{text}: must be whole numbers, as in 0,1"
        ) from None
