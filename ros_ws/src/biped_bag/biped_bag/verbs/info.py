"""Print what a bag holds, as `ros2 bag info` does, and of which run and walks it is.

The whole bag is checked first.

Exit status:
    0  printed
    2  no such bag, or one that is broken
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from biped_bag.info import info_mapping, info_text, run_text
from biped_bag.storage.reader import BagReader
from biped_bag.verbs.bag import add_bag_verb
from biped_common.command_line import add_json_option, print_json


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser = add_bag_verb(verbs, "info", "print what a bag holds", __doc__, run)
    add_json_option(parser)


def run(options: argparse.Namespace) -> int:
    """Print."""
    bag = BagReader(options.bag)
    if options.json:
        print_json(info_mapping(bag))
    else:
        print(info_text(bag))
        print(run_text(bag))
    return 0
