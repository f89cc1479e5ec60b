"""One node as a child process: its start, its log, its end.

What failures do:
    the log cannot be written (disk full): `log_failure` says why, and it ends there.
        What the process prints is read and shown all the same: a process whose output
        nobody reads stops when the pipe is full.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import IO

from biped_common.lifeline import end_with


class Child:
    """A node's process; started, watched and ended by the supervisor."""

    def __init__(
        self,
        name: str,
        module: str,
        arguments: Sequence[str],
        environment: Mapping[str, str],
        log_file: Path,
        show: Callable[[str, str], None],
    ) -> None:
        """Prepare; start nothing yet.

        Args:
            name: of the node.
            module: that runs it.
            arguments: of the module.
            environment: of the process.
            log_file: takes everything that the process prints.
            show: told (name, line) of everything that the process prints.
        """
        self.name = name
        self.starts = 0
        self.last_line = ""
        """What it printed last."""
        self.log_failure: str | None = None
        """Why the log ends before the process does."""
        self._command = [sys.executable, "-m", module, *arguments]
        self._environment = dict(environment)
        self._log_file = log_file
        self._show = show
        self._process: subprocess.Popen[str] | None = None
        self._reader: threading.Thread | None = None

    @property
    def pid(self) -> int | None:
        """Process id while it runs."""
        return self._process.pid if self.running and self._process else None

    @property
    def running(self) -> bool:
        """Whether the process is there."""
        return self._process is not None and self._process.poll() is None

    @property
    def exit_status(self) -> int | None:
        """How the last process ended: its status, or minus the signal."""
        return None if self._process is None else self._process.poll()

    def start(self) -> int:
        """Start the process, in a session of its own, since Ctrl-C is the supervisor's.

        Returns:
            Its process id.
        """
        self.starts += 1
        self._process = subprocess.Popen(
            self._command,
            env=self._environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            start_new_session=True,
            preexec_fn=partial(end_with, os.getpid(), signal.SIGTERM),
        )
        assert self._process.stdout is not None
        self._reader = threading.Thread(
            target=self._read, args=(self._process.stdout,), daemon=True
        )
        self._reader.start()
        return self._process.pid

    def signal(self, number: signal.Signals) -> None:
        """Send a signal, if there is a process to take it."""
        if self.running and self._process is not None:
            self._process.send_signal(number)

    def wait(self, timeout_s: float) -> bool:
        """Wait for the process to end; return whether it did."""
        if self._process is None:
            return True
        try:
            self._process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            return False
        if self._reader is not None:
            self._reader.join(timeout_s)
        return True

    def _read(self, stream: IO[str]) -> None:
        self._log("")  # one that cannot be written is known at once
        with stream:
            for line in stream:
                self._log(line)
                self.last_line = line.strip() or self.last_line
                with suppress(OSError):  # nobody looks any more
                    self._show(self.name, line.rstrip())

    def _log(self, line: str) -> None:
        if self.log_failure is not None:
            return
        try:
            with self._log_file.open("a") as log:
                log.write(line)
        except OSError as error:
            self.log_failure = f"{self._log_file}: {error.strerror}"
