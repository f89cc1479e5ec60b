"""`biped bag` as users meet it: one line for what is wrong, a status for scripts."""

import json
import re

import pytest
from tests.biped_bag.bags import RELIABLE, record

from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.reader import BagReader
from biped_bag.storage.writer import BagWriter
from biped_common.terminal_text import printable
from biped_ros.cdr import string_message

READERS = ("info {}", "cut {} out --start 0", "export {} out")
# What is given as a bag, and what the line must say.
REFUSED = {
    "none": r"none: no such file or folder",
    "empty.mcap": r"empty\.mcap: empty, nothing was recorded",
    "text.mcap": r"text\.mcap: not an MCAP file",
    "folder": r"folder: not a bag, it has no \.mcap file",
    "unfinished": r"has no metadata\.yaml.*`biped bag recover unfinished OUT`",
    "truncated.mcap": r"cut off.*`biped bag recover truncated\.mcap OUT` saves",
    "flipped.mcap": r"damaged.*`biped bag recover flipped\.mcap OUT` saves",
}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A bag of 0.2 s."""
    folder = tmp_path_factory.mktemp("recorded") / "bag"
    record(folder, ticks=100)
    return folder


@pytest.fixture
def bags(recorded, biped, tmp_path):
    """Put what the command lines name into the folder where they are run."""
    content = (recorded / "bag_0.mcap").read_bytes()
    middle = len(content) // 2
    (tmp_path / "bag").symlink_to(recorded)
    (tmp_path / "empty.mcap").touch()
    (tmp_path / "text.mcap").write_text("no bag at all\n" * 100)
    (tmp_path / "folder").mkdir()
    (tmp_path / "unfinished").mkdir()
    (tmp_path / "unfinished" / "unfinished_0.mcap").write_bytes(content[:-200])
    (tmp_path / "truncated.mcap").write_bytes(content[:middle])
    flipped = bytearray(content)
    flipped[middle] ^= 0x20
    (tmp_path / "flipped.mcap").write_bytes(flipped)
    return biped


@pytest.mark.parametrize("verb", READERS)
@pytest.mark.parametrize("bag", REFUSED)
def test_what_is_no_sound_bag_is_refused_in_one_line(bags, tmp_path, verb, bag):
    outcome = bags("bag", *verb.format(bag).split())
    assert (outcome.status, outcome.out) == (2, "")
    assert len(outcome.err.splitlines()) == 1
    assert re.search(REFUSED[bag], outcome.err)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("bag", ["truncated.mcap", "flipped.mcap", "unfinished"])
def test_what_is_refused_can_be_recovered(bags, tmp_path, bag):
    outcome = bags("bag", "recover", bag, "out", "--json")
    told = outcome.values
    assert outcome.status == (0 if told["nothing_lost"] else 3)
    assert BagReader(tmp_path / "out").message_count == told["recovered"] > 0


def test_recovering_a_sound_bag_loses_nothing(bags):
    outcome = bags("bag", "recover", "bag", "out")
    assert outcome.status == 0
    assert outcome.out.splitlines()[-1] == "nothing was lost"


def test_recovering_a_damaged_bag_says_what_was_lost(bags):
    outcome = bags("bag", "recover", "flipped.mcap", "out")
    assert outcome.status == 3
    assert re.search(r"lost: /clock: \d+ of 100 messages, 0\.\d+ s\n", outcome.out)


@pytest.mark.parametrize(
    ("line", "status", "text"),
    [
        ("recover text.mcap out", 1, r"text\.mcap: not an MCAP file"),
        ("recover empty.mcap out", 1, r"empty\.mcap: empty"),
        ("recover folder out", 1, r"folder: not a bag"),
        ("recover truncated.mcap text.mcap/out", 1, r"text\.mcap/out: Not a directory"),
        ("recover none out", 2, r"none: no such file or folder"),
        ("recover bag folder", 2, r"folder: is there already"),
        ("cut bag out", 2, r"needs --start or --end or both, or else --episodes"),
        ("cut bag out --start 0 --episodes 1", 2, r"or else --episodes"),
        ("cut bag out --start 5", 2, r"must lie within the bag's"),
        ("cut bag out --episodes 1-2", 2, r"no finished episode from 1 to 2"),
        ("cut bag folder --start 0", 2, r"folder: is there already"),
        ("cut bag text.mcap/out --start 0", 2, r"text\.mcap/out: Not a directory"),
        ("export bag text.mcap", 2, r"text\.mcap: cannot be written to"),
        ("export bag out --topics /odom", 2, r"no topic /odom; there: /clock"),
    ],
)
def test_wrong_input_is_refused_in_one_line(bags, tmp_path, line, status, text):
    outcome = bags("bag", *line.split())
    assert (outcome.status, outcome.out) == (status, "")
    assert len(outcome.err.splitlines()) == 1
    assert re.search(text, outcome.err)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "line",
    [
        "",
        "recover bag",
        "cut bag out --start -1",
        "cut bag out --start nan",
        "cut bag out --episodes 3-1",
        "cut bag out --episodes one",
        "export bag out --format xml",
    ],
)
def test_it_is_not_understood(bags, line):
    outcome = bags("bag", *line.split())
    assert (outcome.status, outcome.out) == (2, "")
    assert outcome.err.startswith("biped bag")


def test_info_tells_scripts_the_same(bags):
    told = bags("bag", "info", "bag", "--json").values
    assert told["messages"] == 201
    assert {t["name"]: t["count"] for t in told["topics"]}["/clock"] == 100
    assert told["run"]["seed"] == "7"


def test_info_names_run_and_topics(bags):
    out = bags("bag", "info", "bag").out
    assert "Topic: /clock | Type: rosgraph_msgs/msg/Clock | Count: 100 |" in out
    assert "Run:               seed 7" in out


def test_a_cut_is_a_bag_again(bags, tmp_path):
    outcome = bags("bag", "cut", "bag", "out", "--start", "0.1", "--end", "0.15")
    assert outcome.status == 0
    assert BagReader(tmp_path / "out").topics["/clock"].count == 25


def test_an_export_names_its_tables(bags):
    told = json.loads(bags("bag", "export", "bag", "out", "--json").out)
    assert told["/clock"] == {"file": "out/clock.parquet", "rows": 100}


NAME = "/a\n/b\x1b[2J"
NAME_AS_SHOWN = "/a\\n/b\\x1b[2J"


@pytest.fixture(params=[NAME, "/a"])
def hostile(request, biped, tmp_path):
    """A bag whose topic or run would clear the screen and make lines of their own."""
    run = {"seed": "7\n\x1b[2J", "preset": "\u202e"}
    writer = BagWriter(tmp_path / "bag", records={"biped.run": run})
    writer.add_topic(BagTopic(request.param, "std_msgs/msg/String", [RELIABLE]))
    writer.write(BagMessage(request.param, string_message("text"), 1, 1, 1))
    writer.close()
    return biped


@pytest.mark.parametrize("verb", ["info", "export {} out", "verify", "play"])
def test_names_in_a_bag_do_not_act_on_the_terminal(hostile, verb):
    command = verb if "{}" in verb else f"{verb} {{}}"
    done = hostile("bag", *command.format("bag").split())
    shown = done.out + done.err
    assert shown == printable(shown, layout=True)


@pytest.mark.parametrize("hostile", [NAME], indirect=True)
def test_a_topic_that_would_act_on_the_terminal_is_refused_in_one_line(hostile):
    done = hostile("bag", "info", "bag")
    assert (done.status, done.err.count("\n")) == (2, 1)
    assert f"topic '{NAME_AS_SHOWN}'" in done.err


@pytest.mark.parametrize("hostile", ["/a"], indirect=True)
def test_what_a_run_says_of_itself_makes_no_line_of_its_own(hostile):
    shown = hostile("bag", "info", "bag").out
    assert "seed 7\\n\\x1b[2J, preset \\u202e" in shown
