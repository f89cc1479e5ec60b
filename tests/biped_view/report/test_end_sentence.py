"""How a walk ended, in a sentence: exact, and fair to who walked."""

from dataclasses import replace

import numpy as np
import pytest

from biped_bringup.run_settings import load_settings
from biped_view.report.end_sentence import end_sentence
from msgs_json.end_cause import EndCause


@pytest.fixture(scope="module")
def sentence(static_walk):
    def of(cause, **changes):
        record = replace(static_walk.record, end_cause=cause, **changes)
        return end_sentence(record, static_walk.settings)

    return of


def test_the_static_walk_leaves_its_limit_in_the_second_double_support(sentence):
    assert sentence(EndCause.ZMP_ERROR) == (
        "The ZMP left its 65 mm limit at 2.26 s, in the second double support, to the "
        "left."
    )


@pytest.mark.parametrize(
    ("error_m", "direction"),
    [
        ((0.066, 0.0), "forward"),
        ((-0.066, 0.02), "backward"),
        ((0.01, -0.066), "to the right"),
        ((0.05, 0.045), "forward and to the left"),
    ],
)
def test_the_way_of_the_zmp_is_named(static_walk, sentence, error_m, direction):
    zmp_m = static_walk.record.zmp_m.copy()
    zmp_m[-1] = static_walk.record.zmp_reference_m[-1] + error_m
    assert sentence(EndCause.ZMP_ERROR, zmp_m=zmp_m).endswith(f", {direction}.")


def test_the_way_is_that_of_the_last_tick_that_was_recorded(static_walk, sentence):
    zmp_m = static_walk.record.zmp_m.copy()
    zmp_m[-3:] = np.nan
    assert sentence(EndCause.ZMP_ERROR, zmp_m=zmp_m).endswith("to the left.")


@pytest.mark.parametrize("cause", EndCause)
def test_every_cause_has_a_sentence(sentence, cause):
    text = sentence(cause)
    assert text.endswith(".")
    assert "nan" not in text
    assert "None" not in text


@pytest.mark.parametrize("cause", [cause for cause in EndCause if cause.from_outside])
def test_what_came_from_outside_is_no_failure_of_robot_or_learner(sentence, cause):
    text = sentence(cause)
    assert "Neither robot nor learner had failed" in text or (
        "no failure of robot or learner" in text
    )


def test_a_late_machine_is_said_to_be_late(sentence):
    assert sentence(EndCause.LATE).startswith("The machine was late: at 2.26 s")


def test_the_joint_that_was_too_fast_is_named(static_walk, sentence):
    velocity = static_walk.record.joint_velocity_rad_s.copy()
    velocity[-1, 3] = -63.0
    assert sentence(EndCause.JOINT_VELOCITY, joint_velocity_rad_s=velocity).startswith(
        "A joint, left knee, reached its speed limit of 62.8 rad/s at 2.26 s"
    )


def test_a_recording_that_was_cut_off_is_said_to_be(sentence):
    assert sentence(None) == (
        "The recording ends before the walk, at 2.26 s: until then nothing had failed."
    )


def test_a_completed_walk_tells_of_its_margin(static_walk):
    record = replace(
        static_walk.record, end_cause=EndCause.COMPLETED,
        walk_ticks=static_walk.record.ticks,
    )  # fmt: skip
    assert end_sentence(record, load_settings()) == (
        "The walk was completed, all 2.262 s of it; its ZMP error was 65.03 of 65 mm "
        "at most."
    )
