"""`biped up` as people use it: exit statuses, logs, parts of a graph, leftovers."""

import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.graph.domains import MODULE, own_domain
from tests.graph.players import SAMPLE

from biped_bag.storage.reader import BagReader
from biped_common.settings import to_mapping
from learner_node.checkpoint import read_checkpoint

TIMEOUT_S = 120.0
NODES = ("trajectory_node", "learner_node", "sim_node")


def command(domain, out, *options, record="none"):
    """Return the words of a `biped up`, perhaps on no domain of its own."""
    fixed = ["--record", record, "--out", out, "--no-view"]
    if domain is not None:
        fixed += ["--domain", domain]
    words = [sys.executable, "-m", "biped_bringup.cli.main", "up", *fixed, *options]
    return [str(word) for word in words]


def up(domain, out, *options, **recording):
    """Run it to its end."""
    return subprocess.run(
        command(domain, out, *options, **recording),
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


@pytest.fixture
def small_disk(tmp_path):
    """A disk with room for parameter files, but neither for a memory nor for a bag."""
    folder = tmp_path / "small"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=80k", "tmpfs", str(folder)]
    if subprocess.run(mount, capture_output=True).returncode != 0:
        pytest.skip("nothing can be mounted here")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


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


@pytest.fixture(scope="module")
def ended(tmp_path_factory):
    """What a run of one episode on the environment's domain said, and its folder."""
    out = tmp_path_factory.mktemp("ended")
    words = command(None, out, "--preset", "quick", "--episodes", "1", "--json")
    said = subprocess.run(
        words,
        env=os.environ | {"ROS_DOMAIN_ID": str(own_domain(MODULE))},
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
    )
    return said, out


@pytest.mark.thorough
def test_a_greedy_walk_that_is_walked_ends_with_0(domain, learned):
    ended = up(domain, learned, "--greedy")
    assert ended.returncode == 0, ended.stderr
    assert re.search("greedy walk: completed after 11.25 s, peak ZMP", ended.stdout)


@pytest.mark.thorough
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


def test_lines_say_whose_they_are_and_files_keep_them(ended):
    said, out = ended
    lines = said.stderr.splitlines()
    assert all(re.match(r"\[\w+\] ", line) for line in lines), lines
    ready = [line for line in lines if "is ready" in line]
    assert [line.split()[1] for line in ready] == list(NODES)
    assert {file.stem for file in out.glob("*.log")} == set(NODES)


def test_a_run_on_the_domain_of_the_environment_says_which_it_is(ended):
    first = ended[0].stderr.splitlines()[0]
    assert first.endswith(f"export ROS_DOMAIN_ID={own_domain(MODULE)}")


def test_the_table_of_episodes_is_that_of_the_memory(ended, training):
    log = training(ended[1] / "memory.npz").log
    assert len(log) == 1
    assert (ended[1] / "episodes.csv").read_text() == log.csv_text()


def test_json_tells_what_came_out_and_of_which_settings(ended, training):
    said, out = ended
    run, told = training(out / "memory.npz"), json.loads(said.stdout)
    assert (told["outcome"], told["episodes"]) == ("not learned", 1)
    assert told["episodes_not_saved"] == told["missed_deadlines"] == 0
    assert told["memory_sha256"] == run.session.memory_sha256()
    assert told["settings"] == to_mapping(run.settings)
    assert told["not_saved"] == told["bags"] == []


@pytest.mark.thorough
def test_episodes_that_the_disk_has_no_room_for_are_told_last(domain, tmp_path):
    options = ("--preset", "quick", "--episodes", "25", "--publish-every", "1000")
    with subprocess.Popen(
        command(domain, tmp_path, *options), stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True,
    ) as process:  # fmt: skip
        memory = tmp_path / "memory.npz"
        assert wait_for(memory.exists)
        learner = node_processes(tmp_path)["learner_node"]
        little = (10_000, 10_000)
        resource.prlimit(learner, resource.RLIMIT_FSIZE, little)
        lines = process.communicate(timeout=TIMEOUT_S)[0].splitlines()
    saved = len(read_checkpoint(memory)[1]["log/reward"])
    assert process.returncode == 1
    assert lines[0].startswith(f"not learned yet: {saved} episodes")
    assert lines[-1] == (
        f"not saved: {25 - saved} of 25 episodes: {memory}: cannot be written: "
        "File too large"
    )


@pytest.mark.thorough
def test_on_a_full_disk_the_run_ends_in_order(domain, small_disk):
    options = ("--preset", "quick", "--episodes", "2")
    said = up(domain, small_disk, *options, record=small_disk / "bag")
    assert said.returncode == 1, said.stderr
    assert "memory.npz: 0 of 2 episodes" in said.stdout
    # Which logs had found room beside them is chance: their lines may follow.
    memory, bag, *logs = re.findall(r"^not saved: (.*)$", said.stdout, re.MULTILINE)
    assert memory.startswith("2 of 2 episodes: ")
    assert memory.endswith("memory.npz: cannot be written: No space left on device")
    assert bag.startswith("the rest of ")
    assert all(log.startswith("log ") for log in logs)


@pytest.mark.thorough
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
