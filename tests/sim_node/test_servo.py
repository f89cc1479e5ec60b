"""Servos that lag or give way: by how much, and what is refused."""

import itertools
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.robots import SHIPPED

from biped_common.settings import SettingsError, from_mapping
from sim_node.biped import SimulatedBiped
from sim_node.engines import ENGINES
from sim_node.servo import IDEAL_SERVO, SERVO_KINDS, ServoSettings
from sim_node.settings import SimSettings

DT_S = 0.002
STURDY = {"zmp_error_m": 1.0}
LAGGING = [name for name, engine in ENGINES.items() if "lag" in engine.servos]
PULLING = [name for name, engine in ENGINES.items() if "pid" in engine.servos]
PUSHED = {"push_force_n": 10.0, "push_time_s": 1.4, "mass_error": 0.02}
IN_THE_AIR = np.array([0.0, 0.0, 3.0])


@pytest.fixture
def driven(static_walk):
    """Build robots on an engine, with a servo."""
    robots = []

    def build(engine, disturbances=None, **servo):
        sim = {"engine": engine, "servo": servo, "limits": STURDY}
        sim["disturbances"] = disturbances or {}
        settings, ticks = from_mapping(SimSettings, sim), []
        robot = SimulatedBiped(
            robot=SHIPPED,
            settings=settings,
            start=static_walk[0],
            rng=np.random.default_rng(0),
            on_tick=ticks.append,
        )
        robots.append(robot)
        return robot, ticks

    yield build
    for robot in robots:
        robot.close()


def follow(robot, segments):
    """Walk segments; return the trajectory's hash."""
    for segment in segments:
        robot.execute(segment)
    return robot.trajectory_sha256


def worst_error_rad(ticks):
    """Return the largest distance of a joint from its reference."""
    return max(
        np.abs(np.subtract(tick.joint_position, tick.joint_reference)).max()
        for tick in ticks
    )


# -- lag -------------------------------------------------------------------------------


@pytest.mark.parametrize("engine", LAGGING)
def test_the_error_of_a_servo_that_lags_dies_out_critically_damped(driven, engine):
    robot, _ = driven(engine, kind="lag", bandwidth_hz=10.0)
    world, q, measured = robot.world, np.zeros(12), np.empty(36)
    world.place(IN_THE_AIR, q)
    aim, errors = q + 0.01, []
    for _ in range(60):
        world.step(aim, q, measured)
        errors.append(aim[3] - measured[3])
    # (z - p)^2 e = 0 from rest.
    p, n = np.exp(-2.0 * np.pi * 10.0 * DT_S), np.arange(1, 61)
    expected = 0.01 * p**n * (1.0 + n * (1.0 - p))
    np.testing.assert_allclose(errors, expected, rtol=0, atol=1e-4)


@pytest.mark.parametrize("engine", LAGGING)
def test_a_wider_band_lags_less(driven, static_walk, engine):
    worst = []
    for bandwidth_hz in (20.0, 40.0):
        robot, ticks = driven(engine, kind="lag", bandwidth_hz=bandwidth_hz)
        robot.begin_walk(1)
        follow(robot, static_walk[:150])
        worst.append(worst_error_rad(ticks))
    assert 3.0 < worst[0] / worst[1] < 6.0


def test_engines_lag_alike(driven, static_walk):
    worst = []
    for engine in LAGGING:
        robot, ticks = driven(engine, kind="lag", bandwidth_hz=20.0)
        robot.begin_walk(1)
        follow(robot, static_walk[:90])
        worst.append(worst_error_rad(ticks))
    assert worst[0] == pytest.approx(worst[1], rel=0.1)


# -- pid -------------------------------------------------------------------------------


@pytest.mark.parametrize("engine", PULLING)
def test_a_pid_servo_gives_way_by_its_torque_over_its_stiffness(
    driven, static_walk, engine
):
    robot, ticks = driven(engine, kind="pid", friction_nm=0.0, integral_per_s=0.0)
    robot.begin_walk(1)
    follow(robot, static_walk[:1])
    tick = ticks[-1]
    error = np.subtract(tick.joint_reference, tick.joint_position)
    np.testing.assert_allclose(30e3 * error, tick.joint_torque, rtol=0, atol=0.2)
    assert np.abs(error).max() > 1e-4


@pytest.mark.parametrize("engine", PULLING)
def test_an_integral_takes_back_what_a_servo_gave_way(driven, static_walk, engine):
    errors = []
    for integral_per_s in (0.0, 3.0):
        robot, ticks = driven(engine, kind="pid", integral_per_s=integral_per_s)
        robot.begin_walk(1)
        follow(robot, static_walk[:100])
        errors.append(worst_error_rad(ticks[-10:]))  # on one foot
    assert errors[1] < 0.3 * errors[0]


@pytest.mark.parametrize("engine", PULLING)
def test_an_integral_stands_still_while_the_torque_is_at_its_limit(driven, engine):
    pulled = []
    for integral_per_s in (0.0, 3.0):
        robot, _ = driven(engine, kind="pid", integral_per_s=integral_per_s)
        world, aim, measured = robot.world, np.full(12, 1.0), np.empty(36)
        world.place(IN_THE_AIR, np.zeros(12))
        for _ in range(5):
            world.step(aim, np.zeros(12), measured)  # more than there is torque for
            aim = measured[:12] + 1.0
        world.step(measured[:12].copy(), np.zeros(12), measured)
        world.step(measured[:12].copy(), np.zeros(12), measured)
        pulled.append(measured[24:].copy())
    assert np.abs(pulled[0]).max() > 1.0
    np.testing.assert_array_equal(*pulled)


@pytest.mark.parametrize("engine", PULLING)
def test_a_pid_servo_has_no_more_than_its_torque(driven, static_walk, engine):
    robot, ticks = driven(engine, kind="pid")
    robot.begin_walk(1)
    robot.follow(static_walk[0])
    for _ in range(8):
        robot.world.push((3000.0, 0.0, 0.0))
        robot.advance()
    torques = np.abs([tick.joint_torque for tick in ticks])
    limits = np.array(robot.robot.torque_limit_nm)
    assert (torques <= limits).all() and (torques == limits).any()


@pytest.mark.parametrize("engine", PULLING)
def test_dry_friction_brings_a_joint_to_rest_and_keeps_it_there(driven, engine):
    friction_nm, inertia = 2.0, 0.5
    robot, _ = driven(
        engine, kind="pid", friction_nm=friction_nm, rotor_inertia_kg_m2=inertia,
        stiffness_nm_rad=1e-3, damping_nm_s_rad=20.0, integral_per_s=0.0,
    )  # fmt: skip
    world, measured = robot.world, np.empty(36)
    world.place(IN_THE_AIR, np.zeros(12))
    speed = np.zeros(12)
    speed[3] = 1.0  # the damping pulls the knee along with the reference
    for _ in range(40):
        world.step(measured[:12].copy(), speed, measured)
    assert measured[12 + 3] > 0.5
    slowed = []
    for _ in range(300):
        # Friction alone: damping, which would help, has no error.
        world.step(measured[:12].copy(), measured[12:24].copy(), measured)
        slowed.append(measured[12 + 3])
    lost = -np.diff(slowed[:20]) / DT_S
    # By friction over the inertia of rotor and leg, at most that of the rotor alone.
    assert (0.5 * friction_nm / inertia < lost).all()
    assert (lost < 1.5 * friction_nm / inertia).all()
    assert np.abs(slowed[-50:]).max() < 1e-3


@pytest.mark.parametrize("engine", PULLING)
def test_a_push_is_felt_and_masses_weigh(driven, engine):
    robot, _ = driven(engine, kind="pid")
    world, measured = robot.world, np.empty(36)
    mass_kg = sum(link.mass for link in robot.robot.links)
    moved = []
    for scale in (1.0, 2.0):
        world.set_mass_factors(np.full(13, scale))
        world.place(IN_THE_AIR, np.zeros(12))
        for _ in range(50):
            world.push((50.0, 0.0, 0.0))
            world.step(np.zeros(12), np.zeros(12), measured)
        moved.append(world.waist().velocity[0])
    # Pushed above its waist, the robot turns, too, and the waist stays behind the CoM.
    of_com = 50 * DT_S * 50.0 / mass_kg
    assert 0.8 * of_com < moved[0] < of_com
    assert moved[1] == pytest.approx(moved[0] / 2.0, rel=0.02)


@pytest.mark.parametrize("engine", PULLING)
@pytest.mark.parametrize("joint", range(12))
def test_a_rotor_stands_between_a_torque_and_its_joint(driven, engine, joint):
    # A joint in the air, pulled at by its servo: without the rotor's inertia a knee's
    # shank and foot would be thrown.
    moved = {}
    for inertia in (0.5, 1.0):
        robot, _ = driven(
            engine, kind="pid", rotor_inertia_kg_m2=inertia, friction_nm=0.0
        )
        world, aim, measured = robot.world, np.zeros(12), np.empty(36)
        world.place(IN_THE_AIR, np.zeros(12))
        aim[joint] = 1e-4
        pulled = 0.0
        for _ in range(4):
            world.step(aim, np.zeros(12), measured)
            pulled += DT_S * measured[24 + joint]
        moved[inertia] = pulled / measured[12 + joint]
    # Inertia, as momentum over velocity: half a kg m^2 more is half a kg m^2 more.
    assert moved[1.0] - moved[0.5] == pytest.approx(0.5, rel=0.03)


def test_engines_give_way_alike(driven, static_walk):
    errors, loads = [], []
    for engine in PULLING:
        robot, ticks = driven(engine, kind="pid")
        robot.begin_walk(1)
        follow(robot, static_walk[:200])  # a step, and the next foot is down
        assert len(ticks) == 2000
        errors.append(
            [np.subtract(tick.joint_reference, tick.joint_position) for tick in ticks]
        )
        loads.append([tick.joint_torque for tick in ticks])
    for one, other in (errors, loads):
        apart = np.sqrt(np.mean(np.subtract(one, other) ** 2))
        assert apart < 0.15 * np.sqrt(np.mean(np.square(one)))


@pytest.mark.parametrize("engine", PULLING)
@pytest.mark.parametrize("delay_ticks", [0, 1])
def test_a_delay_holds_a_torque_back_for_a_tick(driven, delay_ticks, engine):
    robot, _ = driven(engine, kind="pid", delay_ticks=delay_ticks)
    world, q, measured = robot.world, np.zeros(12), np.empty(36)
    world.place(IN_THE_AIR, q)
    pulled = []
    for aim in (0.001, 0.0, 0.0):
        world.step(q + aim, q, measured)
        pulled.append(measured[24:].any())
    assert pulled.index(True) == delay_ticks


@pytest.mark.parametrize("engine", PULLING)
@pytest.mark.parametrize(
    "servo",
    [
        {"kind": "lag", "bandwidth_hz": 40.0},
        {"kind": "pid", "delay_ticks": 0},
        {"kind": "pid"},
    ],
    ids=["lag", "pid", "delayed_pid"],
)
def test_a_walk_goes_on_bit_for_bit_from_a_state_kept(
    driven, static_walk, servo, engine
):
    robot, ticks = driven(engine, PUSHED, **servo)
    robot.begin_walk(1)
    follow(robot, static_walk[:72])  # on one foot, while it is pushed
    kept = robot.snapshot()
    expected = follow(robot, static_walk[72:130])
    robot.restore(kept)
    assert follow(robot, static_walk[72:130]) == expected
    assert len(ticks) == 10 * (72 + 2 * 58)


# -- stability -------------------------------------------------------------------------


class Gains(NamedTuple):
    """Of a PID servo."""

    stiffness_nm_rad: float
    damping_nm_s_rad: float
    integral_per_s: float
    rotor_inertia_kg_m2: float
    delay_ticks: int


def slowest_mode(servo):
    """Return the largest modulus by which a mode of a rotor alone moves in a tick."""
    gain = servo.stiffness_nm_rad * DT_S**2 / servo.rotor_inertia_kg_m2
    damping = servo.damping_nm_s_rad * DT_S / servo.rotor_inertia_kg_m2
    position, speed, integral, late = np.eye(4)  # what a tick begins with
    grown = integral - servo.integral_per_s * DT_S * position
    pull = gain * (grown - position) - damping * speed
    speed = speed + (late if servo.delay_ticks else pull)
    tick = np.array([position + speed, speed, grown, pull])
    if servo.integral_per_s == 0.0:  # nothing grows or fades
        tick = np.delete(np.delete(tick, 2, axis=0), 2, axis=1)
    return np.abs(np.linalg.eigvals(tick)).max()


@given(
    st.floats(1.0, 1e6),
    st.floats(0.1, 3e3),
    st.floats(0.01, 5.0),
    st.sampled_from([0.0, 3.0, 30.0]),
    st.booleans(),
)
def test_gains_are_refused_where_a_rotor_alone_is_unstable(
    stiffness, damping, inertia, integral, delayed
):
    gains = Gains(stiffness, damping, integral, inertia, int(delayed))
    largest = slowest_mode(gains)
    try:
        ServoSettings("pid", **gains._asdict())
    except SettingsError as error:
        assert "unstable at 2 ms with damping_nm_s_rad = " in str(error)
        assert largest > 1.0 - 1e-6
    else:
        assert largest < 1.0 + 1e-6


# -- settings --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("engine", "kind"),
    [
        (engine, kind)
        for engine, kind in itertools.product(ENGINES, SERVO_KINDS)
        if kind not in ENGINES[engine].servos
    ],
)
def test_a_servo_that_an_engine_has_not_is_refused_in_one_line(engine, kind):
    kinds = ", ".join(ENGINES[engine].servos)
    message = (
        rf"^servo\.kind = '{kind}': must be one of {kinds} with engine = {engine}$"
    )
    with pytest.raises(SettingsError, match=message):
        SimSettings(engine, servo=ServoSettings(kind))


@pytest.mark.parametrize(
    ("kind", "setting", "value"),
    [
        ("ideal", "bandwidth_hz", 20.0),
        ("lag", "stiffness_nm_rad", 1e4),
        ("pid", "bandwidth_hz", 20.0),
    ],
)
def test_a_setting_of_another_kind_is_refused(kind, setting, value):
    message = rf"^{setting} = {value}: has no effect with kind = {kind}$"
    with pytest.raises(SettingsError, match=message):
        ServoSettings(kind, **{setting: value})


def test_servos_are_ideal_by_default():
    assert SimSettings().servo == IDEAL_SERVO == ServoSettings("ideal")
