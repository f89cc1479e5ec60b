"""The workers of a Dask cluster that sees the same files.

Dask gives the task of a lost worker to another one, where it goes on from its
checkpoint; only what it gives up comes back as lost.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from contextlib import contextmanager
from typing import Any

from distributed import Client
from distributed.scheduler import KilledWorker

from biped_common.command_line import CommandError

_CONNECT_S = 10


@contextmanager
def dask(address: str) -> Iterator[Executor]:
    """Connect to the scheduler of a cluster.

    Raises:
        CommandError: no scheduler answers, or its workers have several threads.
    """
    try:
        client = Client(address, timeout=_CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise CommandError(f"--dask {address}: no scheduler answers: {error}") from None
    with client:
        for worker, threads in client.nthreads().items():
            if threads > 1:
                raise CommandError(
                    f"--dask {address}: worker {worker} has {threads} threads, which "
                    "would share one core; start it with --nthreads 1 --nworkers "
                    f"{threads}"
                )
        yield _DaskExecutor(client)


class _DaskExecutor(Executor):
    """Dask's own executor, but for what becomes of losses and cancellation."""

    def __init__(self, client: Client) -> None:
        # What a run returns depends on the files it finds, which Dask cannot see.
        self._executor = client.get_executor(pure=False)

    def submit(
        self, fn: Callable[..., Any], /, *args: Any, **named: Any
    ) -> Future[Any]:
        """Have a function called by a worker."""
        future: Future[Any] = Future()
        self._executor.submit(fn, *args, **named).add_done_callback(
            lambda inner: _pass_on(inner, future)
        )
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Cancel nothing: Dask would cancel what runs, and leave it running.

        What has not begun sees the stop file as soon as it does.
        """


def _pass_on(inner: Future[Any], outer: Future[Any]) -> None:
    try:
        outer.set_result(inner.result())
    except (KilledWorker, CancelledError) as error:
        outer.set_exception(BrokenExecutor(f"Dask: {error}"))
    except Exception as error:
        outer.set_exception(error)
