"""A stranger on the graph: a program of another middleware, which keeps to no rule.

    python -m tests.graph.foreign ATTACK    # on ROS_DOMAIN_ID

It says `ready`, listens, and begins to attack with the first line on stdin; with
SIGTERM it leaves. Eclipse Cyclone DDS instead of Fast DDS: nothing of the project is
asked whether a message may be sent.
"""

import os
import signal
import sys
import time
from dataclasses import dataclass, replace

import msgspec
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int32, sequence, uint8, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from tests.payloads import RESULT

from biped_common.timing import CONTROL_PERIOD_US
from msgs_json import topics
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation
from msgs_json.wire import decode, encode

# As the nodes with LOCALHOST, on the loopback interface. Fast DDS does not understand
# how Cyclone DDS says farewell: who leaves is there until his lease ends (else 10 s).
LOOPBACK = """<CycloneDDS><Domain>
<General><Interfaces>
<NetworkInterface address="127.0.0.1" multicast="true"/>
</Interfaces></General>
<Discovery><LeaseDuration>1 s</LeaseDuration></Discovery>
</Domain></CycloneDDS>"""
TICKS_AHEAD = 10**9
FLOOD_HZ = 5000
FLOOD_TURN_S = 0.02
FORGED_PARAMETERS = 16_000_000
IDLE_S = 0.001


# The messages as ROS has them on the wire.


@dataclass
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Vector3Stamped(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3Stamped_"):
    header: Header
    vector: Vector3


@dataclass
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3
    rotation: array[float64, 4]


@dataclass
class Point(
    IdlStruct, typename="trajectory_msgs::msg::dds_::MultiDOFJointTrajectoryPoint_"
):
    transforms: sequence[Transform]
    velocities: sequence[array[float64, 6]]
    accelerations: sequence[array[float64, 6]]
    time_from_start: Time


@dataclass
class MultiDOFJointTrajectory(
    IdlStruct, typename="trajectory_msgs::msg::dds_::MultiDOFJointTrajectory_"
):
    header: Header
    joint_names: sequence[str]
    points: sequence[Point]


@dataclass
class ParameterNames(
    IdlStruct, typename="rcl_interfaces::srv::dds_::SetParameters_Request_"
):
    """So many parameters as there are bytes, each of them cut short."""

    parameters: sequence[uint8]


KINDS = {
    topics.CORRECTION.name: Vector3Stamped,
    topics.WAIST_REFERENCE.name: MultiDOFJointTrajectory,
}


class Stranger:
    """A participant that hears and says what it likes."""

    def __init__(self, domain):
        self._domain = Domain(domain, LOOPBACK)
        self._participant = DomainParticipant(domain)

    def writer(self, topic):
        return self.writer_of(f"rt{topic.name}", KINDS.get(topic.name, String), topic)

    def writer_of(self, name, kind, topic):
        return DataWriter(
            self._participant,
            Topic(self._participant, name, kind),
            qos=Qos(
                Policy.DataRepresentation(use_cdrv0_representation=True),
                *_policies(topic),
            ),
        )

    def reader(self, topic):
        kind = KINDS.get(topic.name, String)
        return DataReader(
            self._participant,
            Topic(self._participant, f"rt{topic.name}", kind),
            qos=Qos(*_policies(topic)),
        )


def _policies(topic):
    durability = Policy.Durability
    return (
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        durability.TransientLocal if topic.latched else durability.Volatile,
        Policy.History.KeepLast(topic.depth),
    )


def answering(stranger, heard, said, answer):
    """Return an attack that says something to everything that it hears."""
    reader = stranger.reader(heard)
    begun = []

    def turn():
        begun[:] = begun or [stranger.writer(said)]
        for message in reader.take(100):
            begun[0].write(answer(message))
        time.sleep(IDLE_S)

    return turn


def forged_results(stranger):
    """Every walk that is walked has been a success, and the last one needed."""

    def answer(message):
        observed = decode(Observation, message.data)
        return String(
            encode(
                msgspec.structs.replace(
                    RESULT,
                    episode=observed.episode,
                    trajectory_sha256=observed.trajectory_sha256,
                    schedule_complete=True,
                )
            )
        )

    return answering(stranger, topics.OBSERVATION, topics.EPISODE, answer)


def forged_status(stranger):
    """The learner, by its own name, has learned everything."""

    def answer(message):
        status = decode(LearnerStatus, message.data)
        return String(
            encode(
                msgspec.structs.replace(
                    status, schedule_complete=True, learned=True, episodes=10**6
                )
            )
        )

    return answering(stranger, topics.LEARNER_STATUS, topics.LEARNER_STATUS, answer)


def observations_ahead(stranger):
    """The robot observes what will be in years, after which all else is the past."""

    def answer(message):
        observed = decode(Observation, message.data)
        if observed.clock_ticks >= TICKS_AHEAD:
            return message
        return String(
            encode(
                msgspec.structs.replace(
                    observed, clock_ticks=observed.clock_ticks + TICKS_AHEAD
                )
            )
        )

    return answering(stranger, topics.OBSERVATION, topics.OBSERVATION, answer)


def corrections(stranger):
    """Sound corrections, in the right frame and of the right moment."""

    def answer(message):
        ticks = decode(Observation, message.data).clock_ticks
        seconds, microseconds = divmod(ticks * CONTROL_PERIOD_US, 1_000_000)
        header = Header(Time(seconds, 1000 * microseconds), "world")
        return Vector3Stamped(header, Vector3(0.02, -0.02, 0.0))

    return answering(stranger, topics.OBSERVATION, topics.CORRECTION, answer)


def second_segments(stranger):
    """Each segment again, with the waist a centimetre further."""

    def answer(segment):
        for point in segment.points:
            waist = point.transforms[0].translation
            point.transforms[0] = replace(
                point.transforms[0], translation=replace(waist, x=waist.x + 0.01)
            )
        return segment

    return answering(stranger, topics.WAIST_REFERENCE, topics.WAIST_REFERENCE, answer)


def flood(stranger):
    """On every control topic, 5,000 messages a second that can only be refused."""
    stale = Header(Time(0, 0), "world")
    said = {
        topics.CORRECTION: Vector3Stamped(stale, Vector3(0.0, 0.0, 0.0)),
        topics.WAIST_REFERENCE: MultiDOFJointTrajectory(stale, ["waist"], []),
    }
    writers = {}

    def turn():
        end = time.monotonic() + FLOOD_TURN_S
        for topic in topics.CONTROL:
            if topic not in writers:
                writers[topic] = stranger.writer(topic)
            message = said.get(topic, String('{"version": 99}'))
            for _ in range(int(FLOOD_HZ * FLOOD_TURN_S)):
                writers[topic].write(message)
        time.sleep(max(0.0, end - time.monotonic()))

    return turn


def forged_request(stranger):
    """A request for so many parameters that a machine has no room for them."""
    writer = stranger.writer_of(
        f"rq/{topics.TRAJECTORY_NODE}/set_parametersRequest",
        ParameterNames,
        topics.EPISODE,
    )
    request = ParameterNames(bytes(FORGED_PARAMETERS))

    def turn():
        if writer.get_matched_subscriptions():
            writer.write(request)
            writer.wait_for_acks(duration(seconds=20))
            print("taken", flush=True)
            sys.stdin.read()
        time.sleep(IDLE_S)

    return turn


ATTACKS = {
    attack.__name__: attack
    for attack in (
        forged_results,
        forged_status,
        observations_ahead,
        corrections,
        second_segments,
        flood,
        forged_request,
    )
}


def attack(name):
    """Listen; attack from the first line on stdin until SIGTERM."""
    ends = []
    signal.signal(signal.SIGTERM, lambda *_: ends.append(True))
    stranger = Stranger(int(os.environ["ROS_DOMAIN_ID"]))
    turn = ATTACKS[name](stranger)
    print("ready", flush=True)
    sys.stdin.readline()
    while not ends:
        turn()


if __name__ == "__main__":
    attack(sys.argv[1])
