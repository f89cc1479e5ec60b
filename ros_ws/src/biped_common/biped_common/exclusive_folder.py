"""One run in a folder at a time: a lock that ends with its process, however it ends."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from biped_common.command_line import CommandError

LOCK_FILE = ".lock"


@contextmanager
def exclusive_folder(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder.

    The kernel holds the lock, on LOCK_FILE; the file holds the id of its process. A
    process that is killed leaves the file behind, but not the lock. The file is never
    removed: who has opened it already could lock a file that nobody else finds.

    Args:
        folder: that is there, and can be written to.

    Raises:
        CommandError: another process has it; the text says which.
    """
    with (folder / LOCK_FILE).open("a+") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            raise CommandError(
                f"{folder}: another run is in this folder, process {file.read()}; "
                "take another --out, or wait for its end"
            ) from None
        file.truncate(0)
        file.write(str(os.getpid()))
        file.flush()
        yield
