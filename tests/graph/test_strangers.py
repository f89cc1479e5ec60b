"""Strangers on the graph change no memory and no walk: they are named, and walked past.

Some are programs of another middleware (`foreign.py`), some are what people leave
running by mistake. Each comes while the biped learns, and leaves; then memory and
trajectories must be those of a run that nobody disturbed.
"""

import os
import subprocess
import sys
import threading
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.graph.clients import (
    SEED,
    TIMEOUT_S,
    Client,
    hashes,
    learned_in_process,
    quick,
)
from tests.graph.players import SAMPLE

from biped_bringup.one_executor import OneExecutor
from biped_bringup.run_settings import load_settings
from biped_bringup.training import TrainingRun
from msgs_json import topics

EPISODES = 24
BEFORE = 2
NO_NODE = "a program that is no ROS node"
# Imports first, so that it is on the graph soon after it is told to go.
ON_COMMAND = """
import importlib, runpy, sys
import rclpy
importlib.import_module(sys.argv[1])
print("ready", flush=True)
sys.stdin.readline()
del sys.argv[0]
runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
"""


@pytest.fixture(scope="module")
def undisturbed():
    """Memory and trajectories of a run that nobody disturbed."""
    return learned_in_process(EPISODES)


@contextmanager
def waiting(domain, *command):
    """Have a program wait on a domain for the line that lets it go."""
    process = subprocess.Popen(
        [sys.executable, *command],
        env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    with process:
        try:
            yield process
        finally:
            process.kill()


def foreign(domain, attack):
    return waiting(domain, "-m", "tests.graph.foreign", attack)


def module(domain, *arguments):
    return waiting(domain, "-c", ON_COMMAND, *arguments)


def named(message):
    """What /diagnostics say of those who publish beside an owner."""
    texts = [status.message for status in message.status]
    return " ".join(text for text in texts if "should be by one" in text)


def learned_beside(domain, stranger, name):
    """Learn while a program comes, is named and goes; return the hashes."""
    with (
        stranger as process,
        OneExecutor(quick(max_episodes=EPISODES, timeout_s=5.0), domain) as graph,
        Client(graph, topics.DIAGNOSTICS) as client,
    ):
        session = graph.learner.session
        assert process.stdout.readline() == "ready\n"
        assert graph.spin_until(lambda: session.episodes >= BEFORE, TIMEOUT_S)
        process.stdin.write("go\n")
        process.stdin.flush()
        # Seen first, and known by name a moment later.
        client.wait_for(topics.DIAGNOSTICS, lambda message: name in named(message))
        assert session.episodes < EPISODES
        process.terminate()
        assert graph.spin_until(lambda: session.episodes >= EPISODES, TIMEOUT_S)
        return hashes(session)


@pytest.mark.parametrize(
    "attack",
    [
        "forged_results",
        "observations_ahead",
        "corrections",
        "second_segments",
        "flood",
    ],
)
@pytest.mark.thorough
def test_a_program_of_another_middleware_changes_nothing(domain, undisturbed, attack):
    assert learned_beside(domain, foreign(domain, attack), NO_NODE) == undisturbed


@pytest.mark.thorough
def test_a_second_robot_changes_nothing(domain, undisturbed):
    assert (
        learned_beside(
            domain,
            module(domain, "sim_node.node"),
            "sim_node (this host) and sim_node (this host)",
        )
        == undisturbed
    )


@pytest.mark.thorough
def test_a_bag_that_is_played_onto_a_live_graph_changes_nothing(domain, undisturbed):
    player = module(
        domain, "biped_bringup.cli.main",
        *("bag", "play", str(SAMPLE), "--domain", str(domain), "--loop"),
    )  # fmt: skip
    assert learned_beside(domain, player, "player (this host)") == undisturbed


@pytest.mark.thorough
def test_ros2_topic_pub_onto_a_live_graph_changes_nothing(domain, undisturbed):
    publisher = module(
        domain, "ros2_verbs.main",
        *("topic", "pub", "--rate", "50", topics.CORRECTION.name,
          topics.CORRECTION.type_name, "{header: {frame_id: world}}"),
    )  # fmt: skip
    assert learned_beside(domain, publisher, "this host") == undisturbed


# -- what `biped up` reports -----------------------------------------------------------


@contextmanager
def up(domain, folder, *options):
    """Have `biped up` run, from when all of its nodes are there."""
    process = subprocess.Popen(
        [sys.executable, "-m", "biped_bringup.cli.main", "up", "--no-view",
         "--record", "none", "--domain", str(domain), "--out", str(folder), *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )  # fmt: skip
    late = threading.Timer(TIMEOUT_S, process.kill)
    late.start()
    with process:
        try:
            assert any("sim_node is ready" in line for line in process.stderr)
            yield process
        finally:
            late.cancel()
            process.kill()


def ended(process):
    """Return the exit status, after all that is said has been read."""
    process.communicate(timeout=TIMEOUT_S)
    return process.returncode


def disturb(process, stranger):
    """Have a stranger come, be named on the screen, and leave."""
    stranger.stdin.write("go\n")
    stranger.stdin.flush()
    assert any(NO_NODE in line for line in process.stderr)
    stranger.terminate()


@pytest.mark.thorough
def test_a_forged_success_is_no_success(domain, tmp_path):
    run = TrainingRun(load_settings("quick"), SEED)
    run.run(1, False, lambda _: True)
    run.save(tmp_path / "memory.npz")
    run.close()
    with (
        foreign(domain, "forged_results") as stranger,
        # Slowly, so that the stranger comes before the walk is over.
        up(
            domain, tmp_path, "--greedy", "--pace", "realtime", "--factor", "0.5"
        ) as process,
    ):
        disturb(process, stranger)
        status = ended(process)
    assert status == 1


@pytest.mark.thorough
def test_a_learner_that_a_stranger_calls_learned_learns_on(
    domain, tmp_path, undisturbed
):
    options = ("--preset", "quick", "--seed", str(SEED), "--episodes", str(EPISODES))
    with (
        foreign(domain, "forged_status") as stranger,
        up(domain, tmp_path, *options) as process,
    ):
        disturb(process, stranger)
        status = ended(process)
    assert status == 1
    run = TrainingRun.load(tmp_path / "memory.npz")
    run.close()
    assert hashes(run.session) == undisturbed


# -- what a node takes of the machine --------------------------------------------------


def peak_mb(process):
    """Return the most memory that a process has ever had [MB]."""
    for line in Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) / 1024.0
    raise AssertionError("no such line")


def test_a_request_that_claims_millions_of_parameters_fills_no_memory(
    domain, processes
):
    with foreign(domain, "forged_request") as stranger:
        node = processes("trajectory_node.node", {})
        stranger.stdin.write("go\n")
        stranger.stdin.flush()
        assert [stranger.stdout.readline() for _ in range(2)] == ["ready\n", "taken\n"]
        assert node.poll() is None
        assert peak_mb(node.pid) < 600.0
