"""Processes that die, stall or are not wanted: the run goes on, or ends in order."""

import os
import signal
import subprocess
import sys
import threading
import time

import pytest
from tests.thorough import first_always

from biped_bringup.node_parameters import node_parameters
from biped_bringup.run_settings import load_settings
from biped_bringup.supervisor.restart_budget import RestartBudget
from biped_bringup.supervisor.supervisor import (
    NodeFailureError,
    Patience,
    Supervisor,
)
from biped_ros.environment import node_environment
from learner_node.checkpoint import read_checkpoint

SEED = 5
TIMEOUT_S = 90.0


def parameters(folder, **changes):
    """Return parameters of nodes that notice silence soon."""
    return node_parameters(
        load_settings("quick"),
        SEED,
        checkpoint_file=str(folder / "memory.npz"),
        publish_every_ticks=10,
        timeout_s=1.0,
        listen_s=0.5,
        **changes,
    ).flat()


class Graph:
    """A supervisor in a thread of the test."""

    def __init__(self, folder, domain, values=None, patience=None):
        self.lines = []
        self.supervisor = Supervisor(
            values or parameters(folder),
            node_environment(domain, "LOCALHOST"),
            folder,
            lambda who, line: self.lines.append(f"[{who}] {line}"),
            patience,
        )
        self.failure = None
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def __repr__(self):
        """Return what was said last, for failures of tests."""
        return "\n".join(self.lines[-30:])

    def _run(self):
        try:
            self.supervisor.run(lambda: False, self._stopped.is_set)
        except NodeFailureError as error:
            self.failure = error

    def wait_for(self, condition):
        """Return whether the condition came true in time."""
        end = time.monotonic() + TIMEOUT_S
        while time.monotonic() < end and not condition():
            time.sleep(0.05)
        return condition()

    def walks(self, more):
        """Return whether so many more walks of the learner ended in time."""
        before = self.supervisor.graph.results
        return self.wait_for(lambda: self.supervisor.graph.results >= before + more)

    def stop(self):
        """End everything."""
        self._stopped.set()
        self._thread.join()
        self.supervisor.stop()


@pytest.fixture
def graph(tmp_path, domain):
    """Return a graph on which walks are being walked."""
    graph = Graph(tmp_path, domain)
    try:
        assert graph.walks(2)
        yield graph
    finally:
        graph.stop()


@pytest.mark.parametrize(
    "name", first_always(["learner_node", "sim_node", "trajectory_node"])
)
def test_after_a_node_was_killed_walks_go_on(graph, name):
    child = graph.supervisor.children[name]
    os.kill(child.pid, signal.SIGKILL)
    assert graph.wait_for(lambda: child.starts == 2)
    assert graph.walks(3)


def test_a_killed_learner_goes_on_from_its_checkpoint(graph, tmp_path):
    memory = tmp_path / "memory.npz"
    assert graph.wait_for(memory.exists)
    os.kill(graph.supervisor.children["learner_node"].pid, signal.SIGKILL)
    saved = read_checkpoint(memory)[1]["memory/episode"]
    graph.supervisor.graph.status = None
    assert graph.wait_for(lambda: graph.supervisor.graph.status is not None)
    assert graph.supervisor.graph.status.episodes >= saved


@pytest.mark.thorough
def test_a_learner_that_stalls_for_two_seconds_is_not_restarted(graph):
    child = graph.supervisor.children["learner_node"]
    os.kill(child.pid, signal.SIGSTOP)
    time.sleep(2.0)
    os.kill(child.pid, signal.SIGCONT)
    assert graph.walks(3)
    assert child.starts == 1


@pytest.mark.thorough
def test_a_node_without_a_heartbeat_is_killed_and_started_anew(tmp_path, domain):
    graph = Graph(tmp_path, domain, patience=Patience(silence_s=10.0))
    try:
        assert graph.walks(1)
        child = graph.supervisor.children["trajectory_node"]
        os.kill(child.pid, signal.SIGSTOP)
        assert graph.wait_for(lambda: child.starts >= 2)
        assert any("trajectory_node has been silent" in line for line in graph.lines)
        assert graph.walks(2)
    finally:
        graph.stop()


def test_the_silent_peer_is_reported(graph):
    child = graph.supervisor.children["learner_node"]
    os.kill(child.pid, signal.SIGSTOP)
    reported = graph.wait_for(lambda: any("silent" in line for line in graph.lines))
    os.kill(child.pid, signal.SIGCONT)
    assert reported


@pytest.mark.thorough
def test_a_second_learner_is_refused(graph, processes, tmp_path):
    folder = tmp_path / "second"
    folder.mkdir()
    second = processes("learner_node.node", parameters(folder)["learner_node"])
    assert second.wait(TIMEOUT_S) == 4
    assert graph.walks(2)


def test_a_node_that_keeps_dying_ends_the_run(tmp_path, domain):
    graph = Graph(tmp_path, domain)
    child = graph.supervisor.children["trajectory_node"]

    def given_up_after_another_death():
        child.signal(signal.SIGKILL)
        return graph.failure is not None

    try:
        assert graph.wait_for(given_up_after_another_death)
        assert "trajectory_node died too often" in str(graph.failure)
        assert child.starts == RestartBudget().limit
    finally:
        graph.stop()


def test_a_node_that_cannot_be_what_is_asked_for_is_not_started_again(tmp_path, domain):
    values = parameters(tmp_path)
    values["trajectory_node"]["gait.step_length_m"] = 0.45
    graph = Graph(tmp_path, domain, values)
    try:
        assert graph.wait_for(lambda: graph.failure is not None)
        assert "trajectory_node cannot start: the robot cannot walk this gait" in str(
            graph.failure
        )
        assert graph.supervisor.children["trajectory_node"].starts == 1
    finally:
        graph.stop()


@pytest.mark.thorough
def test_in_real_time_a_learner_that_stalls_does_not_stop_the_robot(tmp_path, domain):
    graph = Graph(tmp_path, domain, parameters(tmp_path, pace="realtime"))
    try:
        assert graph.walks(1)
        child = graph.supervisor.children["learner_node"]
        os.kill(child.pid, signal.SIGSTOP)
        time.sleep(2.0)
        os.kill(child.pid, signal.SIGCONT)
        assert graph.walks(2)
        assert child.starts == 1
    finally:
        graph.stop()


@pytest.mark.parametrize("after_s", first_always([2.0, 0.3, 1.0, 4.0, 8.0]))
def test_ctrl_c_ends_all_at_every_stage_of_the_start(tmp_path, domain, after_s):
    process = subprocess.Popen(
        [sys.executable, "-m", "biped_bringup.cli.main", "up", "--preset", "quick",
         "--domain", str(domain), "--no-view", "--out", str(tmp_path)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )  # fmt: skip
    time.sleep(after_s)
    process.send_signal(signal.SIGINT)
    status = process.wait(TIMEOUT_S)
    # Before Python runs the program's own code, the signal itself ends it.
    assert status in (130, -signal.SIGINT)
    assert not node_processes(tmp_path)


def node_processes(folder):
    """Return command lines of processes that were started with files of this folder."""
    listing = subprocess.run(
        ["ps", "-eo", "args"], capture_output=True, text=True, check=True
    )
    return [line for line in listing.stdout.splitlines() if f"{folder}/" in line]
