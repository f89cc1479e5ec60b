"""`biped lab status`: how far the studies in a folder have come."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from biped_common.command_line import DONE
from biped_lab.progress import status_table
from biped_lab.results import ResultsError, studies_of
from biped_lab.verbs.run import DEFAULT_OUT


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "status",
        help="how far the studies in a folder have come",
        description="Say for each study and arm what is done, running and waiting, "
        "and how much processor time is left, as far as it can be known.",
    )
    parser.add_argument(
        "folder", type=Path, nargs="?", default=DEFAULT_OUT, metavar="DIR"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Print a table per study."""
    names = studies_of(options.folder)
    if not names:
        raise ResultsError(f"{options.folder}: no study")
    for name in names:
        Console().print(status_table(options.folder, name))
    return DONE
