"""Drivers and workers that are killed, and Ctrl-C: nothing is lost, nothing stays.

Many more kills, at random moments: `python -m benchmarks.lab_kills`.
"""

import json
import os
import signal
import time
from functools import partial
from multiprocessing import active_children
from pathlib import Path

import pytest

from biped_common.command_line import INTERRUPTED
from biped_lab.execution import processes
from biped_lab.run_folder import is_done, read_cost

from .studies import WALKS, carried_out, left_behind, planned

TIMEOUT_S = 300.0


def wait_for(condition):
    """Return whether the condition came true in time."""
    end = time.monotonic() + TIMEOUT_S
    while not condition() and time.monotonic() < end:
        time.sleep(0.01)
    return condition()


def children(process: int) -> list[Path]:
    """The processes that one has started, in /proc."""
    threads = Path(f"/proc/{process}/task").glob("*/children")
    return [Path(f"/proc/{child}") for t in threads for child in t.read_text().split()]


def kept(folder: Path) -> int:
    """Episodes that are kept, of all runs."""
    return sum(read_cost(run).episodes for run in planned(folder, WALKS))


@pytest.fixture
def driver(launch, tmp_path):
    """The command, as soon as it has kept some episodes of a run."""
    (tmp_path / "small.yaml").write_text(json.dumps(WALKS))
    words = "lab run small.yaml --out . --workers 1 --checkpoint-every 0"
    process = launch(*words.split())
    assert wait_for(lambda: kept(tmp_path) > 3)
    return process


@pytest.mark.thorough
def test_a_driver_that_is_killed_takes_its_workers_with_it_and_goes_on(
    driver, tmp_path, is_the_same
):
    workers = children(driver.pid)
    driver.kill()
    assert wait_for(lambda: not any(worker.exists() for worker in workers))
    assert not all(map(is_done, planned(tmp_path, WALKS)))
    carried_out(tmp_path, WALKS)
    assert is_the_same(tmp_path)
    assert left_behind(tmp_path) == []


@pytest.mark.thorough
def test_ctrl_c_keeps_all_episodes_and_the_study_goes_on(driver, tmp_path, is_the_same):
    for process in (driver.pid, *(int(child.name) for child in children(driver.pid))):
        os.kill(process, signal.SIGINT)  # as a terminal does
    _, said = driver.communicate(timeout=TIMEOUT_S)
    assert driver.returncode == INTERRUPTED
    assert "interrupted; all episodes so far are kept" in said
    assert "Traceback" not in said
    assert left_behind(tmp_path) == []
    carried_out(tmp_path, WALKS)
    assert is_the_same(tmp_path)


@pytest.mark.thorough
def test_a_worker_that_is_killed_is_replaced_and_its_run_goes_on(tmp_path, is_the_same):
    killed = []

    def watch():
        if not killed and kept(tmp_path) > 3:
            killed.extend(active_children())
            killed[0].kill()

    assert carried_out(tmp_path, WALKS, partial(processes, 1), watch=watch) == []
    assert killed
    assert is_the_same(tmp_path)
    assert left_behind(tmp_path) == []
