"""What a viewer is shown: geometry, and real messages on a real graph."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from scipy.spatial import ConvexHull
from tests.graph.clients import Client, quick
from tests.graph.domains import MODULE, own_domain
from tests.robots import SHIPPED
from visualization_msgs.msg import Marker, MarkerArray

from biped_bringup.one_executor import OneExecutor
from biped_ros.cdr import MessageTemplate
from biped_ros.markers import MarkerForm, marker_array_template
from msgs_json import topics
from sim_node.markers import support_polygon

LENGTH_M, WIDTH_M, AHEAD_M = 0.22, 0.14, 0.02
places = st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))


def sole(foot):
    """Corners of the sole around a foot, the point under its ankle."""
    x, y = foot
    return [
        (x + AHEAD_M + i * LENGTH_M / 2, y + j * WIDTH_M / 2)
        for i in (-1, 1)
        for j in (-1, 1)
    ]


def area(corners):
    """Signed area; positive where the corners go anticlockwise."""
    x, y = np.transpose(corners)
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def test_without_a_foot_on_the_floor_there_is_no_support():
    assert support_polygon(SHIPPED.settings, []) == []


@given(places)
def test_one_foot_supports_with_its_sole(foot):
    polygon = support_polygon(SHIPPED.settings, [foot])
    np.testing.assert_allclose(sorted(polygon), sorted(sole(foot)))
    assert area(polygon) == pytest.approx(LENGTH_M * WIDTH_M)


@settings(deadline=None)
@given(places, places)
def test_two_feet_support_with_the_hull_of_both_soles(left, right):
    polygon = support_polygon(SHIPPED.settings, [left, right])
    hull = ConvexHull(sole(left) + sole(right))
    assert area(polygon) == pytest.approx(hull.volume)
    # No corner lies outside of the hull: A x + b <= 0 inside.
    distances = np.array(polygon) @ hull.equations[:, :2].T + hull.equations[:, 2]
    assert distances.max() < 1e-9


def test_the_message_is_what_ros_itself_would_write():
    form = MarkerForm(
        "a", Marker.LINE_STRIP, (0.1, 0.2, 0.3), (0.5, 0.25, 1.0, 0.75), 2
    )
    template: MessageTemplate = marker_array_template([form, form])
    written = template.fill(np.arange(18.0), clock_ticks=501)
    message = deserialize_message(written, MarkerArray)
    values, ticks = template.read(serialize_message(message))  # all else is alike
    assert (values.tolist(), ticks) == (list(range(18)), 501)
    first, second = message.markers
    assert (first.ns, first.type, first.action) == ("a", Marker.LINE_STRIP, Marker.ADD)
    assert (first.scale.z, first.color.g, first.color.a) == (0.3, 0.25, 0.75)
    assert [(p.x, p.y, p.z) for p in second.points] == [(12, 13, 14), (15, 16, 17)]
    assert (second.pose.position.x, second.pose.orientation.w) == (9.0, 1.0)
    assert {(m.header.frame_id, m.header.stamp.sec) for m in message.markers} == {
        ("world", 1)
    }


# -- on a graph ------------------------------------------------------------------------


@pytest.fixture(scope="module")
def seen():
    """Everything that two walks and a bit of a third publish to be looked at."""
    watched = (topics.MARKERS, topics.TORSO_POSE, topics.ZMP, topics.ZMP_REFERENCE)
    with (
        OneExecutor(quick(), own_domain(MODULE)) as graph,
        Client(graph, *watched, topics.EPISODE) as client,
    ):
        # As long as a walk must last for both kinds of support to be seen.
        assert graph.spin_until(
            lambda: len(client.messages[topics.EPISODE.name]) >= 3, 60.0
        )
        return {topic.name: client.messages[topic.name] for topic in watched}


def drawn(seen):
    """The marker arrays that draw, as {name space: marker}."""
    return [
        {marker.ns: marker for marker in array.markers}
        for array in seen[topics.MARKERS.name]
        if array.markers[0].action != Marker.DELETEALL
    ]


def at(message):
    return message.header.stamp.sec, message.header.stamp.nanosec


def points(marker):
    return np.array([(p.x, p.y, p.z) for p in marker.points])


def test_each_marker_has_a_name_space_of_its_own(seen):
    assert {tuple(markers) for markers in drawn(seen)} == {
        (
            "support_polygon",
            "zmp",
            "zmp_reference",
            "zmp_limit",
            "waist_planned",
            "waist_walked",
        )
    }


def test_markers_come_25_times_a_simulated_second(seen):
    times = [1000 * s + ns // 10**6 for s, ns in map(at, seen[topics.TORSO_POSE.name])]
    # Walks end and begin in between.
    assert {40} == {b - a for a, b in pairwise(times)}


def test_a_walk_begins_with_nothing_left_of_the_last(seen):
    arrays = seen[topics.MARKERS.name]
    cleared = [a for a in arrays if a.markers[0].action == Marker.DELETEALL]
    assert arrays[0] is cleared[0]
    assert len(cleared) >= 3


@pytest.mark.parametrize(
    "topic", [topics.ZMP, topics.ZMP_REFERENCE], ids=lambda t: t.name
)
def test_the_zmp_is_drawn_where_it_is(seen, topic):
    published = {at(m): (m.point.x, m.point.y) for m in seen[topic.name]}
    for markers in drawn(seen):
        marker = markers[topic.name.removeprefix("/biped/")]
        drawn_at = (marker.pose.position.x, marker.pose.position.y)
        assert published.get(at(marker), drawn_at) == drawn_at


def test_the_limit_is_a_disc_of_65_mm_around_the_reference(seen):
    for markers in drawn(seen):
        disc, reference = markers["zmp_limit"], markers["zmp_reference"]
        assert disc.pose.position == reference.pose.position
        assert (disc.scale.x, disc.scale.y) == (0.13, 0.13)


def test_the_zmp_lies_within_the_support_polygon(seen):
    for markers in drawn(seen):
        polygon, zmp = markers["support_polygon"], markers["zmp"].pose.position
        if polygon.action == Marker.ADD:
            corners = points(polygon)[:-1, :2]
            edges = np.roll(corners, -1, axis=0) - corners
            to_zmp = np.array([zmp.x, zmp.y]) - corners
            left_of = edges[:, 0] * to_zmp[:, 1] - edges[:, 1] * to_zmp[:, 0]
            assert left_of.min() > -1e-3


def test_both_kinds_of_support_are_seen(seen):
    corners = {len(markers["support_polygon"].points) - 1 for markers in drawn(seen)}
    assert {4, 6} <= corners


def test_the_waist_is_planned_from_where_it_walks(seen):
    for markers in drawn(seen):
        planned = points(markers["waist_planned"])
        walked = points(markers["waist_walked"])
        assert np.linalg.norm(planned[:, :2] - walked[-1, :2], axis=1).min() < 0.05


def test_the_torso_is_where_the_waist_has_walked(seen):
    torso = {at(m): m.transform.translation for m in seen[topics.TORSO_POSE.name]}
    for markers in drawn(seen):
        walked = markers["waist_walked"]
        place = torso[at(walked)]
        assert (place.x, place.y, place.z) == tuple(points(walked)[-1])


def test_the_torso_stands_upright_between_world_and_urdf(seen):
    for message in seen[topics.TORSO_POSE.name]:
        assert (message.header.frame_id, message.child_frame_id) == ("world", "torso")
        assert message.transform.rotation.w > 0.99
