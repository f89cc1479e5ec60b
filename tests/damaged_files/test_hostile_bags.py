"""Bags with all their checksums, whose content is not what it should be.

Every verb that reads them ends with one of its statuses and one line at most.
"""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mcap.records import Attachment
from mcap.writer import CompressionType, Writer
from tests.biped_bag.bags import START_NS
from tests.damaged_files.corruption import corrupted
from tests.damaged_files.test_bombs import write_chunk

from biped_bag.qos import playing_qos
from biped_bag.storage.contents import BagTopic, channel_metadata
from biped_bag.storage.reader import BagReader
from biped_bringup.cli.main import main
from biped_bringup.run_settings import load_settings
from biped_common.plain_yaml import yaml_text
from biped_common.settings import to_mapping

SEED = 20_261_125
DRAWS = 60
SAMPLE = Path(__file__).parents[2] / "bags/sample"
VERBS = (
    "info {}",
    "info {} --json",
    "verify {}",
    "cut {} out --start 0",
    "cut {} out --episodes 1",
    "export {} out",
    "export {} out --format csv",
    "recover {} out",
)
READERS = ("info {}", "export {} out", "recover {} out")


@pytest.fixture(scope="module")
def sample():
    """Topics, and the first messages of each, of a recorded walk."""
    bag = BagReader(SAMPLE)
    messages = {}
    for message in bag.messages():
        messages.setdefault(message.topic, []).append(message)
    return bag.topics, [m for of_one in messages.values() for m in of_one[:3]]


def write(file, topics, messages, records, attachments=()):
    """Write a bag of these, whatever they are."""
    with file.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD, enable_data_crcs=True)
        writer.start()
        for item in attachments:
            writer.add_attachment(
                item.create_time, item.log_time, item.name, item.media_type, item.data
            )
        for name, texts in records:
            writer.add_metadata(name, texts)
        channels = {}
        for name, topic in topics.items():
            schema = writer.register_schema(
                topic.type_name, "ros2msg", topic.definition.encode()
            )
            channels[name] = writer.register_channel(
                topic.name, topic.encoding, schema, channel_metadata(topic)
            )
        for message in messages:
            writer.add_message(
                channels[message.topic],
                message.log_ns,
                message.data,
                message.publish_ns,
            )
        writer.finish()


def run_of(**changes):
    """Return the record of a run."""
    settings = yaml_text(to_mapping(load_settings("quick")))
    values = {"settings": settings, "seed": "1", "begins_with": "nothing"}
    return "biped.run", values | changes


@pytest.fixture
def every_verb_ends_in_order(tmp_path, capsys):
    """Run every verb on a bag."""

    def check(file, verbs=VERBS):
        for number, verb in enumerate(verbs):
            words = verb.format(file).replace("out", str(tmp_path / f"out_{number}"))
            status = main(["bag", *words.split()])
            complaint = capsys.readouterr().err
            assert status in (0, 1, 2, 3), verb
            assert complaint.count("\n") <= 1, verb

    return check


ODD_QOS = [
    {"depth": "deep", "reliability": ["x"], "durability": {"a": 1}},
    {"depth": -5, "durability": "transient_local"},
    {"depth": 10**30, "reliability": 1, "durability": 1},
    {"depth": 1.5},
    {1: 2},
]
ODD_TOPICS = {
    "a NUL in its name": {"name": "/a\0b"},
    "a line's end in its name": {"name": "/a\nb"},
    "no name": {"name": ""},
    "a path as its name": {"name": "/../../a"},
    "a NUL in its type": {"type_name": "std_msgs/msg/\0"},
    "a type of nobody": {"type_name": "no/msg/Such"},
    "no definition": {"definition": ""},
    "a definition of itself": {"definition": "std_msgs/String data"},
    "a definition of the sun": {"definition": "float64[99999999999] data\n" * 9},
    "odd qualities of service": {"offered_qos": ODD_QOS},
    "another encoding": {"encoding": "json"},
}


@pytest.mark.parametrize("what", ODD_TOPICS)
def test_a_topic_that_has(sample, tmp_path, every_verb_ends_in_order, what):
    topics, messages = sample
    odd = dict(topics)
    odd["/biped/learner"] = replace(topics["/biped/learner"], **ODD_TOPICS[what])
    write(tmp_path / "odd.mcap", odd, messages, [run_of()])
    every_verb_ends_in_order(tmp_path / "odd.mcap", READERS)


def test_an_odd_quality_of_service_is_played_as_well_as_it_can():
    topic = BagTopic("/a", "std_msgs/msg/String", offered_qos=ODD_QOS)
    assert playing_qos(topic).depth == 5000


ODD_RUNS = {
    "no seed": {"seed": ""},
    "a seed below nothing": {"seed": "-1"},
    "a seed without end": {"seed": "9" * 5000},
    "settings without end": {"settings": "[" * 100_000},
    "settings in a list": {"settings": "[gait, learner]"},
    "tables that fill the machine": {
        "settings": run_of()[1]["settings"]
        .replace("alternatives: 15", "alternatives: 1001")
        .replace("decomposed: true", "decomposed: false")
    },
    "a memory of nobody": {"begins_with": "memory.npz"},
}


@pytest.mark.parametrize("what", ODD_RUNS)
def test_a_run_that_has(sample, tmp_path, every_verb_ends_in_order, what):
    write(tmp_path / "odd.mcap", *sample, [run_of(**ODD_RUNS[what])])
    every_verb_ends_in_order(tmp_path / "odd.mcap", ["verify {}"])


@pytest.mark.parametrize("content", [b"", b"PK", bytes(100)])
def test_an_attached_memory_that_is_none(
    sample, tmp_path, every_verb_ends_in_order, content
):
    item = Attachment(START_NS, START_NS, "memory.npz", "", content)
    write(tmp_path / "odd.mcap", *sample, [run_of(begins_with="memory.npz")], [item])
    every_verb_ends_in_order(tmp_path / "odd.mcap", ["verify {}"])


@pytest.mark.parametrize(
    ("compression", "data"),
    [("lz4", b"garbage"), ("zstd", b"garbage"), ("xz", b"x"), ("", b"\x05" + bytes(9))],
)
def test_a_chunk_of_garbage(tmp_path, every_verb_ends_in_order, compression, data):
    write_chunk(tmp_path / "odd.mcap", compression, data, claimed=len(data))
    every_verb_ends_in_order(tmp_path / "odd.mcap")


def test_messages_of_any_bytes(sample, tmp_path, every_verb_ends_in_order):
    """Every topic's messages, each damaged at random."""
    topics, messages = sample
    for draw in range(DRAWS // len(VERBS)):
        rng = np.random.default_rng((SEED, draw))
        damaged = [m._replace(data=corrupted(m.data, rng)) for m in messages]
        file = tmp_path / f"odd{draw}.mcap"
        write(file, topics, damaged, [run_of()])
        every_verb_ends_in_order(file)
        for folder in tmp_path.glob("out_*"):
            shutil.rmtree(folder)


def test_messages_of_any_time_and_number(sample, tmp_path, every_verb_ends_in_order):
    topics, messages = sample
    last = 2**64 - 1
    odd = [m._replace(log_ns=last - n, publish_ns=0) for n, m in enumerate(messages)]
    write(tmp_path / "odd.mcap", topics, odd, [run_of()])
    every_verb_ends_in_order(tmp_path / "odd.mcap")
