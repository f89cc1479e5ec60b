"""Runs on other people's engines: whoever is a `concurrent.futures.Executor` will do.

What failures do:
    Ctrl-C or SIGTERM: running runs are kept after the episode under way; nothing is
        begun any more. A second one ends the processes of this machine at once.
    a lost worker: its runs go on from their checkpoints, on a new one; a run that time
        and again takes its worker with it is carried out alone, and then given up.
    a driver that is killed: its processes end with it. Workers of a cluster finish
        what they have; the next driver waits for those runs, as for any other's.
    a run that raises, or whose files are damaged: it is told, the others go on.
"""

from __future__ import annotations

import concurrent.futures as futures
import multiprocessing
import os
import signal
import time
import traceback
import uuid
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from biped_common.errors import BipedError
from biped_common.lifeline import end_with
from biped_lab.run_folder import (
    CHECKPOINT_EVERY_S,
    Cost,
    RunError,
    TakenError,
    carry_out,
    check_end,
    is_done,
    is_taken,
    read_cost,
)

OpenExecutor = Callable[[], AbstractContextManager[Executor]]
"""Its `shutdown` takes `cancel_futures`, for those that have not begun."""
_WATCH_S = 0.5
_ALONE_AFTER, _GIVEN_UP_AFTER = 2, 3
"""Losses of a run's worker in a row, without an episode kept in between."""


class Failure(NamedTuple):
    """A run that could not be carried out."""

    folder: Path
    reason: str


# -- the one code path ----------------------------------------------------------------


@dataclass(frozen=True)
class Driver:
    """Who has runs carried out, and how."""

    open_executor: OpenExecutor
    """Opens what carries them out; anew when workers are lost."""
    stop_file: Path
    """Made to tell workers that they have to stop; all see it. See `new_stop_file`."""
    stop_asked: Callable[[], bool]
    watch: Callable[[], None]
    """Called now and then."""
    per_job: int = 1
    """Runs that one job of the executor carries out, one after the other."""
    checkpoint_every_s: float = CHECKPOINT_EVERY_S
    """What a run loses at most with its worker."""

    def carry_out_all(self, folders: Sequence[Path]) -> list[Failure]:
        """Carry out all runs that are not done; wait for those of other drivers.

        Args:
            folders: of the runs, in the order in which they are begun.
        """
        failures = _damaged(folders)
        losses: Counter[Path] = Counter()
        while not self.stop_asked():
            before = _standings(folders, failures)
            free = [folder for folder in before if not is_taken(folder)]
            if free:
                jobs = [f for f in free if losses[f] < _ALONE_AFTER] or free[:1]
                lost = self._round(jobs, failures)
                _count(lost, before, losses, failures)
            elif before:
                self.watch()
                time.sleep(_WATCH_S)
            else:
                break
        self.stop_file.unlink(missing_ok=True)
        return list(failures.values())

    def _round(
        self, folders: Sequence[Path], failures: dict[Path, Failure]
    ) -> dict[Path, str]:
        """Have each run carried out once; return those whose workers were lost."""
        lost: dict[Path, str] = {}
        waiting: dict[Future[list[Failure]], Sequence[Path]] = {}
        with self.open_executor() as executor:
            try:
                for n in range(0, len(folders), self.per_job):
                    job = folders[n : n + self.per_job]
                    waiting[self._submit(executor, job)] = job
                while waiting:
                    futures.wait(waiting, timeout=_WATCH_S)
                    if self.stop_asked() and not self.stop_file.exists():
                        self._stop(executor)
                    for future in [future for future in waiting if future.done()]:
                        _take_note(future, waiting.pop(future), failures, lost)
                    self.watch()
            except BaseException:
                self._stop(executor)
                raise
        return lost

    def _submit(self, executor: Executor, job: Sequence[Path]) -> Future[list[Failure]]:
        try:
            return executor.submit(
                carry_out_job, job, self.stop_file, self.checkpoint_every_s
            )
        except futures.BrokenExecutor as error:  # by a job before this one
            broken: Future[list[Failure]] = Future()
            broken.set_exception(error)
            return broken

    def _stop(self, executor: Executor) -> None:
        self.stop_file.touch()
        executor.shutdown(wait=False, cancel_futures=True)


def new_stop_file(folder: Path) -> Path:
    """Return a name for a driver's stop file in the laboratory's folder.

    Those of drivers that were killed are removed; who is just stopping makes his again.
    """
    for left_behind in folder.glob(".stop-*"):
        left_behind.unlink(missing_ok=True)
    return folder / f".stop-{uuid.uuid4().hex}"


def carry_out_job(
    folders: Sequence[Path], stop_file: Path, checkpoint_every_s: float
) -> list[Failure]:
    """Carry out some runs, one after the other; what a worker does."""
    failures = []
    for folder in folders:
        try:
            if not carry_out(folder, stop_file.exists, checkpoint_every_s):
                break
        except TakenError:
            continue  # by another driver's worker, who may leave it unfinished
        except Exception as error:
            failures.append(Failure(folder, _in_words(error)))
    return failures


def _damaged(folders: Sequence[Path]) -> dict[Path, Failure]:
    """Return which runs are done, but not readable any more."""
    failures = {}
    for folder in filter(is_done, folders):
        try:
            check_end(folder)
        except RunError as error:
            failures[folder] = Failure(folder, str(error))
    return failures


def _standings(
    folders: Sequence[Path], failures: dict[Path, Failure]
) -> dict[Path, Cost]:
    """Return what the runs that are neither done nor failed have taken so far."""
    standings = {}
    for folder in dict.fromkeys(folders):
        if folder not in failures and not is_done(folder):
            try:
                standings[folder] = read_cost(folder)
            except RunError as error:
                failures[folder] = Failure(folder, str(error))
    return standings


def _take_note(
    future: Future[list[Failure]],
    job: Sequence[Path],
    failures: dict[Path, Failure],
    lost: dict[Path, str],
) -> None:
    try:
        failures.update({failure.folder: failure for failure in future.result()})
    except futures.CancelledError:
        pass
    except futures.BrokenExecutor as error:
        lost.update(dict.fromkeys(job, str(error)))
    except Exception as error:
        reason = _in_words(error)
        failures.update({folder: Failure(folder, reason) for folder in job})


def _count(
    lost: dict[Path, str],
    before: dict[Path, Cost],
    losses: Counter[Path],
    failures: dict[Path, Failure],
) -> None:
    """Count losses of workers that brought nothing; give up what is hopeless.

    One lost process takes all of its pool with it. Its run is among those that had
    begun; if none had, the workers do not get that far.
    """
    after = _standings(list(lost), failures)
    begun = {f for f in after if after[f].sittings > before[f].sittings}
    for folder, cost in after.items():
        if cost.episodes > before[folder].episodes:
            losses[folder] = 0
        elif folder in begun or not begun:
            losses[folder] += 1
        if losses[folder] >= _GIVEN_UP_AFTER:
            reason = (
                f"its worker was lost {losses[folder]} times and nothing came of it; "
                f"was it killed for its memory? ({lost[folder]})"
            )
            failures[folder] = Failure(folder, reason)


def _in_words(error: Exception) -> str:
    """Return an error in one line; one that nobody foresaw, with its place."""
    if isinstance(error, BipedError):
        return str(error)
    words = " ".join(f"{type(error).__name__}: {error}".split())
    if isinstance(error, OSError):
        return words
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"{words} ({Path(frame.filename).name}, line {frame.lineno})"


# -- processes of this machine --------------------------------------------------------


@contextmanager
def processes(workers: int) -> Iterator[Executor]:
    """Open a pool of processes on this machine, which end with this one."""
    others = multiprocessing.active_children()
    pool = _Pool(
        workers,
        multiprocessing.get_context("spawn"),
        initializer=end_with,
        initargs=(os.getpid(), signal.SIGKILL),
    )
    with pool:
        try:
            yield pool
        except BaseException:
            for process in multiprocessing.active_children():
                if process not in others:
                    process.kill()
            raise


class _Pool(ProcessPoolExecutor):
    """Leaves Ctrl-C to this process, from the first moment of a worker on."""

    def submit(
        self, fn: Callable[..., Any], /, *args: Any, **named: Any
    ) -> Future[Any]:
        """Start a worker if need be; it inherits which signals are blocked."""
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return super().submit(fn, *args, **named)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
