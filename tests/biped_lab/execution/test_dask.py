"""A Dask cluster of other processes on this machine, on the loopback only."""

import json
import os
import signal
import subprocess
import sys
import time
from functools import partial

import pytest

from biped_common.command_line import CommandError
from biped_common.exclusive_folder import LOCK_FILE
from biped_lab.dask_cluster import dask
from biped_lab.run_folder import is_done, is_taken, read_cost

from .studies import WALKS, carried_out, left_behind, planned

TIMEOUT_S = 300.0


class Cluster:
    """A scheduler and its workers."""

    def __init__(self, folder):
        self.folder = folder
        self.processes = []
        self._start("scheduler", "--port", "0", "--no-dashboard")
        self.address = json.loads(self._when_written().read_text())["address"]

    def _when_written(self):
        file = self.folder / "scheduler.json"
        end = time.monotonic() + TIMEOUT_S
        while not file.exists() and time.monotonic() < end:
            time.sleep(0.1)
        return file

    def _start(self, program, *options):
        words = [sys.executable, "-m", "dask", program, "--host", "127.0.0.1"]
        words += ["--scheduler-file", "scheduler.json", *options]
        log = (self.folder / f"{program}.log").open("a")
        process = subprocess.Popen(words, cwd=self.folder, stdout=log, stderr=log)
        self.processes.append(process)
        return process

    def start_worker(self, threads=1):
        options = ["--nthreads", str(threads), "--no-nanny", "--no-dashboard"]
        return self._start("worker", *options)

    def end(self):
        for process in reversed(self.processes):
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    made = Cluster(tmp_path_factory.mktemp("dask"))
    yield made
    made.end()


def connect(address):
    """Connect to a cluster, and leave it at once."""
    with dask(address):
        pass


@pytest.mark.thorough
def test_a_cluster_carries_a_study_out_though_a_worker_is_killed_in_the_middle(
    cluster, tmp_path, is_the_same
):
    runs = planned(tmp_path, WALKS)
    workers = [cluster.start_worker(), cluster.start_worker()]

    def watch():
        unharmed = all(worker.poll() is None for worker in workers)
        if unharmed and is_taken(runs[0]) and read_cost(runs[0]).episodes > 3:
            os.kill(int((runs[0] / LOCK_FILE).read_text()), signal.SIGKILL)

    failures = carried_out(tmp_path, WALKS, partial(dask, cluster.address), watch=watch)
    assert failures == []
    assert [worker.poll() for worker in workers].count(None) == 1
    assert read_cost(runs[0]).sittings == 2
    assert is_the_same(tmp_path)
    assert left_behind(tmp_path) == []


@pytest.mark.thorough
def test_a_stopped_study_leaves_no_run_going_on_in_a_cluster(cluster, tmp_path):
    cluster.start_worker()
    study = WALKS | {"goal": "schedule", "settings": {}, "most_episodes": 1_000}
    runs = planned(tmp_path, study)
    carried_out(
        tmp_path,
        study,
        partial(dask, cluster.address),
        stop_asked=lambda: any(read_cost(run).episodes > 0 for run in runs),
    )
    assert not any(map(is_taken, runs))
    assert not any(map(is_done, runs))


@pytest.mark.thorough
def test_workers_of_several_threads_are_refused(cluster):
    cluster.start_worker(threads=2)
    with pytest.raises(CommandError, match="start it with --nthreads 1 --nworkers 2"):
        for _ in range(1_000):  # it may take a while to join the cluster
            connect(cluster.address)


def test_a_scheduler_that_does_not_answer_is_told(monkeypatch):
    monkeypatch.setattr("biped_lab.dask_cluster._CONNECT_S", 0.5)
    with pytest.raises(CommandError, match="no scheduler answers"):
        connect("tcp://127.0.0.1:1")
