"""Play a bag on a ROS domain, as asked for: schedule, player and node put together.

What failures do:
    a topic that is not in the bag, a start behind its end, an end before the start, a
        name that ROS does not allow, two types on one topic: BagError, before anything
        is published.
    no topic is left to play: BagError.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field

import rclpy
from rclpy.exceptions import InvalidTopicNameException
from rclpy.executors import SingleThreadedExecutor
from rclpy.validate_full_topic_name import validate_full_topic_name

from biped_bag.errors import BagError
from biped_bag.keyboard import Key, keyboard
from biped_bag.player.node import PlayerNode
from biped_bag.player.player import Played, Player
from biped_bag.player.schedule import scheduled, with_clock
from biped_bag.qos import playing_qos
from biped_bag.selection import Selection
from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.reader import BagReader
from biped_common.timing import NS_PER_S
from msgs_json.topics import CLOCK

_TURN_S = 0.01
_RATE_STEP = 0.1
_ALL = Selection(include_hidden=True)


@dataclass(frozen=True)
class PlayRequest:
    """How a bag is to be played."""

    rate: float = 1.0
    """Times as fast; FLAT_OUT for no waiting."""
    start_s: float = 0.0
    """From the bag's first message."""
    duration_s: float | None = None
    """Recorded time to play; None plays to the end."""
    until_ns: int | None = None
    """Log time up to which to play; with a duration, the later end counts."""
    delay_s: float = 0.0
    """Before each pass."""
    selection: Selection = _ALL
    remaps: Mapping[str, str] = field(default_factory=dict)
    """Other names under which topics are published."""
    clock_period_ns: int | None = None
    """Recorded time between two messages with the log time on /clock, which there are
    unless a /clock from the bag is played."""
    paused: bool = False
    loop: bool = False
    keyboard: bool = False
    """Listen to keys: pause or go on, step, change the rate."""


def play(
    bag: BagReader,
    request: PlayRequest,
    domain: int,
    stopped: Callable[[], bool],
    tell: Callable[[str], None],
) -> Played:
    """Play a bag to its end, or until stopped.

    Args:
        bag: to be played.
        request: what of it, and how.
        domain: ROS domain to publish on.
        stopped: asked often whether to end.
        tell: given lines for people.

    Raises:
        BagError: see the top of this module.
    """
    start_ns, end_ns = _extent(bag, request)
    topics = _topics(bag, request)
    period_ns = None if CLOCK.name in topics else request.clock_period_ns
    if period_ns:
        topics[CLOCK.name] = BagTopic(CLOCK.name, CLOCK.type_name)
    _check_names(topics, request.remaps)
    context = rclpy.Context()
    rclpy.init(
        args=[],  # the command line is ours: ROS would read A:=B, too
        context=context,
        domain_id=domain,
        signal_handler_options=rclpy.signals.SignalHandlerOptions.NO,
    )
    node = PlayerNode(topics, request.remaps, context=context)
    try:
        played = node.topics - ({CLOCK.name} if period_ns else set())
        if not played:
            raise BagError(f"{bag.path}: there is nothing to play")
        latched = {
            name: playing_qos(topics[name]).depth
            for name in sorted(played)
            if topics[name].latched
        }

        def messages() -> Iterator[BagMessage]:
            one_pass = scheduled(bag.messages, played, latched, start_ns, end_ns + 1)
            if period_ns is None:
                return one_pass
            return with_clock(one_pass, start_ns, end_ns, period_ns)

        player = Player(
            messages,
            node.publish,
            start_ns,
            end_ns,
            request.rate,
            paused=request.paused,
            loop=request.loop,
            delay_s=request.delay_s,
        )
        node.serve(player)
        tell(
            f"playing {(end_ns - start_ns) / NS_PER_S:.2f} s of {bag.path}, "
            f"{len(node.topics)} topics, ROS_DOMAIN_ID={domain}"
        )
        with keyboard() if request.keyboard else nullcontext(list) as keys:
            _spin(node, player, stopped, lambda: _obey(keys(), player, tell))
        played_in_all = player.finish()
        if player.lag is not None:
            node.get_logger().warning(
                f"rate {player.rate:g} could not be kept: messages came up to "
                f"{played_in_all.worst_lateness_s:.2f} s late"
            )
        node.await_acknowledgements()
        return played_in_all
    finally:
        node.destroy_node()
        rclpy.try_shutdown(context=context)


def _spin(
    node: PlayerNode,
    player: Player,
    stopped: Callable[[], bool],
    turn: Callable[[], None],
) -> None:
    """Serve the services while the player plays, and do something else in turn."""
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    try:
        node.await_subscribers(stopped)
        player.start()
        told = False
        while player.playing:
            executor.spin_once(timeout_sec=_TURN_S)
            turn()
            if stopped():
                player.stop()
            if player.lag is not None and not told:
                told = True
                node.get_logger().warning(
                    f"too fast for this machine: {player.lag.late_s:.2f} s behind, "
                    f"so far at rate {player.lag.rate:.3g}"
                )
    finally:
        executor.shutdown()


def _obey(keys: Iterable[Key], player: Player, tell: Callable[[str], None]) -> None:
    """Do what keys ask for, and say so in the words of rosbag2."""
    for key in keys:
        if key is Key.SPACE:
            paused = player.toggle_paused()
            tell("Pausing play." if paused else "Resuming play.")
        elif key is Key.CURSOR_RIGHT:
            if not player.step():
                tell("Called play next, but not in paused state.")
        else:
            change = _RATE_STEP if key is Key.CURSOR_UP else -_RATE_STEP
            rate = round(player.rate + change, 6)
            if rate > 0.0:
                player.set_rate(rate)
                tell(f"Set rate to {rate:g}")
            else:
                tell(f"Failed to set rate to invalid value {rate:g}")


def _extent(bag: BagReader, request: PlayRequest) -> tuple[int, int]:
    """Return log times of the first and of the last message to play."""
    start_ns = bag.start_ns + round(request.start_s * NS_PER_S)
    if bag.message_count == 0:
        raise BagError(f"{bag.path}: holds no message")
    if start_ns > bag.end_ns:
        raise BagError(
            f"{bag.path}: lasts {bag.duration_ns / NS_PER_S:.3f} s, so playing cannot "
            f"start at {request.start_s:g} s"
        )
    ends_ns = [] if request.until_ns is None else [request.until_ns]
    if request.duration_s is not None:
        ends_ns.append(start_ns + round(request.duration_s * NS_PER_S))
    end_ns = min(bag.end_ns, max(ends_ns, default=bag.end_ns))
    if end_ns < start_ns:
        raise BagError(
            f"{bag.path}: playing cannot end at {end_ns} ns of the epoch, before it "
            f"starts at {start_ns} ns"
        )
    return start_ns, end_ns


def _topics(bag: BagReader, request: PlayRequest) -> dict[str, BagTopic]:
    for name in sorted(request.selection.names.union(request.remaps)):
        if name not in bag.topics:
            known = ", ".join(sorted(bag.topics))
            raise BagError(f"{name}: not in the bag, which has {known}")
    return {
        name: topic
        for name, topic in bag.topics.items()
        if request.selection.wants(name, [topic.type_name])
    }


def _check_names(topics: Mapping[str, BagTopic], remaps: Mapping[str, str]) -> None:
    types: dict[str, str] = {}
    for name, topic in topics.items():
        target = remaps.get(name, name)
        try:
            validate_full_topic_name(target)
        except InvalidTopicNameException as error:
            reason = " ".join(str(error).split())
            raise BagError(f"{name}:={target}: {reason}") from None
        if types.setdefault(target, topic.type_name) != topic.type_name:
            raise BagError(
                f"{target}: would be of two types, {types[target]} and "
                f"{topic.type_name}"
            )
