"""Jobs of a SLURM cluster that sees the same files, by submitit.

submitit writes the batch script and carries function and result to and fro as files.
Whether a job is still there is asked of `squeue`, which every cluster has, for all jobs
at once; submitit itself would ask the accounting (`sacct`), which not every one has.

A job that is pre-empted, reaches its time limit or loses its node ends without a
result. Its runs are submitted again, and go on from their checkpoints.
"""

from __future__ import annotations

import signal
import subprocess
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import submitit
from submitit.core.utils import FailedJobError, FailedSubmissionError

from biped_common.command_line import CommandError

_LOOK_FOR_RESULTS_S = 1.0
_ASK_SQUEUE_S = 10.0
_SLURM_ANSWERS_S = 60.0


@contextmanager
def slurm(
    folder: Path, partition: str | None, minutes: int, options: Mapping[str, str]
) -> Iterator[Executor]:
    """Open the way to the SLURM cluster of this machine.

    Args:
        folder: for logs and what goes to and fro; all nodes see it.
        partition: None is the cluster's default.
        minutes: time limit of a job [min].
        options: of `sbatch`, by their long names.

    Raises:
        CommandError: this is no machine of a cluster.
    """
    try:
        jobs = submitit.SlurmExecutor(folder)
    except RuntimeError as error:
        raise CommandError(f"--slurm: {error}") from None
    jobs.update_parameters(
        job_name="biped-lab",
        partition=partition,
        time=minutes,
        ntasks_per_node=1,
        cpus_per_task=1,
        # One way to go on is enough: what was lost is submitted again.
        additional_parameters={"no-requeue": True, **options},
    )
    executor = _SlurmExecutor(jobs)
    try:
        yield executor
    finally:
        executor.shutdown(wait=True, cancel_futures=True)


class _SlurmExecutor(Executor):
    """Futures of jobs, completed by a thread that looks for results."""

    def __init__(self, jobs: submitit.SlurmExecutor) -> None:
        self._jobs = jobs
        self._pending: dict[str, tuple[submitit.Job[Any], Future[Any]]] = {}
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)
        self._thread.start()

    def submit(
        self, fn: Callable[..., Any], /, *args: Any, **named: Any
    ) -> Future[Any]:
        """Submit a job that calls a function.

        Raises:
            CommandError: `sbatch` refuses it.
        """
        try:
            job = self._jobs.submit(_in_job, fn, *args, **named)
        except (FailedJobError, FailedSubmissionError) as error:
            words = " ".join(str(error).split())
            raise CommandError(f"--slurm: sbatch refuses: {words}") from None
        future: Future[Any] = Future()
        self._pending[job.job_id] = (job, future)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Take jobs that have not begun out of the queue; look for no more results."""
        if cancel_futures and self._pending:
            _ask("scancel", "--state=PENDING", *self._pending)
            for job, future in self._gone():
                if self._settles(job):
                    future.cancel()
        if wait:
            self._over.set()
            self._thread.join()

    def _look(self) -> None:
        try:
            self._complete_futures()
        except Exception as error:  # such as of a file system that is away
            for job, future in list(self._pending.values()):
                if self._settles(job):
                    future.set_exception(BrokenExecutor(str(error)))

    def _complete_futures(self) -> None:
        missed: set[str] = set()
        asked = time.monotonic()
        while not self._over.wait(_LOOK_FOR_RESULTS_S):
            for job, future in list(self._pending.values()):
                if job.paths.result_pickle.exists() and self._settles(job):
                    _complete(job, future)
            if self._pending and time.monotonic() - asked >= _ASK_SQUEUE_S:
                gone = self._gone()
                for job, future in gone:
                    # Twice, since a result may take a while to be seen.
                    if job.job_id in missed and self._settles(job):
                        future.set_exception(
                            BrokenExecutor(
                                f"job {job.job_id} ended early; log: {job.paths.stderr}"
                            )
                        )
                missed, asked = {job.job_id for job, _ in gone}, time.monotonic()

    def _settles(self, job: submitit.Job[Any]) -> bool:
        """Take a job out; return whether no other thread has done so before."""
        return self._pending.pop(job.job_id, None) is not None

    def _gone(self) -> list[tuple[submitit.Job[Any], Future[Any]]]:
        """Return whose jobs neither wait nor run, as far as SLURM says."""
        pending = list(self._pending.values())
        there = _ask("squeue", "--me", "--noheader", "--format=%i")
        if there is None:
            return []
        return [each for each in pending if each[0].job_id not in there.split()]


def _ask(*command: str) -> str | None:
    """Return what SLURM says; None if it is busy, or just being started again."""
    try:
        asked = subprocess.run(
            command, timeout=_SLURM_ANSWERS_S, capture_output=True, text=True
        )
    except subprocess.TimeoutExpired:
        return None
    return asked.stdout if asked.returncode == 0 else None


def _complete(job: submitit.Job[Any], future: Future[Any]) -> None:
    try:
        future.set_result(job.result())
    except Exception:  # what it was stands in the log
        future.set_exception(
            CommandError(f"job {job.job_id} failed; log: {job.paths.stderr}")
        )
    # Job numbers may begin anew; no result is to be taken for a later job's.
    job.paths.result_pickle.unlink(missing_ok=True)
    job.paths.submitted_pickle.unlink(missing_ok=True)


def _in_job(fn: Callable[..., Any], *args: Any, **named: Any) -> Any:
    """Call a function, without submitit's own answers to SLURM's signals.

    It would submit the job again itself, under an old number; and shortly before the
    time limit it would raise in the middle of a run.
    """
    signal.signal(signal.SIGUSR2, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    return fn(*args, **named)
