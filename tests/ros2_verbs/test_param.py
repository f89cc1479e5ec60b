"""What `ros2 param` prints, and how it reads values and parameter files."""

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
from tests.ros2_verbs.golden_texts import golden

from ros2_verbs.errors import VerbError
from ros2_verbs.param.describe import description_text
from ros2_verbs.param.dump import dump_text
from ros2_verbs.param.get import value_text
from ros2_verbs.param.load import loaded_text, parameters_from_file
from ros2_verbs.param.set import typed_parameter

READ_ONLY = (
    "parameter 'qos_overrides./parameter_events.publisher.depth' cannot be set "
    "because it is read-only"
)

FILE = """
/**:
  ros__parameters: {use_sim_time: true, gait: {steps: 5}}
/walker:
  ros__parameters: {gait: {steps: 7, length_m: 0.1}, name: '7', list: [1, 2]}
bare:
  ros__parameters: {a: 1}
"""


def value_of(value):
    """Return the ParameterValue of a Python value."""
    return Parameter("x", value=value).get_parameter_value()


def load(tmp_path, content, node="/walker", wildcard=True):
    """Return what a file with this content sets, as a dictionary."""
    path = tmp_path / "parameters.yaml"
    path.write_text(content)
    parameters = parameters_from_file(str(path), node, wildcard=wildcard)
    return {parameter.name: parameter.value for parameter in parameters}


def refusal(tmp_path, content, **options):
    """Return why a file with this content is refused."""
    with pytest.raises(VerbError) as caught:
        load(tmp_path, content, **options)
    return str(caught.value)


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


def test_the_nodes_own_values_win_over_those_for_all(tmp_path):
    assert load(tmp_path, FILE) == {
        "use_sim_time": True,
        "gait.steps": 7,
        "gait.length_m": 0.1,
        "name": "7",
        "list": [1, 2],
    }


def test_values_for_all_can_be_left_out(tmp_path):
    assert "use_sim_time" not in load(tmp_path, FILE, wildcard=False)


def test_values_for_all_suffice(tmp_path):
    assert load(tmp_path, FILE, node="/other") == {
        "use_sim_time": True,
        "gait.steps": 5,
    }


def test_a_name_in_the_file_may_lack_its_slash(tmp_path):
    assert load(tmp_path, FILE, node="/bare", wildcard=False) == {"a": 1}


def test_a_file_for_others_is_refused(tmp_path):
    text = refusal(tmp_path, FILE, node="/other", wildcard=False)
    assert text == (
        "Param file does not contain parameters for /other, "
        "only for nodes: ['/**', '/walker', 'bare']"
    )


@pytest.mark.parametrize("content", ["/walker: {a: 1}", "/walker: [1]", "/walker:"])
def test_a_section_without_parameters_is_refused(tmp_path, content):
    text = refusal(tmp_path, content)
    assert text == "YAML file is not a valid ROS parameter file for node /walker"


@pytest.mark.parametrize("content", ["", "[1, 2]", "walk"])
def test_a_file_that_names_no_nodes_is_refused(tmp_path, content):
    assert "must map node names to ros__parameters" in refusal(tmp_path, content)


def test_broken_yaml_is_refused(tmp_path):
    assert "is no YAML" in refusal(tmp_path, "/walker: [")


@pytest.mark.parametrize("value", ["[1, a]", "2026-01-01"])
def test_a_value_that_no_parameter_can_have_is_refused(tmp_path, value):
    text = refusal(tmp_path, f"/walker: {{ros__parameters: {{x: {value}}}}}")
    assert "parameters.yaml: x: must be" in text
