"""`biped up` as people use it: exit statuses, logs, parts of a graph, leftovers."""

import re
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.graph.players import SAMPLE

from biped_bag.storage.reader import BagReader
from learner_node.checkpoint import read_checkpoint

TIMEOUT_S = 120.0
NODES = ("trajectory_node", "learner_node", "sim_node")


def command(domain, out, *options):
    """Return the words of a `biped up` that records nothing."""
    fixed = ("--record", "none", "--domain", str(domain), "--out", str(out))
    return [sys.executable, "-m", "biped_bringup.cli.main", "up", *fixed, *options]


def up(domain, out, *options):
    """Run it to its end."""
    return subprocess.run(
        command(domain, out, *options),
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
    )


@contextmanager
def running(domain, out, *options):
    """Run it until told to end; give the process."""
    process = subprocess.Popen(
        command(domain, out, *options), stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        yield process
    finally:
        process.terminate()
        process.wait(TIMEOUT_S)


def node_processes(folder):
    """Return the ids of node processes, by node, that were started for a folder."""
    found = {}
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            words = (entry / "cmdline").read_text().split("\0")
        except OSError:  # it has ended
            continue
        for name in NODES:
            if str(folder / f"{name}.yaml") in words:
                found[name] = int(entry.name)
    return found


def wait_for(condition):
    """Return whether the condition came true in time."""
    end = time.monotonic() + TIMEOUT_S
    while not condition() and time.monotonic() < end:
        time.sleep(0.1)
    return condition()


@pytest.fixture
def learned(tmp_path):
    """A folder with the memory of a learned walk: the sample bag's."""
    (memory,) = BagReader(SAMPLE).attachments()
    (tmp_path / "memory.npz").write_bytes(memory.data)
    return tmp_path


def test_a_greedy_walk_that_is_walked_ends_with_0(domain, learned):
    ended = up(domain, learned, "--greedy")
    assert ended.returncode == 0, ended.stderr
    assert re.search("greedy walk: completed after 11.25 s, peak ZMP", ended.stdout)


def test_a_walk_not_learned_yet_ends_with_1_and_goes_on_when_resumed(domain, tmp_path):
    first = up(domain, tmp_path, "--preset", "quick", "--episodes", "2")
    assert (first.returncode, first.stdout.splitlines()[0][:27]) == (
        1,
        "not learned yet: 2 episodes",
    ), first.stderr
    second = up(domain, tmp_path, "--resume", "--episodes", "4")
    assert second.returncode == 1
    header, _ = read_checkpoint(tmp_path / "memory.npz")
    assert header["tally"]["evaluations"] == 0
    assert "not learned yet: 4 episodes" in second.stdout
    assert f"biped up --resume --out {tmp_path}" in second.stdout


def test_lines_say_whose_they_are_and_files_keep_them(domain, tmp_path):
    ended = up(domain, tmp_path, "--preset", "quick", "--episodes", "1")
    lines = ended.stderr.splitlines()
    assert all(re.match(r"\[\w+\] ", line) for line in lines), lines
    ready = [line for line in lines if "is ready" in line]
    assert [line.split()[1] for line in ready] == list(NODES)
    assert {file.stem for file in tmp_path.glob("*.log")} == set(NODES)


def test_parts_of_a_graph_find_each_other_and_a_second_learner_fails(domain, tmp_path):
    body, mind, second = (tmp_path / name for name in ("body", "mind", "second"))
    with (
        running(domain, body, "--nodes", "trajectory,sim") as of_body,
        running(domain, mind, "--nodes", "learner") as of_mind,
    ):
        assert wait_for((mind / "memory.npz").exists)
        processes = node_processes(body) | node_processes(mind)
        assert set(processes) == set(NODES)
        for process in processes.values():
            assert "/dev/shm/fastrtps" not in Path(f"/proc/{process}/maps").read_text()
        refused = up(domain, second, "--nodes", "learner")
        assert refused.returncode == 3, refused.stderr
        assert "failed: learner_node cannot be started" in refused.stdout
        assert "published already by learner_node (this host)" in refused.stdout
        assert not any(second.glob("*.npz"))
        assert of_body.poll() is of_mind.poll() is None
        of_body.send_signal(signal.SIGTERM)
        assert of_body.wait(TIMEOUT_S) == 130
    assert not node_processes(body) | node_processes(mind)
