"""Publish a bag's messages with their recorded timing, bytes and quality of service.

Latched topics come first. While it plays, /player/pause, /player/resume and
/player/step (std_srvs/srv/Trigger) stop it, let it go on, and let one message pass.
A rate that the machine cannot keep is a warning; no message is left out.

Exit status:
    0    played to the end
    2    no such bag or a broken one, or there is nothing in it of what was asked for
    130  interrupted
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from collections.abc import Sequence
from typing import Any

from biped_bag.player.clock import FLAT_OUT
from biped_bag.player.play import PlayRequest, play
from biped_bag.selection import Selection
from biped_bag.storage.reader import BagReader
from biped_bag.verbs.bag import add_bag_verb
from biped_common.command_line import DONE, INTERRUPTED, CommandError, natural
from biped_common.signals import stop_requests
from biped_ros.environment import (
    DISCOVERY_RANGES,
    LAST_DOMAIN,
    node_environment,
)

_CLOCK_PERIOD_NS = 10_000_000


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser = add_bag_verb(
        verbs, "play", "publish a bag's messages as they were recorded", __doc__, run
    )
    pace = parser.add_mutually_exclusive_group()
    pace.add_argument(
        "--rate", metavar="R", default="1", help="times as fast (default 1)"
    )
    pace.add_argument(
        "--flat-out", action="store_true", help="as fast as subscribers acknowledge"
    )
    parser.add_argument("--loop", action="store_true", help="play again and again")
    parser.add_argument(
        "--start", metavar="S", default="0", help="begin S seconds into the bag"
    )
    parser.add_argument(
        "--duration", metavar="S", help="play S seconds of it (default: to its end)"
    )
    parser.add_argument(
        "--topics", nargs="+", default=[], metavar="TOPIC", help="play these only"
    )
    parser.add_argument(
        "--remap",
        action="append",
        default=[],
        metavar="A:=B",
        help="publish topic A as B; repeatable",
    )
    parser.add_argument(
        "--clock",
        action="store_true",
        help="publish the log time on /clock, 100 times a recorded second, unless a "
        "/clock from the bag is played",
    )
    parser.add_argument("--paused", action="store_true", help="begin paused")
    parser.add_argument(
        "--domain",
        type=natural,
        metavar="ID",
        help="ROS_DOMAIN_ID (default: that of the environment, or 0)",
    )
    parser.add_argument(
        "--discovery",
        choices=DISCOVERY_RANGES,
        default=DISCOVERY_RANGES[0],
        help="who may listen: processes on this machine (default), or in the subnet",
    )


def run(options: argparse.Namespace) -> int:
    """Play, and say what was played."""
    request = _request(options)
    domain = _domain(options.domain)
    bag = BagReader(options.bag)
    os.environ.update(node_environment(domain, options.discovery))
    with stop_requests() as stops:
        played = play(bag, request, domain, lambda: bool(stops), _tell)
    print(
        f"played {played.messages} messages in {played.duration_s:.2f} s, at worst "
        f"{1000 * played.worst_lateness_s:.1f} ms late"
    )
    return INTERRUPTED if stops else DONE


def _tell(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _request(options: argparse.Namespace) -> PlayRequest:
    duration = options.duration
    return PlayRequest(
        rate=FLAT_OUT if options.flat_out else _number("--rate", options.rate),
        start_s=_number("--start", options.start, or_zero=True),
        duration_s=None if duration is None else _number("--duration", duration),
        selection=Selection(frozenset(options.topics), include_hidden=True),
        remaps=dict(_remap(text) for text in options.remap),
        clock_period_ns=_CLOCK_PERIOD_NS if options.clock else None,
        paused=options.paused,
        loop=options.loop,
    )


def _number(option: str, text: str, *, or_zero: bool = False) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if math.isfinite(value) and (value > 0.0 or (or_zero and value == 0.0)):
        return value
    bound = "at least 0" if or_zero else "above 0"
    raise CommandError(f"{option} {text}: must be a number {bound}")


def _remap(text: str) -> tuple[str, str]:
    source, separator, target = text.partition(":=")
    if not (source and separator and target):
        raise CommandError(f"--remap {text}: must have the form /topic:=/other")
    return source, target


def _domain(given: int | None) -> int:
    text = os.environ.get("ROS_DOMAIN_ID") or "0"
    domain = given if given is not None else int(text) if text.isdecimal() else -1
    if not 0 <= domain <= LAST_DOMAIN:
        raise CommandError(
            f"--domain, ROS_DOMAIN_ID: must be a whole number from 0 to {LAST_DOMAIN}"
        )
    return domain
