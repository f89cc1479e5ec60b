"""Parameter files, as `ros2 param load` reads them."""

import pytest

from ros2_verbs.errors import VerbError
from ros2_verbs.param.load import parameters_from_file

FILE = """
/**:
  ros__parameters: {use_sim_time: true, gait: {steps: 5}}
/walker:
  ros__parameters: {gait: {steps: 7, length_m: 0.1}, name: '7', list: [1, 2]}
bare:
  ros__parameters: {a: 1}
"""


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
