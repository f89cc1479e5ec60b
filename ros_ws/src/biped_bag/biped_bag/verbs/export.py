"""Write the topics of a bag as tables, one per topic, one row per message.

Columns are log_time_ns, stamp_ns where there is a header, and one per number, named
with its unit where the topic defines it.

Exit status:
    0  all tables are written
    2  no such bag or a broken one, no such topic, a message that is not of its type;
       a table is there already or cannot be written: those before it are written
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from biped_bag.export import FORMATS, export
from biped_bag.storage.reader import BagReader
from biped_bag.verbs.bag import add_bag_verb
from biped_common.command_line import add_json_option, print_json


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser = add_bag_verb(
        verbs, "export", "write the topics of a bag as Parquet or CSV", __doc__, run
    )
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
