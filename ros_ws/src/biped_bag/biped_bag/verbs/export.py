"""`biped bag export`: the topics of a bag as tidy tables."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from biped_bag.export import FORMATS, export
from biped_bag.storage.reader import BagReader
from biped_common.command_line import add_json_option, print_json


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "export",
        help="write the topics of a bag as Parquet or CSV",
        description="Write one table per topic, one row per message: log_time_ns, "
        "stamp_ns where there is a header, and a column per number, named with its "
        "unit where the topic defines it.",
    )
    parser.add_argument("bag", type=Path, metavar="BAG", help="folder or MCAP file")
    parser.add_argument("out", type=Path, metavar="OUT", help="folder of the tables")
    parser.add_argument(
        "--format", choices=tuple(FORMATS), default="parquet", help="default parquet"
    )
    parser.add_argument(
        "--topics", nargs="+", metavar="TOPIC", help="export these only"
    )
    parser.add_argument(
        "--force", action="store_true", help="replace tables that are there already"
    )
    add_json_option(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Export and report."""
    bag = BagReader(options.bag)
    tables = export(
        bag, options.out, options.format, options.topics, replace=options.force
    )
    if options.json:
        print_json(
            {
                table.topic: {"file": str(table.file), "rows": table.rows}
                for table in tables
            }
        )
    else:
        for table in tables:
            print(f"{table.file}  {table.rows} rows  {table.topic}")
    return 0
