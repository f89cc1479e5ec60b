"""T_err (eq. (2)) and its estimate (eqs. (3) and (4))."""

import numpy as np
import pytest
from tests.learner_node.walking.observations import observation

from learner_node.walking.cost import CostEstimate, CostIntegral
from learner_node.walking.settings import CostSettings
from msgs_json.end_cause import EndCause

DT_S = 0.002
N_JOINTS = 12
READINGS = ("in_root", "outside_root")


class Signals:
    """A walk of 1.2 s as the signals of eq. (2), one row per control tick."""

    n = 600
    t_s = DT_S * np.arange(1, n + 1)

    def __init__(self):
        rng = np.random.default_rng(0)
        self.zmp_error_m = rng.normal(0.0, 0.02, (self.n, 2))
        self.joint_error_rad = rng.normal(0.0, 0.002, (self.n, N_JOINTS))
        self.joint_velocity_error_rad_s = rng.normal(0.0, 0.05, (self.n, N_JOINTS))
        self.torque_nm = rng.normal(0.0, 20.0, (self.n, N_JOINTS))

    def observations(self):
        """The same walk, as the simulation would report it."""
        zmp_squared = (self.zmp_error_m**2).sum(axis=1)
        joint_squared = (self.joint_error_rad**2).sum(axis=1)
        torque_squared = (self.torque_nm**2).sum(axis=1)
        yield observation(0)
        for first in range(0, self.n, 10):
            tick, last = slice(first, first + 10), first + 9
            yield observation(
                first + 10,
                zmp_error_m=tuple(self.zmp_error_m[last]),
                worst_zmp_error_m=np.sqrt(zmp_squared[tick].max()),
                zmp_error_integral_m2_s2=DT_S * zmp_squared[tick] @ self.t_s[tick],
                joint_error_integral_rad2_s=DT_S * joint_squared[tick].sum(),
                torque_integral_n2m2_s=DT_S * torque_squared[tick].sum(),
                mean_joint_error_rad=np.abs(self.joint_error_rad[last]).mean(),
                mean_joint_velocity_error_rad_s=np.abs(
                    self.joint_velocity_error_rad_s[last]
                ).mean(),
            )

    def t_err(self, torque_reading, zmp_limit_m=0.065):
        """Eq. (2), term after term, with integrals over the whole walk."""
        t_f = self.t_s[-1]
        total = 0.0
        for z, t in zip(self.zmp_error_m, self.t_s, strict=True):
            total += (np.hypot(*z) / zmp_limit_m) ** 2 * t * DT_S / t_f
        total += 50 * (abs(self.zmp_error_m[-1, 0]) + abs(self.zmp_error_m[-1, 1]))
        int_q = sum(e @ e * DT_S for e in self.joint_error_rad)
        int_u = sum(u @ u * DT_S for u in self.torque_nm)
        if torque_reading == "in_root":
            total += np.sqrt(1000 * int_q + int_u / 1000) / t_f
        else:
            total += np.sqrt(1000 * int_q) / t_f + int_u / 1000 / t_f
        total += 10 * sum(abs(e) / N_JOINTS for e in self.joint_error_rad[-1])
        total += 10 * sum(
            abs(e) / N_JOINTS for e in self.joint_velocity_error_rad_s[-1]
        )
        return total


def integral_of(observations, **settings):
    """(integral, last observation)."""
    integral = CostIntegral(CostSettings(**settings))
    for each in observations:
        integral.add(each)
    return integral, each


def terms_of(observations, **settings):
    integral, last = integral_of(observations, **settings)
    return integral.terms(last)


@pytest.mark.parametrize("reading", READINGS)
def test_t_err_is_eq_2_evaluated_on_the_signals(reading):
    signals = Signals()
    terms = terms_of(signals.observations(), torque_reading=reading)
    assert terms.total == pytest.approx(signals.t_err(reading), rel=1e-12)


def test_the_zmp_limit_scales_the_first_term():
    signals = Signals()
    terms = terms_of(signals.observations(), zmp_limit_m=0.03)
    expected = signals.t_err("in_root", zmp_limit_m=0.03)
    assert terms.total == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("reading", READINGS)
def test_the_six_terms_add_up(reading):
    terms = terms_of(Signals().observations(), torque_reading=reading)
    each = [getattr(terms, name) for name in terms.__struct_fields__]
    assert len(each) == 6
    assert terms.total == pytest.approx(sum(each), rel=1e-15)


ALONE = {
    "zmp": ({"zmp_error_integral_m2_s2": 0.065**2}, 1.0 / 2),
    "final_zmp": ({"zmp_error_m": (0.03, -0.01)}, 50 * 0.04),
    "joint_tracking": ({"joint_error_integral_rad2_s": 0.009}, 3.0 / 2),
    "final_joint_position": ({"mean_joint_error_rad": 0.02}, 0.2),
    "final_joint_velocity": ({"mean_joint_velocity_error_rad_s": 0.03}, 0.3),
}


@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize("name, case", ALONE.items(), ids=ALONE.keys())
def test_a_walk_with_one_kind_of_error_costs_its_term_alone(name, case, reading):
    changes, expected = case
    terms = terms_of([observation(1000, **changes)], torque_reading=reading)
    assert getattr(terms, name) == pytest.approx(expected)
    assert terms.total == pytest.approx(expected)


@pytest.mark.parametrize("reading, expected", [("in_root", 3.0), ("outside_root", 9.0)])
def test_torque_alone_costs_a_root_or_its_integral(reading, expected):
    only_torque = observation(500, torque_integral_n2m2_s=9000.0)
    terms = terms_of([only_torque], torque_reading=reading)
    assert terms.joint_torque == pytest.approx(expected)
    assert terms.total == pytest.approx(expected)


def test_in_a_common_root_both_terms_share_in_proportion():
    both = observation(
        500, joint_error_integral_rad2_s=0.004, torque_integral_n2m2_s=12_000.0
    )
    terms = terms_of([both], torque_reading="in_root")
    assert terms.joint_tracking == pytest.approx(4.0 * 4 / 16)
    assert terms.joint_torque == pytest.approx(4.0 * 12 / 16)


def test_final_errors_are_those_of_the_last_observation():
    walk = [observation(10, zmp_error_m=(0.06, 0.06)), observation(20)]
    assert terms_of(walk).final_zmp == 0.0


def test_before_the_first_control_tick_there_is_no_cost():
    assert terms_of([observation(0)]) is None


@pytest.mark.parametrize("reading", READINGS)
def test_a_faultless_walk_costs_nothing(reading):
    assert terms_of([observation(10)], torque_reading=reading).total == 0.0


def test_the_next_walk_starts_at_zero():
    integral, _ = integral_of(Signals().observations())
    integral.reset()
    last = observation(10)
    integral.add(last)
    result = integral.result(last, EndCause.COMPLETED, target_ticks=10)
    assert result.cost.total == 0.0
    assert result.peak_zmp_error_m == 0.0


def test_the_result_reports_the_worst_of_all_ticks():
    walk = [
        observation(10, worst_zmp_error_m=0.05, worst_joint_velocity_rad_s=3.0),
        observation(20, worst_zmp_error_m=0.01, worst_joint_velocity_rad_s=7.0),
        observation(30),
    ]
    integral, last = integral_of(walk)
    result = integral.result(last, EndCause.COMPLETED, target_ticks=30)
    assert (result.peak_zmp_error_m, result.peak_joint_velocity_rad_s) == (0.05, 7.0)


# -- T_err-hat ------------------------------------------------------------------------


def estimate_after(*costs, **settings):
    estimate = CostEstimate(CostSettings(**settings))
    for t_err in costs:
        estimate.update(t_err)
    return estimate


def test_the_first_walk_is_a_success_whatever_it_costs():
    assert estimate_after().is_success(1e9)


def test_the_estimate_starts_above_the_first_cost():
    assert estimate_after(2.0).value == pytest.approx(1.05 * 2.0)


def test_a_cheaper_walk_pulls_the_estimate_half_way():
    assert estimate_after(2.0, 1.1).value == pytest.approx(0.5 * 2.1 + 0.5 * 1.1)


@pytest.mark.parametrize("t_err", (2.1, 5.0))
def test_a_walk_that_is_not_cheaper_pulls_the_estimate_by_a_tenth(t_err):
    estimate = estimate_after(2.0, first_estimate_factor=1.05)
    estimate.value = 2.1
    estimate.update(t_err)
    assert estimate.value == pytest.approx(0.9 * 2.1 + 0.1 * t_err)


def test_a_walk_below_the_estimate_is_a_success():
    assert estimate_after(2.0, tolerance=0.0).is_success(2.0999)


def test_a_walk_at_the_estimate_is_none():
    estimate = estimate_after(2.0, tolerance=0.0)
    assert not estimate.is_success(estimate.value)


def test_a_walk_within_the_tolerance_is_a_success():
    estimate = estimate_after(2.0, tolerance=0.01)
    assert estimate.is_success(1.0099 * estimate.value)


def test_a_walk_beyond_the_tolerance_is_none():
    estimate = estimate_after(2.0, tolerance=0.01)
    assert not estimate.is_success(1.0101 * estimate.value)


def successes_of_equal_walks(tolerance):
    """Successes among 300 walks of the same cost, after a much better one."""
    estimate = estimate_after(1.0, tolerance=tolerance)
    successes = 0
    for _ in range(300):
        successes += estimate.is_success(2.0)
        estimate.update(2.0)
    return successes


def test_without_tolerance_equal_walks_never_succeed_again():
    assert successes_of_equal_walks(tolerance=0.0) == 0


def test_with_tolerance_equal_walks_succeed_again():
    assert successes_of_equal_walks(tolerance=0.001) > 200
