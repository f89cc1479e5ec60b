"""What the options of `ros2 bag record` ask of the recorder."""

import argparse
from types import SimpleNamespace

import pytest

from biped_bag.recorder.selection import selection_of
from ros2_verbs.bag import record
from ros2_verbs.errors import VerbError


def settings(folder: object, *options: str) -> SimpleNamespace:
    """Return the recorder's settings and its selection of topics."""
    parser = argparse.ArgumentParser()
    record.add_arguments(parser)
    asked = record.settings_of(parser.parse_args([*options, "-o", f"{folder}/bag"]))
    return SimpleNamespace(settings=asked, wants=selection_of(asked).wants)


def test_a_regular_expression_may_match_a_part_of_a_name(tmp_path):
    made = settings(tmp_path, "-e", "zmp", "-x", "reference")
    assert made.wants("/biped/zmp") and not made.wants("/biped/zmp_reference")


def test_topics_can_be_named_in_both_ways(tmp_path):
    made = settings(tmp_path, "/clock", "--topics", "/joint_states")
    assert made.wants("/clock") and made.wants("/joint_states")
    assert not made.wants("/biped/zmp")


def test_all_overrides_the_regular_expression(tmp_path):
    assert settings(tmp_path, "-a", "-e", "zmp").wants("/clock")


def test_the_size_of_a_file_is_rounded_up_to_megabytes(tmp_path):
    made = settings(tmp_path, "-a", "-b", "1500000").settings
    assert (made.split, made.max_file_mb) == ("size", 2)


def test_nothing_chosen_is_refused(tmp_path):
    with pytest.raises(VerbError, match="at least one option out of --all"):
        settings(tmp_path)


def test_a_folder_that_is_there_is_refused(tmp_path):
    (tmp_path / "bag").mkdir()
    with pytest.raises(VerbError, match="already exists"):
        settings(tmp_path, "-a")
