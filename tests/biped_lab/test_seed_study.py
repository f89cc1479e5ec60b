"""Studies over many seeds: unfinished runs count, finished seeds are not run again."""

import json
import re
import sys

import pytest

from biped_lab.seed_study import (
    RUNS_FILE,
    _parser,
    _seeds,
    main,
    read_runs,
    study_of,
    summary,
)


def run(seed: int = 0, schedule: int | None = 40, greedy: int | None = 50, **figures):
    return {
        "seed": seed,
        "completed": greedy is not None,
        "schedule_complete": schedule is not None,
        "schedule_episodes": schedule,
        "greedy_episodes": greedy,
        "simulated_s": 100.0,
        "cpu_s": 5.0,
        **figures,
    }


# -- seeds -------------------------------------------------------------------------


def test_seeds_are_given_from_first_to_last():
    assert _seeds("101-104") == [101, 102, 103, 104]


def test_a_single_seed_is_a_range_of_one():
    assert _seeds("7") == [7]


@pytest.mark.parametrize("text", ["", "a", "1-b", "1-2-3", "-3"])
def test_other_seeds_are_not_understood(text):
    with pytest.raises(ValueError):
        _seeds(text)


def test_what_follows_the_dashes_goes_to_the_learner():
    options = _parser().parse_args(
        ["--seeds", "1-2", "--out", "x", "--", "--preset", "quick"]
    )
    assert options.learn == ["--preset", "quick"]


# -- runs --------------------------------------------------------------------------


def test_a_study_that_has_not_begun_has_no_runs(tmp_path):
    assert read_runs(tmp_path / RUNS_FILE) == []


def test_a_study_goes_on_from_the_runs_on_file(tmp_path):
    runs = [run(3), run(4, None, None)]
    file = tmp_path / RUNS_FILE
    file.write_text("".join(json.dumps(each) + "\n" for each in runs))
    assert read_runs(file) == runs


@pytest.fixture
def study(tmp_path, monkeypatch):
    """Run the study of seed 3 with these options of `biped learn`."""
    command = ["seed_study", "--seeds", "3", "--out", str(tmp_path), "--"]

    def run_study(*learn_options: str) -> int:
        monkeypatch.setattr(sys, "argv", [*command, *learn_options])
        return main()

    return run_study


def test_a_seed_is_run_once_and_then_stands_on_file(study, tmp_path, capfd):
    short = ("gait.steps=1", "learner.schedule.successes_per_subtask=1")
    options = ("--preset", "quick", "--set", short[0], "--set", short[1])
    assert study(*options) == 0
    (first,) = read_runs(tmp_path / RUNS_FILE)
    assert first["seed"] == 3
    assert first["walk"]["completed"] == first["completed"]
    memory = tmp_path / "seed_3" / "memory.npz"
    learned_at = memory.stat().st_mtime_ns
    assert study(*options) == 0
    assert read_runs(tmp_path / RUNS_FILE) == [first]
    assert memory.stat().st_mtime_ns == learned_at
    assert "1 seeds" in capfd.readouterr().out


def test_a_run_that_cannot_be_carried_out_fails_the_study(study, tmp_path, capfd):
    assert study("--set", "gait.step_length_m=0.45") == 1
    assert "seed 3: biped learn: the robot cannot walk" in capfd.readouterr().err
    assert read_runs(tmp_path / RUNS_FILE) == []


def test_a_wrong_setting_is_refused_before_anything_is_run(study, tmp_path, capfd):
    assert study("--set", "gait.shoes=2") == 2
    assert capfd.readouterr().err.startswith("gait.shoes = 2: unknown key")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--preset", "quick"), r"settings\.\S*rewards_to_fix 15 -> 3"),
        (("--episodes", "9"), r"end\.episodes None -> 9"),
        (("--stop-at-schedule",), r"end\.stop_at_schedule False -> True"),
    ],
)
def test_runs_of_another_study_are_refused(study, tmp_path, capfd, options, said):
    (tmp_path / RUNS_FILE).write_text(json.dumps(run(3) | study_of([])) + "\n")
    assert study(*options) == 2
    (line,) = capfd.readouterr().err.splitlines()
    assert re.search(rf"runs\.jsonl: seed 3 is of another study, .*{said}", line)


def test_a_run_that_does_not_say_its_settings_is_refused(study, tmp_path, capfd):
    (tmp_path / RUNS_FILE).write_text(json.dumps(run(3)) + "\n")
    assert study() == 2
    assert "seed 3 is of another study, does not say" in capfd.readouterr().err


# -- summary -----------------------------------------------------------------------


def test_a_summary_counts_who_came_how_far():
    text = summary([run(), run(1, 60, None), run(2, None, None)])
    assert text.startswith(
        "3 seeds; schedule complete 2, frozen greedy walk learned 1\n"
    )


def test_a_summary_gives_minimum_median_and_maximum():
    text = summary([run(0, 30), run(1, 50), run(2, 40)])
    assert "episodes to the schedule's end: min 30, median 40, max 50\n" in text


def test_an_even_number_of_runs_has_its_median_in_between():
    text = summary([run(0, 30), run(1, 50)])
    assert "schedule's end: min 30, median 40, max 50\n" in text


def test_a_censored_run_counts_as_longer_than_any_other():
    text = summary([run(0, 30, 30), run(1, 90, None), run(2, 40, 40)])
    assert "greedy walk: min 30, median 40, max inf (1 censored)\n" in text


def test_a_median_among_censored_runs_is_not_known():
    text = summary([run(0, 30, 30), run(1, 90, None), run(2, 40, None)])
    assert "greedy walk: min 30, median inf, max inf (2 censored)\n" in text


def test_censored_runs_alone_have_no_bound():
    text = summary([run(0, None, None)])
    assert "schedule's end: min inf, median inf, max inf (1 censored)" in text


def test_a_summary_gives_the_median_of_both_times():
    text = summary([run(simulated_s=900.0, cpu_s=40.0)] * 3 + [run()])
    assert text.endswith("simulated s: median 900; CPU s: median 40")


def test_no_runs_have_no_summary():
    assert summary([]) == "no runs"
