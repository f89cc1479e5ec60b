"""What the project's commands have in common: exit statuses, options, JSON."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from biped_common.errors import BipedError

DONE = 0
NOT_ACHIEVED = 1
WRONG_INPUT = 2
NODE_FAILURE = 3
INTERRUPTED = 130


class CommandError(BipedError, ValueError):
    """Options that do not go together, or a folder that cannot be used."""


def add_json_option(parser: argparse.ArgumentParser) -> None:
    """Add --json."""
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object, for scripts"
    )


def print_json(values: dict[str, Any]) -> None:
    """Print one JSON object."""
    print(json.dumps(values, indent=2))


def natural(text: str) -> int:
    """Parse a whole number that is at least 0."""
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"{text}: must be at least 0")
    return value


def writable_folder(folder: Path) -> Path:
    """Return the folder, made if need be.

    Raises:
        CommandError: it cannot be made or written to.
    """
    probe = folder / ".writable"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise CommandError(
            f"{folder}: must be a folder that can be written to ({error.strerror})"
        ) from None
    return folder
