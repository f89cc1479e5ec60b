"""`biped bag verify`: does a learner, given what was observed, answer as recorded?"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from biped_bringup.bag.errors import BagError
from biped_bringup.bag.reader import BagReader
from biped_bringup.bag.recorded_session import recorded_session
from biped_bringup.bag.recorded_walks import WANTED
from biped_bringup.bag.verify import verify
from biped_bringup.bag.verify_report import Verification
from biped_bringup.cli.options import add_json_option, print_json
from msgs_json.wire import MalformedMessageError

DIFFERS = 1


def add_parser(verbs: Any) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "verify",
        help="let a learner answer the recorded observations again, and compare",
        description="Give the recorded observations to a learner with the recorded "
        "settings, seed and memory, and compare its corrections and results with the "
        "recorded ones, bit for bit; compute ZMP error and T_err anew. Exit status 0 "
        "when every correction was compared and all is the same, 1 when something "
        "differs or could not be compared, 2 for wrong input.",
    )
    parser.add_argument("bag", type=Path, metavar="BAG", help="folder or MCAP file")
    add_json_option(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Verify and report."""
    bag = BagReader(options.bag)
    session = recorded_session(bag)
    try:
        found = verify(session, ((m.topic, m.data) for m in bag.messages(WANTED)))
    except MalformedMessageError as error:
        raise BagError(f"{options.bag}: {error}") from None
    if options.json:
        print_json(found.as_mapping())
    else:
        _print(found)
    return 0 if found.verified else DIFFERS


def _print(found: Verification) -> None:
    for walk in found.walks:
        kind = {True: "learning", False: "frozen", None: "cut short"}[walk.learning]
        print(
            f"walk {walk.number} (episode {walk.episode}, {kind}): {walk.identical} of "
            f"{walk.corrections} corrections identical"
        )
        if walk.first_difference is not None:
            more = walk.differences - 1
            print(
                f"  differs: {walk.first_difference}"
                + (f"; and {more} more" if more else "")
            )
        if walk.not_checked is not None:
            print(f"  not checked: {walk.not_checked}")
    costs = [walk.cost for walk in found.walks if walk.cost is not None]
    for source in sorted({cost.source for cost in costs}):
        chosen = [cost for cost in costs if cost.source == source]
        worst = max(cost.t_err_deviation for cost in chosen)
        print(f"T_err of {len(chosen)} walks from {source}: off by {worst:.1e} at most")
        zmp_m = [c.zmp_error_deviation_m for c in chosen]
        measured_m = [each for each in zmp_m if each is not None]
        if measured_m:
            print(f"ZMP error: off by {1000 * max(measured_m):.1e} mm at most")
    print(
        f"{'verified' if found.verified else 'NOT VERIFIED'}: {found.identical} of "
        f"{found.corrections} corrections identical, {found.differences} differences"
    )
