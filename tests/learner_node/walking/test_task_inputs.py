"""The sensory inputs of Section 4.1."""

import numpy as np
import pytest
from tests.learner_node.walking.observations import observation, phase

from learner_node.walking.settings import InputSettings
from learner_node.walking.task import INPUT_NAMES, N_DISCRETE, sensory_input

PAPER = InputSettings()
TELLING = observation(
    waist_in_support_foot_m=(0.1, 0.2),
    zmp_error_m=(0.3, 0.4),
    waist_acceleration_m_s2=(0.5, 0.6),
)


def test_there_are_eight_inputs_two_of_them_discrete():
    assert (
        len(sensory_input(TELLING, PAPER)),
        N_DISCRETE,
        (len(INPUT_NAMES) - N_DISCRETE),
    ) == (8, 2, 6)


def test_continuous_inputs_come_in_the_order_of_the_paper_in_si_units():
    assert sensory_input(TELLING, PAPER)[2:].tolist() == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]


@pytest.mark.parametrize("right, value", [(True, 10.0), (False, -10.0)])
def test_right_leg_support_is_10_and_left_leg_support_minus_10(right, value):
    seen = sensory_input(observation(phase=phase(planned_right_support=right)), PAPER)
    assert seen[INPUT_NAMES.index("right_support")] == value


@pytest.mark.parametrize("double, value", [(True, 10.0), (False, -10.0)])
def test_two_leg_support_is_10_and_single_leg_support_minus_10(double, value):
    seen = sensory_input(observation(phase=phase(planned_double_support=double)), PAPER)
    assert seen[INPUT_NAMES.index("double_support")] == value


@pytest.mark.parametrize("measured", ("measured_right_support", "step_index"))
def test_only_planned_flags_are_inputs(measured):
    changed = observation(phase=phase(**{measured: 1}))
    assert np.array_equal(
        sensory_input(changed, PAPER), sensory_input(observation(), PAPER)
    )


@pytest.mark.parametrize(
    "tick, clock_s", [(0, 0.0), (500, 1.0), (937, 1.874), (938, 0.001)]
)
def test_a_clock_is_the_last_input_and_begins_anew_with_every_period(tick, clock_s):
    clocked = InputSettings(clock_period_s=1.875, clock_radius_s=0.2)
    seen = sensory_input(observation(control_tick=tick), clocked)
    assert seen.tolist() == [
        *sensory_input(observation(), PAPER),
        pytest.approx(clock_s, abs=1e-9),
    ]
    assert clocked.radii == (*PAPER.radii, 0.2)


def test_each_continuous_input_is_scaled_by_the_width_of_its_kind():
    radii = InputSettings(
        waist_radius_m=1.0, zmp_error_radius_m=2.0, acceleration_radius_m_s2=3.0
    ).radii
    kinds = {"waist_x": 1.0, "waist_y": 1.0, "zmp_error_x": 2.0, "zmp_error_y": 2.0}
    assert dict(zip(INPUT_NAMES[2:], radii, strict=True)) == {
        **kinds,
        "waist_acceleration_x": 3.0,
        "waist_acceleration_y": 3.0,
    }
