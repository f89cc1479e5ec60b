"""`ros2 bag info` and `play`, as far as the tests of biped_bag do not reach."""

from pathlib import Path

import pytest

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
