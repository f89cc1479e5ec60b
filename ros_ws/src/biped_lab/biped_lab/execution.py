"""Runs on other people's engines: whoever is a `concurrent.futures.Executor` will do.

What failures do:
    Ctrl-C or SIGTERM: running runs are kept after the episode under way; nothing is
        begun any more.
    a lost worker: its runs go on from their checkpoints, on a new one.
    a driver that is killed: its workers end with it; started again, it goes on.
    a run that raises: it is told, the others go on.
"""

from __future__ import annotations

import concurrent.futures as futures
import ctypes
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import NamedTuple

from biped_common.command_line import CommandError
from biped_common.errors import BipedError
from biped_lab.run_folder import carry_out, is_done, read_cost

OpenExecutor = Callable[[], AbstractContextManager[Executor]]
_PR_SET_PDEATHSIG = 1
_WATCH_S = 0.5
_FRUITLESS_ROUNDS = 3


class Failure(NamedTuple):
    """A run that could not be carried out."""

    folder: Path
    reason: str


# -- the one code path ----------------------------------------------------------------


def carry_out_all(
    folders: Sequence[Path],
    open_executor: OpenExecutor,
    stop_file: Path,
    stop_asked: Callable[[], bool],
    watch: Callable[[], None],
    per_job: int = 1,
) -> list[Failure]:
    """Carry out all runs that are not done.

    Args:
        folders: of the runs, in the order in which they are begun.
        open_executor: opens what carries them out; anew when workers are lost.
        stop_file: made to tell workers that they have to stop; all see this file.
        stop_asked: whether to stop.
        watch: called now and then.
        per_job: runs that one job of the executor carries out, one after the other.
    """
    failures: dict[Path, Failure] = {}
    fruitless, before = 0, _progress(folders)
    while pending := [f for f in folders if not is_done(f) and f not in failures]:
        jobs = [pending[n : n + per_job] for n in range(0, len(pending), per_job)]
        with open_executor() as executor:
            waiting = {
                executor.submit(carry_out_job, job, stop_file): job for job in jobs
            }
            while waiting:
                done, _ = futures.wait(waiting, timeout=_WATCH_S)
                if stop_asked() and not stop_file.exists():
                    stop_file.touch()
                    for future in list(waiting):
                        if future.cancel():
                            del waiting[future]
                for future in done:
                    if future in waiting:
                        _take_note(future, waiting.pop(future), failures)
                watch()
        if stop_asked():
            break
        now = _progress(folders)
        fruitless = fruitless + 1 if now == before else 0
        if fruitless == _FRUITLESS_ROUNDS:
            raise CommandError(
                f"workers were lost {fruitless} times and nothing came of it; are "
                "they killed for their memory?"
            )
        before = now
    stop_file.unlink(missing_ok=True)
    return list(failures.values())


def carry_out_job(folders: Sequence[Path], stop_file: Path) -> list[Failure]:
    """Carry out some runs, one after the other; what a worker does."""
    failures = []
    for folder in folders:
        try:
            if not carry_out(folder, stop_file.exists):
                break
        except BipedError as error:
            failures.append(Failure(folder, str(error)))
    return failures


def _take_note(
    future: Future[list[Failure]], job: Sequence[Path], failures: dict[Path, Failure]
) -> None:
    try:
        failures.update({failure.folder: failure for failure in future.result()})
    except futures.CancelledError:
        pass
    except futures.BrokenExecutor:
        pass  # the worker is lost, its runs are not
    except Exception as error:
        if type(error).__name__ == "KilledWorker":  # Dask's word for it
            return
        reason = f"{type(error).__name__}: {error}"
        failures.update({folder: Failure(folder, reason) for folder in job})


def _progress(folders: Sequence[Path]) -> list[tuple[bool, int]]:
    return [(is_done(f), read_cost(f).episodes) for f in folders]


# -- engines --------------------------------------------------------------------------


@contextmanager
def processes(workers: int) -> Iterator[Executor]:
    """Open a pool of processes on this machine, which end with this one."""
    pool = ProcessPoolExecutor(
        workers,
        multiprocessing.get_context("spawn"),
        initializer=_become_worker,
        initargs=(os.getpid(),),
    )
    with pool:
        yield pool


def _become_worker(parent: int) -> None:
    """Leave Ctrl-C to the parent, and do not outlive it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it ended before the line above
        sys.exit(1)


@contextmanager
def dask(address: str) -> Iterator[Executor]:
    """Connect to the scheduler of a Dask cluster that sees the same files.

    Raises:
        CommandError: Dask is not installed, or no scheduler answers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise CommandError(
            "--dask: Dask is not installed; the extra `dask` of this package brings it"
        ) from None
    try:
        client = Client(address, timeout="10s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise CommandError(f"--dask {address}: no scheduler answers: {error}") from None
    with client:
        # What a run returns depends on the files it finds, which Dask cannot see.
        yield client.get_executor(pure=False)
