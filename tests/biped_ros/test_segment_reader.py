"""Waist references of any length are read, and nothing else."""

import struct

import numpy as np
import pytest
from rclpy.serialization import deserialize_message
from trajectory_msgs.msg import MultiDOFJointTrajectory

from biped_ros.messages import (
    SEGMENT_FRAMES,
    SegmentReader,
    correction_of,
    correction_template,
    segment_template,
)
from msgs_json.wire import MalformedMessageError


def message(rows, clock_ticks=7):
    positions = np.arange(rows * 12.0).reshape(rows, 4, 3)
    return positions, segment_template(rows).fill(positions, clock_ticks)


def test_references_of_any_length_are_read_one_after_the_other():
    reader = SegmentReader()
    for rows in (60, 1, 11, 60):
        expected, written = message(rows)
        positions, clock_ticks = reader.read(written)
        np.testing.assert_array_equal(positions, expected)
        assert clock_ticks == 7


def test_a_reference_is_a_trajectory_of_frames_in_the_world():
    trajectory = deserialize_message(message(2)[1], MultiDOFJointTrajectory)
    assert trajectory.header.frame_id == "world"
    assert tuple(trajectory.joint_names) == SEGMENT_FRAMES
    assert [len(point.transforms) for point in trajectory.points] == [4, 4]


@pytest.mark.parametrize("size", [0, 3, 40, 200, 2000, -1])
def test_a_reference_that_is_cut_off_is_malformed(size):
    with pytest.raises(MalformedMessageError):
        SegmentReader().read(message(60)[1][:size])


@pytest.mark.parametrize("rows", [0, 59, 61, 10**6, 2**32 - 1])
def test_a_reference_of_another_length_than_it_says_is_malformed(rows):
    written = bytearray(message(60)[1])
    at = len(segment_template(0)) - 4
    struct.pack_into("<I", written, at, rows)
    with pytest.raises(MalformedMessageError, match=f"of {rows} rows"):
        SegmentReader().read(bytes(written))


def test_a_correction_is_in_the_world():
    frame, clock_ticks, correction_m = correction_of(
        correction_template().fill((0.01, -0.02), 30)
    )
    assert (frame, clock_ticks, correction_m.tolist()) == ("world", 30, [0.01, -0.02])
