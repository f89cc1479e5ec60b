"""The same walk is the same to the last bit."""

import hashlib
import subprocess
import sys

import numpy as np
import pytest
from tests.thorough import first_always

from sim_node.engines import ENGINES

STURDY = {"zmp_error_m": 1.0}
# The push comes in the first single support.
DISTURBED = {
    "push_force_n": 20.0,
    "push_time_s": 1.4,
    "mass_error": 0.1,
    "friction": 0.7,
    "position_noise_m": 0.01,
    "zmp_noise_m": 0.01,
    "acceleration_noise_m_s2": 1.0,
}
# Prints the hash of the static walk's first two seconds on the engine given.
PROGRAM = """
import sys

import numpy as np
from biped_description.robot import Robot
from biped_description.settings import RobotSettings
from sim_node.biped import SimulatedBiped
from sim_node.settings import SimSettings
from trajectory_node.settings import CorrectionSettings, GaitSettings
from trajectory_node.waist_reference import WaistReference

robot = Robot(RobotSettings())
reference = WaistReference(robot, GaitSettings(), CorrectionSettings())
segments = [reference.segment(np.zeros(2)) for _ in range(100)]
settings = SimSettings(engine=sys.argv[1])
walker = SimulatedBiped(robot, settings, segments[0], np.random.default_rng(0))
walker.begin_walk(1)
for segment in segments:
    walker.execute(segment)
print(walker.trajectory_sha256)
"""
EVERY_DISTURBANCE = pytest.mark.parametrize(
    "disturbances", [{}, DISTURBED], ids=["undisturbed", "disturbed"]
)


@pytest.fixture(scope="module", params=first_always(ENGINES))
def engine(request):
    return request.param


@EVERY_DISTURBANCE
def test_a_walk_in_another_world_measures_the_same(
    new_walker, shaky_walk, disturbances
):
    one, other = (new_walker(STURDY, disturbances) for _ in range(2))
    one.walk(shaky_walk[:150])
    other.walk(shaky_walk[:150])
    np.testing.assert_array_equal(one.everything, other.everything)


@EVERY_DISTURBANCE
def test_a_walk_in_another_world_observes_the_same(
    new_walker, shaky_walk, disturbances
):
    one, other = (new_walker(STURDY, disturbances) for _ in range(2))
    assert one.walk(shaky_walk[:150]) == other.walk(shaky_walk[:150])


def test_a_second_walk_in_the_same_world_is_the_same(sturdy_walker, shaky_walk):
    sturdy_walker.walk(shaky_walk[:150])
    first = sturdy_walker.everything
    sturdy_walker.forget()
    sturdy_walker.walk(shaky_walk[:150])
    np.testing.assert_array_equal(sturdy_walker.everything, first)


def test_with_its_draws_repeated_a_disturbed_walk_is_the_same(new_walker, shaky_walk):
    walker = new_walker(STURDY, DISTURBED)
    before = walker.rng.bit_generator.state
    walker.walk(shaky_walk[:150])
    first = walker.everything
    walker.forget()
    walker.rng.bit_generator.state = before
    walker.walk(shaky_walk[:150])
    np.testing.assert_array_equal(walker.everything, first)


def test_the_whole_walk_is_the_same_again(sturdy_walker, static_walk):
    sturdy_walker.walk(static_walk)
    first = sturdy_walker.everything
    sturdy_walker.forget()
    sturdy_walker.walk(static_walk)
    np.testing.assert_array_equal(sturdy_walker.everything, first)


@EVERY_DISTURBANCE
def test_worlds_that_take_turns_do_not_feel_each_other(
    new_walker, shaky_walk, static_walk, disturbances
):
    alone = new_walker(STURDY, disturbances)
    alone.walk(shaky_walk[:150])
    one, other = new_walker(STURDY, disturbances), new_walker(STURDY, seed=1)
    one.walk([])
    other.walk([])
    for shaky, static in zip(shaky_walk[:150], static_walk, strict=False):
        one.go_on([shaky])
        other.go_on([static])
    np.testing.assert_array_equal(one.everything, alone.everything)


# -- hashes ----------------------------------------------------------------------------


def test_a_walk_in_another_process_has_the_same_hash(walker, static_walk, engine):
    walker.walk(static_walk[:100])
    other = subprocess.run(
        [sys.executable, "-c", PROGRAM, engine],
        capture_output=True,
        text=True,
        check=True,
    )
    assert other.stdout.strip() == walker.robot.trajectory_sha256


def test_a_walk_starts_with_the_hash_of_nothing(walker, static_walk):
    walker.walk(static_walk[:3])
    walker.walk([])
    assert walker.robot.trajectory_sha256 == hashlib.sha256().hexdigest()


@EVERY_DISTURBANCE
def test_equal_walks_have_equal_hashes(new_walker, shaky_walk, disturbances):
    walkers = [new_walker(STURDY, disturbances) for _ in range(2)]
    for walker in walkers:
        walker.walk(shaky_walk[:20])
    assert walkers[0].robot.trajectory_sha256 == walkers[1].robot.trajectory_sha256


def test_a_breath_of_wind_changes_the_hash(new_walker, static_walk):
    wind = {"push_force_n": 1e-9, "push_time_s": 0.38, "push_duration_s": 0.02}
    walkers = [new_walker(disturbances=each) for each in ({}, wind)]
    for walker in walkers:
        walker.walk(static_walk[:20])
    assert walkers[0].robot.trajectory_sha256 != walkers[1].robot.trajectory_sha256


def test_a_restored_walk_has_the_same_hash(sturdy_walker, shaky_walk):
    sturdy_walker.walk(shaky_walk[:10])
    snapshot = sturdy_walker.robot.snapshot()
    sturdy_walker.go_on(shaky_walk[10:20])
    expected = sturdy_walker.robot.trajectory_sha256
    sturdy_walker.robot.restore(snapshot)
    sturdy_walker.go_on(shaky_walk[10:20])
    assert sturdy_walker.robot.trajectory_sha256 == expected
