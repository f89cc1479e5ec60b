"""The words for a walk's end."""

import msgspec
import pytest

from msgs_json.end_cause import EndCause


def test_these_are_all_the_words():
    assert [cause.value for cause in EndCause] == [
        "completed",
        "zmp_error",
        "joint_velocity",
        "ik_unreachable",
        "ik_joint_limit",
        "torque_saturation",
        "feet_unloaded",
        "foot_through_floor",
        "physics_nan",
        "late",
        "peer_silent",
        "reset",
        "disturbed",
        "sensors_silent",
        "sensors_invalid",
        "emergency_stop",
        "not_standing",
        "tilt",
        "not_following",
    ]


def test_these_come_from_outside():
    assert {cause.value for cause in EndCause if cause.from_outside} == {
        "late",
        "peer_silent",
        "reset",
        "disturbed",
        "sensors_silent",
        "sensors_invalid",
        "emergency_stop",
        "not_standing",
        "not_following",
    }


@pytest.mark.parametrize("cause", EndCause)
def test_a_cause_prints_as_its_word(cause):
    assert f"{cause}" == cause.value


@pytest.mark.parametrize("cause", EndCause)
def test_a_cause_is_found_by_its_word(cause):
    assert EndCause(cause.value) is cause


@pytest.mark.parametrize("cause", EndCause)
def test_a_cause_is_its_word_in_json(cause):
    assert msgspec.json.encode(cause) == f'"{cause.value}"'.encode()
