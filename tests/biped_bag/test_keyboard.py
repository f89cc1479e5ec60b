"""Keys: what a terminal sends for them, and the terminal afterwards."""

import os
import pty
import sys
import termios

import pytest

from biped_bag.keyboard import Key, keyboard, keys_in

UP, DOWN, RIGHT, SPACE = (
    Key.CURSOR_UP,
    Key.CURSOR_DOWN,
    Key.CURSOR_RIGHT,
    Key.SPACE,
)
LISTENER = """
import time
from biped_bag.keyboard import keyboard
with keyboard() as pressed:
    print("ready", flush=True)
    keys = []
    end = time.monotonic() + 30
    while not keys and time.monotonic() < end:
        keys = pressed()
print(keys, flush=True)
"""


@pytest.mark.parametrize(
    ("sent", "keys"),
    [
        (b" ", [SPACE]),
        (b"\x1b[A\x1b[B \x1b[C", [UP, DOWN, SPACE, RIGHT]),
        (b"x\x1b[D\x1b", []),
        (b"", []),
    ],
)
def test_keys_are_found_among_what_is_sent(sent, keys):
    assert keys_in(sent) == keys


def test_without_a_terminal_no_key_is_ever_pressed():
    with open(os.devnull) as nothing:
        before = os.dup(0)
        os.dup2(nothing.fileno(), 0)
        try:
            with keyboard() as pressed:
                assert pressed() == []
        finally:
            os.dup2(before, 0)
            os.close(before)


def test_a_terminal_gives_keys_at_once_and_is_left_as_it_was():
    child, terminal = pty.fork()
    if child == 0:
        os.execv(sys.executable, [sys.executable, "-c", LISTENER])
    before = termios.tcgetattr(terminal)
    said = b""
    while b"ready" not in said:
        said += os.read(terminal, 1000)
    assert not termios.tcgetattr(terminal)[3] & termios.ICANON
    os.write(terminal, b"\x1b[A")
    while b"]" not in said:
        said += os.read(terminal, 1000)
    assert b"[<Key.CURSOR_UP" in said
    assert termios.tcgetattr(terminal)[3] == before[3]
    os.waitpid(child, 0)
    os.close(terminal)
