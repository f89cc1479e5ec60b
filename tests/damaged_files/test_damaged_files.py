"""A damaged file is refused in one line, or is read as it was; nothing in between.

What goes wrong is drawn from a seed. A refusal is a BipedError of one line: any other
exception ends the test. A hang would end it, too, by its file of several seconds.
"""

import shutil
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import yaml
from tests.biped_bag.bags import FAST, LATCHED, RELIABLE, SLOW, control_tick, memory
from tests.biped_bag.bags import robot_description as description
from tests.damaged_files.corruption import corrupted

from biped_bag.info import info_text, run_text
from biped_bag.recovery.recover import recover
from biped_bag.storage.contents import BagTopic
from biped_bag.storage.reader import BagReader
from biped_bag.storage.writer import BagWriter
from biped_bringup.run_settings import load_settings
from biped_common.errors import BipedError
from biped_common.plain_yaml import read_yaml_file
from biped_common.settings import to_mapping
from learner_node.checkpoint import read_checkpoint, write_checkpoint

SEED = 20_261_124
BAGS, METADATA, MEMORIES, SETTINGS = 500, 1500, 500, 500
RECOVERED = 300
TICKS_PER_CHUNK = 8


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    """A bag with all that bags have, in a few small chunks."""
    folder = tmp_path_factory.mktemp("sound") / "bag"
    writer = BagWriter(folder, records={"biped.run": {"seed": "7", "preset": "quick"}})
    for topic in (*FAST, *SLOW):
        qos = LATCHED if topic.latched else RELIABLE
        writer.add_topic(BagTopic(topic.name, topic.type_name, [qos]))
    writer.attach(memory(b"what was learned" * 9))
    writer.write(description())
    for tick in range(6 * TICKS_PER_CHUNK):
        for message in control_tick(tick):
            writer.write(message)
        if tick % TICKS_PER_CHUNK == TICKS_PER_CHUNK - 1:
            writer.flush()
            writer.add_record("biped.episode", {"episode": str(tick), "end": "walked"})
    writer.close({"remark": "sound"})
    return folder


def content_of(path):
    """Everything that a bag tells."""
    bag = BagReader(path)
    return {
        "topics": bag.topics,
        "messages": sorted(bag.messages()),
        "records": [r for r in bag.records() if r.name != "rosbag2"],
        "attachments": list(bag.attachments()),
        "text": [
            line
            for line in info_text(bag).splitlines()
            if not line.startswith(("Files", "Bag size"))
        ],
        "run": run_text(bag),
    }


def refusal(read, *arguments):
    """Return what reading gives, or None if it is refused as it should be."""
    try:
        return read(*arguments)
    except BipedError as error:
        assert len(str(error).splitlines()) == 1
        return None


def damaged_copies(content, number, seed):
    """Yield damaged copies, each with the number of its draw."""
    for draw in range(number):
        damaged = corrupted(content, np.random.default_rng((SEED, seed, draw)))
        if damaged != content:
            yield draw, damaged


def test_a_damaged_bag_is_refused_or_read_as_it_was(bag, tmp_path):
    sound = content_of(bag / "bag_0.mcap")
    file = tmp_path / "bag_0.mcap"
    other = []
    for draw, damaged in damaged_copies((bag / "bag_0.mcap").read_bytes(), BAGS, 0):
        file.write_bytes(damaged)
        if (found := refusal(content_of, file)) not in (None, sound):
            other.append((draw, found))
    assert other == []


@pytest.mark.thorough
def test_of_a_damaged_bag_nothing_is_recovered_that_was_not_recorded(bag, tmp_path):
    sound = content_of(bag / "bag_0.mcap")
    recorded = Counter(sound["messages"])
    file, out = tmp_path / "bag_0.mcap", tmp_path / "out"
    wrong = []
    for draw, damaged in damaged_copies(
        (bag / "bag_0.mcap").read_bytes(), RECOVERED, 0
    ):
        file.write_bytes(damaged)
        shutil.rmtree(out, ignore_errors=True)
        report = refusal(recover, file, out)
        if report is None:
            continue
        found = content_of(out)
        if Counter(found["messages"]) - recorded:
            wrong.append((draw, "more than was recorded"))
        lost = recorded - Counter(found["messages"])
        told = [name for name, loss in report.topics.items() if loss.touched]
        if report.end_known and not {m.topic for m in lost} <= set(told):
            wrong.append((draw, "lost without a word"))
        kept = ("messages", "records", "attachments")
        if report.nothing_lost and any(found[what] != sound[what] for what in kept):
            wrong.append((draw, "another, and said to be whole"))
    assert wrong == []


def test_damaged_metadata_are_refused_or_make_no_difference(bag, tmp_path):
    sound = content_of(bag)
    copy = tmp_path / "bag"
    shutil.copytree(bag, copy)
    other = []
    content = (bag / "metadata.yaml").read_bytes()
    for draw, damaged in damaged_copies(content, METADATA, 1):
        (copy / "metadata.yaml").write_bytes(damaged)
        if refusal(content_of, copy) not in (None, sound):
            other.append(draw)
    assert other == []


def test_with_damaged_metadata_all_messages_are_recovered(bag, tmp_path):
    sound = content_of(bag)
    copy, out = tmp_path / "bag", tmp_path / "out"
    shutil.copytree(bag, copy)
    content = (bag / "metadata.yaml").read_bytes()
    for _, damaged in damaged_copies(content, 40, 1):
        (copy / "metadata.yaml").write_bytes(damaged)
        shutil.rmtree(out, ignore_errors=True)
        recover(copy, out)
        assert content_of(out)["messages"] == sound["messages"]


def test_a_damaged_memory_is_refused_or_read_as_it_was(tmp_path):
    file = tmp_path / "memory.npz"
    arrays = {"memory/q": np.arange(40.0).reshape(2, 20), "log/reward": np.zeros(5)}
    write_checkpoint(file, {"seed": 3, "note": "sound"}, arrays)

    def read(path: Path):
        header, found = read_checkpoint(path)
        return header, {
            name: (array.dtype.str, array.shape, array.tobytes())
            for name, array in found.items()
        }

    content, sound = file.read_bytes(), read(file)
    other = []
    for draw, damaged in damaged_copies(content, MEMORIES, 2):
        file.write_bytes(damaged)
        if refusal(read, file) not in (None, sound):
            other.append(draw)
    assert other == []


def test_damaged_settings_are_refused_or_are_settings(tmp_path):
    """Settings carry no checksum: another number in them is another setting."""
    file = tmp_path / "mine.yaml"
    content = yaml.safe_dump(to_mapping(load_settings("quick"))).encode()
    for _, damaged in damaged_copies(content, SETTINGS, 3):
        file.write_bytes(damaged)
        refusal(read_yaml_file, file)
        refusal(load_settings, "quick", file)
