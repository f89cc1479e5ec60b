"""Messages as YAML, values and JSON, in the words of rosidl_runtime_py."""

import json

import yaml
from geometry_msgs.msg import PoseWithCovariance, Twist, Vector3
from sensor_msgs.msg import JointState
from std_msgs.msg import Byte, Float64MultiArray, String
from tests.ros2_verbs.golden_texts import golden

from biped_common.terminal_text import printable
from ros2_verbs.messages.text import Shown, to_csv, to_json, to_plain, to_yaml

CUT_AT_5 = Shown(length=5)


def test_a_twist_is_shown_as_in_the_tutorial() -> None:
    text = to_yaml(Twist(linear=Vector3(x=2.0)))
    assert f"{text}---\n" == golden("topic_echo_twist")


def test_long_strings_are_cut() -> None:
    assert to_yaml(String(data="Hello World"), CUT_AT_5) == "data: Hello...\n"


def test_long_arrays_end_in_dots() -> None:
    plain = to_plain(JointState(position=[0.5] * 6), CUT_AT_5)
    assert plain["position"] == [0.5] * 5 + ["..."]


def test_what_is_just_as_long_as_allowed_is_not_cut() -> None:
    assert to_plain(String(data="Hello"), CUT_AT_5) == {"data": "Hello"}


def test_without_arrays_their_type_and_length_are_shown() -> None:
    shown = Shown(arrays=False)
    assert "position: '<sequence type: double, length: 3>'\n" in to_yaml(
        JointState(position=[1.0, 2.0, 3.0]), shown
    )
    assert "covariance: '<array type: double[36]>'\n" in to_yaml(
        PoseWithCovariance(), shown
    )


def test_without_strings_their_length_is_shown() -> None:
    text = to_yaml(String(data="Hello"), Shown(strings=False))
    assert text == "data: '<string length: <5>>'\n"


def test_a_text_that_looks_like_a_number_is_quoted() -> None:
    assert to_yaml(String(data="12")) == "data: '12'\n"


def test_characters_beyond_16_bits_are_not_escaped() -> None:
    assert to_yaml(String(data="walk 🚶")) == "data: walk 🚶\n"


def test_flow_style_is_one_line() -> None:
    assert to_yaml(Vector3(x=1.0), flow_style=True) == "{x: 1.0, y: 0.0, z: 0.0}\n"


def test_values_are_separated_by_commas_in_the_order_of_the_fields() -> None:
    assert to_csv(Twist(linear=Vector3(x=2.0))) == "2.0,0.0,0.0,0.0,0.0,0.0"


def test_octets_are_shown_as_bytes_among_values() -> None:
    assert to_csv(Byte(data=b"2")) == "b'2'"


def test_long_arrays_of_values_end_in_dots() -> None:
    text = to_csv(Float64MultiArray(data=[1.0, 2.0, 3.0]), Shown(length=2))
    assert text.endswith("1.0,2.0,...")


def test_json_in_a_string_is_shown_as_what_it_says() -> None:
    shown = to_json(String(data='{"end": "completed", "cost": 1.5}'))
    assert shown == '{\n  "end": "completed",\n  "cost": 1.5\n}'


def test_other_messages_are_shown_as_their_fields_in_json() -> None:
    assert json.loads(to_json(Vector3(x=1.0))) == {"x": 1.0, "y": 0.0, "z": 0.0}


def test_json_has_no_bare_nan() -> None:
    assert json.loads(to_json(Vector3(x=float("nan"))))["x"] == "nan"


def test_what_acts_on_a_terminal_is_escaped_so_that_it_can_be_read_again() -> None:
    hostile = "\x1b[2J\x9b\u202e 歩行\nnext"
    for text in (to_yaml(String(data=hostile)), to_json(String(data=hostile))):
        assert text == printable(text, layout=True)
        assert yaml.safe_load(text) == {"data": hostile}
