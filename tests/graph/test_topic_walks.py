"""Learned walks behind ros2_control's topics, as a table."""

import os
from unittest import mock

import msgspec
import pytest
from tests.payloads import RESULT

from biped_bringup.run_settings import load_settings
from biped_lab.robustness import SENSED
from biped_lab.topic_walks import PACES, Pace, learn, row, walk
from msgs_json.end_cause import EndCause

SHORT = ("gait.steps=1", "gait.double_support_s=0.9")
SEED = 71


@pytest.fixture
def learned(tmp_path):
    settings = load_settings("directed", changes=[SENSED, *SHORT])
    assert learn(settings, SEED, tmp_path / "memory.npz")
    return tmp_path


@pytest.fixture(autouse=True)
def same_environment():
    with mock.patch.dict(os.environ):
        yield


def test_the_nodes_walk_whenever_the_person_says_so(learned):
    (result,) = walk(learned, PACES["lockstep"], SEED, limit_m=0.065)
    assert result.completed and 0.0 < result.peak_zmp_error_m < 0.065


@pytest.mark.thorough
def test_a_walk_that_leaves_its_limit_is_no_walk(learned):
    (result,) = walk(learned, PACES["half of real time"], SEED, limit_m=0.01)
    assert result.end_cause is EndCause.ZMP_ERROR


@pytest.mark.thorough
def test_a_walk_that_the_machine_was_too_slow_for_is_walked_again(learned):
    too_fast = Pace(("pace:=realtime", "realtime_factor:=20.0"), ())
    results = walk(learned, too_fast, SEED, limit_m=0.065)
    assert len(results) > 1
    assert all(result.end_cause.from_outside for result in results[:-1])
    assert not results[-1].completed


@pytest.mark.thorough
def test_what_cannot_be_walked_says_why(tmp_path):
    with pytest.raises(ChildProcessError, match=r"memory\.npz"):
        walk(tmp_path, PACES["lockstep"], SEED, limit_m=0.065)


def test_a_row_tells_walks_apart_by_their_end():
    ends = {
        EndCause.COMPLETED: (0.0601, 5625),
        EndCause.ZMP_ERROR: (0.0652, 4000),
        EndCause.LATE: (0.03, 500),
        EndCause.TILT: (0.03, 3000),
    }
    results = [
        msgspec.structs.replace(
            RESULT, end_cause=cause, peak_zmp_error_m=peak_m, control_ticks=ticks
        )
        for cause, (peak_m, ticks) in ends.items()
    ]
    assert row(results) == (
        "1, peaks 60.1 to 60.1 mm",
        "1",
        "1, after 1.0 to 1.0 s",
        "1 tilt",
    )
    assert row([]) == ("0", "0", "0", "0")
