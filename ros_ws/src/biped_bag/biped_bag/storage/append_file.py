"""An append-only file that loses little: whole flushes, synced to the disk by a thread.

(`biped_common.atomic_file` is for the opposite: a file that counts only when finished.)

What failures do:
    a flush that does not fit on the disk: the file is cut back to the last flush that
        did, hence to a boundary of records, and the error is raised.
    kill -9: what was flushed is in the file.
    power loss: what was flushed before the last sync is in the file.
"""

from __future__ import annotations

import os
import threading
from pathlib import Path


class AppendFile:
    """The stream under an MCAP writer; `write` never fails, `flush` may."""

    def __init__(self, path: Path) -> None:
        """Create the file.

        Args:
            path: must not exist.

        Raises:
            OSError: it does, or cannot be made.
        """
        self._handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o644)
        self._pending = bytearray()
        self._flushed_bytes = 0
        self._sync_due = threading.Event()
        self._closing = False
        self._sync_error: OSError | None = None
        self._syncer = threading.Thread(target=self._sync_on, daemon=True)
        self._syncer.start()

    def write(self, data: bytes) -> int:
        """Append to what the next flush writes."""
        self._pending += data
        return len(data)

    def tell(self) -> int:
        """Return the size of the file, with what is not flushed yet."""
        return self._flushed_bytes + len(self._pending)

    def flush(self) -> None:
        """Hand everything to the operating system and have it synced soon.

        Raises:
            OSError: it does not fit, or an earlier sync failed.
        """
        if self._sync_error is not None:
            raise self._sync_error
        data, self._pending = memoryview(self._pending), bytearray()
        written = 0
        try:
            while written < len(data):
                written += os.write(self._handle, data[written:])
        except OSError:
            os.ftruncate(self._handle, self._flushed_bytes)
            raise
        self._flushed_bytes += written
        self._sync_due.set()

    def close(self) -> None:
        """Sync what was flushed, drop what was not, and close; once is enough."""
        if self._closing:
            return
        self._closing = True
        self._sync_due.set()
        self._syncer.join()
        os.close(self._handle)

    def _sync_on(self) -> None:
        # Whoever flushes never waits for the disk.
        while not self._closing:
            self._sync_due.wait()
            self._sync_due.clear()
            try:
                os.fdatasync(self._handle)
            except OSError as error:
                self._sync_error = error
                return
