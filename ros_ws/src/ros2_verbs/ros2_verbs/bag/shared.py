"""What the verbs on bags share: options, and the form of their errors."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from biped_common.errors import BipedError
from ros2_verbs.errors import VerbError


def add_bag_argument(parser: argparse.ArgumentParser) -> None:
    """Add the bag to be read, and -s."""
    parser.add_argument("bag_path", type=Path, help="bag: its folder, or an MCAP file")
    add_storage_argument(parser)


def add_storage_argument(parser: argparse.ArgumentParser) -> None:
    """Add -s, which has one choice here."""
    parser.add_argument(
        "-s",
        "--storage",
        choices=("mcap",),
        default="mcap",
        help="storage identifier; bags are MCAP here (default: mcap)",
    )


@contextmanager
def bag_errors() -> Iterator[None]:
    """Have errors of bags, and of the recorder's settings, begin as rosbag2's do."""
    try:
        yield
    except BipedError as error:
        raise VerbError(f"[ERROR] [ros2bag]: {error}") from None
