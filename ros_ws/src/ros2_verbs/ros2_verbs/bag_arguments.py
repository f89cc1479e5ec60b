"""Options that the verbs on bags share, and their errors as the verbs' own."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from biped_bag.errors import BagError
from biped_common.settings import SettingsError
from ros2_verbs.errors import VerbError


def add_bag_argument(parser: argparse.ArgumentParser) -> None:
    """Add the bag to be read."""
    parser.add_argument("bag_path", type=Path, help="bag: its folder, or an MCAP file")


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
    """Turn errors of bags and of the recorder's settings into those of verbs."""
    try:
        yield
    except (BagError, SettingsError) as error:
        raise VerbError(f"[ERROR] [ros2bag]: {error}") from None
