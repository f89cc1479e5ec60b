"""How a process shares the machine: priority, cores, memory that stays in RAM."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable
from dataclasses import dataclass

from biped_common.settings import Settings, setting

_MCL_CURRENT, _MCL_FUTURE = 1, 2  # of <sys/mman.h>


@dataclass(frozen=True)
class ProcessorSettings(Settings):
    """What a process asks of the machine; by default, nothing."""

    fifo_priority: int = setting(
        0,
        "",
        "real-time priority (SCHED_FIFO) of all threads; 0: none",
        lower=0,
        upper=99,
    )
    nice: int = setting(
        0,
        "",
        "nice value of all threads, lower comes first; 0: as it was started",
        lower=-20,
        upper=19,
    )
    lock_memory: bool = setting(
        False, "", "keep all memory of the process in RAM (mlockall)"
    )
    cores: tuple[int, ...] = setting(
        (), "", "processor cores to run on; empty: as it was started", lower=0
    )


def claim(settings: ProcessorSettings) -> list[str]:
    """Ask for what the settings say; return in a line each what was refused.

    It holds for the threads that there are, and those that they start later.
    """
    refused: list[str] = []

    def attempt(what: str, act: Callable[[], None]) -> None:
        try:
            act()
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or error
            refused.append(f"{what} refused, goes on without: {reason}")

    if settings.fifo_priority:
        attempt(f"SCHED_FIFO {settings.fifo_priority}", lambda: _fifo(settings))
    if settings.nice:
        attempt(f"nice {settings.nice}", lambda: _nice(settings))
    if settings.cores:
        words = ", ".join(map(str, settings.cores))
        attempt(f"cores {words}", lambda: _cores(settings))
    if settings.lock_memory:
        attempt("mlockall", _lock_memory)
    return refused


def _threads() -> list[int]:
    return [int(name) for name in os.listdir("/proc/self/task")]


def _fifo(settings: ProcessorSettings) -> None:
    for thread in _threads():
        os.sched_setscheduler(
            thread, os.SCHED_FIFO, os.sched_param(settings.fifo_priority)
        )


def _nice(settings: ProcessorSettings) -> None:
    for thread in _threads():
        os.setpriority(os.PRIO_PROCESS, thread, settings.nice)


def _cores(settings: ProcessorSettings) -> None:
    for thread in _threads():
        os.sched_setaffinity(thread, settings.cores)


def _lock_memory() -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.mlockall(_MCL_CURRENT | _MCL_FUTURE) != 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
