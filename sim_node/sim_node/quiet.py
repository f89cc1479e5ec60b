"""Keep the engine's chatter out of standard output and error.

PyBullet prints from C on import and on some calls, which would spoil output that
scripts read.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def engine_chatter_dropped() -> Iterator[None]:
    """Send what C code prints meanwhile to nowhere; both streams come back."""
    _flush()
    kept = {stream: os.dup(stream) for stream in (1, 2)}
    sink = os.open(os.devnull, os.O_WRONLY)
    try:
        for stream in kept:
            os.dup2(sink, stream)
        yield
    finally:
        # C buffers its output; what is left would surface after the switch back.
        _flush()
        os.close(sink)
        for stream, copy in kept.items():
            os.dup2(copy, stream)
            os.close(copy)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:  # closed by whoever started the process
            stream.flush()
    ctypes.CDLL(None).fflush(None)
