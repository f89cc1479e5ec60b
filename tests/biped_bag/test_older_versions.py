"""Bags of older versions: looked into and played as ever, and refused where they must.

`older_versions/` holds a second of a walk per version that was released.
"""

from pathlib import Path

import pytest

from biped_bag.storage.reader import BagReader
from biped_bringup.cli.main import main

FOLDER = Path(__file__).parent / "older_versions"
SAMPLE = Path(__file__).parents[2] / "bags/sample"
# What each version had of its own, and payloads whose fields have changed since.
LATCHED = {"v0_1_0": "/biped/stance", "v0_2_0": "/biped/plan"}
CHANGED = [
    ("v0_1_0", "/biped/learner"),
    ("v0_2_0", "/biped/learner"),
    ("v0_2_0", "/biped/phase"),
]


@pytest.fixture(params=sorted(FOLDER.iterdir()), ids=lambda folder: folder.name)
def bag(request) -> Path:
    return request.param


def test_every_message_is_read(bag):
    read = BagReader(bag)
    assert sum(1 for _ in read.messages()) == read.message_count


def test_it_is_described(bag, capsys):
    assert main(["bag", "info", str(bag)]) == 0
    assert LATCHED[bag.name] in capsys.readouterr().out


def test_payloads_that_are_as_they_were_are_exported(bag, tmp_path):
    tables = tmp_path / "tables"
    topics = ("--topics", "/biped/observation", "/biped/correction")
    assert main(["bag", "export", str(bag), str(tables), *topics]) == 0
    assert any(tables.iterdir())


@pytest.mark.parametrize(("version", "topic"), CHANGED)
def test_a_payload_of_another_version_is_named(version, topic, tmp_path, capsys):
    words = ["bag", "export", str(FOLDER / version), str(tmp_path / "tables")]
    assert main([*words, "--topics", topic]) == 2
    complaint = capsys.readouterr().err
    assert f"{topic}: the message logged at" in complaint
    assert "`$.version`" in complaint


def test_the_settings_of_another_version_are_refused_in_one_line(capsys):
    assert main(["bag", "verify", str(FOLDER / "v0_1_0")]) == 2
    complaint = capsys.readouterr().err
    assert "was recorded by another version" in complaint
    assert complaint.count("\n") == 1


def test_a_learner_of_another_version_is_not_pretended_to_be_the_same(capsys):
    bag, settings = FOLDER / "v0_2_0", ("--run-of", str(SAMPLE))
    assert main(["bag", "verify", str(bag), *settings]) == 1
    told = capsys.readouterr().out
    assert "passed over: 3 messages on /biped/learner that no node understands" in told
    assert "not verified: 0 of 48" in told
