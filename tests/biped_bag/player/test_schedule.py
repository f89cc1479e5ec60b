"""What is played, in which order: latched topics first, nothing twice."""

from biped_bag.player.schedule import clock_message, scheduled, with_clock
from biped_bag.storage.contents import BagMessage
from msgs_json import topics

URDF, ZMP = "/robot_description", "/biped/zmp"
BAG = [
    BagMessage(ZMP, b"zmp 0", 0, 0),
    BagMessage(URDF, b"first", 5, 5),
    BagMessage(ZMP, b"zmp 1", 10, 10),
    BagMessage(URDF, b"second", 15, 15),
    BagMessage(ZMP, b"zmp 2", 20, 20),
]


def read(names, start_ns, end_ns):
    """Read the bag as its reader would."""
    start_ns = 0 if start_ns is None else start_ns
    end_ns = 10**9 if end_ns is None else end_ns
    return (m for m in BAG if m.topic in names and start_ns <= m.log_ns < end_ns)


def payloads(start_ns, end_ns, latched=1):
    """Return what is played between two times."""
    messages = scheduled(read, (URDF, ZMP), {URDF: latched}, start_ns, end_ns)
    return [message.data for message in messages]


def test_the_last_latched_message_before_the_start_comes_first():
    assert payloads(18, 30) == [b"second", b"zmp 2"]


def test_as_many_latched_messages_as_were_kept_come_first():
    assert payloads(18, 30, latched=2) == [b"first", b"second", b"zmp 2"]


def test_a_latched_message_after_the_start_is_brought_forward_and_not_repeated():
    assert payloads(0, 30) == [b"first", b"zmp 0", b"zmp 1", b"second", b"zmp 2"]


def test_the_end_is_exclusive():
    assert payloads(0, 10) == [b"first", b"zmp 0"]


def test_the_clock_ticks_from_start_to_end_in_order():
    messages = list(with_clock(read((ZMP,), 0, 21), 0, 21, period_ns=4))
    times = [message.log_ns for message in messages]
    assert times == sorted(times)
    ticks = [m.log_ns for m in messages if m.topic == topics.CLOCK.name]
    assert ticks == [0, 4, 8, 12, 16, 20]


def test_a_clock_message_is_that_of_ros():
    from rclpy.serialization import deserialize_message
    from rosgraph_msgs.msg import Clock

    clock = deserialize_message(clock_message(3_000_000_007).data, Clock).clock
    assert (clock.sec, clock.nanosec) == (3, 7)
