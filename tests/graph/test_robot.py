"""A robot behind ros2_control's topics, played by a simulation that tells no more."""

import itertools
import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import Bool
from std_srvs.srv import SetBool, Trigger
from tests.conftest import COMMAND
from tests.robots import SHIPPED
from trajectory_msgs.msg import JointTrajectory

from biped_bringup.run_settings import load_settings
from biped_common.timing import CONTROL_PERIOD_NS, TICKS_PER_LEARNING_TICK
from biped_description.robot import Robot
from biped_lab.robustness import SENSED
from biped_lab.topic_walks import learn
from biped_ros.messages import message_type
from msgs_json import topics
from msgs_json.end_cause import EndCause
from sim_node.biped import SimulatedBiped
from sim_node.errors import PlantStoppedError, SnapshotError
from sim_node.settings import LimitSettings, SensorSettings, SimSettings
from trajectory_node.settings import CorrectionSettings, GaitSettings
from trajectory_node.waist_reference import WaistReference

TIMEOUT_S = 120.0
LOCKSTEP = ("pace:=lockstep",)
IN_ITS_OWN_TIME = ("pace:=realtime", "realtime_factor:=0.25")
SERVOS_THAT_LAG = (*LOCKSTEP, "sim.servo.kind:=lag", "sim.servo.bandwidth_hz:=2.0")


class Person:
    """Puts the robot on its feet, asks for walks, and can stop it at once."""

    def __init__(self, domain):
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain)
        self.node = rclpy.create_node("person", context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        name = topics.EMERGENCY_STOP.name
        self.button = self.node.create_publisher(Bool, name, 10)
        self.asked = []
        """Of the joints, newest last."""
        name = topics.HARDWARE_COMMANDS.name
        self.node.create_subscription(JointTrajectory, name, self.asked.append, 1000)

    def call(self, service, kind=Trigger, **request):
        client = self.node.create_client(kind, service)
        assert client.wait_for_service(TIMEOUT_S)
        future = client.call_async(kind.Request(**request))
        self.executor.spin_until_future_complete(future, TIMEOUT_S)
        return future.result()

    def have_it_walk(self):
        """Ask for a walk until it is granted."""
        end = time.monotonic() + TIMEOUT_S
        while not (answer := self.call("/robot_hardware/begin")).success:
            assert time.monotonic() < end, answer.message
            time.sleep(0.1)

    def last_asked(self):
        """Return (points, 12) positions, once nothing comes any more."""
        heard = -1
        while heard < len(self.asked):
            heard = len(self.asked)
            end = time.monotonic() + 0.5
            while time.monotonic() < end:
                self.executor.spin_once(0.05)
        return np.array([point.positions for point in self.asked[-1].points])

    def press(self, pressed):
        end = time.monotonic() + TIMEOUT_S
        while self.button.get_subscription_count() == 0:
            assert time.monotonic() < end
            time.sleep(0.05)
        self.button.publish(Bool(data=pressed))

    def close(self):
        self.node.destroy_node()
        rclpy.shutdown(context=self.context)


@pytest.fixture
def person(domain):
    made = Person(domain)
    yield made
    made.close()


@pytest.fixture
def hardware(domain, request):
    """Play the robot: in lockstep, time goes on with every command."""
    settings = getattr(request, "param", LOCKSTEP)
    arguments = [word for each in settings for word in ("-p", each)]
    process = subprocess.Popen(
        [sys.executable, "-m", "sim_node.hardware_node", "--ros-args", *arguments],
        env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
    )
    yield process
    process.kill()
    process.wait(10.0)


@pytest.fixture
def new_biped(domain, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    stance = WaistReference(SHIPPED, GaitSettings(), CorrectionSettings()).stance()
    made = []

    def make(robot, following_limit_rad=0.05, zmp_limit_m=0.065):
        settings = SimSettings(
            engine="robot",
            observations="sensors",
            limits=LimitSettings(zmp_error_m=zmp_limit_m),
            sensors=SensorSettings(
                timeout_s=3.0, following_limit_rad=following_limit_rad
            ),
        )
        made.append(SimulatedBiped(robot, settings, stance, np.random.default_rng(0)))
        return made[-1]

    yield make
    for each in made:
        each.close()


def segments():
    reference = WaistReference(SHIPPED, GaitSettings(), CorrectionSettings())
    return (reference.segment(np.zeros(2)) for _ in itertools.count())


def begin(biped, person, number):
    """Begin a walk, as a person asks for it meanwhile."""
    assert not biped.world.hardware.ready()
    asks = threading.Thread(target=person.have_it_walk)
    asks.start()
    observation = biped.begin_walk(number)
    asks.join()
    return observation


def test_a_robot_walks_is_stopped_and_walks_again(new_biped, hardware, person):
    biped = new_biped(SHIPPED)
    observation = begin(biped, person, 1)
    assert observation.end_cause is None
    static = segments()
    while observation.end_cause is None and observation.control_tick < 300:
        observation = biped.execute(next(static))
    # It stood on straight legs; it has bent them and begun to shift its weight.
    assert (observation.control_tick, observation.end_cause) == (300, None)
    assert observation.worst_zmp_error_m < 0.03
    assert biped.world.waist().position[2] == pytest.approx(0.475, abs=0.002)

    refused = person.call("/robot_hardware/begin")
    assert (refused.success, refused.message) == (False, "a walk is under way")
    with pytest.raises(SnapshotError):
        biped.snapshot()
    person.press(True)  # between two segments, and let go before the next one
    assert_asked_to_stay(person)
    refused = person.call("/robot_hardware/begin")
    assert (refused.success, refused.message) == (
        False,
        "the emergency stop is pressed",
    )
    person.press(False)
    observation = biped.execute(next(static))
    assert observation.end_cause is EndCause.EMERGENCY_STOP

    assert person.call("/simulated_hardware/reset").success
    assert begin(biped, person, 2).end_cause is None
    static = segments()
    assert biped.execute(next(static)).end_cause is None
    biped.end(EndCause.RESET)
    assert_asked_to_stay(person)

    assert person.call("/simulated_hardware/reset").success
    assert begin(biped, person, 3).end_cause is None
    static = segments()
    assert biped.execute(next(static)).end_cause is None
    hardware.kill()
    assert biped.execute(next(static)).end_cause is EndCause.SENSORS_SILENT


def test_a_reading_that_is_no_number_ends_the_walk(new_biped, hardware, person):
    biped = new_biped(SHIPPED)
    readings, publishers = {}, {}
    for topic in (
        topics.HARDWARE_JOINTS, topics.HARDWARE_IMU, *topics.HARDWARE_SOLES
    ):  # fmt: skip
        name, kind, newest_only = topic.name, message_type(topic), 1
        take = partial(readings.__setitem__, name)
        person.node.create_subscription(kind, name, take, newest_only)
        publishers[name] = person.node.create_publisher(kind, name, 10)
    assert begin(biped, person, 1).end_cause is None
    static = segments()
    assert biped.execute(next(static)).end_cause is None
    person.last_asked()
    hardware.send_signal(signal.SIGSTOP)
    readings[topics.HARDWARE_JOINTS.name].position[3] = math.nan
    for name, message in readings.items():
        message.header.stamp.nanosec += CONTROL_PERIOD_NS
        publishers[name].publish(message)
    assert biped.execute(next(static)).end_cause is EndCause.SENSORS_INVALID
    assert_asked_to_stay(person)


def test_a_stop_before_a_walk_leads_nowhere(new_biped, hardware, person):
    """Not to where the walk before was led, from which somebody moved the robot."""
    biped = new_biped(SHIPPED, zmp_limit_m=1e-4)
    observation = begin(biped, person, 1)
    static = segments()
    while observation.end_cause is None:
        observation = biped.execute(next(static))
    assert observation.end_cause is EndCause.ZMP_ERROR
    person.last_asked()
    person.asked.clear()
    hardware.send_signal(signal.SIGSTOP)  # no reading comes with which to begin
    robot = biped.world.hardware
    assert not robot.ready()
    person.have_it_walk()
    end = time.monotonic() + TIMEOUT_S
    while not robot.ready():
        assert time.monotonic() < end
    with pytest.raises(PlantStoppedError, match="sensors_silent"):
        robot.load(0)
    person.press(True)
    end = time.monotonic() + 1.0
    while time.monotonic() < end:
        person.executor.spin_once(0.05)
    assert person.asked == []


def test_a_stop_on_the_way_to_the_stance_ends_it_there(new_biped, hardware, person):
    biped = new_biped(SHIPPED)
    assert not biped.world.hardware.ready()

    def presses():
        person.have_it_walk()
        end = time.monotonic() + TIMEOUT_S
        while not person.asked:
            assert time.monotonic() < end
            person.executor.spin_once(0.01)
        person.press(True)

    asks = threading.Thread(target=presses)
    asks.start()
    observation = biped.begin_walk(1)
    asks.join()
    assert (observation.control_tick, observation.end_cause) == (
        0,
        EndCause.EMERGENCY_STOP,
    )
    asked = person.last_asked()
    assert np.ptp(asked[TICKS_PER_LEARNING_TICK:], axis=0).max() == 0.0


def test_a_node_that_ends_asks_the_joints_to_stay(new_biped, hardware, person):
    biped = new_biped(SHIPPED)
    assert begin(biped, person, 1).end_cause is None
    assert biped.execute(next(segments())).end_cause is None
    biped.close()
    assert_asked_to_stay(person)


def test_a_walk_that_was_asked_for_is_not_begun_much_later(
    new_biped, hardware, person, monkeypatch
):
    monkeypatch.setattr("sim_node.robot_hardware._ASKED_S", 0.5)
    robot = new_biped(SHIPPED).world.hardware
    assert not robot.ready()
    person.have_it_walk()
    end = time.monotonic() + TIMEOUT_S
    while robot.ready():
        assert time.monotonic() < end


def test_who_has_asked_for_a_walk_asks_again_after_an_emergency_stop(
    new_biped, hardware, person
):
    robot = new_biped(SHIPPED).world.hardware
    assert not robot.ready()
    person.have_it_walk()
    assert robot.ready()
    person.press(True)
    person.press(False)
    end = time.monotonic() + TIMEOUT_S
    while robot.ready():
        assert time.monotonic() < end


def assert_asked_to_stay(person):
    """Where the last segment led to: without a jump, and for a while."""
    asked = person.last_asked()
    assert len(asked) == 50
    assert np.ptp(asked, axis=0).max() == 0.0
    segment = person.asked[-2].points
    assert len(segment) == TICKS_PER_LEARNING_TICK
    assert asked[0].tolist() == list(segment[-1].positions)


def assert_no_step(asked):
    """Each begins with what was asked before, and comes to something else."""
    rows = [np.array([point.positions for point in each.points]) for each in asked]
    assert len(rows) == 30
    for before, after in itertools.pairwise(rows):
        known = before[TICKS_PER_LEARNING_TICK:]
        assert np.array_equal(known[:20], after[:20])
        assert 0.0 < np.abs(known - after[: len(known)]).max() < 1e-3


@pytest.mark.parametrize("hardware", [IN_ITS_OWN_TIME], indirect=True)
def test_a_robot_that_keeps_its_own_time_is_followed_tick_by_tick(
    new_biped, hardware, person
):
    biped = new_biped(SHIPPED)
    for number in range(1, 6):  # a machine that is late says so, and walks again
        # Segments as nodes send them, with look-ahead.
        reference = WaistReference(SHIPPED, GaitSettings(), CorrectionSettings(), 50)
        observation = begin(biped, person, number)
        person.last_asked()
        person.asked.clear()
        for sway in itertools.cycle((0.024, -0.024)):
            if observation.end_cause is not None or observation.control_tick == 300:
                break
            observation = biped.execute(reference.segment(np.array([0.0, sway])))
            time.sleep(0.01)  # the robot walks on
        if observation.end_cause is not EndCause.LATE:
            break
    assert (observation.control_tick, observation.end_cause) == (300, None)
    assert observation.worst_zmp_error_m < 0.03
    assert biped.world.waist().position[2] == pytest.approx(0.475, abs=0.002)
    person.last_asked()
    assert_no_step(person.asked)

    time.sleep(0.5)  # for longer than a segment may take
    observation = biped.execute(reference.segment(np.zeros(2)))
    assert observation.end_cause is EndCause.LATE


def test_a_robot_that_does_not_stand_does_not_walk(new_biped, hardware, person):
    # By its table it weighs far more than the soles feel: somebody holds it up.
    biped = new_biped(Robot(replace(SHIPPED.settings, torso_mass_kg=100.0)))
    assert begin(biped, person, 1).end_cause is EndCause.NOT_STANDING


@pytest.mark.parametrize("hardware", [SERVOS_THAT_LAG], indirect=True)
def test_a_robot_that_does_not_do_what_it_is_sent_is_stopped(
    new_biped, hardware, person
):
    biped = new_biped(SHIPPED, following_limit_rad=0.02, zmp_limit_m=1.0)
    observation = begin(biped, person, 1)
    static = segments()
    while observation.end_cause is None:
        observation = biped.execute(next(static))
    assert observation.end_cause is EndCause.NOT_FOLLOWING
    # It stood well, and was in motion when its joints were too far behind.
    assert 500 < observation.control_tick < 1000
    asked = person.last_asked()
    assert len(asked) == 50
    assert np.ptp(asked[TICKS_PER_LEARNING_TICK:], axis=0).max() == 0.0


@pytest.mark.thorough
def test_the_learned_walk_holds_on_the_graph(domain, tmp_path, hardware, person):
    # As docs/real-robot.md has it: learned 15 mm stricter than it is walked.
    stricter = "sim.limits.zmp_error_m=0.05"
    settings = load_settings("directed", changes=[SENSED, stricter])
    assert learn(settings, 5, tmp_path / "memory.npz")
    changes = (
        "sim.engine=robot",
        "sim.sensors.timeout_s=3",
        "sim.limits.zmp_error_m=0.065",
    )
    up = subprocess.Popen(
        [*COMMAND, "up", "--greedy", "--no-view", "--plain", "--json"]
        + ["--record", "none", "--domain", str(domain), "--out", str(tmp_path)]
        + [word for change in changes for word in ("--set", change)],
        stdout=subprocess.PIPE,
    )
    try:
        person.have_it_walk()
        assert not person.call("/sim_node/pause", SetBool, data=True).success
        out, _ = up.communicate(timeout=10 * TIMEOUT_S)
    finally:
        up.kill()
        up.wait(10.0)
    walk = json.loads(out)
    assert up.returncode == 0, walk
