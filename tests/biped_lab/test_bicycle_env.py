"""The bicycle of Randløv and Alstrøm: its equations, its limits, and a rider."""

import math

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from hypothesis import given
from hypothesis import strategies as st

from biped_lab.bicycle_env import (
    LEANS_M,
    MOST_STEER_RAD,
    MOST_TILT_RAD,
    TORQUES_NM,
    BicycleBalanceEnv,
    accelerations,
)

STATES = st.tuples(
    st.floats(-MOST_STEER_RAD, MOST_STEER_RAD),
    st.floats(-5.0, 5.0),
    st.floats(-MOST_TILT_RAD, MOST_TILT_RAD),
    st.floats(-2.0, 2.0),
    st.floats(-2.0, 2.0),
    st.floats(-0.04, 0.04),
)


def as_printed(steer, steer_rate, tilt, tilt_rate, torque_nm, lean_m):
    """The equations with the symbols of the paper, radii and all; not for θ = 0."""
    M_c, M_p, M_d = 15.0, 60.0, 1.7
    c, d_cm, h, wheelbase, r, v = 0.66, 0.30, 0.94, 1.11, 0.34, 10.0 / 3.6
    M = M_c + M_p
    inertia = 13 / 3 * M_c * h**2 + M_p * (h + d_cm) ** 2
    I_dc, I_dv, I_dl = M_d * r**2, 3 / 2 * M_d * r**2, 1 / 2 * M_d * r**2
    r_f, r_b = wheelbase / abs(np.sin(steer)), wheelbase / abs(np.tan(steer))
    r_cm = np.sqrt((wheelbase - c) ** 2 + wheelbase**2 / np.tan(steer) ** 2)
    spin = v / r
    phi = tilt + np.arctan(lean_m / h)
    turning = M_d * r / r_f + M_d * r / r_b + M * h / r_cm
    return (
        (torque_nm - I_dv * spin * tilt_rate) / I_dl,
        (
            M * h * 9.82 * np.sin(phi)
            - np.cos(phi) * (I_dc * spin * steer_rate + np.sign(steer) * v**2 * turning)
        )
        / inertia,
    )


@given(STATES.filter(lambda state: abs(state[0]) > 1e-6))
def test_the_equations_are_those_of_the_paper(state):
    np.testing.assert_allclose(accelerations(*state), as_printed(*state), rtol=1e-9)


@given(STATES)
def test_seen_in_a_mirror_it_is_the_same_bicycle(state):
    mirrored = accelerations(*(-value for value in state))
    np.testing.assert_allclose(mirrored, -np.array(accelerations(*state)), atol=1e-12)


def test_upright_and_straight_on_it_is_in_balance():
    assert accelerations(0.0, 0.0, 0.0, 0.0, 0.0, 0.0) == (0.0, 0.0)


@given(st.floats(1e-3, MOST_TILT_RAD))
def test_going_straight_on_it_falls_to_the_side_it_leans_to(tilt):
    assert accelerations(0.0, 0.0, tilt, 0.0, 0.0, 0.0)[1] > 0.0


def test_steering_into_the_fall_raises_it():
    tilt = math.radians(3.0)
    assert accelerations(math.radians(15.0), 0.0, tilt, 0.0, 0.0, 0.0)[1] < 0.0


def ride(rider, seed=1):
    """Return for how many of 1,000 steps a rider stays up."""
    env = gymnasium.make("biped_lab:BicycleBalance-v0")
    seen, _ = env.reset(seed=seed)
    total, over = 0.0, False
    while not over:
        seen, reward, terminated, truncated, _ = env.step(rider(seen))
        total, over = total + reward, terminated or truncated
    return total


def steering_into_the_fall(seen):
    """Return a torque towards a steering angle in proportion to the tilt; no lean."""
    steer, steer_rate, tilt, tilt_rate, _ = seen
    wanted = 20.0 * (6.0 * tilt + 2.0 * tilt_rate - steer) - steer_rate
    return np.array([1 + int(wanted > 0.5) - int(wanted < -0.5), 1])


def test_without_a_rider_it_falls():
    assert ride(lambda _: np.array([1, 1])) < 500.0


def test_it_can_be_ridden():
    assert ride(steering_into_the_fall) == 1000.0


def test_the_noise_is_that_of_the_seed():
    rides = [ride(lambda _: np.array([1, 1]), seed) for seed in (1, 1, 2)]
    assert rides[0] == rides[1] != rides[2]


def test_the_handlebars_stop():
    env = BicycleBalanceEnv()
    env.reset(seed=1)
    env.state = np.array([MOST_STEER_RAD - 1e-3, 5.0, 0.0, 0.0, 0.0])
    (steer, steer_rate, *_), *_ = env.step(np.array([2, 1]))
    assert (steer, steer_rate) == (MOST_STEER_RAD, 0.0)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_beyond_twelve_degrees_it_has_fallen(side):
    env = BicycleBalanceEnv()
    env.reset(seed=1)
    env.state = np.array([0.0, 0.0, side * (MOST_TILT_RAD - 1e-4), side * 0.5, 0.0])
    _, reward, terminated, _, _ = env.step(np.array([1, 1]))
    assert (reward, terminated) == (0.0, True)


def test_the_middle_alternatives_do_nothing():
    assert TORQUES_NM[1] == LEANS_M[1] == 0.0


def test_gymnasium_takes_it_for_an_environment():
    check_env(BicycleBalanceEnv(), skip_render_check=True)
