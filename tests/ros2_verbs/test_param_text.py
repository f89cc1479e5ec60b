"""What `ros2 param` prints, and how it reads what the user types."""

import pytest
import yaml
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    SetParametersResult,
)
from rclpy.parameter import Parameter
from tests.ros2_verbs.golden_files import golden

from ros2_verbs.param.describe import description_text
from ros2_verbs.param.dump import dump_text
from ros2_verbs.param.get import value_text
from ros2_verbs.param.load import loaded_text
from ros2_verbs.param.set import typed_parameter

READ_ONLY = (
    "parameter 'qos_overrides./parameter_events.publisher.depth' cannot be set "
    "because it is read-only"
)


def value_of(value):
    """Return the ParameterValue of a Python value."""
    return Parameter("x", value=value).get_parameter_value()


def test_a_value_is_shown_as_in_the_tutorial():
    assert value_text(value_of(86), hide_type=False) + "\n" == golden("param_get")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (True, "Boolean value is: True"),
        (0.3, "Double value is: 0.3"),
        ("walk", "String value is: walk"),
        ([b"a"], "Byte values are: [b'a']"),
        ([True, False], "Boolean values are: [True, False]"),
        ([1, 2], "Integer values are: [1, 2]"),
        ([0.5], "Double values are: [0.5]"),
        (["a", "b"], "String values are: ['a', 'b']"),
        (None, "Parameter not set."),
    ],
)
def test_each_type_has_its_label(value, text):
    assert value_text(value_of(value), hide_type=False) == text


def test_the_type_can_be_hidden():
    assert value_text(value_of([1, 2]), hide_type=True) == "[1, 2]"


def test_descriptions_are_those_of_the_example():
    bounds = IntegerRange(from_value=0, to_value=255, step=0)
    red, green = (
        ParameterDescriptor(
            name=f"background_{colour[0].lower()}",
            type=ParameterType.PARAMETER_INTEGER,
            description=f"{colour} channel of the background color",
            integer_range=[bounds],
        )
        for colour in ("Red", "Green")
    )
    green.additional_constraints = "foo"
    text = f"{description_text(red)}\n{description_text(green)}\n"
    assert text == golden("param_describe")


def test_read_only_and_a_step_are_constraints():
    descriptor = ParameterDescriptor(
        name="gain",
        type=ParameterType.PARAMETER_DOUBLE,
        read_only=True,
        floating_point_range=[
            FloatingPointRange(from_value=0.0, to_value=1.0, step=0.1)
        ],
    )
    assert description_text(descriptor).splitlines() == [
        "Parameter name: gain",
        "  Type: double",
        "  Constraints:",
        "    Read only: true",
        "    Min value: 0.0",
        "    Max value: 1.0",
        "    Step: 0.1",
    ]


def test_a_dump_is_the_file_of_the_tutorial():
    quality = "qos_overrides./parameter_events.publisher"
    values = {
        "background_b": 255,
        "background_g": 86,
        "background_r": 150,
        f"{quality}.depth": 1000,
        f"{quality}.durability": "volatile",
        f"{quality}.history": "keep_last",
        f"{quality}.reliability": "reliable",
        "use_sim_time": False,
    }
    assert dump_text("/turtlesim", values.items()) == golden("param_dump")


def test_a_dump_says_what_is_not_set():
    dumped = yaml.safe_load(dump_text("/a", [("b.c", None)]))
    assert dumped == {"/a": {"ros__parameters": {"b": {"c": None}}}}


def test_what_became_of_a_file_is_told_as_in_the_tutorial():
    lines = [
        loaded_text("background_b", SetParametersResult(successful=True)),
        loaded_text(
            "qos_overrides./parameter_events.publisher.depth",
            SetParametersResult(successful=False, reason=READ_ONLY),
        ),
    ]
    assert "\n".join(lines) + "\n" == golden("param_load")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("150", 150),
        ("-1", -1),
        ("0.3", 0.3),
        ("true", True),
        ("off", False),
        ("walk", "walk"),
        ("'150'", "150"),
        ("[1, 2]", [1, 2]),
        ("[0.5, 1.0]", [0.5, 1.0]),
        ("[a, b]", ["a", "b"]),
        ("", ""),
        (" ", " "),
        ("null", "null"),
    ],
)
def test_a_typed_value_is_read_as_yaml(text, value):
    parameter = typed_parameter("x", text)
    assert (parameter.value, type(parameter.value)) == (value, type(value))


@pytest.mark.parametrize(
    "text", ["[1, 2.5]", "{a: 1}", "2026-01-01", "[", "a: b: c", "%", "[[1]]"]
)
def test_what_is_no_parameter_value_is_a_string(text):
    assert typed_parameter("x", text).value == text
