"""What a process of the graph is called, on whatever machine it runs, and may take."""

import os
import resource
import socket

# Seven times what a node needs. Fast DDS bounds no message that it receives, and the
# generated code makes room for as many elements as a message has bytes.
_MEMORY_BYTES = 2 << 30


def process_name(pid: int | None = None) -> str:
    """Return host and id of a process of this machine; by default, this one's."""
    return f"{socket.gethostname()}:{os.getpid() if pid is None else pid}"


def bound_memory() -> None:
    """Keep a message of a stranger from filling this machine.

    Room beyond the bound is not given: a message that asks for it is dropped, or, where
    the middleware cannot do without, this process ends and the machine lives.
    """
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    bounds = [_MEMORY_BYTES] + [hard] * (hard != resource.RLIM_INFINITY)
    resource.setrlimit(resource.RLIMIT_DATA, (min(bounds), hard))
