"""A process that does not outlive the one that started it, however that one ended.

It imports next to nothing, so that a new process is bound to its parent at once, not
only after the seconds in which it imports what it is for.
"""

from __future__ import annotations

import ctypes
import os

_PR_SET_PDEATHSIG = 1


def end_with(parent: int, signal_number: int) -> None:
    """Have the kernel send this process a signal when its parent is gone.

    Args:
        parent: its process id; the thread that started this process has to live on.
        signal_number: such as SIGKILL.
    """
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal_number)
    # It may have died before the line above. In a container it may itself be process 1.
    if os.getppid() != parent:
        os._exit(1)
