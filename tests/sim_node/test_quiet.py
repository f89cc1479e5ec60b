"""Standard output and error belong to the project, not to the engine."""

import ctypes
import os
import subprocess
import sys

import pytest

from sim_node.quiet import engine_chatter_dropped


def print_from_c(text: str) -> None:
    ctypes.CDLL(None).puts(text.encode())


@pytest.fixture(scope="module")
def world_builder():
    """Run a program that builds a world, in a process of its own."""
    program = "import sim_node.world as w; w.World().close()"
    return subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )


@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_building_a_world_prints_nothing(world_builder, stream):
    assert getattr(world_builder, stream) == ""


def test_what_c_prints_meanwhile_is_dropped(capfd):
    with engine_chatter_dropped():
        print_from_c("chatter")
    ctypes.CDLL(None).fflush(None)
    assert capfd.readouterr().out == ""


def test_what_c_writes_to_standard_error_meanwhile_is_dropped(capfd):
    with engine_chatter_dropped():
        os.write(2, b"chatter")
    assert capfd.readouterr().err == ""


def test_what_c_prints_before_and_after_is_kept(capfd):
    print_from_c("before")
    with engine_chatter_dropped():
        print_from_c("chatter")
    print_from_c("after")
    ctypes.CDLL(None).fflush(None)
    assert capfd.readouterr().out == "before\nafter\n"


def test_what_python_prints_before_and_after_is_kept(capfd):
    print("before")
    with engine_chatter_dropped():
        pass
    print("after")
    assert capfd.readouterr().out == "before\nafter\n"


def test_an_error_gives_standard_output_back(capfd):
    with pytest.raises(RuntimeError), engine_chatter_dropped():
        raise RuntimeError
    print_from_c("after")
    ctypes.CDLL(None).fflush(None)
    assert capfd.readouterr().out == "after\n"
