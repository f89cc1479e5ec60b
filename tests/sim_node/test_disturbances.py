"""Disturbances: what is drawn, and what the walk feels of it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.sim_node.bullet import LINKS, dynamics, link_com

from sim_node.disturbance import draw_disturbance
from sim_node.settings import DisturbanceSettings

STURDY = {"zmp_error_m": 1.0}
N_LINKS = 13
PUSH = {"push_force_n": 20.0, "push_time_s": 0.5}
NOISES = {
    "position_noise_m": 0.01,
    "zmp_noise_m": 0.02,
    "acceleration_noise_m_s2": 3.0,
}
EVERY_NOISE = pytest.mark.parametrize(
    ("setting", "observed"),
    [
        ("position_noise_m", "waist_in_support_foot_m"),
        ("zmp_noise_m", "zmp_error_m"),
        ("acceleration_noise_m_s2", "waist_acceleration_m_s2"),
    ],
)
seeds = st.integers(0, 2**32 - 1)
untimed = settings(deadline=None, max_examples=50)


def draw(seed: int = 0, **disturbances: float):
    rng = np.random.default_rng(seed)
    return draw_disturbance(DisturbanceSettings(**disturbances), N_LINKS, rng)


# -- what is drawn ---------------------------------------------------------------------


@untimed
@given(seeds, st.floats(0.1, 1000.0))
def test_a_push_is_horizontal_and_has_its_force(seed, force):
    x, y, z = draw(seed, push_force_n=force).push_force_n
    assert (np.hypot(x, y), z) == (pytest.approx(force), 0.0)


def test_pushes_come_from_all_sides():
    pushes = [draw(seed, push_force_n=1.0).push_force_n for seed in range(400)]
    quadrants = [(x > 0.0, y > 0.0) for x, y, _ in pushes]
    counts = [quadrants.count(each) for each in set(quadrants)]
    assert (len(counts), min(counts) > 70) == (4, True)


def test_a_push_lasts_from_its_time_for_its_duration():
    push = draw(push_force_n=1.0, push_time_s=1.5, push_duration_s=0.2)
    assert (push.push_from_tick, push.push_to_tick) == (750, 850)


def test_without_force_there_is_no_push():
    push = draw(push_force_n=0.0)
    assert push.push_from_tick == push.push_to_tick


def test_mass_factors_scatter_about_one_as_much_as_they_should():
    factors = np.concatenate([draw(s, mass_error=0.1).mass_factors for s in range(300)])
    found = factors.mean(), factors.std()
    assert found == (pytest.approx(1.0, abs=0.006), pytest.approx(0.1, abs=0.006))


def test_no_link_loses_all_its_mass():
    factors = [draw(s, mass_error=0.3).mass_factors.min() for s in range(1000)]
    assert min(factors) == 0.1


def test_without_error_every_mass_is_nominal():
    np.testing.assert_array_equal(draw(mass_error=0.0).mass_factors, np.ones(N_LINKS))


@untimed
@given(seeds, st.floats(0.0, 100.0), st.floats(0.0, 0.3))
def test_the_stream_of_random_numbers_is_the_same_for_all_sizes(seed, force, error):
    states = []
    for sizes in ({}, {"push_force_n": force, "mass_error": error}):
        rng = np.random.default_rng(seed)
        draw_disturbance(DisturbanceSettings(**sizes), N_LINKS, rng)
        states.append(rng.bit_generator.state)
    assert states[0] == states[1]


@untimed
@given(seeds, st.floats(0.0, 100.0))
def test_a_push_does_not_change_the_masses_drawn(seed, force):
    np.testing.assert_array_equal(
        draw(seed, push_force_n=force, mass_error=0.2).mass_factors,
        draw(seed, mass_error=0.2).mass_factors,
    )


# -- pushes ----------------------------------------------------------------------------


def test_a_push_changes_the_walk_from_its_tick_on(new_walker, static_walk):
    still, pushed = new_walker(STURDY), new_walker(STURDY, PUSH)
    still.walk(static_walk[:40])
    pushed.walk(static_walk[:40])
    differs = (still.everything != pushed.everything).any(axis=1)
    assert np.flatnonzero(differs)[0] == 250


def test_a_push_is_over_after_its_duration(new_walker, static_walk):
    short, long = (
        new_walker(STURDY, PUSH | {"push_duration_s": duration})
        for duration in (0.1, 0.2)
    )
    short.walk(static_walk[:40])
    long.walk(static_walk[:40])
    differs = (short.everything != long.everything).any(axis=1)
    assert np.flatnonzero(differs)[0] == 300


def test_the_generator_decides_where_a_push_comes_from(new_walker, static_walk):
    walkers = [new_walker(STURDY, PUSH, seed=seed) for seed in (3, 3, 4)]
    for walker in walkers:
        walker.walk(static_walk[:40])
    same, again, other = (walker.zmp_m for walker in walkers)
    assert (np.array_equal(same, again), np.array_equal(same, other)) == (True, False)


def test_the_next_walk_is_pushed_from_elsewhere(new_walker, static_walk):
    walker = new_walker(STURDY, PUSH)
    walker.walk(static_walk[:40])
    first = walker.zmp_m
    walker.forget()
    walker.walk(static_walk[:40])
    assert not np.array_equal(walker.zmp_m, first)


def test_the_zmp_gives_way_in_the_direction_of_the_push(new_walker, static_walk):
    still, pushed = new_walker(STURDY), new_walker(STURDY, PUSH, seed=8)
    still.walk(static_walk[:40])
    pushed.walk(static_walk[:40])
    moved = (pushed.zmp_m - still.zmp_m)[250:300].mean(axis=0)
    direction = np.array(draw(8, **PUSH).push_force_n[:2]) / 20.0
    across = np.array([-direction[1], direction[0]])
    assert moved @ direction > 10 * abs(moved @ across)


@pytest.mark.parametrize("engine", ["mujoco", "kinematic"])
def test_other_engines_feel_a_push_about_alike(build_walker, static_walk, engine):
    push = {"push_force_n": 10.0, "push_time_s": 0.1, "push_duration_s": 0.02}
    shifts_m = []
    for each in ("pybullet", engine):
        calm, pushed = (build_walker(STURDY, d, engine=each) for d in ({}, push))
        for walker in (calm, pushed):
            walker.walk(static_walk[:6])
            walker.robot.close()
        shifts_m.append((pushed.zmp_m - calm.zmp_m)[50:60].mean(axis=0))
    np.testing.assert_allclose(*shifts_m, rtol=0, atol=0.003)


# -- friction, masses and torques ------------------------------------------------------


def slip_m(walker):
    """Return how far the left foot, which carries the first step, has slipped [m]."""
    world = walker.robot.world
    position, _ = link_com(world, world.left_sole)
    return float(np.hypot(position[0] - 0.02, position[1] - 0.09))


@pytest.mark.parametrize(
    ("friction", "slips"), [(0.9, False), (0.02, True), (0.0, True)]
)
def test_feet_slip_where_friction_is_low(new_walker, shaky_walk, friction, slips):
    walker = new_walker(STURDY | {"unloaded_feet_s": 5.0}, {"friction": friction})
    walker.walk(shaky_walk[:80])
    assert (slip_m(walker) > 0.001) == slips


def test_a_frictionless_floor_ends_the_walk_early(new_walker, static_walk):
    walker = new_walker(disturbances={"friction": 0.0})
    assert walker.walk(static_walk)[-1].control_tick < 1000


def test_mass_errors_change_the_walk_from_the_first_tick_on(new_walker, static_walk):
    nominal, other = new_walker(STURDY), new_walker(STURDY, {"mass_error": 0.1})
    nominal.walk(static_walk[:3])
    other.walk(static_walk[:3])
    assert (nominal.zmp_m[0] != other.zmp_m[0]).all()


def test_the_floor_carries_the_masses_drawn(new_walker, static_walk):
    walker = new_walker(STURDY, {"mass_error": 0.1})
    walker.walk(static_walk[:8])
    world = walker.robot.world
    masses = [dynamics(world, link)[0] for link in LINKS]
    assert walker.load_n[-1] == pytest.approx(9.81 * sum(masses), rel=1e-3)


def test_each_walk_has_masses_of_its_own(new_walker, static_walk):
    walker = new_walker(STURDY, {"mass_error": 0.1})
    walker.walk(static_walk[:8])
    first = walker.zmp_m
    walker.forget()
    walker.walk(static_walk[:8])
    assert not np.array_equal(walker.zmp_m, first)


@pytest.mark.parametrize("factor", [0.1, 0.3, 1.0])
def test_no_joint_exceeds_the_torque_that_is_there(new_walker, shaky_walk, factor):
    limits = STURDY | {"torque_saturation_s": 10.0, "unloaded_feet_s": 10.0}
    walker = new_walker(limits, {"torque_limit_factor": factor})
    walker.walk(shaky_walk[:100])
    allowed = factor * np.tile([40.0, 80.0, 80.0, 100.0, 80.0, 60.0], 2)
    assert (np.abs(walker.joints[2]) <= allowed + 1e-9).all()


# -- noise -----------------------------------------------------------------------------


def test_noise_does_not_reach_the_motion(new_walker, shaky_walk):
    clear, noisy = new_walker(STURDY), new_walker(STURDY, NOISES)
    clear.walk(shaky_walk[:100])
    noisy.walk(shaky_walk[:100])
    np.testing.assert_array_equal(clear.everything, noisy.everything)


@EVERY_NOISE
def test_noise_has_the_size_that_was_asked_for(
    new_walker, shaky_walk, setting, observed
):
    clear, noisy = (
        np.array([getattr(each, observed) for each in walker.walk(shaky_walk[:150])])
        for walker in (new_walker(STURDY), new_walker(STURDY, {setting: 0.01}))
    )
    assert (noisy - clear).std() == pytest.approx(0.01, rel=0.15)


@EVERY_NOISE
def test_noise_is_on_its_own_input_only(new_walker, shaky_walk, setting, observed):
    clear, noisy = (
        walker.walk(shaky_walk[:20])
        for walker in (new_walker(STURDY), new_walker(STURDY, {setting: 0.01}))
    )
    different = {
        name
        for a, b in zip(clear, noisy, strict=True)
        for name in a.__struct_fields__
        if getattr(a, name) != getattr(b, name)
    }
    assert different == {observed}


def test_noise_does_not_end_a_walk(new_walker, static_walk):
    clear, noisy = new_walker(), new_walker(disturbances={"zmp_noise_m": 1.0})
    assert len(clear.walk(static_walk)) == len(noisy.walk(static_walk))


def test_noise_comes_from_the_generator(new_walker, shaky_walk):
    same, again, other = (
        new_walker(STURDY, NOISES, seed=seed).walk(shaky_walk[:5]) for seed in (3, 3, 4)
    )
    assert (same == again, same == other) == (True, False)


@pytest.mark.parametrize("size", [0.0, 1e-9])
def test_a_noise_changes_no_draw_of_another(new_walker, shaky_walk, size):
    base = {"zmp_noise_m": 0.02}
    plain, more = (
        [each.zmp_error_m for each in walker.walk(shaky_walk[:5])]
        for walker in (
            new_walker(STURDY, base),
            new_walker(STURDY, base | {"position_noise_m": size}),
        )
    )
    assert plain == more


def test_without_noise_a_disturbed_walk_draws_as_many_numbers(new_walker, shaky_walk):
    states = []
    for noises in ({}, NOISES):
        walker = new_walker(STURDY, noises | {"mass_error": 0.01})
        walker.walk(shaky_walk[:5])
        states.append(walker.rng.bit_generator.state)
    assert states[0] == states[1]


@pytest.mark.parametrize(
    "constant", [{}, {"friction": 0.7, "torque_limit_factor": 0.9}]
)
def test_a_walk_without_chance_draws_nothing(new_walker, shaky_walk, constant):
    walker = new_walker(STURDY, constant)
    before = walker.rng.bit_generator.state
    walker.walk(shaky_walk[:5])
    assert walker.rng.bit_generator.state == before


@pytest.mark.parametrize(
    "size",
    [{"push_force_n": 1.0}, {"mass_error": 0.1}, *({name: 0.1} for name in NOISES)],
)
def test_every_size_brings_chance_into_the_walk(size):
    assert DisturbanceSettings(**size).random


@pytest.mark.parametrize("duration_s", [1e-4, 0.0019, 0.002])
def test_a_push_lasts_at_least_a_tick(duration_s):
    push = draw(push_force_n=1.0, push_time_s=1.5, push_duration_s=duration_s)
    assert push.push_to_tick - push.push_from_tick == 1
