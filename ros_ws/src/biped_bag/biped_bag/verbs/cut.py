"""Write a stretch of a bag, and maybe only some topics of it, as a bag of its own.

Latched messages from before the stretch stand at its start.

Exit status:
    0  written, and it holds nothing but whole messages
    2  no such bag or a broken one, no such topic or episode, nothing in the stretch;
       OUT is there already or cannot be written: what was begun of it is removed
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from biped_bag.cut import cut, stretch_of_episodes, stretch_of_time
from biped_bag.storage.reader import BagReader
from biped_bag.verbs.bag import add_bag_verb
from biped_common.command_line import (
    CommandError,
    add_json_option,
    duration_s,
    print_json,
)


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser = add_bag_verb(
        verbs,
        "cut",
        "cut a stretch of time, or some episodes, out of a bag",
        __doc__,
        run,
        "IN",
    )
    parser.add_argument(
        "out", type=Path, metavar="OUT", help="folder of the new bag; must not exist"
    )
    parser.add_argument(
        "--start", type=duration_s, metavar="S", help="[s] from the bag's first message"
    )
    parser.add_argument(
        "--end", type=duration_s, metavar="S", help="[s] from the bag's first message"
    )
    parser.add_argument(
        "--episodes",
        type=_episodes,
        metavar="A-B",
        help="these episodes, both included, instead of --start and --end",
    )
    parser.add_argument("--topics", nargs="+", metavar="TOPIC", help="keep these only")
    add_json_option(parser)


def run(options: argparse.Namespace) -> int:
    """Cut and report."""
    timed = options.start is not None or options.end is not None
    if timed == (options.episodes is not None):
        raise CommandError("cut: needs --start or --end or both, or else --episodes")
    bag = BagReader(options.bag)
    if timed:
        stretch = stretch_of_time(bag, options.start, options.end)
    else:
        stretch = stretch_of_episodes(bag, *options.episodes)
    done = cut(bag, options.out, stretch, options.topics)
    if options.json:
        print_json(
            {
                "out": str(options.out),
                "messages": done.messages,
                "latched_from_before": done.latched,
                "start_ns": stretch.start_ns,
                "end_ns": stretch.end_ns,
            }
        )
    else:
        print(
            f"{done.messages} messages, and {done.latched} latched ones from before, "
            f"in {options.out}"
        )
    return 0


def _episodes(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d+)(?:-(\d+))?", text, flags=re.ASCII)
    first, last = (int(match[1]), int(match[2] or match[1])) if match else (1, 0)
    if first > last:
        raise argparse.ArgumentTypeError(f"{text}: must be A-B with A not above B")
    return first, last
