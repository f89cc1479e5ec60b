"""`ros2 run`: what it finds, what it starts, how it ends."""

import contextlib
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from biped_ros.environment import PROFILE, PROFILE_VARIABLE
from ros2_verbs.errors import VerbError
from ros2_verbs.run.executables import command_of, executables, packages

COMMAND = (sys.executable, "-m", "ros2_verbs.main", "run")
TIMEOUT_S = 60.0


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an ament prefix with a package `walker` that has no executables yet."""
    index = tmp_path / "share/ament_index/resource_index/packages"
    index.mkdir(parents=True)
    (index / "walker").touch()
    (tmp_path / "lib/walker").mkdir(parents=True)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    return tmp_path


def script(path: Path, text: str) -> Path:
    """Write an executable of the shell."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return path


def run(*arguments: str) -> "subprocess.CompletedProcess[str]":
    """Run `ros2 run` to its end."""
    return subprocess.run(
        [*COMMAND, *arguments], capture_output=True, text=True, timeout=TIMEOUT_S
    )


def install_nodes(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Install nodes of a package by pip, as far as their entry points go."""
    about = folder / "robot-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: robot\nVersion: 1.0\n"
    )
    (about / "entry_points.txt").write_text(
        "[biped.nodes]\nrobot/arm = robot.arm_node:main\n"
    )
    monkeypatch.syspath_prepend(str(folder))


def test_an_executable_of_a_package_is_found(prefix):
    path = script(prefix / "lib/walker/walk", "exit 0")
    assert command_of("walker", "walk") == [str(path)]


def test_what_cannot_be_executed_is_not_found(prefix):
    script(prefix / "lib/walker/walk", "exit 0").chmod(0o644)
    assert not executables("walker")


def test_what_lies_in_a_hidden_folder_is_not_found(prefix):
    script(prefix / "lib/walker/.old/walk", "exit 0")
    assert not executables("walker")


def test_two_executables_of_one_name_are_refused(prefix):
    first = script(prefix / "lib/walker/a/walk", "exit 0")
    second = script(prefix / "lib/walker/b/walk", "exit 0")
    with pytest.raises(VerbError, match=f"Multiple .* found: - {first} - {second}"):
        command_of("walker", "walk")


def test_a_node_installed_by_pip_is_run_as_a_module(prefix, tmp_path, monkeypatch):
    install_nodes(tmp_path, monkeypatch)
    assert command_of("robot", "arm") == [sys.executable, "-m", "robot.arm_node"]
    assert {"robot", "walker"} <= set(packages())


def test_an_executable_of_the_prefix_goes_before_one_of_pip(
    prefix, tmp_path, monkeypatch
):
    install_nodes(tmp_path, monkeypatch)
    (prefix / "share/ament_index/resource_index/packages/robot").touch()
    path = script(prefix / "lib/robot/arm", "exit 0")
    assert command_of("robot", "arm") == [str(path)]


def test_an_unknown_package_is_one_line(prefix):
    done = run("nobody", "walk")
    assert (done.returncode, done.stderr) == (1, "Package 'nobody' not found\n")


def test_an_unknown_executable_is_one_line(prefix):
    done = run("walker", "fly")
    assert (done.returncode, done.stderr) == (1, "No executable found\n")


def test_arguments_and_exit_status_are_passed_on(prefix):
    script(prefix / "lib/walker/walk", 'echo "$@"; exit 3')
    done = run("walker", "walk", "--ros-args", "-p", "a:=1")
    assert done.returncode == 3
    assert "--ros-args -p a:=1\n" in done.stdout
    assert "[ros2run]: Process exited with failure 3\n" in done.stdout


def test_a_prefix_goes_before_the_executable(prefix):
    script(prefix / "lib/walker/walk", 'echo "$GAIT"')
    done = run("--prefix", "env GAIT=trot", "walker", "walk")
    assert done.stdout == "trot\n"


def test_the_node_has_the_discovery_profile_of_the_project(prefix, monkeypatch):
    monkeypatch.delenv(PROFILE_VARIABLE, raising=False)
    script(prefix / "lib/walker/walk", f'echo "${PROFILE_VARIABLE}"')
    assert run("walker", "walk").stdout == f"{PROFILE}\n"


@pytest.mark.parametrize(
    ("number", "whole_group", "status"),
    [(signal.SIGINT, True, 5), (signal.SIGTERM, False, 6)],
)
def test_the_node_may_end_in_order(prefix, number, whole_group, status):
    script(
        prefix / "lib/walker/walk",
        "trap 'exit 5' INT; trap 'exit 6' TERM; echo up; while :; do sleep 0.05; done",
    )
    process = subprocess.Popen(
        [*COMMAND, "walker", "walk"],
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        assert process.stdout is not None and process.stdout.readline() == "up\n"
        # A terminal sends Ctrl-C to all of its foreground group.
        (os.killpg if whole_group else os.kill)(process.pid, number)
        assert process.wait(TIMEOUT_S) == status
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate(timeout=TIMEOUT_S)


def test_a_node_that_was_killed_is_told_by_its_signal(prefix):
    script(prefix / "lib/walker/walk", "kill -KILL $$")
    done = run("walker", "walk")
    assert (done.returncode, done.stdout) == (137, "[ros2run]: Killed\n")
