"""Priority, cores and locked memory: really asked for, and missed without harm."""

import os
import subprocess
import sys

import pytest

from biped_ros.processor import ProcessorSettings

# In a process of its own, since it is for good; one thread is older, one younger.
SCRIPT = """
import os, threading
from biped_ros.processor import ProcessorSettings, claim
from pathlib import Path
gate, ids = threading.Event(), []
def run():
    ids.append(threading.get_native_id())
    gate.wait()
before = threading.Thread(target=run); before.start()
for line in claim({settings!r}):
    print("refused:", line)
after = threading.Thread(target=run); after.start()
ids.append(os.getpid())
print({said})
gate.set()
"""


def said(settings, expression):
    """What an expression of each thread's `id` says after the settings were claimed."""
    script = SCRIPT.format(
        settings=settings, said=f"sorted({{{expression} for id in ids}})"
    )
    return subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
        timeout=60.0,
    ).stdout.splitlines()


def test_by_default_nothing_is_asked_for():
    own = os.getpriority(os.PRIO_PROCESS, 0), os.sched_getscheduler(0)
    found = said(
        ProcessorSettings(),
        "(os.getpriority(os.PRIO_PROCESS, id), os.sched_getscheduler(id))",
    )
    assert found == [str([own])]


def test_all_threads_are_as_nice_as_asked_for():
    value = min(19, os.getpriority(os.PRIO_PROCESS, 0) + 3)
    found = said(ProcessorSettings(nice=value), "os.getpriority(os.PRIO_PROCESS, id)")
    assert found == [str([value])]


def test_all_threads_run_on_the_cores_asked_for():
    core = max(os.sched_getaffinity(0))
    found = said(ProcessorSettings(cores=(core,)), "tuple(os.sched_getaffinity(id))")
    assert found == [str([(core,)])]


def test_all_threads_have_the_priority_asked_for_or_it_is_said_that_they_do_not():
    *refused, found = said(
        ProcessorSettings(fifo_priority=7),
        "(os.sched_getscheduler(id), os.sched_getparam(id).sched_priority)",
    )
    if refused:
        (line,) = refused
        assert line.startswith("refused: SCHED_FIFO 7 refused, goes on without: ")
    else:
        assert found == str([(os.SCHED_FIFO, 7)])


def test_memory_is_locked_or_it_is_said_that_it_is_not():
    *refused, found = said(
        ProcessorSettings(lock_memory=True),
        "next(line for line in Path('/proc/self/status').read_text().splitlines() "
        "if line.startswith('VmLck'))",
    )
    if refused:
        (line,) = refused
        assert line.startswith("refused: mlockall refused, goes on without: ")
    else:
        assert " 0 kB" not in found


@pytest.mark.parametrize("core", [1023, 10**9, 2**40])
def test_a_core_that_is_not_there_is_refused_and_the_process_goes_on(core):
    line, found = said(ProcessorSettings(cores=(core,)), "0")
    assert line.startswith(f"refused: cores {core} refused, goes on without: ")
    assert found == "[0]"
