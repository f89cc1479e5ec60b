"""Tables of a bag: one row per message, one column per number, units in its name."""

import csv
import json

import pyarrow.parquet
import pytest
from tests.biped_bag.bags import RELIABLE, START_NS, TICK_NS, record
from tests.payloads import STAMPED_PHASE

from biped_bag.errors import BagError
from biped_bag.export import export
from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.reader import BagReader
from biped_bag.storage.writer import BagWriter
from biped_description.joints import JOINT_NAMES
from biped_ros.cdr import string_message
from biped_ros.messages import (
    correction_template,
    point_template,
    segment_template,
)
from msgs_json import topics
from msgs_json.wire import encode

STATES = topics.JOINT_STATES.name


def bag_of(folder, *messages):
    """Return a bag of (topic, serialized message)."""
    writer = BagWriter(folder)
    for topic in dict.fromkeys(topic for topic, _ in messages):
        writer.add_topic(BagTopic(topic.name, topic.type_name, [RELIABLE]))
    for i, (topic, data) in enumerate(messages):
        writer.write(BagMessage(topic.name, bytes(data), START_NS + i, START_NS))
    writer.close()
    return BagReader(folder)


def exported(bag, name, folder):
    """Return the table of one topic."""
    (done,) = export(bag, folder / "tables", "parquet", [name])
    return pyarrow.parquet.read_table(done.file)


@pytest.fixture(scope="module")
def walk(tmp_path_factory):
    """A bag of 20 control ticks."""
    folder = tmp_path_factory.mktemp("bags") / "bag"
    record(folder, ticks=20)
    return BagReader(folder)


def test_a_topic_becomes_one_file_with_one_row_per_message(walk, tmp_path):
    export(walk, tmp_path, "parquet")
    names = {"clock.parquet", "joint_states.parquet", "robot_description.parquet"}
    assert {file.name for file in tmp_path.iterdir()} == names
    table = pyarrow.parquet.read_table(tmp_path / "joint_states.parquet")
    assert table.num_rows == 20


def test_joints_have_columns_by_name_with_units(walk, tmp_path):
    table = exported(walk, STATES, tmp_path)
    expected = ["log_time_ns", "stamp_ns", "frame_id"]
    for field in ("position_{}_rad", "velocity_{}_rad_s", "effort_{}_n_m"):
        expected += [field.format(joint) for joint in JOINT_NAMES]
    assert table.column_names == expected
    row = table.slice(7, 1).to_pylist()[0]
    knee = JOINT_NAMES.index("left_knee")
    assert row["stamp_ns"] == 7 * TICK_NS
    assert row["log_time_ns"] == START_NS + 7 * TICK_NS + 7
    assert row["position_left_knee_rad"] == pytest.approx(0.007 + knee)
    assert row["effort_left_knee_n_m"] == pytest.approx(3 * (0.007 + knee))


def test_points_are_named_for_what_they_are(tmp_path):
    point = point_template().fill((0.1, -0.02), 3)
    correction = correction_template().fill((0.004, 0.001), 3)
    bag = bag_of(tmp_path / "bag", (topics.ZMP, point), (topics.CORRECTION, correction))
    zmp = exported(bag, topics.ZMP.name, tmp_path).to_pylist()[0]
    assert (zmp["zmp_x_m"], zmp["zmp_y_m"]) == (0.1, -0.02)
    row = exported(bag, topics.CORRECTION.name, tmp_path).to_pylist()[0]
    assert (row["correction_x_m"], row["frame_id"]) == (0.004, "world")


def test_json_payloads_become_columns(tmp_path):
    bag = bag_of(
        tmp_path / "bag", (topics.PHASE, string_message(encode(STAMPED_PHASE)))
    )
    row = exported(bag, topics.PHASE.name, tmp_path).to_pylist()[0]
    assert row["step_index"] == 2
    assert row["planned_right_support"] is True
    assert row["clock_ticks"] == 1040


def test_waist_references_are_lists_over_their_rows(tmp_path):
    values = range(3 * 4 * 3)
    segment = segment_template(3).fill([float(value) for value in values], 5)
    bag = bag_of(tmp_path / "bag", (topics.WAIST_REFERENCE, segment))
    row = exported(bag, topics.WAIST_REFERENCE.name, tmp_path).to_pylist()[0]
    assert row["waist_y_m"] == [1.0, 13.0, 25.0]
    assert row["time_from_start_ns"] == [0, TICK_NS, 2 * TICK_NS]


def test_csv_says_the_same_as_parquet(walk, tmp_path):
    (done,) = export(walk, tmp_path, "csv", [STATES])
    with done.file.open() as stream:
        rows = list(csv.DictReader(stream))
    table = exported(walk, STATES, tmp_path).to_pylist()
    assert [float(row["position_left_knee_rad"]) for row in rows] == [
        row["position_left_knee_rad"] for row in table
    ]


def test_lists_are_json_in_csv(tmp_path):
    segment = segment_template(2).fill([0.5] * 24, 5)
    bag = bag_of(tmp_path / "bag", (topics.WAIST_REFERENCE, segment))
    (done,) = export(bag, tmp_path / "out", "csv")
    with done.file.open() as stream:
        row = next(csv.DictReader(stream))
    assert json.loads(row["waist_x_m"]) == [0.5, 0.5]


def test_only_the_topics_asked_for_are_exported(walk, tmp_path):
    done = export(walk, tmp_path, "parquet", [STATES])
    assert [table.topic for table in done] == [STATES]


def test_a_table_that_is_there_is_replaced_only_if_asked(walk, tmp_path):
    file = tmp_path / "joint_states.parquet"
    file.write_text("mine")
    with pytest.raises(BagError, match="is there already; --force replaces it"):
        export(walk, tmp_path, "parquet")
    assert [path.name for path in tmp_path.iterdir()] == [file.name]
    export(walk, tmp_path, "parquet", [STATES], replace=True)
    assert pyarrow.parquet.read_table(file).num_rows == 20


def test_a_message_that_is_not_of_its_type_is_named(tmp_path):
    bag = bag_of(tmp_path / "bag", (topics.PHASE, string_message("{}")))
    with pytest.raises(
        BagError, match=rf"/biped/phase: the message logged at {START_NS}"
    ):
        export(bag, tmp_path / "out", "parquet")
    assert not (tmp_path / "out").exists()
