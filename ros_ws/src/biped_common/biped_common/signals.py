"""Requests to stop: obeyed at once while a program loads, collected while it works."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def loading() -> Iterator[None]:
    """Have SIGINT end the process itself while modules are imported.

    Python makes an exception of it. Libraries that are interrupted while they load have
    swallowed it, so that the program went on, or made an ImportError of it.
    """
    raised = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if raised:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        yield
    finally:
        if raised:
            signal.signal(signal.SIGINT, signal.default_int_handler)


@contextmanager
def stop_requests() -> Iterator[list[int]]:
    """Collect SIGINT and SIGTERM; a second one falls through to the old handler."""
    requests: list[int] = []
    old: dict[int, Any] = {}

    def request(number: int, _: Any) -> None:
        requests.append(number)
        signal.signal(number, old[number])

    for number in (int(signal.SIGINT), int(signal.SIGTERM)):
        old[number] = signal.signal(number, request)
    try:
        yield requests
    finally:
        for number, handler in old.items():
            signal.signal(number, handler)
