"""Rewrite a bag that is cut off or damaged anywhere into a sound one.

What is whole is saved, and what is lost is counted. The broken bag is not changed.

Exit status:
    0  nothing was lost
    1  nothing could be recovered, or it could not be written: nothing is left of OUT
    2  no such bag, or OUT is there already
    3  something was lost, or may have been
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from biped_bag.recovery.recover import RecoveryFailedError, recover
from biped_bag.verbs.bag import add_bag_verb
from biped_common.command_line import add_json_option, print_json

FAILED = 1
SOMETHING_LOST = 3


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser = add_bag_verb(
        verbs,
        "recover",
        "rewrite a broken bag into a sound one, and say what was lost",
        __doc__,
        run,
        "BROKEN",
    )
    parser.add_argument(
        "out", type=Path, metavar="OUT", help="folder of the new bag; must not exist"
    )
    add_json_option(parser)


def run(options: argparse.Namespace) -> int:
    """Recover and report."""
    try:
        report = recover(options.bag, options.out)
    except RecoveryFailedError as error:
        print(f"biped bag: {error}", file=sys.stderr)
        return FAILED
    if options.json:
        print_json(report.as_mapping())
    else:
        print(report.text())
    return 0 if report.nothing_lost else SOMETHING_LOST
