"""`biped bag`: what can be done with a recorded bag; one module per sub-verb."""

from __future__ import annotations

import argparse
from typing import Any

from biped_bringup.cli import (
    bag_cut,
    bag_export,
    bag_info,
    bag_play,
    bag_recover,
    bag_verify,
)

VERBS = (bag_info, bag_play, bag_verify, bag_recover, bag_cut, bag_export)


def add_parser(verbs: Any) -> None:
    """Add the verb and its sub-verbs."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "bag",
        help="look into recorded bags; play, verify, mend, cut and export them",
        description="Work with bags: folders in the layout of rosbag2, or single MCAP "
        "files. A bag that is cut off or damaged is refused by all of these but "
        "`recover`.",
    )
    sub_verbs = parser.add_subparsers(dest="bag_verb", required=True, metavar="VERB")
    for verb in VERBS:
        verb.add_parser(sub_verbs)
