"""Servos that lag or give way: by how much, and what is refused."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.robots import SHIPPED

from biped_common.settings import SettingsError, from_mapping
from sim_node.biped import SimulatedBiped
from sim_node.engines import ENGINES
from sim_node.servo import IDEAL_SERVO, ServoSettings
from sim_node.settings import SimSettings

DT_S = 0.002
STURDY = {"zmp_error_m": 1.0}
LAGGING = [name for name, engine in ENGINES.items() if "lag" in engine.servos]
PULLING = [name for name, engine in ENGINES.items() if "pid" in engine.servos]
IN_THE_AIR = np.array([0.0, 0.0, 3.0])


@pytest.fixture
def driven(static_walk):
    """Build robots on an engine, with a servo."""
    robots = []

    def build(engine, **servo):
        sim = {"engine": engine, "servo": servo, "limits": STURDY}
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
    robot.world.push((3000.0, 0.0, 0.0))
    robot.follow(static_walk[0])
    for _ in range(5):
        robot.advance()
    torques = np.abs([tick.joint_torque for tick in ticks])
    assert (torques <= robot.robot.torque_limit_nm).all()


@pytest.mark.parametrize("engine", PULLING)
def test_a_rotor_stands_between_a_torque_and_its_joint(driven, engine):
    # A knee in the air, pulled at by its servo: without the rotor's inertia the shank
    # and foot would be thrown.
    moved = {}
    for inertia in (0.5, 1.0):
        robot, _ = driven(
            engine, kind="pid", rotor_inertia_kg_m2=inertia, friction_nm=0.0
        )
        world, aim, measured = robot.world, np.zeros(12), np.empty(36)
        world.place(IN_THE_AIR, np.zeros(12))
        aim[3] = 1e-4
        pulled = 0.0
        for _ in range(4):
            world.step(aim, np.zeros(12), measured)
            pulled += DT_S * measured[24 + 3]
        moved[inertia] = pulled / measured[12 + 3]
    # Inertia, as momentum over velocity: half a kg m^2 more is half a kg m^2 more.
    assert moved[1.0] - moved[0.5] == pytest.approx(0.5, rel=0.02)


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
@pytest.mark.parametrize("delay_ticks", [0, 1])
@pytest.mark.parametrize("kind", ["lag", "pid"])
def test_a_walk_goes_on_bit_for_bit_from_a_state_kept(
    driven, static_walk, kind, delay_ticks, engine
):
    robot, _ = driven(engine, kind=kind, delay_ticks=delay_ticks)
    robot.begin_walk(1)
    follow(robot, static_walk[:30])
    kept = robot.snapshot()
    expected = follow(robot, static_walk[30:50])
    robot.restore(kept)
    assert follow(robot, static_walk[30:50]) == expected


# -- stability -------------------------------------------------------------------------


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
    gains = stiffness, damping, integral, inertia, 0.0, int(delayed)
    largest = slowest_mode(ServoSettings("ideal", 10.0, *gains))
    try:
        ServoSettings("pid", 10.0, *gains)
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
        for engine, kind in itertools.product(ENGINES, ("ideal", "lag", "pid"))
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


def test_servos_are_ideal_by_default():
    assert SimSettings().servo == IDEAL_SERVO == ServoSettings("ideal")
