"""Keys pressed in the terminal, one by one and without waiting."""

from __future__ import annotations

import os
import select
import termios
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import Enum

_STDIN = 0
_MAX_BYTES = 256


class Key(Enum):
    """Keys that mean something; the value is what a terminal sends."""

    SPACE = b" "
    CURSOR_UP = b"\x1b[A"
    CURSOR_DOWN = b"\x1b[B"
    CURSOR_RIGHT = b"\x1b[C"


def keys_in(sent: bytes) -> list[Key]:
    """Return the keys among what a terminal has sent, in order; others are passed."""
    found = []
    while sent:
        key = next((key for key in Key if sent.startswith(key.value)), None)
        if key is not None:
            found.append(key)
        sent = sent[1 if key is None else len(key.value) :]
    return found


@contextmanager
def keyboard() -> Iterator[Callable[[], list[Key]]]:
    """Give a function that returns the keys pressed since it was last called.

    None ever where standard input is no terminal, and while the process is in the
    background, whose reading would stop it. Ctrl-C stays a signal.
    """
    if not has_keyboard():
        yield list
        return
    before = termios.tcgetattr(_STDIN)
    if _in_foreground():
        tty.setcbreak(_STDIN, termios.TCSANOW)  # keeps what was typed before
    try:
        yield _pressed
    finally:
        if _in_foreground():
            termios.tcsetattr(_STDIN, termios.TCSADRAIN, before)


def has_keyboard() -> bool:
    """Return whether standard input is a terminal."""
    return os.isatty(_STDIN)


def _in_foreground() -> bool:
    # A terminal that has been hung up has no foreground.
    return has_keyboard() and os.tcgetpgrp(_STDIN) == os.getpgrp()


def _pressed() -> list[Key]:
    if not _in_foreground() or not select.select([_STDIN], [], [], 0.0)[0]:
        return []
    return keys_in(os.read(_STDIN, _MAX_BYTES))
