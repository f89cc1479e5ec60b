"""Episode results as values and as JSON."""

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msgs_json.end_cause import EndCause
from msgs_json.episode_result import CostTerms, EpisodeResult

numbers = st.floats(allow_nan=False, allow_infinity=False)
counts = st.integers(0, 10**9)
costs = st.builds(
    CostTerms,
    zmp=numbers,
    final_zmp=numbers,
    joint_tracking=numbers,
    joint_torque=numbers,
    final_joint_position=numbers,
    final_joint_velocity=numbers,
)
results = st.builds(
    EpisodeResult,
    episode=counts,
    learning=st.booleans(),
    end_cause=st.sampled_from(EndCause),
    control_ticks=counts,
    target_ticks=counts,
    peak_zmp_error_m=numbers,
    peak_joint_velocity_rad_s=numbers,
    cost=st.none() | costs,
    t_err_estimate=st.none() | numbers,
    reward=numbers,
    subtask=counts,
    trajectory_sha256=st.text(),
    schedule_complete=st.booleans(),
)


@pytest.fixture
def cost() -> CostTerms:
    return CostTerms(
        zmp=1.0,
        final_zmp=0.5,
        joint_tracking=0.25,
        joint_torque=0.125,
        final_joint_position=0.0625,
        final_joint_velocity=0.03125,
    )


def result_of(end_cause: EndCause, cost: CostTerms) -> EpisodeResult:
    """Return a result in which only the end and the cost matter."""
    return EpisodeResult(
        episode=1,
        learning=True,
        end_cause=end_cause,
        control_ticks=940,
        target_ticks=940,
        peak_zmp_error_m=0.03,
        peak_joint_velocity_rad_s=2.0,
        cost=cost,
        t_err_estimate=2.1,
        reward=10.0,
        subtask=0,
        trajectory_sha256="6f1c",
        schedule_complete=False,
    )


@settings(deadline=None, max_examples=100)
@given(results)
def test_a_result_comes_back_from_json(result):
    text = msgspec.json.encode(result)
    assert msgspec.json.decode(text, type=EpisodeResult) == result


def test_the_six_terms_add_up_to_the_cost(cost):
    assert cost.total == 1.96875


@pytest.mark.parametrize("cause", EndCause)
def test_only_a_completed_walk_is_completed(cause, cost):
    assert result_of(cause, cost).completed == (cause == "completed")


@pytest.mark.parametrize("field", EpisodeResult.__struct_fields__)
def test_a_result_cannot_be_changed(cost, field):
    with pytest.raises(AttributeError):
        setattr(result_of(EndCause.COMPLETED, cost), field, None)


@pytest.mark.parametrize("field", CostTerms.__struct_fields__)
def test_a_cost_cannot_be_changed(cost, field):
    with pytest.raises(AttributeError):
        setattr(cost, field, 0.0)
