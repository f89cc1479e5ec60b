"""`ros2 bag`, as far as the tests of biped_bag do not reach."""

import argparse
import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from ros2_verbs.bag import record
from ros2_verbs.errors import VerbError
from ros2_verbs.main import main

SAMPLE = Path(__file__).parents[2] / "bags" / "sample"


def test_names_of_topics_are_listed_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bag", "info", "-t", str(SAMPLE)]) == 0
    names = capsys.readouterr().out.splitlines()
    assert names == sorted(names) and "/biped/zmp" in names


def test_a_bag_is_described(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bag", "info", str(SAMPLE)]) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("\nFiles:             sample_0.mcap\nBag size:          ")
    assert "\nTopic information: Topic: /biped/correction | Type: geometry_" in shown


@pytest.mark.parametrize("verb", ["info", "play"])
def test_what_is_no_bag_is_one_line(
    verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = tmp_path / "nowhere"
    assert main(["bag", verb, str(missing)]) == 1
    error = f"[ERROR] [ros2bag]: {missing}: no such file or folder\n"
    assert capsys.readouterr().err == error


def settings(folder: object, *options: str) -> SimpleNamespace:
    """Return the recorder's settings and its selection of topics."""
    parser = argparse.ArgumentParser()
    record.add_arguments(parser)
    asked = record.settings_of(parser.parse_args([*options, "-o", f"{folder}/bag"]))

    def wants(topic: str, type_name: str = "std_msgs/msg/String") -> bool:
        return asked.selection().wants(topic, [type_name])

    return SimpleNamespace(settings=asked, wants=wants)


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


def test_topics_can_be_chosen_by_type_and_excluded_by_name(tmp_path):
    made = settings(
        tmp_path, "--topic-types", "std_msgs/msg/String", "--exclude-topics", "/y"
    )
    assert made.wants("/x") and not made.wants("/y")
    assert not made.wants("/clock", "rosgraph_msgs/msg/Clock")


def test_names_alone_cannot_be_excluded_from(tmp_path):
    with pytest.raises(VerbError, match="--exclude-topics argument requires either"):
        settings(tmp_path, "/x", "--exclude-topics", "/x")


def refusal(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str]:
    """Return the status, and the last line on stderr."""
    try:
        status = main(["bag", *words])
    except SystemExit as ended:
        status = int(ended.code or 0)
    return status, capsys.readouterr().err.splitlines()[-1]


@pytest.mark.parametrize(
    ("words", "status", "named"),
    [
        (["-x", "["], 2, "argument -x/--exclude-regex: [: unterminated"),
        (["-e", "("], 2, "argument -e/--regex: (: missing )"),
        (["-m", "/a"], 2, "argument -m/--remap: /a: must have the form OLD:=NEW"),
        (["--clock", "0"], 2, "argument --clock: 0: must be a positive number"),
        (["--start-offset", "99"], 1, " s, so playing cannot start at 99"),
        (["--playback-until-nsec", "7"], 1, "playing cannot end at 7 ns of the epoch"),
    ],
)
def test_an_error_of_play_names_no_option_but_the_one_that_was_typed(
    words: list[str], status: int, named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    ended, line = refusal(capsys, "play", str(SAMPLE), *words)
    assert (ended, named in line) == (status, True)
    assert not set(re.findall("--[a-z-]+", line)) - set(re.findall("--[a-z-]+", named))


def test_an_error_of_record_names_the_option_that_was_typed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    status, line = refusal(capsys, "record", "-x", "[")
    assert (status, "argument -x/--exclude-regex: [" in line) == (2, True)
