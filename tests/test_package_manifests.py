"""What the ROS packages say of themselves agrees with their code and with pip."""

import ast
import re
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest
import tomllib

TOP = Path(__file__).resolve().parents[1]
FOLDERS = sorted(file.parent for file in TOP.glob("ros_ws/src/*/package.xml"))
OWN = {folder.name for folder in FOLDERS}

ROSDEP_KEYS = {
    "argcomplete": "python3-argcomplete",
    "gymnasium": "python3-gymnasium-pip",
    "jinja2": "python3-jinja2",
    "PIL": "python3-pil",
    "matplotlib": "python3-matplotlib",
    "numpy": "python3-numpy",
    "pandas": "python3-pandas",
    "pybullet": "python3-pybullet-pip",
    "rich": "python3-rich",
    "scipy": "python3-scipy",
    "yaml": "python3-yaml",
}
"""Of what is imported from neither ROS nor the standard library."""
FROM_PIP = {
    "av": "av",
    "cma": "cma",
    "distributed": "distributed",
    "foxglove": "foxglove-sdk",
    "lifelines": "lifelines",
    "llvmlite": "llvmlite",
    "lz4": "lz4",
    "mcap": "mcap",
    "mcap_ros2": "mcap-ros2-support",
    "msgspec": "msgspec",
    "mujoco": "mujoco-core",
    "numba": "numba",
    "pyarrow": "pyarrow",
    "stable_baselines3": "stable-baselines3",
    "submitit": "submitit",
    "threadpoolctl": "threadpoolctl",
    "torch": "torch",
    "viser": "viser",
    "zstandard": "zstandard",
}
"""Named in a comment of package.xml: rosdep has no key, or none for Jazzy's Ubuntu."""
_MESSAGE_TYPE = re.compile(r"(\w+)/(?:msg|srv)/[A-Z]\w*")

each_package = pytest.mark.parametrize("folder", FOLDERS, ids=lambda f: f.name)


def manifest(folder: Path) -> ElementTree.Element:
    """Return the root of package.xml, with its comments."""
    builder = ElementTree.TreeBuilder(insert_comments=True)
    parser = ElementTree.XMLParser(target=builder)
    return ElementTree.parse(folder / "package.xml", parser).getroot()


def setup_arguments(folder: Path) -> dict[str, Any]:
    """Return what setup.py gives to setuptools, as far as it is literal."""
    (call,) = (
        node
        for node in ast.walk(ast.parse((folder / "setup.py").read_text()))
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "setup"
    )
    return {
        keyword.arg: ast.literal_eval(keyword.value)
        for keyword in call.keywords
        if keyword.arg in ("version", "entry_points")
    }


def project() -> dict[str, Any]:
    """Return the [project] table of pyproject.toml."""
    return tomllib.loads((TOP / "pyproject.toml").read_text())["project"]


def used_modules(folder: Path) -> set[str]:
    """Return the top-level modules from elsewhere that a package's code needs."""
    trees = (
        ast.parse(file.read_text()) for file in folder.glob(f"{folder.name}/**/*.py")
    )
    used = {name for tree in trees for name in _named_modules(tree)}
    return used - {folder.name} - sys.stdlib_module_names


def _named_modules(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            yield node.module.split(".")[0]
        elif isinstance(node, ast.Constant) and (
            named := _MESSAGE_TYPE.fullmatch(str(node.value))
        ):
            yield named[1]  # such as std_msgs of "std_msgs/msg/String"


@each_package
def test_package_xml_names_what_the_code_imports(folder: Path) -> None:
    named = {element.text for element in manifest(folder).iter("exec_depend")}
    needed = used_modules(folder) - FROM_PIP.keys()
    assert {ROSDEP_KEYS.get(module, module) for module in needed} - named == set()


@each_package
def test_a_comment_in_package_xml_names_what_comes_from_pip(folder: Path) -> None:
    comments = " ".join(
        comment.text or "" for comment in manifest(folder).iter(ElementTree.Comment)
    )
    needed = {FROM_PIP[module] for module in used_modules(folder) & FROM_PIP.keys()}
    assert needed - set(re.findall(r"[\w-]+", comments)) == set()


@each_package
def test_package_xml_names_no_package_of_ours_that_the_code_does_not(
    folder: Path,
) -> None:
    named = {element.text for element in manifest(folder).iter("exec_depend")}
    code = "".join(file.read_text() for file in folder.glob(f"{folder.name}/**/*.py"))
    assert {name for name in named & OWN if name not in code} == set()


@each_package
def test_every_version_is_that_of_the_distribution(folder: Path) -> None:
    versions = {
        manifest(folder).findtext("version"),
        setup_arguments(folder)["version"],
        project()["version"],
    }
    assert len(versions) == 1


@each_package
def test_a_package_is_built_as_ament_python(folder: Path) -> None:
    root = manifest(folder)
    assert root.get("format") == "3"
    assert root.findtext("name") == folder.name
    assert root.findtext("export/build_type") == "ament_python"


def executables() -> dict[str, str]:
    """Return "module:function" by "package/executable", as pip gets to know them."""
    return project()["entry-points"]["biped.nodes"]


def test_pip_and_colcon_offer_the_same_executables_and_verbs() -> None:
    by_colcon: dict[str, dict[str, str]] = {}
    for folder in FOLDERS:
        for group, lines in setup_arguments(folder).get("entry_points", {}).items():
            for name, target in (line.split(" = ") for line in lines):
                if group == "console_scripts":
                    by_colcon.setdefault("biped.nodes", {})[f"{folder.name}/{name}"] = (
                        target
                    )
                else:
                    by_colcon.setdefault(group, {})[name] = target
    assert by_colcon == project()["entry-points"]


def offered(*beginnings: str) -> list[EntryPoint]:
    """Return the entry points of the groups whose names begin so."""
    return [
        EntryPoint(name, target, group)
        for group, points in project()["entry-points"].items()
        if group.startswith(beginnings)
        for name, target in points.items()
    ]


@pytest.mark.parametrize(
    "point", offered("biped.verbs", "biped.bag_verbs"), ids=lambda p: p.value
)
def test_a_verb_of_biped_is_a_function(point: EntryPoint) -> None:
    assert callable(point.load())


@pytest.mark.parametrize("point", offered("ros2."), ids=lambda p: p.value)
def test_a_verb_of_ros2_is_a_module_with_a_line_of_help(point: EntryPoint) -> None:
    module = point.load()
    assert module.__doc__.partition("\n")[0].endswith(".")
    has_verbs = f"ros2.{point.name}_verbs" in project()["entry-points"]
    if point.group != "ros2.commands" or not has_verbs:
        assert callable(module.add_arguments)
        assert callable(module.main)


@pytest.mark.parametrize("name", executables())
def test_what_an_executable_calls_is_there(name: str) -> None:
    entry = EntryPoint(name, executables()[name], group="biped.nodes")
    assert callable(entry.load())
