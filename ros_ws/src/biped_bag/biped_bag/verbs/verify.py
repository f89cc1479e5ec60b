"""Let a learner answer the recorded observations again, and compare.

It has the recorded settings, seed and memory; its corrections and results must be the
recorded ones, bit for bit. ZMP error and T_err are computed anew.

Exit status:
    0  every correction was compared, and all is the same
    1  something differs, or could not be compared, or there is nothing to compare
    2  no such bag or a broken one, or it does not say how the run began
    3  all that was recorded is the same, but the last walk is cut short
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from biped_bag.errors import BagError
from biped_bag.storage.reader import BagReader
from biped_bag.verbs.bag import add_bag_verb
from biped_bag.verification.learner import recorded_session
from biped_bag.verification.report import Verdict, Verification, WalkCheck
from biped_bag.verification.verify import verify
from biped_bag.verification.walks import WANTED, ImpossibleWalkError
from biped_common.command_line import add_json_option, print_json

_STATUS = {
    Verdict.VERIFIED: 0,
    Verdict.NOT_VERIFIED: 1,
    Verdict.AS_FAR_AS_RECORDED: 3,
}


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser = add_bag_verb(
        verbs,
        "verify",
        "let a learner answer the recorded observations again, and compare",
        __doc__,
        run,
    )
    parser.add_argument(
        "--run-of",
        type=Path,
        metavar="ORIGINAL",
        help="take settings, seed and memory from this bag; for recordings of a "
        "replay, which cannot know them, and for cut bags",
    )
    add_json_option(parser)


def run(options: argparse.Namespace) -> int:
    """Verify and report."""
    bag = BagReader(options.bag)
    session = recorded_session(
        bag if options.run_of is None else BagReader(options.run_of)
    )
    try:
        found = verify(session, ((m.topic, m.data) for m in bag.messages(WANTED)))
    except ImpossibleWalkError as error:
        raise BagError(f"{options.bag}: {error}") from None
    if options.json:
        print_json(found.as_mapping())
    else:
        _print(found)
    return _STATUS[found.verdict]


def _print(found: Verification) -> None:
    for walk in found.walks:
        print(
            f"walk {walk.number} (episode {walk.episode}, {_kind(walk)}): "
            f"{walk.identical} of {walk.corrections} corrections identical"
        )
        if walk.first_difference is not None:
            more = walk.differences - 1
            print(
                f"  differs: {walk.first_difference}"
                + (f"; and {more} more" if more else "")
            )
        if walk.not_checked is not None:
            print(f"  not checked: {walk.not_checked}")
    refused = sum(walk.refused for walk in found.walks)
    if refused:
        print(f"passed over: {refused} corrections that the trajectory refuses")
    for topic, count in sorted(found.not_understood.items()):
        print(f"passed over: {count} messages on {topic} that no node understands")
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
        f"{found.verdict}: {found.identical} of {found.corrections} corrections "
        f"identical, {found.differences} differences"
    )


def _kind(walk: WalkCheck) -> str:
    if walk.learning is None:
        return "cut short" if walk.cut_short else "not begun"
    return "learning" if walk.learning else "frozen"
