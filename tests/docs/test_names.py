"""What the pages name exists: files, functions, tests, settings, commands, modules."""

import ast
import importlib.util
import re
import shlex
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterable
from pathlib import Path

import pytest
import tomllib
from tests.docs.pages import PAGES, TOP, blocks, prose

from biped_bringup.cli.main import parser
from biped_bringup.run_settings import load_settings
from biped_common.settings import to_mapping
from ros2_verbs.main import make_parser

MAP = TOP / "docs" / "paper-map.md"
LIVING = [page for page in PAGES if page.name != "CHANGELOG.md"]
"""All pages that tell how things are, not how they were."""
SHORT = {
    "xol/": "learner_node/xol/",
    "walking/": "learner_node/walking/",
    "sim/": "sim_node/",
}
"""Folders that the map abbreviates; what is in none of them is the trajectory's."""


def found_in(pages: list[Path], pattern: str) -> list[tuple[Path, str]]:
    """Return what the pages say, outside of fenced blocks, that fits a pattern."""
    return sorted(
        {(page, text) for page in pages for text in re.findall(pattern, prose(page))}
    )


def each(cases: list[tuple[Path, str]]) -> pytest.MarkDecorator:
    """Return a test's parameters: pages, and what they say."""
    names = [f"{page.relative_to(TOP)}: {text}" for page, text in cases]
    return pytest.mark.parametrize(("page", "said"), cases, ids=names)


# -- files and what is in them ---------------------------------------------------------


def located(page: Path, path: str) -> Path:
    """Return the file that a path of a page stands for.

    Paths are from the top, from `tests/`, or begin with a package: `sim_node/biped.py`
    is `sim_node/sim_node/biped.py`.
    """
    if page == MAP and "test_" not in path:
        for short, folder in SHORT.items():
            path = re.sub(f"^{short}", folder, path)
        path = path if "/" in path else f"trajectory_node/{path}"
    package = path.partition("/")[0]
    for folder in (TOP / "ros_ws/src" / package, TOP, TOP / "tests"):
        if (folder / path).is_file():
            return folder / path
    raise AssertionError(f"{path}: no such file")


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


@each(
    found_in(
        LIVING, r"`((?:[\w/]+/|test_)\w+\.(?:py|yaml)(?:::[\w.]+)?|\w+\.py::[\w.]+)`"
    )
)
def test_a_file_and_what_is_named_of_it_exist(page: Path, said: str) -> None:
    path, _, name = said.partition("::")
    file = located(page, path)
    assert not name or name in names_in(ast.parse(file.read_text()))


# -- settings --------------------------------------------------------------------------


@each(
    found_in(
        LIVING, r"`((?:robot|gait|correction|sim|learner)\.(?!py|yaml)[\w.*]+)[`=]"
    )
)
def test_a_setting_exists(page: Path, said: str) -> None:
    value = to_mapping(load_settings())
    for part in said.removesuffix(".*").split("."):
        assert part in value
        value = value[part]


# -- commands --------------------------------------------------------------------------


def commands(lines: list[str]) -> list[str]:
    """Return the single commands of lines for a shell."""
    parts = (re.split(r"\|\||&&|[|;&>]| #", line) for line in lines if "$(" not in line)
    return [part.strip() for line in parts for part in line]


def typed(page: Path) -> list[str]:
    """Return the commands that a page shows as blocks."""
    shown = blocks(page.read_text())
    return commands(
        [line for each in shown if each.language == "sh" for line in each.commands]
    )


def named(page: Path) -> list[str]:
    """Return the commands that a page names in its text."""
    return commands([text for _, text in found_in([page], r"`([^`\n]+)`")])


def called(
    name: str, ways: Iterable[Callable[[Path], list[str]]] = (typed, named)
) -> list[tuple[Path, str]]:
    """Return the commands of all pages that call a program with arguments."""
    return [
        (page, command)
        for page in LIVING
        for command in dict.fromkeys(said for way in ways for said in way(page))
        if command.startswith(f"{name} ")
    ]


def understood(parsers: Callable[[list[str]], ArgumentParser], said: str) -> Namespace:
    """Return the options of a command as the real parser reads it.

    In a text a verb is often named without what it would need.
    """
    words = shlex.split(said)[1:]
    names_a_verb = not any(word.startswith("-") for word in words)
    if names_a_verb and not (words[0] == "run" and words[1:]):  # of another program
        with pytest.raises(SystemExit, match=r"^0$"):
            parsers(words).parse_args([*words, "--help"])
        return Namespace()
    return parsers(words).parse_args(words)


@each([(page, said) for page, said in called("biped") if "dance" not in said])
def test_biped_understands_what_is_named(page: Path, said: str) -> None:
    if "--help" not in said:
        load_settings(changes=getattr(understood(parser, said), "changes", ()))


@each([(page, said) for page, said in called("biped", [typed]) if "dance" not in said])
def test_biped_understands_what_is_typed(page: Path, said: str) -> None:
    words = shlex.split(said)[1:]
    if "--help" not in words:
        parser(words).parse_args(words)


# Named because they do not exist here.
NOT_THERE = {"ros2 bag burst", "ros2 launch", "ros2 pkg"}


@each([(page, said) for page, said in called("ros2") if said not in NOT_THERE])
def test_ros2_understands_what_is_named(page: Path, said: str) -> None:
    understood(make_parser, said)


@each(called("ros2", [typed]))
def test_ros2_understands_what_is_typed(page: Path, said: str) -> None:
    words = shlex.split(said)[1:]
    assert make_parser(words).parse_args(words).run is not None


@pytest.mark.parametrize("said", sorted(NOT_THERE))
def test_ros2_has_no_such_command(said: str) -> None:
    words = said.split()[1:]
    with pytest.raises(SystemExit, match=r"^2$"):
        make_parser(words).parse_args([*words, "--help"])


@each(called("make"))
def test_make_has_the_target(page: Path, said: str) -> None:
    targets = re.findall(r"^([a-z]+):", (TOP / "Makefile").read_text(), re.M)
    assert said.split()[1] in targets


@each(
    [
        (page, module)
        for page in LIVING
        for module in sorted({*re.findall(r"python -m ([\w.]+)", page.read_text())})
    ]
)
def test_a_module_that_is_run_exists(
    page: Path, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(TOP))
    assert importlib.util.find_spec(said) is not None


# -- two pages as wholes ---------------------------------------------------------------


def test_every_step_of_the_algorithm_is_on_the_map() -> None:
    text = MAP.read_text()
    steps = [f"2(c){step}:" for step in ("i", "ii", "iii", "iv", "v", "vi", "vii")]
    for step in ["1:", "2:", "2(a):", "2(b):", *steps, "2(c)viii:", "2(c)ix:"]:
        assert f"| {step}" in text


def test_the_table_of_the_rooms_is_the_contract() -> None:
    design = (TOP / "docs" / "design.md").read_text()
    rows = re.findall(r"^\| (\d) \| `(\w+)` \| `([\w/]+)` \|", design, re.M)
    told = {int(floor): set[str]() for floor, _, _ in rows}
    for floor, package, folder in rows:
        told[int(floor)].add(package)
        assert (TOP / folder / package / "__init__.py").exists() or (
            TOP / folder / package / package / "__init__.py"
        ).exists()
    project = tomllib.loads((TOP / "pyproject.toml").read_text())
    contracts = project["tool"]["importlinter"]["contracts"]
    (layers,) = (each["layers"] for each in contracts if each["id"] == "floors")
    floors = [{*layer.split(" | ")} for layer in layers]
    assert [told[floor] for floor in sorted(told, reverse=True)] == floors
