"""What a process of the graph is called, on whatever machine it runs."""

import os
import socket


def process_name(pid: int | None = None) -> str:
    """Return host and id of a process of this machine; by default, this one's."""
    return f"{socket.gethostname()}:{os.getpid() if pid is None else pid}"
