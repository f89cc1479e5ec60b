"""`biped bag`: what can be done with a recorded bag; sub-verbs are entry points."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from biped_common.terminal_text import printable_output
from biped_common.verbs import add_verbs


def add_parser(verbs: Any, words: Sequence[str]) -> None:
    """Add the verb and its sub-verbs."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "bag",
        help="look into recorded bags; play, verify, mend, cut and export them",
        description="Work with bags: folders in the layout of rosbag2, or single MCAP "
        "files. A bag that is cut off or damaged is refused by all of these but "
        "`recover`.",
    )
    sub_verbs = parser.add_subparsers(dest="bag_verb", required=True, metavar="VERB")
    add_verbs(sub_verbs, "biped.bag_verbs", words)


def add_bag_verb(
    verbs: Any,
    name: str,
    summary: str,
    description: str | None,
    run: Callable[[argparse.Namespace], int],
    bag: str = "BAG",
) -> argparse.ArgumentParser:
    """Add a sub-verb on one bag; return its parser.

    Args:
        verbs: what `add_subparsers` returned.
        name: of the sub-verb.
        summary: one line, for the list of sub-verbs.
        description: docstring of its module, with the exit statuses, for its help.
        run: runs it and returns the exit status; what it prints is made printable,
            for names and contents of a bag are anybody's.
        bag: what the bag is called in the help.
    """
    parser: argparse.ArgumentParser = verbs.add_parser(
        name,
        help=summary,
        description=description,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("bag", type=Path, metavar=bag, help="folder or MCAP file")

    def run_printably(options: argparse.Namespace) -> int:
        with printable_output():
            return run(options)

    parser.set_defaults(run=run_printably)
    return parser
