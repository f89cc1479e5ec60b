"""Studies from YAML: what they plan, and what they refuse."""

from pathlib import Path
from typing import Any

import pytest

from biped_lab.results import plan_study, read_study
from biped_lab.run_folder import END_FILE
from biped_lab.study import (
    Study,
    StudyError,
    load_study,
    study_names,
    study_of,
)

SMALL: dict[str, Any] = {
    "title": "small",
    "preset": "quick",
    "most_episodes": 20,
    "seeds": {"first": 7, "count": 3},
    "axes": {
        "K": {
            "setting": "learner.xol.fixed_mode.rewards_to_fix",
            "values": [1, 3],
        }
    },
    "arms": {
        "none": {"settings": {"learner.xol.fixed_mode.strategy": "none"}, "seeds": 2}
    },
    "baseline": "none",
    "reduced": {"seeds": 1, "arms": ["K = 3", "none"], "most_episodes": 5},
}


def addresses(study: Study) -> list[str]:
    return [spec.address for _, spec in study.specs()]


# -- planning --------------------------------------------------------------------------


def test_axes_and_arms_make_the_runs() -> None:
    study = study_of("small", SMALL)
    assert [arm.name for arm in study.arms] == ["K = 1", "K = 3", "none"]
    assert [arm.seeds for arm in study.arms] == [(7, 8, 9), (7, 8, 9), (7, 8)]
    assert study.arms[1].settings.learner.xol.fixed_mode.rewards_to_fix == 3
    assert study.arms[1].factors == {"K": 3}


def test_two_axes_make_every_combination() -> None:
    second = {
        "LT": {"setting": "learner.schedule.successes_per_subtask", "values": [2]}
    }
    study = study_of("small", SMALL | {"axes": SMALL["axes"] | second})
    assert [arm.name for arm in study.arms][:2] == ["K = 1, LT = 2", "K = 3, LT = 2"]


def test_an_arm_can_change_what_the_axes_made() -> None:
    study = study_of("small", SMALL | {"arms": {"K = 3": {"seeds": 1}, "none": None}})
    arm = study.arms[1]
    assert (arm.name, arm.seeds, arm.factors) == ("K = 3", (7,), {"K": 3})
    assert arm.settings.learner.xol.fixed_mode.rewards_to_fix == 3


def test_runs_come_seed_by_seed() -> None:
    arms = [arm for arm, _ in study_of("small", SMALL).specs()]
    assert arms == ["K = 1", "K = 3", "none"] * 2 + ["K = 1", "K = 3"]


def test_addresses_tell_runs_apart() -> None:
    found = addresses(study_of("small", SMALL))
    assert len(set(found)) == len(found) == 8


@pytest.mark.parametrize(
    "change",
    [
        {"settings": {"gait.steps": 2}},
        {"goal": "greedy"},
        {"most_episodes": 21},
        {"seeds": {"first": 107, "count": 3}},
    ],
)
def test_what_decides_a_run_is_in_its_address(change: dict[str, Any]) -> None:
    before, after = study_of("small", SMALL), study_of("small", SMALL | change)
    assert not set(addresses(before)) & set(addresses(after))


@pytest.mark.parametrize(
    "change",
    [
        {"title": "another", "claim": "none", "figure": "fixed states"},
        {"seeds": {"first": 7, "count": 5}},
        # A setting by its default is the same setting.
        {"settings": {"gait.steps": 5}},
    ],
)
def test_what_is_asked_of_runs_does_not_change_them(change: dict[str, Any]) -> None:
    before, after = study_of("small", SMALL), study_of("small", SMALL | change)
    assert set(addresses(before)) <= set(addresses(after))


def test_the_reduced_study_is_a_part_of_the_whole() -> None:
    whole, less = study_of("small", SMALL), study_of("small", SMALL, reduced=True)
    assert less.name == "small-reduced"
    assert [(arm.name, arm.seeds) for arm in less.arms] == [
        ("K = 3", (7,)), ("none", (7,))
    ]  # fmt: skip
    assert less.file.most_episodes == 5 != whole.file.most_episodes


def seeds_of(folder: Path) -> set[str]:
    """Return those that are written down of the study `small`."""
    return {seed for arm in read_study(folder, "small").arms for seed in arm.runs}


def test_a_sitting_is_the_first_seeds_of_the_whole(tmp_path: Path) -> None:
    whole = study_of("small", SMALL)
    folders = plan_study(tmp_path, whole, first_seeds=2)
    assert folders == plan_study(tmp_path, whole)[: len(folders)]
    plan_study(tmp_path, whole, first_seeds=2)
    assert seeds_of(tmp_path) == {"7", "8"}
    assert read_study(tmp_path, "small").first_seeds == 2


def test_a_smaller_sitting_forgets_no_run_that_has_ended(tmp_path: Path) -> None:
    whole = study_of("small", SMALL)
    for folder in plan_study(tmp_path, whole, first_seeds=2):
        (folder / END_FILE).touch()
    plan_study(tmp_path, whole, first_seeds=1)
    assert seeds_of(tmp_path) == {"7", "8"}


@pytest.mark.parametrize("name", ["runs", "slurm"])
def test_a_study_is_not_named_as_a_folder_of_the_laboratory(name: str) -> None:
    with pytest.raises(StudyError, match=f"study {name}: must have another name"):
        study_of(name, SMALL)


def test_a_study_may_be_like_a_file_beside_it(tmp_path: Path) -> None:
    (tmp_path / "one.yaml").write_text("like: other.yaml\ntitle: one\n")
    (tmp_path / "other.yaml").write_text("like: rivals\nmost_episodes: 7\n")
    study = load_study(str(tmp_path / "one.yaml"))
    assert (study.file.title, study.file.most_episodes) == ("one", 7)
    assert study.source == str(tmp_path / "one.yaml")


def test_a_study_that_is_like_itself_is_refused(tmp_path: Path) -> None:
    (tmp_path / "one.yaml").write_text("like: other.yaml\n")
    (tmp_path / "other.yaml").write_text("like: one.yaml\n")
    with pytest.raises(
        StudyError, match=r"is like itself: .*one\.yaml is like .*other"
    ):
        load_study(str(tmp_path / "one.yaml"))


# -- studies that come with the laboratory ---------------------------------------------


@pytest.mark.parametrize("name", study_names())
def test_every_study_can_be_planned_whole_and_reduced(name: str) -> None:
    whole = list(load_study(name).specs())
    less = list(load_study(name, reduced=True).specs())
    assert 1 < len(less) < len(whole)


def test_figures_of_the_same_runs_have_the_same_addresses() -> None:
    fig2 = addresses(load_study("fig2"))
    assert addresses(load_study("fig3")) == fig2
    fig4 = addresses(load_study("fig4"))
    assert addresses(load_study("fig5")) == addresses(load_study("fig6")) == fig4
    assert len(set(fig2) & set(fig4)) == 15  # no fixed mode at LT = 15


def test_the_paper_asks_for_these_k_and_lt() -> None:
    fig2, fig4 = load_study("fig2"), load_study("fig4")
    assert [arm.factors["K"] for arm in fig2.arms] == [1, 3, 5, 10, 15, 20, "none"]
    lt = [arm.settings.learner.schedule.successes_per_subtask for arm in fig4.arms]
    assert lt == [1, 1, 3, 3, 5, 5, 10, 10, 15, 15]
    assert {a.settings.learner.schedule.successes_per_subtask for a in fig2.arms} == {
        15
    }


# -- refusals --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"titel": "x"}, "unknown field `titel`"),
        ({"most_episodes": 0}, "`int` >= 1 - at `$.most_episodes`"),
        ({"seeds": {"first": 1}}, "missing required field `count`"),
        ({"figure": "grid"}, "Invalid enum value 'grid' - at `$.figure`"),
        ({"goal": "walk"}, "Invalid enum value 'walk' - at `$.goal`"),
        ({"axes": {}, "arms": {}, "baseline": None}, "neither axes nor arms"),
        ({"preset": "slow"}, "arm 'K = 1': preset = 'slow': must be one of"),
        ({"settings": {"gait.stps": 1}}, "arm 'K = 1': gait.stps = 1: unknown key"),
        ({"settings": {"gait.steps": 0}}, "gait.steps = 0: must be"),
        ({"baseline": "all"}, "baseline 'all': no such arm"),
        ({"arms": {"a/b": None}}, "at `key` in `$.arms`"),
    ],
)
def test_a_wrong_study_is_refused(change: dict[str, Any], words: str) -> None:
    with pytest.raises(StudyError) as refusal:
        study_of("small", SMALL | change)
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"contestant": "nobody"}, "contestant 'nobody': must be one of"),
        ({"options": {"alpha": 1}}, "alpha = 1: unknown key"),
    ],
)
def test_a_wrong_contestant_is_refused(change: dict[str, Any], words: str) -> None:
    with pytest.raises(StudyError) as refusal:
        list(study_of("small", SMALL | change).specs())
    assert words in str(refusal.value)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "cannot be read"),
        (b"a: [", "is not YAML"),
        (b"- a", "must hold keys"),
        (b"\xff\xfe", "cannot be read"),
    ],
)
def test_a_wrong_file_is_refused(
    tmp_path: Path, content: bytes | None, words: str
) -> None:
    path = tmp_path / "study.yaml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(StudyError) as refusal:
        load_study(str(path))
    assert words in str(refusal.value)


def test_an_unknown_name_is_refused_with_those_that_are_known() -> None:
    with pytest.raises(StudyError) as refusal:
        load_study("fig7")
    assert "must be a YAML file, or one of beyond, beyond_080, fig2" in str(
        refusal.value
    )


def test_a_study_without_a_reduced_form_says_so() -> None:
    with pytest.raises(StudyError, match="has no reduced form"):
        study_of("small", SMALL | {"reduced": None}, reduced=True)
