"""Standard output belongs to the project, not to the engine."""

import ctypes
import subprocess
import sys

import pytest

from sim_node.quiet import engine_chatter_dropped


def output_of(program: str) -> str:
    """Return what a program prints on standard output."""
    return subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    ).stdout


def print_from_c(text: str) -> None:
    ctypes.CDLL(None).puts(text.encode())


def test_building_a_world_prints_nothing():
    assert output_of("import sim_node.world as w; w.World().close()") == ""


def test_what_c_prints_meanwhile_is_dropped(capfd):
    with engine_chatter_dropped():
        print_from_c("chatter")
    ctypes.CDLL(None).fflush(None)
    assert capfd.readouterr().out == ""


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
