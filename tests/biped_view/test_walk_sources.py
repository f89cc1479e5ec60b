"""A walk is the same, read from a bag or walked from a memory; the rest is refused."""

import shutil
from dataclasses import fields

import numpy as np
import pytest
from tests.biped_view.recorded_walk import POSE_EVERY_TICKS, write_bag

from biped_bag.errors import BagError
from biped_common.errors import BipedError
from biped_view.walk_sources import read_walk
from learner_node.checkpoint import CheckpointError
from msgs_json import topics

_TORSO = ("torso_position_m", "torso_quaternion")


@pytest.fixture(scope="module")
def both(walked_twice):
    return read_walk(walked_twice.memory).record, read_walk(walked_twice.bag).record


def test_bag_and_memory_show_the_same_walk_to_the_last_bit(both):
    memory, bag = both
    assert memory.ticks > 500
    for field in fields(memory):
        own, recorded = getattr(memory, field.name), getattr(bag, field.name)
        if isinstance(own, np.ndarray) and field.name not in _TORSO:
            np.testing.assert_array_equal(recorded, own, err_msg=field.name)
    assert bag.end_cause is memory.end_cause
    assert bag.walk_ticks == memory.walk_ticks
    assert bag.result.cost == memory.result.cost


def test_a_learner_had_a_part_in_it(both):
    memory, _ = both
    assert np.abs(memory.correction_m).max() > 0.001
    assert not np.array_equal(memory.waist_m, memory.static_waist_m)


def test_the_pose_is_as_recorded_and_near_the_truth_in_between(both):
    memory, bag = both
    clock_ticks = np.arange(1, memory.ticks + 1) + 1  # the first walk begins at 1
    recorded = clock_ticks % POSE_EVERY_TICKS == 0
    for name in _TORSO:
        own, read = getattr(memory, name), getattr(bag, name)
        np.testing.assert_array_equal(read[recorded], own[recorded])
        known = np.isfinite(read).all(axis=1)
        assert known.mean() > 0.9
        np.testing.assert_allclose(read[known], own[known], atol=1e-3)


def test_nothing_is_made_up_before_the_first_and_behind_the_last_pose(both):
    _, bag = both
    first, last = np.flatnonzero(np.isfinite(bag.torso_position_m[:, 0]))[[0, -1]]
    assert (first + 2) % POSE_EVERY_TICKS == 0
    assert (last + 2) % POSE_EVERY_TICKS == 0
    assert np.isnan(bag.torso_quaternion[:first]).all()
    assert np.isnan(bag.torso_quaternion[last + 1 :]).all()


def test_a_folder_of_a_run_is_its_memory_with_its_learner(walked_twice):
    loaded = read_walk(walked_twice.memory.parent)
    assert loaded.session is not None
    assert loaded.session.episodes == 3
    assert loaded.facts["memory"] == str(walked_twice.memory)


def test_a_bag_without_poses_has_no_pose(walked_twice, tmp_path):
    bag = write_bag(tmp_path / "bag", walked_twice.run, without=["/biped/torso_pose"])
    record = read_walk(bag).record
    assert np.isnan(record.torso_position_m).all()
    assert np.isfinite(record.zmp_m).all()


def test_a_recording_that_ends_before_the_walk_has_no_end_cause(walked_twice, tmp_path):
    run = walked_twice.run
    whole = run.messages
    cut = [n for n, (name, _) in enumerate(whole) if name == topics.OBSERVATION.name][
        20
    ]
    try:
        run.messages = whole[:cut]
        record = read_walk(write_bag(tmp_path / "bag", run)).record
    finally:
        run.messages = whole
    assert record.end_cause is None
    assert record.result is None
    assert record.ticks == 190


@pytest.mark.parametrize("topic", [topics.PLAN, topics.ZMP, topics.JOINT_STATES])
def test_a_bag_without_what_a_walk_is_seen_by_is_refused(walked_twice, tmp_path, topic):
    bag = write_bag(tmp_path / "bag", walked_twice.run, without=[topic.name])
    with pytest.raises(BagError, match=f"has no {topic.name}"):
        read_walk(bag)


def test_a_bag_that_does_not_say_which_robot_walked_is_refused(walked_twice, tmp_path):
    bag = write_bag(tmp_path / "bag", walked_twice.run, records=False)
    with pytest.raises(BagError, match=r"has no record biped\.run"):
        read_walk(bag)


def test_a_walk_that_is_not_in_the_bag_is_refused(walked_twice):
    with pytest.raises(BagError, match="has no walk 7; it has 1 walks"):
        read_walk(walked_twice.bag, 7)


def test_a_bag_whose_recorder_was_killed_is_sent_to_recover(walked_twice, tmp_path):
    bag = tmp_path / "bag"
    shutil.copytree(walked_twice.bag, bag)
    (bag / "metadata.yaml").unlink()
    (file,) = bag.glob("*.mcap")
    with file.open("r+b") as stream:
        stream.truncate(file.stat().st_size // 2)
    with pytest.raises(BagError, match="biped bag recover") as raised:
        read_walk(bag)
    assert "\n" not in str(raised.value)


def test_a_memory_of_another_version_is_refused(walked_twice, tmp_path):
    old = tmp_path / "memory.npz"
    content = walked_twice.memory.read_bytes()
    text = '"version": 2'.encode("utf-32-le")
    assert content.count(text) == 1
    old.write_bytes(content.replace(text, '"version": 9'.encode("utf-32-le")))
    with pytest.raises(CheckpointError):
        read_walk(old)


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("nothing", None, "no such file or folder"),
        ("notes.txt", b"hello", "neither a bag nor a memory"),
        ("walk.mcap", b"hello", "not an MCAP file"),
        ("memory.npz", b"hello", "not a biped checkpoint, or damaged"),
        ("folder/notes.txt", b"hello", "neither a bag nor a run"),
    ],
)
def test_what_holds_no_walk_is_refused_in_one_line(tmp_path, name, content, reason):
    path = tmp_path / name
    if content is not None:
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
    source = path.parent if "/" in name else path
    with pytest.raises(BipedError, match=reason) as raised:
        read_walk(source)
    assert "\n" not in str(raised.value)
