"""`biped lab status` and `compare` on a study that was carried out."""

import argparse
import shutil

import pytest

from biped_lab.results import ResultsError
from biped_lab.run_folder import END_FILE
from biped_lab.verbs import compare, status


@pytest.fixture
def call(capsys, monkeypatch):
    """Call a verb; return what it printed, line by line."""

    def run(verb, *words):
        verbs = argparse.ArgumentParser()
        verb.add_parser(verbs.add_subparsers(), ())
        name = verb.__name__.rsplit(".", 1)[1]
        options = verbs.parse_args([name, *map(str, words)])
        assert options.run(options) == 0
        return [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]

    monkeypatch.setenv("COLUMNS", "120")
    return run


def test_status_says_what_is_done_and_what_is_left(lab, call):
    text = call(status, lab)
    assert "2 of 2 runs done, 0 running; nothing left" in text
    (run, *_) = (lab / "runs").iterdir()
    (run / END_FILE).unlink()
    text = call(status, lab)
    assert any(line.startswith("1 of 2 runs done, 0 running; about") for line in text)


def test_status_of_a_folder_without_a_study_is_an_error(tmp_path, call):
    with pytest.raises(ResultsError, match=f"^{tmp_path}: no study$"):
        call(status, tmp_path)


def test_a_study_is_as_fast_as_itself(lab, call, tmp_path):
    shutil.copytree(lab / "small", tmp_path / "lab2" / "small")
    shutil.copytree(lab / "runs", tmp_path / "lab2" / "runs")
    rows = [
        [cell.strip() for cell in line.split("|")]
        for line in call(compare, lab / "small", tmp_path / "lab2" / "small")[2:]
    ]
    assert [row[1] for row in rows] == ["fixed", "free"]
    for _, _, one, other, ratio, faster, p, _ in rows:
        assert one == other
        assert (ratio, faster.split()[0], p) == ("1.00", "0.50", "1")
