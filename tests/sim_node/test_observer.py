"""What the observer makes of sensors, beside the truth that the engine knows."""

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest
from tests.robots import SHIPPED

from biped_common.settings import to_mapping
from biped_common.timing import CONTROL_PERIOD_S
from msgs_json.end_cause import EndCause
from sim_node.biped import SimulatedBiped
from sim_node.engines import plant_of
from sim_node.observer import Observer
from sim_node.sensed_world import SensedWorld
from sim_node.sensors import SensorReading
from sim_node.settings import LimitSettings, SensorSettings, SimSettings
from sim_node.simulated_hardware import SimulatedHardware

NO_NOISE = {name: 0.0 for name in to_mapping(SensorSettings()) if "_noise_" in name}
STANCE, LEFT, RIGHT = np.array([[[0, 0, 0.475]], [[0, 0.09, 0]], [[0, -0.09, 0]]])
SEGMENTS = 120  # double support, two steps and a change of feet


class Sensed:
    """A walk of a robot known by its sensors, with the truth of every tick."""

    def __init__(self, walk, seed=0, sturdy=True, **sensors):
        settings = SimSettings(
            observations="sensors",
            limits=LimitSettings(zmp_error_m=1.0 if sturdy else 0.065),
            sensors=SensorSettings(**sensors),
        )
        self.rng = np.random.default_rng(seed)
        self.zmp, self.waist, self.loads = [], [], []
        self.biped = SimulatedBiped(SHIPPED, settings, walk[0], self.rng, self._look)

    def _look(self, tick):
        hardware = self.biped.world.hardware
        true, seen = hardware.contact, tick.contact
        self.zmp.append(np.subtract(seen[:2], true[:2]))
        self.waist.append(
            np.subtract(
                self.biped.world.waist().position, hardware.plant.waist().position
            )
        )
        self.loads.append(((true[2] > 0, true[3] > 0), (seen[2] > 0, seen[3] > 0)))

    def walk(self, segments):
        observations = [self.biped.begin_walk(1)]
        observations += [self.biped.execute(segment) for segment in segments]
        return observations


@pytest.fixture
def sensed(static_walk):
    made = []

    def make(**options):
        made.append(Sensed(static_walk, **options))
        return made[-1]

    yield make
    for each in made:
        each.biped.close()


def test_without_noise_and_delay_the_sensors_tell_the_truth(sensed, static_walk):
    exact = sensed(delay_ticks=0, **NO_NOISE)
    exact.walk(static_walk[:SEGMENTS])
    assert np.abs(exact.zmp).max() < 2e-5
    assert np.abs(exact.waist).max() < 2e-4


def test_observations_are_those_of_the_truth(sensed, static_walk, new_walker):
    exact = sensed(delay_ticks=0, **NO_NOISE).walk(static_walk[:SEGMENTS])
    true = new_walker(limits={"zmp_error_m": 1.0}).walk(static_walk[:SEGMENTS])
    # A sole that carries next to nothing counts as in the air: at touch-down only.
    different = [a.phase != b.phase for a, b in zip(exact, true, strict=True)]
    assert sum(different) <= 3
    for one, other in zip(exact, true, strict=True):
        assert one.zmp_error_m == pytest.approx(other.zmp_error_m, abs=2e-5)
        assert one.waist_in_support_foot_m == pytest.approx(
            other.waist_in_support_foot_m, abs=2e-4
        )
        assert one.waist_acceleration_m_s2 == pytest.approx(
            other.waist_acceleration_m_s2, abs=0.02
        )


def test_noise_moves_the_zmp_by_millimetres_and_no_more(sensed, static_walk):
    noisy = sensed()
    noisy.walk(static_walk[:SEGMENTS])
    # One tick of delay counts where a foot touches down: the 95 % that are between.
    off_mm = 1000 * np.hypot(*np.transpose(noisy.zmp))
    assert 0.3 < np.median(off_mm) < 2.0
    assert np.percentile(off_mm, 95) < 5.0


def test_the_same_generator_gives_the_same_walk(sensed, static_walk):
    one, other, third = sensed(seed=1), sensed(seed=1), sensed(seed=2)
    hashes = [
        each.walk(static_walk[:5])[-1].trajectory_sha256 for each in (one, other, third)
    ]
    assert hashes[0] == hashes[1] != hashes[2]


def test_a_snapshot_goes_on_bit_for_bit(sensed, static_walk):
    walk = sensed(delay_ticks=2)
    walk.walk(static_walk[:10])
    snapshot = walk.biped.snapshot()
    hashes = []
    for _ in range(2):
        walk.biped.restore(snapshot)
        hashes.append(walk.biped.execute(static_walk[10]).trajectory_sha256)
    assert hashes[0] == hashes[1]


def test_readings_are_as_old_as_the_delay_says(sensed, static_walk):
    ages = {}
    for delay in (0, 3):
        made = sensed(delay_ticks=delay, **NO_NOISE)
        made.walk(static_walk[:SEGMENTS])
        ages[delay] = made
    # What is late by three ticks is where the other was three ticks before.
    late = np.array([both[1] for both in ages[3].loads])
    now = np.array([both[1] for both in ages[0].loads])
    assert np.array_equal(late[3:], now[:-3])
    assert not np.array_equal(late, now)


# -- what cannot be walked on ----------------------------------------------------------


class Broken:
    """The readings of real hardware, but for what a test makes of them."""

    def __init__(self, hardware, change):
        self._hardware, self._change = hardware, change

    def exchange(self, q, dq):
        return self._change(self._hardware.exchange(q, dq))

    def step(self, q, dq, joints):
        contact = self._hardware.step(q, dq, joints)
        joints[20] = np.nan
        return contact

    def __getattr__(self, name):
        return getattr(self._hardware, name)


def nan_in_a_joint(reading: SensorReading) -> SensorReading:
    joints = reading.joints.copy()
    joints[7] = np.nan
    return reading._replace(joints=joints)


def no_orientation(reading: SensorReading) -> SensorReading:
    return reading._replace(orientation=np.zeros(4))


def half_a_radian(reading: SensorReading) -> SensorReading:
    return reading._replace(orientation=np.array([np.sin(0.25), 0, 0, np.cos(0.25)]))


def in_the_air(reading: SensorReading) -> SensorReading:
    return reading._replace(soles=np.zeros((2, 3)))


@pytest.mark.parametrize(
    ("change", "cause", "ticks"),
    [
        (nan_in_a_joint, EndCause.SENSORS_INVALID, 50),
        (no_orientation, EndCause.SENSORS_INVALID, 50),
        (half_a_radian, EndCause.TILT, 50),
        (in_the_air, EndCause.FEET_UNLOADED, 75),
    ],
)
def test_sensors_end_a_walk(sensed, static_walk, change, cause, ticks):
    walk = sensed()
    walk.walk(static_walk[:5])
    walk.biped.world.hardware = Broken(walk.biped.world.hardware, change)
    ends = [
        walk.biped.execute(each)
        for each in static_walk[5:8]
        if walk.biped.end_cause is None
    ]
    assert (ends[-1].end_cause, ends[-1].control_tick) == (cause, ticks)


def test_two_observations_never_share_a_time_though_a_walk_breaks(sensed, static_walk):
    walk = sensed()
    before = walk.walk(static_walk[:5])[-1]
    walk.biped.world.hardware = Broken(walk.biped.world.hardware, nan_in_a_joint)
    after = walk.biped.execute(static_walk[5])
    assert after.clock_ticks == before.clock_ticks + 1


class Ahead(SimulatedHardware):
    """Does not come to the stance; it stands a centimetre ahead of it."""

    def load(self, handle):
        super().load(handle)
        stance, left, right = np.repeat([STANCE, LEFT, RIGHT], 1000, axis=1)
        stance[:, 0] = np.linspace(0.0, 0.02, 1000).clip(max=0.01)
        motion = SHIPPED.leg_joint_positions(stance, left, right)
        rates = np.diff(motion, axis=0) / CONTROL_PERIOD_S
        return list(map(self.exchange, motion, rates))


def test_a_walk_begins_where_the_robot_was_read_to_stand(static_walk):
    rng = np.random.default_rng(0)
    sensors = SensorSettings(delay_ticks=0, **NO_NOISE)
    plant = plant_of("pybullet")(SHIPPED, 0.9, SHIPPED.torque_limit_nm)
    world = SensedWorld(SHIPPED, Ahead(plant, SHIPPED, sensors, rng), 0.3)
    with closing(world):
        q = SHIPPED.leg_joint_positions(STANCE, LEFT, RIGHT)[0]
        world.place(STANCE[0], q)
        for _ in range(150):
            world.step(q, np.zeros(12), np.empty(36))
        world.load(world.save())
        true, seen = plant.waist(), world.waist()
    assert true.position[0] == pytest.approx(0.01, abs=1e-3)
    assert seen.position == pytest.approx(true.position, abs=3e-4)
    assert seen.velocity == pytest.approx(true.velocity, abs=5e-3)


def test_physics_that_come_to_no_number_are_no_fault_of_the_sensors(
    sensed, static_walk
):
    walk = sensed()
    walk.walk(static_walk[:5])
    plant = walk.biped.world.hardware.plant
    walk.biped.world.hardware.plant = Broken(plant, None)
    assert walk.biped.execute(static_walk[5]).end_cause is EndCause.PHYSICS_NAN


# -- the IMU's heading -----------------------------------------------------------------


def test_an_imu_may_point_anywhere():
    q = SHIPPED.leg_joint_positions([[0, 0, 0.5]], [[0, 0.09, 0]], [[0, -0.09, 0]])[0]
    weight = 9.81 * SHIPPED.mass_kg
    level = SensorReading(
        np.concatenate([q, np.zeros(24)]),
        np.array([0.0, 0.0, 0.0, 1.0]),
        np.array([0.0, 0.0, 9.81]),
        np.array([[weight / 2, 0.0, -1.0], [weight / 2, 0.0, -1.0]]),
    )
    turned = level._replace(orientation=np.array([0, 0, np.sin(1.2), np.cos(1.2)]))
    seen = []
    for reading in (level, turned):
        observer = Observer(SHIPPED)
        observer.start(np.array([0.0, 0.0, 0.5]), q)
        seen.append(observer.update(reading))
    assert seen[0] == pytest.approx(seen[1])
    # A moment of -1 N m about y presses the floor 2 / weight ahead of the ankles.
    assert seen[0].zmp_x_m == pytest.approx(2.0 / weight)
    assert seen[0].zmp_y_m == pytest.approx(0.0)


# -- settings --------------------------------------------------------------------------


def test_noise_makes_every_walk_different_and_no_noise_does_not():
    sensors = SimSettings(observations="sensors")
    assert sensors.random
    assert not replace(sensors, sensors=SensorSettings(**NO_NOISE)).random
    assert not SimSettings().random
