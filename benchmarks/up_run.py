"""`biped up` as people run it: a process, the nodes that it starts, what it leaves."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from biped_bringup.supervisor.supervisor import START_ORDER

SUPERVISOR = "supervisor"
_SHARED_MEMORY = Path("/dev/shm")
_TURN_S = 0.05
_END_S = 60.0


class UpRun:
    """A running `biped up` without a screen."""

    def __init__(self, folder: Path, *options: str) -> None:
        """Start it.

        Args:
            folder: for memory, bags and logs; what is said goes into `up.log`.
            options: of `biped up`, but for --out and --no-view.
        """
        command = [sys.executable, "-m", "biped_bringup.cli.main", "up", "--no-view"]
        command += ["--out", str(folder), *options]
        with (folder / "up.log").open("a") as log:
            self.process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=log
            )

    def processes(self) -> dict[str, int]:
        """Return the ids of the processes that are there now, supervisor first."""
        supervisor = self.process.pid
        found = {SUPERVISOR: supervisor}
        for task in _entries(Path(f"/proc/{supervisor}/task")):
            for child in _text(task / "children").split():
                words = _text(Path(f"/proc/{child}/cmdline")).split("\0")
                for name in START_ORDER:
                    if any(word.endswith(f"{name}.yaml") for word in words):
                        found[name] = int(child)
        return found

    def end(self, number: int) -> int:
        """Send a signal and wait for the end; return the exit status."""
        self.process.send_signal(number)
        return self.process.wait(_END_S)


@contextmanager
def up(folder: Path, *options: str) -> Iterator[UpRun]:
    """Have `biped up` run; at the end of the block it is killed, should it be there."""
    run = UpRun(folder, *options)
    try:
        yield run
    finally:
        run.process.kill()  # its nodes end with it
        run.process.wait(_END_S)


def resident_kb(process: int) -> int | None:
    """Return the memory that a process has taken for itself [kB], None if it is gone.

    Without mapped files: their pages come and go as the system likes.
    """
    for line in _text(Path(f"/proc/{process}/status")).splitlines():
        if line.startswith("RssAnon:"):
            return int(line.split()[1])
    return None


def alive(process: int) -> bool:
    """Return whether a process is there and has not ended."""
    status = _text(Path(f"/proc/{process}/status"))
    return bool(status) and "State:\tZ" not in status


def shared_memory() -> set[str]:
    """Return the names in shared memory."""
    return {file.name for file in _entries(_SHARED_MEMORY)}


def wait_until(condition: Callable[[], bool], timeout_s: float) -> bool:
    """Return whether a condition came true in time."""
    end = time.monotonic() + timeout_s
    while not condition() and time.monotonic() < end:
        time.sleep(_TURN_S)
    return condition()


def _entries(folder: Path) -> list[Path]:
    try:
        return list(folder.iterdir())
    except OSError:
        return []


def _text(file: Path) -> str:
    """Return what is in a file of /proc; nothing where its process has ended."""
    try:
        return file.read_text()
    except OSError:
        return ""
