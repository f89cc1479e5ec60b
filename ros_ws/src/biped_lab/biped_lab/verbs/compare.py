"""`biped lab compare`: the arms of one study against those of another."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from biped_common.command_line import DONE
from biped_lab.report.tables import studies_table
from biped_lab.results import read_results


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "compare",
        help="the arms of one study against those of another",
        description="Compare arms of the same name in two studies, such as those of "
        "two versions of a learner, with intervals and corrected p-values. Seeds "
        "that are in both are pairs. A ratio below 1 says that the first is faster.",
    )
    for name in ("one", "other"):
        parser.add_argument(
            name, type=Path, metavar="DIR/STUDY", help="a study in a folder"
        )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Print a table in Markdown."""
    one, other = (
        read_results(path.parent, path.name) for path in (options.one, options.other)
    )
    print(studies_table(one, other, np.random.default_rng(0)).markdown(), end="")
    return DONE
