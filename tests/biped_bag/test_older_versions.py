"""Bags of older versions: looked into and played as ever, and refused where they must.

`older_versions/` holds a second of a walk per version that was released.
"""

from pathlib import Path

import pytest

from biped_bag.storage.reader import BagReader
from biped_bringup.cli.main import main

BAGS = sorted((Path(__file__).parent / "older_versions").iterdir())


@pytest.fixture(params=BAGS, ids=lambda folder: folder.name)
def bag(request) -> Path:
    return request.param


def test_every_message_is_read(bag):
    read = BagReader(bag)
    assert sum(1 for _ in read.messages()) == read.message_count


def test_it_is_described(bag, capsys):
    assert main(["bag", "info", str(bag)]) == 0
    assert "/biped/stance" in capsys.readouterr().out


def test_payloads_that_are_as_they_were_are_exported(bag, tmp_path):
    tables = tmp_path / "tables"
    topics = ("--topics", "/biped/observation", "/biped/correction")
    assert main(["bag", "export", str(bag), str(tables), *topics]) == 0
    assert any(tables.iterdir())


def test_a_payload_of_another_version_is_named(bag, tmp_path, capsys):
    assert main(["bag", "export", str(bag), str(tmp_path / "tables")]) == 2
    complaint = capsys.readouterr().err
    assert "/biped/learner: the message logged at" in complaint
    assert "`$.version`" in complaint


def test_a_learner_of_another_version_is_not_pretended_to_be_the_same(bag, capsys):
    assert main(["bag", "verify", str(bag)]) == 2
    complaint = capsys.readouterr().err
    assert "was recorded by another version" in complaint
    assert complaint.count("\n") == 1
