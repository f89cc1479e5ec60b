"""Observations as values and as JSON."""

import math

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from tests.payloads import OBSERVATION

from msgs_json.end_cause import EndCause
from msgs_json.observation import Observation, PhaseFlags

numbers = st.floats(allow_nan=False, allow_infinity=False)
pairs = st.tuples(numbers, numbers)
counts = st.integers(0, 10**9)
phases = st.builds(
    PhaseFlags,
    planned_right_support=st.booleans(),
    planned_double_support=st.booleans(),
    measured_right_support=st.booleans(),
    measured_double_support=st.booleans(),
    step_index=counts,
)
observations = st.builds(
    Observation,
    simulation=st.text(max_size=200),
    episode=counts,
    clock_ticks=counts,
    control_tick=counts,
    phase=phases,
    waist_in_support_foot_m=pairs,
    zmp_error_m=pairs,
    waist_acceleration_m_s2=pairs,
    worst_zmp_error_m=numbers,
    worst_joint_velocity_rad_s=numbers,
    zmp_error_integral_m2_s2=numbers,
    joint_error_integral_rad2_s=numbers,
    torque_integral_n2m2_s=numbers,
    mean_joint_error_rad=numbers,
    mean_joint_velocity_error_rad_s=numbers,
    trajectory_sha256=st.text(max_size=64),
    end_cause=st.none() | st.sampled_from(EndCause),
)


@pytest.fixture
def observation() -> Observation:
    return replace(OBSERVATION, end_cause=None)


@settings(deadline=None, max_examples=100)
@given(observations)
def test_an_observation_comes_back_from_json(observation):
    text = msgspec.json.encode(observation)
    assert msgspec.json.decode(text, type=Observation) == observation


@settings(deadline=None, max_examples=200)
@given(numbers)
def test_no_bit_of_a_number_is_lost_in_json(number):
    back = msgspec.json.decode(msgspec.json.encode(number), type=float)
    assert (back, math.copysign(1.0, back)) == (number, math.copysign(1.0, number))


def test_a_walk_goes_on_unless_it_is_said_to_end(observation):
    assert observation.end_cause is None


@pytest.mark.parametrize("field", Observation.__struct_fields__)
def test_an_observation_cannot_be_changed(observation, field):
    with pytest.raises(AttributeError):
        setattr(observation, field, None)


@pytest.mark.parametrize("field", PhaseFlags.__struct_fields__)
def test_phase_flags_cannot_be_changed(observation, field):
    with pytest.raises(AttributeError):
        setattr(observation.phase, field, True)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("zmp_error_m", [0.1]),
        ("worst_zmp_error_m", "large"),
        ("control_tick", 1.5),
        ("end_cause", "tired"),
        ("phase", {"step_index": 1}),
    ],
)
def test_json_of_another_shape_is_refused(observation, field, value):
    message = msgspec.to_builtins(observation) | {field: value}
    with pytest.raises(msgspec.ValidationError, match=field):
        msgspec.json.decode(msgspec.json.encode(message), type=Observation)


def test_json_without_a_field_is_refused(observation):
    message = msgspec.to_builtins(observation)
    del message["zmp_error_m"]
    with pytest.raises(msgspec.ValidationError, match="zmp_error_m"):
        msgspec.json.decode(msgspec.json.encode(message), type=Observation)
