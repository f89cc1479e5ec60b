"""The map from the paper to code and tests names only what exists."""

import ast
import re
from pathlib import Path

import pytest

from biped_bringup.run_settings import load_settings
from biped_common.settings import to_mapping

TOP = Path(__file__).resolve().parents[1]
MAP = TOP / "docs" / "paper-map.md"
FOLDERS = {
    "learner_node": TOP / "learner_node/learner_node",
    "xol": TOP / "learner_node/learner_node/xol",
    "walking": TOP / "learner_node/learner_node/walking",
    "sim": TOP / "sim_node/sim_node",
    "biped_common": TOP / "ros_ws/src/biped_common/biped_common",
    "biped_bringup": TOP / "ros_ws/src/biped_bringup/biped_bringup",
    "biped_description": TOP / "ros_ws/src/biped_description/biped_description",
    "biped_lab": TOP / "ros_ws/src/biped_lab/biped_lab",
    "msgs_json": TOP / "msgs_json/msgs_json",
}
NAMED = sorted(set(re.findall(r"`([\w/]+\.py)(?:::([\w.]+))?`", MAP.read_text())))
SETTINGS = sorted(
    set(re.findall(r"`((?:gait|sim|learner)\.(?!py)[\w.]+)`", MAP.read_text()))
)


def located(path: str) -> Path:
    """Return the file that a short path of the map stands for."""
    folder, _, rest = path.partition("/")
    if Path(path).name.startswith("test_"):
        return TOP / "tests" / path
    if not rest:
        return TOP / "trajectory_node/trajectory_node" / path
    return FOLDERS[folder] / rest


def names_in(tree: ast.AST) -> set[str]:
    """Return functions, classes and constants, methods as Class.method."""
    found: set[str] = set()
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            found.add(node.name)
            if isinstance(node, ast.ClassDef):
                found |= {f"{node.name}.{inner}" for inner in names_in(node)}
        elif isinstance(node, ast.Assign):
            found |= {t.id for t in node.targets if isinstance(t, ast.Name)}
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            found.add(node.target.id)
    return found


@pytest.mark.parametrize(("path", "name"), NAMED)
def test_what_the_map_names_exists(path: str, name: str) -> None:
    names = names_in(ast.parse(located(path).read_text()))
    assert not name or name in names


@pytest.mark.parametrize("key", SETTINGS)
def test_every_setting_that_the_map_names_exists(key: str) -> None:
    value = to_mapping(load_settings())
    for part in key.split("."):
        assert part in value
        value = value[part]


def test_every_step_of_the_algorithm_is_on_the_map() -> None:
    text = MAP.read_text()
    steps = [f"2(c){step}:" for step in ("i", "ii", "iii", "iv", "v", "vi", "vii")]
    for step in ["1:", "2:", "2(a):", "2(b):", *steps, "2(c)viii:", "2(c)ix:"]:
        assert f"| {step}" in text
