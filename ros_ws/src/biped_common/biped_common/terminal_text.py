"""Text from others, made fit for a terminal: nothing in it acts on the screen.

Names, messages and log lines from the graph may hold anything. Escape sequences clear
the screen or set its title; bidi controls show a text in another order than it has.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from typing import Any, cast

# C0, DEL, C1, separators of lines and paragraphs, bidi marks and overrides, surrogates.
_ACTING = re.compile(
    "[\0-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)
_LAYOUT = "\n\t"


def printable(text: str, *, layout: bool = False) -> str:
    r"""Return a text with what acts on a terminal written as escapes, such as \x1b.

    Everything else stays, in whatever script.

    Args:
        text: any.
        layout: newlines and tabs stay; for text whose lines are ours.
    """
    return _ACTING.sub(
        lambda found: (
            found[0] if layout and found[0] in _LAYOUT else ascii(found[0])[1:-1]
        ),
        text,
    )


@contextmanager
def printable_output() -> Iterator[None]:
    """Have `print` write printable text: what acts on a terminal is escaped.

    On standard output and on standard error, whether a terminal, a pipe or a file, so
    that a file that is shown later does no harm either.
    """
    with (
        redirect_stdout(cast(Any, _PrintableStream(sys.stdout))),
        redirect_stderr(cast(Any, _PrintableStream(sys.stderr))),
    ):
        yield


class _PrintableStream:
    """A text stream that escapes what is written to it."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        self._stream.write(printable(text, layout=True))
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
