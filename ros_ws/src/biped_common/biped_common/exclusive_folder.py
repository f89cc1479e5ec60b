"""One run in a folder at a time: a lock that ends with its process, however it ends."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from biped_common.command_line import CommandError

LOCK_FILE = ".lock"


@contextmanager
def exclusive_folder(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder.

    The kernel holds the lock, on LOCK_FILE; the file holds the id of its process. A
    process that is killed leaves the file behind, but not the lock.

    Args:
        folder: that is there, and can be written to.

    Raises:
        CommandError: another process has it; the text says which.
    """
    path = folder / LOCK_FILE
    with _locked(path) as file:
        file.truncate(0)
        file.write(str(os.getpid()))
        file.flush()
        try:
            yield
        finally:
            path.unlink(missing_ok=True)


def _locked(path: Path) -> IO[str]:
    """Return the file, locked, and still the one of this name."""
    while True:
        file = path.open("a+")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            with file:
                file.seek(0)
                raise CommandError(
                    f"{path.parent}: another run is in this folder, process "
                    f"{file.read()}; take another --out, or wait for its end"
                ) from None
        # Its holder may have removed it between the two lines above.
        if os.fstat(file.fileno()).st_nlink:
            return file
        file.close()
