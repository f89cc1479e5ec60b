"""A display that is redrawn on a terminal, and is not there elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import TracebackType
from typing import TypeVar

from rich.console import Console, RenderableType
from rich.live import Live

_Display = TypeVar("_Display", bound="LiveDisplay")
_REDRAWN_HZ = 4.0


class LiveDisplay:
    """Base of what commands show while they run.

    Elsewhere than on a terminal there is nothing to redraw: `due` then says when it is
    time for another plain line.
    """

    def __init__(self, console: Console, live: bool, plain_interval_s: float) -> None:
        """Prepare; show nothing yet.

        Args:
            console: to write to.
            live: redraw, if the console is a terminal.
            plain_interval_s: between plain lines.
        """
        self.console = console
        self._interval_s = plain_interval_s
        self._shown = time.monotonic()
        self._live = (
            Live(console=console, refresh_per_second=_REDRAWN_HZ)
            if live and console.is_terminal
            else None
        )

    def __enter__(self: _Display) -> _Display:
        """Start to show."""
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave the last state on the screen."""
        if self._live is not None:
            self._live.stop()

    def redraw(self, content: Callable[[], RenderableType]) -> bool:
        """Redraw the display; return whether there is one."""
        if self._live is None:
            return False
        self._live.update(content())
        return True

    def due(self) -> bool:
        """Return whether it is time for a plain line, and count from now if so."""
        now = time.monotonic()
        if now - self._shown < self._interval_s:
            return False
        self._shown = now
        return True
