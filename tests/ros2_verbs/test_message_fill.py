"""YAML into messages: the way back from echo, and what is refused."""

import importlib
from typing import Any

import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PolygonStamped, PoseWithCovarianceStamped, Vector3Stamped
from hypothesis import given, settings
from hypothesis import strategies as st
from rosidl_parser.definition import (
    AbstractNestedType,
    Array,
    BoundedSequence,
    NamespacedType,
)
from sensor_msgs.msg import JointState, PointCloud2, TimeReference
from std_msgs.msg import Bool, Byte, ByteMultiArray, Float32, Int8, String, UInt8
from trajectory_msgs.msg import MultiDOFJointTrajectory

from ros2_verbs.errors import VerbError
from ros2_verbs.messages.fill import fill, values_of
from ros2_verbs.messages.text import fields_of, to_yaml, type_name

ROUND_TRIPS = (
    ByteMultiArray,
    JointState,
    MultiDOFJointTrajectory,
    PointCloud2,
    PolygonStamped,
    PoseWithCovarianceStamped,
    String,
)
TEXT = st.text(
    st.characters(codec="utf-8", exclude_characters="\0"), max_size=6
) | st.sampled_from(["two\nlines\n", "- a: b", "1e5", "~", "'\"", " x ", "yes", "é🚶"])


def integers(kind: str) -> st.SearchStrategy[int]:
    bits = int(kind.removeprefix("u").removeprefix("int"))
    low = 0 if kind.startswith("u") else -(2 ** (bits - 1))
    return st.integers(low, low + 2**bits - 1)


def values(kind: Any) -> st.SearchStrategy[Any]:
    if isinstance(kind, AbstractNestedType):
        size = kind.size if isinstance(kind, Array) else 0
        most = size or min(2, getattr(kind, "maximum_size", 2))
        assert isinstance(kind, Array | BoundedSequence) or most == 2
        return st.lists(values(kind.value_type), min_size=size, max_size=most)
    if isinstance(kind, NamespacedType):
        *package, name = kind.namespaced_name()
        return messages(getattr(importlib.import_module(".".join(package)), name))
    match type_name(kind):
        case "string":
            return TEXT
        case "boolean":
            return st.booleans()
        case "octet":
            return st.binary(min_size=1, max_size=1)
        case "float":
            return st.floats(width=32, allow_nan=False)
        case "double":
            return st.floats(allow_nan=False)
        case integer:
            return integers(integer)


def messages(kind: Any) -> st.SearchStrategy[Any]:
    return st.builds(kind, **{name: values(of) for name, of in fields_of(kind())})


@pytest.mark.parametrize("kind", ROUND_TRIPS, ids=lambda kind: kind.__name__)
def test_what_echo_prints_can_be_published_again(kind: Any) -> None:
    @given(messages(kind))
    @settings(max_examples=10, deadline=None, derandomize=True)
    def there_and_back(message: Any) -> None:
        again = kind()
        fill(again, values_of(to_yaml(message)))
        assert again == message

    there_and_back()


def test_only_what_is_named_is_set() -> None:
    message = Vector3Stamped()
    message.vector.y = 2.0
    fill(message, {"header": {"frame_id": "world"}})
    assert (message.header.frame_id, message.vector.y) == ("world", 2.0)


def test_an_automatic_header_is_stamped_at_every_publication() -> None:
    message = Vector3Stamped()
    (stamp,) = fill(message, {"header": "auto"})
    for seconds in (1, 2):
        stamp(Time(sec=seconds))
        assert message.header.stamp.sec == seconds


def test_a_time_may_be_now() -> None:
    message = TimeReference()
    for stamp in fill(message, {"header": "auto", "time_ref": "now"}):
        stamp(Time(sec=3))
    assert (message.header.stamp.sec, message.time_ref.sec) == (3, 3)


def test_an_exponent_without_a_point_is_a_number() -> None:
    message = Float32()
    fill(message, values_of("data: 1e3"))
    assert message.data == 1000.0


def test_a_number_is_taken_for_a_text_where_one_is_wanted() -> None:
    message = String()
    fill(message, values_of("data: 5"))
    assert message.data == "5"


@pytest.mark.parametrize(
    ("message", "text", "named"),
    [
        (String(), "dta: x", "'dta', it has data"),
        (String(), "data: [x]", "data: got ['x'], expected a string"),
        (Vector3Stamped(), "vector: {w: 1}", "'vector.w', it has x, y, z"),
        (Vector3Stamped(), "vector: 1", "vector: got 1, expected a dictionary of x"),
        (JointState(), "position: [1, a]", "position[1]: got 'a', expected a number"),
        (JointState(), "position: 1", "position: got 1, expected a list of double"),
        (UInt8(), "data: 300", "data: got 300, expected a whole number from 0 to 255"),
        (Int8(), "data: 1.5", "data: got 1.5, expected a whole number"),
        (Bool(), "data: 'false'", "expected true or false"),
        (Byte(), "data: 256", "a number from 0 to 255 or one character"),
        (
            PoseWithCovarianceStamped(),
            "pose: {covariance: [1]}",
            "pose.covariance: got [1], expected a list of length 36 of double",
        ),
    ],
)
def test_what_does_not_fit_is_refused_by_name(
    message: Any, text: str, named: str
) -> None:
    with pytest.raises(VerbError) as refusal:
        fill(message, values_of(text))
    assert str(refusal.value).startswith("Failed to populate field: ")
    assert named in str(refusal.value)


@pytest.mark.parametrize("text", ["{data: [", "just text", "[1, 2]"])
def test_what_is_no_dictionary_in_yaml_is_refused(text: str) -> None:
    with pytest.raises(VerbError, match=r"The passed value"):
        values_of(text)
