"""`biped lab`: its verbs are entry points of the group `biped.lab_verbs`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from biped_common.verbs import add_verbs


def add_parser(verbs: Any, words: Sequence[str]) -> None:
    """Add the verb, with verbs of its own."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "lab",
        help="carry out studies, and report them",
        description="Experiments with honest statistics: studies of many runs, which "
        "are never carried out twice and can be interrupted at any time.",
    )
    own = parser.add_subparsers(dest="lab_verb", required=True, metavar="VERB")
    add_verbs(own, "biped.lab_verbs", words)
