"""A bag written by a thread of its own, so that receiving never waits for the disk.

What failures do:
    the disk is full, or too slow to keep up for long: the thread ends, `error` says
        why, and what is put in afterwards is dropped; the bag stays as its writer says.
    kill -9: costs what came since the last flush, 0.1 s ago or less.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from queue import Empty, SimpleQueue

from biped_bag.errors import BagError
from biped_bag.storage.contents import BagMessage
from biped_bag.storage.writer import BagWriter

_FLUSH_PERIOD_S = 0.1
# About two minutes of all topics at 500 Hz.
_LARGEST_BACKLOG_BYTES = 256 * 1024 * 1024

Job = Callable[[BagWriter], object]


class WriterThread:
    """Writes one bag; its methods never block but for `close`."""

    def __init__(self, writer: BagWriter) -> None:
        """Start the thread; from now on only it touches the writer.

        Args:
            writer: of the bag.
        """
        self.error: BagError | None = None
        self.writer = writer
        """Not to be touched before `close`."""
        self._jobs: SimpleQueue[Job | None] = SimpleQueue()
        # Each is counted by one thread only.
        self._bytes_in = 0
        self._bytes_out = 0
        self._thread = threading.Thread(target=self._run, name="bag", daemon=True)
        self._thread.start()

    def do(self, job: Job) -> None:
        """Have something done with the writer, after all that was put in before."""
        if self.error is None:
            self._jobs.put(job)

    def put(self, messages: Sequence[BagMessage]) -> None:
        """Have messages written, in this order."""
        if not messages:
            return
        size = sum(len(message.data) for message in messages)

        def write(writer: BagWriter) -> None:
            for message in messages:
                writer.write(message)
            self._bytes_out += size

        self._bytes_in += size
        self.do(write)
        if self._bytes_in - self._bytes_out > _LARGEST_BACKLOG_BYTES:
            self.error = self.error or BagError(
                f"{self.writer.folder}: the disk is too slow, "
                f"{_LARGEST_BACKLOG_BYTES >> 20} MiB wait to be written"
            )

    def close(self, custom: Mapping[str, str]) -> None:
        """Write everything that was put in and finish the bag.

        Args:
            custom: remarks for `metadata.yaml`.
        """
        self._jobs.put(None)
        self._thread.join()
        try:
            self.writer.close(custom)
        except BagError as error:
            self.error = self.error or error

    def _run(self) -> None:
        try:
            self._write_on()
        except BagError as error:
            self.error = error
        except Exception as error:
            # Whatever it is, a recorder that writes nothing must not look like one.
            self.error = BagError(f"{self.writer.folder}: {error!r}")
            raise

    def _write_on(self) -> None:
        flush_at = time.monotonic() + _FLUSH_PERIOD_S
        written = False
        while self.error is None:
            try:
                job = self._jobs.get(timeout=max(0.0, flush_at - time.monotonic()))
            except Empty:
                pass
            else:
                if job is None:
                    return
                job(self.writer)
                written = True
            if time.monotonic() >= flush_at:
                if written:
                    self.writer.flush()
                written = False
                flush_at = time.monotonic() + _FLUSH_PERIOD_S
