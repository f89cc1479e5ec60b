"""Markers read as bytes, against rclpy's reading of them."""

from pathlib import Path

import numpy as np
from rclpy.serialization import deserialize_message
from visualization_msgs.msg import Marker, MarkerArray

from biped_bag.storage.reader import BagReader
from biped_view.live.marker_reader import MarkerReader
from msgs_json import topics

SAMPLE = Path(__file__).parents[3] / "bags/sample"


def test_the_markers_of_a_walk_are_read_as_rclpy_reads_them():
    reader, compared = MarkerReader(), 0
    for message in BagReader(SAMPLE).messages([topics.MARKERS.name]):
        drawn = reader.read(message.data)
        for marker in deserialize_message(message.data, MarkerArray).markers:
            if marker.action == Marker.ADD:
                points = marker.points or [marker.pose.position]
                expected = [(point.x, point.y, point.z) for point in points]
                np.testing.assert_array_equal(drawn[marker.ns], expected)
                compared += 1
    assert compared > 1000
    assert reader.limit_m == 0.065


def test_bytes_that_are_no_markers_are_read_as_nothing():
    reader = MarkerReader()
    assert reader.read(b"") == {}
    assert reader.read(b"\0\1\0\0" + b"\xff" * 100) == {}
