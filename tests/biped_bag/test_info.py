"""What a bag holds, in the words and columns of `ros2 bag info`."""

import re
import time

import pytest
from tests.biped_bag.bags import record

from biped_bag.info import info_mapping, info_text, run_text
from biped_bag.storage.reader import BagReader
from biped_bag.storage.writer import BagWriter


@pytest.fixture
def in_utc(monkeypatch):
    """Local time is UTC."""
    monkeypatch.setenv("TZ", "UTC")
    time.tzset()
    yield
    monkeypatch.undo()
    time.tzset()


@pytest.mark.usefixtures("in_utc")
def test_it_reads_as_ros2_bag_info_does(tmp_path):
    record(tmp_path / "bag", ticks=50)
    text = info_text(BagReader(tmp_path / "bag"))
    size = sum(file.stat().st_size for file in (tmp_path / "bag").iterdir())
    assert text.splitlines() == [
        "",
        "Files:             bag_0.mcap",
        f"Bag size:          {size / 1024:.1f} KiB",
        "Storage id:        mcap",
        "ROS Distro:        jazzy",
        "Duration:          0.098000007s",
        "Start:             Nov 14 2023 22:13:20.000000000 (1700000000.000000000)",
        "End:               Nov 14 2023 22:13:20.098000007 (1700000000.098000007)",
        "Messages:          101",
        "Topic information: Topic: /clock | Type: rosgraph_msgs/msg/Clock | Count: 50 "
        "| Serialization Format: cdr",
        "                   Topic: /joint_states | Type: sensor_msgs/msg/JointState | "
        "Count: 50 | Serialization Format: cdr",
        "                   Topic: /robot_description | Type: std_msgs/msg/String | "
        "Count: 1 | Serialization Format: cdr",
        "Service:           0",
        "Service information: ",
    ]


def test_several_files_stand_one_below_the_other(tmp_path):
    record(tmp_path / "bag", ticks=200, max_file_bytes=15_000)
    text = info_text(BagReader(tmp_path / "bag"))
    assert re.search(r"\nFiles:             bag_0\.mcap\n {19}bag_1\.mcap\n", text)


def test_the_run_and_the_ends_of_its_episodes_are_told(tmp_path):
    writer = BagWriter(
        tmp_path / "bag",
        records={"biped.run": {"seed": "3", "git_commit": "abc", "git_dirty": "true"}},
    )
    for number, cause in enumerate(["zmp_error", "zmp_error", "completed"], start=1):
        writer.add_record(
            "biped.episode",
            {
                "episode": str(number),
                "end_cause": cause,
                "control_ticks": "900",
                "target_ticks": "937",
            },
        )
    writer.close()
    bag = BagReader(tmp_path / "bag")
    assert run_text(bag).splitlines() == [
        "Run:               seed 3, commit abc, with changes",
        "Episodes:          3 (zmp_error 2, completed 1)",
        *(
            f"                   Episode: {number} | End cause: {cause} | "
            "Control ticks: 900 of 937"
            for number, cause in ((1, "zmp_error"), (2, "zmp_error"), (3, "completed"))
        ),
    ]
    ends = [episode["end_cause"] for episode in info_mapping(bag)["episodes"]]
    assert ends == ["zmp_error", "zmp_error", "completed"]
