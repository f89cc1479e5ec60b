"""Requests to stop, collected instead of obeyed at once."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


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
