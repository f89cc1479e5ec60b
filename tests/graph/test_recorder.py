"""The recorder on a real run: complete, readable by others, and dispensable."""

import json
import os
import pickle
import resource
import signal
import subprocess
import sys
import threading
import time
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from tests.biped_bag.bags import messages_to_the_end
from tests.graph.domains import MODULE, own_domain

from biped_bag.records import STATE_KEY, run_record
from biped_bag.storage.metadata import read_metadata
from biped_bringup.cli.recording import recorder_parameters
from biped_bringup.node_parameters import node_parameters
from biped_bringup.run_settings import load_settings
from biped_bringup.supervisor.supervisor import RECORDER, Supervisor
from biped_bringup.training import TrainingRun
from biped_common.settings import to_mapping
from biped_ros.cdr import string_text
from biped_ros.environment import node_environment
from msgs_json import topics
from msgs_json.episode_result import EpisodeResult
from msgs_json.wire import decode

SEED = 5
EPISODES = 3
TIMEOUT_S = 90.0
# Of messages; a new file has a few kB of definitions.
LITTLE_BYTES = 100_000
# All topics but the one on which the recorder itself speaks.
OF_THE_WALK = [
    topic
    for topic in vars(topics).values()
    if isinstance(topic, topics.Topic) and topic is not topics.DIAGNOSTICS
]


@dataclass
class Run:
    """What is left of a run."""

    bag: Path
    heard: dict[str, list[bytes]] = field(default_factory=dict)
    errors: list[str] = field(default_factory=list)
    done_without: dict[str, str] = field(default_factory=dict)
    killed_ns: int = 0


class Graph:
    """Three nodes and a recorder under a supervisor, in a thread of the test."""

    def __init__(self, folder, domain, every_ticks=1, max_episodes=0, **split):
        settings = load_settings("quick")
        self.bag = folder / "bag"
        parameters = node_parameters(
            settings,
            SEED,
            checkpoint_file=str(folder / "memory.npz"),
            max_episodes=max_episodes,
            publish_every_ticks=every_ticks,
            listen_s=0.5,
            recorders=2,  # the robot waits for the witness, too
        ).flat()
        run = run_record(
            to_mapping(settings),
            SEED,
            preset="quick",
            pace="lockstep",
            frozen=False,
            max_episodes=max_episodes,
            memory_file=None,
        )
        parameters[RECORDER] = recorder_parameters(self.bag, run, None, split)
        environment = node_environment(domain, "LOCALHOST")
        self._heard = folder / "heard"
        self._witness = subprocess.Popen(
            [sys.executable, "-m", "tests.graph.witness", str(self._heard)],
            env=environment,
        )
        self.supervisor = Supervisor(parameters, environment, folder, lambda *_: None)
        self._stopped = threading.Event()
        self._thread = threading.Thread(
            target=self.supervisor.run,
            args=(lambda: False, self._stopped.is_set),
            daemon=True,
        )
        self._thread.start()

    def wait_for(self, condition):
        """Fail unless the condition comes true in time."""
        end = time.monotonic() + TIMEOUT_S
        while time.monotonic() < end and not condition():
            time.sleep(0.05)
        assert condition()

    def walk_on(self, walks):
        """Wait until so many more walks have ended."""
        before = self.supervisor.graph.results
        self.wait_for(lambda: self.supervisor.graph.results >= before + walks)

    def stop(self):
        """End everything; return what is left."""
        self._stopped.set()
        self._thread.join()
        self.supervisor.stop()
        time.sleep(0.5)  # what was sent last is on its way to the witness
        self._witness.terminate()
        self._witness.wait(TIMEOUT_S)
        heard, errors = pickle.loads(self._heard.read_bytes())
        return Run(self.bag, heard, errors, self.supervisor.done_without)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Return a short run in lockstep, two walks to a file."""
    folder = tmp_path_factory.mktemp("run")
    graph = Graph(
        folder,
        own_domain(MODULE),
        max_episodes=EPISODES,
        split="episode",
        episodes_per_file=2,
    )
    try:
        graph.walk_on(EPISODES)
    finally:
        left = graph.stop()
    return left


def recorded(bag):
    """Return the messages of a bag by topic, as rosbags reads them."""
    messages = defaultdict(list)
    with Reader(bag) as reader:
        for connection, _, data in reader.messages():
            messages[connection.topic].append(bytes(data))
    return messages


def records(bag, name):
    """Return the MCAP metadata records of this name, in order."""
    found = []
    for info in read_metadata(bag).files:
        with (bag / info.path).open("rb") as file:
            for record in make_reader(file).iter_metadata():
                if record.name == name:
                    found.append(record.metadata)
    return found


def topics_of(latched):
    """Return ids and topics that are latched, or not."""
    return pytest.mark.parametrize(
        "topic",
        [topic for topic in OF_THE_WALK if topic.latched == latched],
        ids=lambda topic: topic.name,
    )


@topics_of(latched=False)
def test_everything_that_was_published_is_in_the_bag(run, topic):
    assert recorded(run.bag)[topic.name] == run.heard[topic.name]


def test_there_was_something_to_hear(run):
    for topic in (topics.JOINT_STATES, topics.CORRECTION, topics.WAIST_REFERENCE):
        assert len(run.heard[topic.name]) > EPISODES


@topics_of(latched=True)
def test_what_is_latched_is_in_the_bag(run, topic):
    # Of what was sent before both were connected, each has the last at that moment.
    assert run.heard[topic.name][-1] in recorded(run.bag)[topic.name]


@topics_of(latched=True)
def test_every_file_alone_holds_what_is_latched(run, topic):
    for info in read_metadata(run.bag).files:
        assert recorded(run.bag / info.path)[topic.name], info.path


def test_mcap_ros2_decodes_every_message(run):
    count = 0
    for info in read_metadata(run.bag).files:
        with (run.bag / info.path).open("rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            count += sum(1 for _ in reader.iter_decoded_messages())
    assert count == read_metadata(run.bag).message_count


def test_metadata_counts_every_topic(run):
    messages = recorded(run.bag)
    for topic in read_metadata(run.bag).topics:
        assert topic.count == len(messages[topic.name]), topic.name


def test_nothing_was_lost(run):
    (counts,) = records(run.bag, "biped.counts")
    for topic, text in counts.items():
        of_topic = json.loads(text)
        assert of_topic["lost"] == 0, topic
        assert of_topic["written"] == of_topic["received"], topic


def test_the_robot_waits_for_the_recorder(run):
    (counts,) = records(run.bag, "biped.counts")
    for topic in (topics.CLOCK, topics.JOINT_STATES, topics.OBSERVATION):
        assert json.loads(counts[topic.name])["earlier"] == 0


def test_a_file_holds_as_many_walks_as_asked_for(run):
    first = read_metadata(run.bag).files[0]
    messages = recorded(run.bag / first.path)
    assert len(messages[topics.EPISODE.name]) == 2


def test_every_walk_has_its_record(run):
    walks = records(run.bag, "biped.episode")
    results = [
        decode(EpisodeResult, string_text(message))
        for message in run.heard[topics.EPISODE.name]
    ]
    assert [
        (walk["walk_sha256"], int(walk["control_ticks"]), walk["end_cause"])
        for walk in walks
    ] == [(r.trajectory_sha256, r.control_ticks, r.end_cause.value) for r in results]


def test_the_last_record_names_the_memory_that_was_saved(run):
    learned = TrainingRun.load(run.bag.parent / "memory.npz")
    learned.close()
    last = records(run.bag, "biped.episode")[-1]
    assert last["memory_sha256"] == learned.session.memory_sha256()
    assert last["trajectory_sha256"] == learned.tally.trajectories_sha256


def test_the_run_s_data_are_in_every_file(run):
    found = records(run.bag, "biped.run")
    assert len(found) == len(read_metadata(run.bag).files)
    assert all(record["seed"] == str(SEED) for record in found)
    assert all(record["preset"] == "quick" for record in found)
    assert all(record["begins_with"] == "nothing" for record in found)


# -- a recorder that dies, and one that cannot go on ---------------------------------


@pytest.fixture(scope="module")
def hard_run(tmp_path_factory):
    """Return a run whose recorder is killed, then finds that no more can be written."""
    folder = tmp_path_factory.mktemp("hard")
    graph = Graph(folder, own_domain(MODULE + 1), every_ticks=5)
    recorder = graph.supervisor.children[RECORDER]
    try:
        graph.walk_on(1)
        os.kill(recorder.pid, signal.SIGKILL)
        killed_ns = time.time_ns()
        graph.wait_for(lambda: recorder.starts == 2)
        second = graph.bag.with_name("bag_2") / "bag_2_0.mcap"
        graph.wait_for(lambda: second.exists() and second.stat().st_size > LITTLE_BYTES)
        time.sleep(1.0)  # many times as long as until it is flushed
        limit = second.stat().st_size
        resource.prlimit(recorder.pid, resource.RLIMIT_FSIZE, (limit, limit))
        graph.wait_for(lambda: RECORDER in graph.supervisor.done_without)
        graph.walk_on(2)
    finally:
        left = graph.stop()
    left.killed_ns = killed_ns
    return left


@pytest.mark.thorough
def test_the_bag_of_a_killed_recorder_is_readable_to_the_end(hard_run):
    # 0.1 s between flushes; ten times that, since other work may be in the way.
    messages = messages_to_the_end(hard_run.bag / "bag_0.mcap")
    assert max(m.log_time for m in messages) > hard_run.killed_ns - 1_000_000_000


@pytest.mark.thorough
def test_the_bag_of_a_killed_recorder_does_not_claim_to_be_complete(hard_run):
    assert STATE_KEY not in read_metadata(hard_run.bag).custom


@pytest.mark.thorough
def test_a_recorder_that_was_killed_begins_another_bag(hard_run):
    assert messages_to_the_end(hard_run.bag.with_name("bag_2") / "bag_2_0.mcap")


@pytest.mark.thorough
def test_on_a_full_disk_the_walk_goes_on_without_a_recorder(hard_run):
    assert "File too large" in hard_run.done_without[RECORDER]


@pytest.mark.thorough
def test_a_full_disk_is_reported_in_diagnostics(hard_run):
    assert any("File too large" in text for text in hard_run.errors)


@pytest.mark.thorough
def test_a_bag_on_a_full_disk_counts_what_is_in_it(hard_run):
    bag = hard_run.bag.with_name("bag_2")
    metadata = read_metadata(bag)
    assert metadata.message_count == len(messages_to_the_end(bag / "bag_2_0.mcap"))
    assert "File too large" in metadata.custom[STATE_KEY]


def recorder_alone(domain, folder):
    """Start a recorder that cannot begin; return exit status and last words."""
    done = subprocess.run(
        [sys.executable, "-m", "biped_bag.recorder.node", "--ros-args",
         "-p", f"folder:={folder}"],
        env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )  # fmt: skip
    return done.returncode, done.stderr.splitlines()[-1]


@pytest.mark.thorough
def test_a_folder_that_cannot_be_written_to_ends_the_recorder(domain, tmp_path):
    (tmp_path / "file").touch()
    status, words = recorder_alone(domain, tmp_path / "file/bag")
    assert status == 4
    assert words.startswith("recording stopped: ")
    assert words.endswith("Not a directory")


@pytest.mark.thorough
def test_a_folder_that_is_a_bag_ends_the_recorder(domain, run):
    before = read_metadata(run.bag)
    status, words = recorder_alone(domain, run.bag)
    assert status == 4
    assert "holds a bag already" in words
    assert read_metadata(run.bag) == before
