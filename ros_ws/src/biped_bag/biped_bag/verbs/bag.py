"""`biped bag`: what can be done with a recorded bag; sub-verbs are entry points."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

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
