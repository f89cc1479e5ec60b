"""Every example does what it says."""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from biped_bringup.cli.main import main

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
SAID = {
    "acrobot.py": "learned after ",
    "bicycle.py": "learned after ",
    "cartpole.py": "learned after ",
    "hopper.py": "learned after ",
    "own_learner.py": ": completed, 11.25 s\n",
    "own_task.py": ": stops at the mark, ",
    "waist_env.py": "walk 3: zmp_error, ",
}
NEEDS = {"hopper.py": ("mujoco", "glfw")}
"""Packages of extras, without which an example cannot be run."""


def test_every_program_is_run_here() -> None:
    assert {file.name for file in EXAMPLES.glob("*.py")} == set(SAID)


@pytest.mark.thorough
@pytest.mark.parametrize(("name", "said"), SAID.items())
def test_a_program_does_what_it_says(name: str, said: str, tmp_path: Path) -> None:
    for package in NEEDS.get(name, ()):
        if find_spec(package) is None:
            pytest.skip(f"{package} is not installed")
    done = subprocess.run(
        [sys.executable, EXAMPLES / name],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300.0,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert said in done.stdout


@pytest.mark.parametrize("file", [*EXAMPLES.glob("*.yaml")], ids=lambda file: file.name)
def test_a_robot_walks_as_its_first_lines_say(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(EXAMPLES.parent)
    (command,) = (
        line.removeprefix("#   ")
        for line in file.read_text().splitlines()
        if line.startswith("#   biped ")
    )
    assert main(command.split()[1:]) == 0
