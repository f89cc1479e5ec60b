"""Snapshots continue a walk to the last bit, also in its middle."""

import numpy as np
import pytest
from tests.thorough import first_always

from msgs_json.end_cause import EndCause
from sim_node.engines import ENGINES
from sim_node.errors import SnapshotError, WorldClosedError

STURDY = {"zmp_error_m": 1.0}
DISTURBED = {
    "push_force_n": 20.0,
    "push_time_s": 1.4,
    "mass_error": 0.1,
    "friction": 0.7,
    "position_noise_m": 0.01,
    "zmp_noise_m": 0.01,
    "acceleration_noise_m_s2": 1.0,
}
EVERY_DISTURBANCE = pytest.mark.parametrize(
    "disturbances", [{}, DISTURBED], ids=["undisturbed", "disturbed"]
)
# Learning ticks. The first single support runs from 1.25 s, the push from 1.4 to 1.5 s.
ANYWHERE = pytest.mark.parametrize(
    "at",
    [0, 30, 72, 90, 130],
    ids=["standing", "first_shift", "push", "single_support", "double_support"],
)
END = 160


@pytest.fixture(scope="module", params=first_always(ENGINES))
def engine(request):
    return request.param


@ANYWHERE
@EVERY_DISTURBANCE
def test_a_restored_walk_measures_the_same(new_walker, shaky_walk, disturbances, at):
    walker = new_walker(STURDY, disturbances)
    walker.walk(shaky_walk[:at])
    snapshot = walker.robot.snapshot()
    walker.forget()
    walker.go_on(shaky_walk[at:END])
    expected = walker.everything
    walker.robot.restore(snapshot)
    walker.forget()
    walker.go_on(shaky_walk[at:END])
    np.testing.assert_array_equal(walker.everything, expected)


@ANYWHERE
@EVERY_DISTURBANCE
def test_a_restored_walk_observes_the_same(new_walker, shaky_walk, disturbances, at):
    walker = new_walker(STURDY, disturbances)
    walker.walk(shaky_walk[:at])
    snapshot = walker.robot.snapshot()
    expected = walker.go_on(shaky_walk[at:END])
    walker.robot.restore(snapshot)
    assert walker.go_on(shaky_walk[at:END]) == expected


@EVERY_DISTURBANCE
def test_another_walk_in_between_does_not_matter(
    new_walker, shaky_walk, static_walk, disturbances
):
    walker = new_walker(STURDY, disturbances)
    walker.walk(shaky_walk[:72])
    snapshot = walker.robot.snapshot()
    walker.forget()
    walker.go_on(shaky_walk[72:END])
    expected = walker.everything
    walker.walk(static_walk[:110], episode=2)
    walker.robot.restore(snapshot)
    walker.forget()
    walker.go_on(shaky_walk[72:END])
    np.testing.assert_array_equal(walker.everything, expected)


def test_a_snapshot_serves_again_and_again(sturdy_walker, shaky_walk, static_walk):
    sturdy_walker.walk(shaky_walk[:50])
    snapshot = sturdy_walker.robot.snapshot()
    sturdy_walker.forget()
    continuations = []
    for _ in range(3):
        sturdy_walker.robot.restore(snapshot)
        sturdy_walker.forget()
        sturdy_walker.go_on(static_walk[50:70])
        continuations.append(sturdy_walker.everything)
    np.testing.assert_array_equal(continuations[1:], continuations[:1] * 2)


def test_an_older_snapshot_is_not_touched_by_a_newer_one(sturdy_walker, shaky_walk):
    sturdy_walker.walk(shaky_walk[:50])
    older = sturdy_walker.robot.snapshot()
    sturdy_walker.forget()
    sturdy_walker.go_on(shaky_walk[50:100])
    expected = sturdy_walker.everything
    newer = sturdy_walker.robot.snapshot()
    sturdy_walker.robot.restore(newer)
    sturdy_walker.robot.restore(older)
    sturdy_walker.forget()
    sturdy_walker.go_on(shaky_walk[50:100])
    np.testing.assert_array_equal(sturdy_walker.everything, expected)


def test_a_restored_walk_knows_its_tick(sturdy_walker, shaky_walk):
    sturdy_walker.walk(shaky_walk[:7])
    snapshot = sturdy_walker.robot.snapshot()
    sturdy_walker.go_on(shaky_walk[7:10])
    sturdy_walker.robot.restore(snapshot)
    assert sturdy_walker.robot.control_tick == 70


def test_a_restored_walk_knows_its_episode(sturdy_walker, shaky_walk):
    sturdy_walker.walk(shaky_walk[:7], episode=12)
    snapshot = sturdy_walker.robot.snapshot()
    sturdy_walker.walk(shaky_walk[:3], episode=13)
    sturdy_walker.robot.restore(snapshot)
    assert sturdy_walker.go_on(shaky_walk[7:8])[0].episode == 12


def test_a_failed_walk_can_be_taken_back(walker, static_walk):
    walker.walk(static_walk[:50])
    snapshot = walker.robot.snapshot()
    assert walker.go_on(static_walk[50:])[-1].end_cause is EndCause.ZMP_ERROR
    walker.robot.restore(snapshot)
    assert walker.go_on(static_walk[50:51])[-1].end_cause is None


def test_a_snapshot_of_a_failed_walk_stays_failed(walker, static_walk):
    walker.walk(static_walk)
    snapshot = walker.robot.snapshot()
    walker.walk(static_walk[:10])
    walker.robot.restore(snapshot)
    with pytest.raises(ValueError, match="the walk is over: zmp_error"):
        walker.robot.execute(static_walk[113])


def test_a_released_snapshot_is_refused(sturdy_walker, shaky_walk):
    sturdy_walker.walk(shaky_walk[:7])
    snapshot = sturdy_walker.robot.snapshot()
    sturdy_walker.robot.release(snapshot)
    with pytest.raises(SnapshotError):
        sturdy_walker.robot.restore(snapshot)


def test_a_release_leaves_the_other_snapshots(sturdy_walker, shaky_walk):
    sturdy_walker.walk(shaky_walk[:7])
    kept, released = (sturdy_walker.robot.snapshot() for _ in range(2))
    expected = sturdy_walker.go_on(shaky_walk[7:20])
    sturdy_walker.robot.release(released)
    sturdy_walker.robot.restore(kept)
    assert sturdy_walker.go_on(shaky_walk[7:20]) == expected


def test_a_snapshot_that_this_world_never_kept_is_refused(new_walker, shaky_walk):
    one, other = new_walker(STURDY), new_walker(STURDY)
    one.walk(shaky_walk[:7])
    snapshot = one.robot.snapshot()
    with pytest.raises(SnapshotError):
        other.robot.restore(snapshot)


def test_a_snapshot_of_another_robot_with_the_same_number_is_refused(
    new_walker, shaky_walk
):
    one, other = new_walker(STURDY), new_walker(STURDY)
    for walker in (one, other):
        walker.walk(shaky_walk[:7])
    snapshot, own = one.robot.snapshot(), other.robot.snapshot()
    assert snapshot.world_state == own.world_state
    with pytest.raises(SnapshotError):
        other.robot.restore(snapshot)


def test_a_snapshot_of_another_robot_cannot_be_released(new_walker, shaky_walk):
    one, other = new_walker(STURDY), new_walker(STURDY)
    for walker in (one, other):
        walker.walk(shaky_walk[:7])
    snapshot, own = one.robot.snapshot(), other.robot.snapshot()
    with pytest.raises(SnapshotError):
        other.robot.release(snapshot)
    other.robot.restore(own)


def test_a_snapshot_cannot_be_released_twice(sturdy_walker, shaky_walk):
    sturdy_walker.walk(shaky_walk[:7])
    snapshot = sturdy_walker.robot.snapshot()
    sturdy_walker.robot.release(snapshot)
    with pytest.raises(SnapshotError):
        sturdy_walker.robot.release(snapshot)


def test_a_released_snapshot_does_not_stand_for_a_later_one(
    sturdy_walker, shaky_walk, engine
):
    sturdy_walker.walk(shaky_walk[:7])
    released = sturdy_walker.robot.snapshot()
    sturdy_walker.robot.release(released)
    sturdy_walker.go_on(shaky_walk[7:9])
    later = sturdy_walker.robot.snapshot()
    # PyBullet gives the number of a state that was released to the next one.
    assert (later.world_state == released.world_state) == (engine == "pybullet")
    with pytest.raises(SnapshotError):
        sturdy_walker.robot.restore(released)


@pytest.mark.parametrize("what", ["snapshot", "restore", "release"])
def test_a_closed_robot_has_no_snapshots(sturdy_walker, what):
    robot = sturdy_walker.robot
    robot.begin_walk(1)
    snapshot = robot.snapshot()
    robot.close()
    with pytest.raises(WorldClosedError):
        getattr(robot, what)(*[snapshot] * (what != "snapshot"))


def test_a_restored_walk_still_has_its_references(sturdy_walker, shaky_walk):
    robot = sturdy_walker.robot
    robot.begin_walk(1)
    robot.follow(shaky_walk[0])
    snapshot = robot.snapshot()
    for _ in range(10):
        robot.advance()
    expected = robot.observe()
    robot.restore(snapshot)
    for _ in range(10):
        robot.advance()
    assert robot.observe() == expected
