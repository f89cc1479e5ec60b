"""`biped lab report`: figures, tables and a page for each study in a folder."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from biped_common.command_line import DONE
from biped_lab.report.write import write_report
from biped_lab.results import ResultsError, read_results, studies_of


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "report",
        help="figures, tables and a page for each study in a folder",
        description="Write for each study in a laboratory's folder a page that needs "
        "nothing else (DIR/STUDY/report.html), tables in Markdown, and the figures as "
        "SVG and PNG. Works as well while runs are under way: those that have ended "
        "are shown, the others counted. Exit status 0 when all are written, 2 when a "
        "study is not there or cannot be read.",
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="of `biped lab run`")
    parser.add_argument(
        "studies", nargs="*", metavar="STUDY", help="those to report (default: all)"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Write the reports; print where each is."""
    names = options.studies or studies_of(options.folder)
    if not names:
        raise ResultsError(f"{options.folder}: no study")
    for name in names:
        print(write_report(read_results(options.folder, name)), flush=True)
    return DONE
