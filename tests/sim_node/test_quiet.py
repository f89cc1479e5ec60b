"""Standard output and error belong to the project, not to the engine."""

import os
import subprocess
import sys

import pytest

BUILD_A_WORLD = """
from biped_description.robot import Robot
from biped_description.settings import RobotSettings
from sim_node.pybullet_world import PyBulletWorld

robot = Robot(RobotSettings())
PyBulletWorld(robot, 0.9, robot.torque_limit_nm).close()
"""
CHATTER = """
import ctypes, sys
from sim_node.quiet import engine_chatter_dropped

c = ctypes.CDLL(None)
print("python before")
sys.stdout.flush()
c.puts(b"c before")
try:
    with engine_chatter_dropped():
        c.puts(b"chatter")
        c.perror(b"chatter")
        raise RuntimeError
except RuntimeError:
    pass
c.puts(b"c after")
c.fflush(None)
print("python after")
print("error after", file=sys.stderr)
"""


def run(program: str) -> subprocess.CompletedProcess[str]:
    """Run a program whose output is buffered, as it is by default into a pipe."""
    env = {k: v for k, v in os.environ.items() if k != "PYTHONUNBUFFERED"}
    return subprocess.run(
        [sys.executable, "-c", program],
        env=env,
        capture_output=True,
        text=True,
        check=True,
    )


@pytest.fixture(scope="module")
def world_builder():
    return run(BUILD_A_WORLD)


@pytest.fixture(scope="module")
def chatterer():
    return run(CHATTER)


@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_building_a_world_prints_nothing(world_builder, stream):
    assert getattr(world_builder, stream) == ""


def test_only_what_is_printed_meanwhile_is_dropped_from_standard_output(chatterer):
    assert chatterer.stdout.splitlines() == [
        "python before",
        "c before",
        "c after",
        "python after",
    ]


def test_only_what_is_printed_meanwhile_is_dropped_from_standard_error(chatterer):
    assert chatterer.stderr == "error after\n"
