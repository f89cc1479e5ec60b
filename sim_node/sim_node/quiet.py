"""Keep the engine's chatter out of standard output.

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
    """Send what C code prints meanwhile to nowhere; Python's own streams come back."""
    sys.stdout.flush()
    ctypes.CDLL(None).fflush(None)
    kept = os.dup(1)
    sink = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(sink, 1)
        yield
    finally:
        # C buffers its output; what is left would surface after the switch back.
        ctypes.CDLL(None).fflush(None)
        os.dup2(kept, 1)
        os.close(sink)
        os.close(kept)
