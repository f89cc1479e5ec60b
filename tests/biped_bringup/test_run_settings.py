"""Presets, and what is laid over them: nothing is taken that nobody knows."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

import pytest
import yaml

from biped_bringup.run_settings import (
    PRESETS,
    RunSettings,
    changed_settings,
    load_settings,
    preset_text,
)
from biped_common.settings import SettingsError, to_mapping

PARTIAL_PRESETS = [name for name in PRESETS if name != "paper"]


def leaves(values: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Walk nested mappings: dotted key and value of each setting."""
    for key, value in values.items():
        if isinstance(value, dict):
            yield from leaves(value, f"{path}{key}.")
        else:
            yield f"{path}{key}", value


def units(settings: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Walk settings: dotted key and unit of each number."""
    for field in fields(settings):
        value = getattr(settings, field.name)
        if is_dataclass(value):
            yield from units(value, f"{path}{field.name}.")
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            yield f"{path}{field.name}", field.metadata["unit"]


def comments(node: yaml.MappingNode, lines: list[str], path: str = "") -> dict:
    """Return the comment behind each setting of a YAML text, by dotted key."""
    found: dict[str, str] = {}
    for key, value in node.value:
        if isinstance(value, yaml.MappingNode):
            found |= comments(value, lines, f"{path}{key.value}.")
        else:
            line = lines[key.start_mark.line]
            found[f"{path}{key.value}"] = line.partition("# ")[2]
    return found


PAPER = dict(leaves(yaml.safe_load(preset_text("paper"))))
DEFAULTS = dict(leaves(to_mapping(RunSettings())))


# -- presets -----------------------------------------------------------------------


def test_the_paper_preset_lists_every_setting_there_is():
    assert PAPER.keys() == DEFAULTS.keys()


@pytest.mark.parametrize("key", DEFAULTS)
def test_the_paper_preset_agrees_with_the_default(key):
    assert PAPER[key] == DEFAULTS[key]


def test_the_paper_preset_gives_every_number_its_unit():
    text = preset_text("paper")
    found = comments(yaml.compose(text), text.splitlines())
    wrong = {
        key: found[key]
        for key, unit in units(RunSettings())
        if not found[key].startswith(f"[{unit}")
    }
    assert wrong == {}


def test_the_paper_preset_is_the_default():
    assert load_settings() == load_settings("paper") == RunSettings()


@pytest.mark.parametrize("name", PARTIAL_PRESETS)
def test_a_preset_lists_only_settings_that_there_are(name):
    listed = dict(leaves(yaml.safe_load(preset_text(name))))
    assert listed.keys() <= DEFAULTS.keys()


@pytest.mark.parametrize("name", PARTIAL_PRESETS)
def test_a_preset_lists_only_what_it_changes(name):
    listed = dict(leaves(yaml.safe_load(preset_text(name))))
    assert [key for key, value in listed.items() if value == DEFAULTS[key]] == []


@pytest.mark.parametrize("name", PARTIAL_PRESETS)
def test_a_preset_changes_what_it_lists_and_nothing_else(name):
    listed = dict(leaves(yaml.safe_load(preset_text(name))))
    assert dict(leaves(to_mapping(load_settings(name)))) == DEFAULTS | listed


def test_an_unknown_preset_is_refused_with_those_there_are():
    with pytest.raises(SettingsError, match="'fast': must be one of paper, coarse"):
        load_settings("fast")


# -- changes -----------------------------------------------------------------------


def test_a_file_changes_what_it_lists_and_nothing_else(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("gait:\n  steps: 3\nlearner: {action: {alternatives: 9}}\n")
    found = dict(leaves(to_mapping(load_settings("paper", file))))
    assert found == DEFAULTS | {"gait.steps": 3, "learner.action.alternatives": 9}


def test_an_empty_file_changes_nothing(tmp_path):
    file = tmp_path / "empty.yaml"
    file.write_text("# nothing yet\n")
    assert load_settings("quick", file) == load_settings("quick")


def test_a_change_reaches_the_innermost_section():
    settings = load_settings(changes=["learner.xol.fixed_mode.rewards_to_fix=3"])
    assert settings.learner.xol.fixed_mode.rewards_to_fix == 3


def test_a_change_leaves_its_neighbours_alone():
    changed = load_settings("quick", changes=["learner.xol.discount=0.9"])
    quick = load_settings("quick")
    xol = replace(quick.learner.xol, discount=0.9)
    assert changed == replace(quick, learner=replace(quick.learner, xol=xol))


def test_a_change_may_be_a_whole_section():
    settings = load_settings(changes=["gait={steps: 2, stand_s: 0.1}"])
    assert (settings.gait.steps, settings.gait.stand_s) == (2, 0.1)


def test_a_whole_number_will_do_for_a_number():
    value = load_settings(changes=["gait.double_support_s=1"]).gait.double_support_s
    assert (value, type(value)) == (1.0, float)


def test_a_file_prevails_over_the_preset(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("learner: {action: {hold_ticks: 2}}\n")
    assert load_settings("coarse", file).learner.action.hold_ticks == 2


def test_a_change_prevails_over_the_file(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("gait: {steps: 3}\n")
    assert load_settings("paper", file, ["gait.steps=4"]).gait.steps == 4


@pytest.mark.parametrize("again", ["gait.steps=2", "gait.steps=4", "gait={steps: 2}"])
def test_a_setting_is_changed_once(again):
    with pytest.raises(SettingsError, match=r"gives gait\.steps a second time"):
        load_settings(changes=["gait.steps=4", again])


def test_settings_can_be_changed_afterwards():
    quick = load_settings("quick")
    assert changed_settings(quick, None, ["gait.steps=2"]) == load_settings(
        "quick", None, ["gait.steps=2"]
    )


def test_no_change_leaves_settings_as_they_are():
    assert changed_settings(load_settings("quick")) == load_settings("quick")


# -- what is refused ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("gaits.steps=3", r"^gaits = .*unknown key; known here: correction, gait, "),
        ("gait.step=3", r"^gait\.step = 3: unknown key; known here: .*steps"),
        ("learner.xol.lambda=1", r"^learner\.xol\.lambda = 1: unknown key"),
        (
            "learner.states.shape=1",
            r"^learner\.states\.shape = 1: unknown key; known here: .*basis",
        ),
        ("gait.steps.count=3", r"^gait\.steps = .*: must be a whole number"),
        ("gait=3", r"^gait = 3: must be a section of keys"),
        ("gait=", r"^gait = None: must be a section of keys"),
        ("gait.steps=2.5", r"^gait\.steps = 2\.5: must be a whole number"),
        ("gait.steps=true", r"^gait\.steps = True: must be a whole number"),
        ("gait.steps=", r"^gait\.steps = None: must be a whole number"),
        ("gait.stand_s=.inf", r"^gait\.stand_s = inf: must be a finite number"),
        ("gait.stand_s=1e-1", r"^gait\.stand_s = '1e-1': must be a number .*mantissa"),
        ("learner.xol.decomposed=1", r"^learner\.xol\.decomposed = 1: must be true or"),
        ("learner.states.basis=disc", "must be one of gaussian, uniform"),
        ("learner.method=sarsa", "must be one of xol, q_lambda"),
        ("gait.steps", "^--set = 'gait.steps': must have the form section.key=value"),
        ("=3", "^--set = '=3': must have the form section.key=value"),
        ("gait.steps=[", r"^--set = 'gait\.steps=\[': the value is not YAML"),
        (
            "learner.schedule.first_target_s=11.3",
            r"^learner\.schedule\.first_target_s = 11\.3: must be at most the walk's "
            r"11\.25 s",
        ),
    ],
)
def test_a_change_is_refused_that_says(change, message):
    with pytest.raises(SettingsError, match=message):
        load_settings(changes=[change])


def test_the_first_target_may_be_the_whole_walk():
    settings = load_settings(changes=["learner.schedule.first_target_s=11.25"])
    assert settings.learner.schedule.first_target_s == settings.gait.duration_s


def test_a_shorter_walk_is_refused_that_the_first_target_exceeds():
    changes = ["gait.steps=1", "learner.schedule.first_target_s=4"]
    with pytest.raises(SettingsError, match=r"first_target_s = 4\.0: .* 3\.75 s"):
        load_settings(changes=changes)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"gait: [", "is not YAML"),
        (b"gait: {steps: 3}\n\tcost: 1", "is not YAML"),
        (b"gait: !!python/object:os.system {}", "is not YAML"),
        (b"- steps\n- 3\n", "must hold sections of settings"),
        (b"steps", "must hold sections of settings"),
        (b"\xff\xfe\x00", "cannot be read"),
        (b"1: 2\n", "^1 = 2: unknown key"),
        (b"gait: {steps: 3, shoes: 2}\n", r"^gait\.shoes = 2: unknown key"),
        (b"gait:\n", "^gait = None: must be a section of keys"),
    ],
)
def test_a_file_is_refused_that_says(tmp_path, content, message):
    file = tmp_path / "mine.yaml"
    file.write_bytes(content)
    with pytest.raises(SettingsError, match=message) as caught:
        load_settings("paper", file)
    assert len(str(caught.value).splitlines()) == 1


def test_a_file_that_is_no_yaml_is_named(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("gait: [")
    with pytest.raises(SettingsError, match=r"mine\.yaml"):
        load_settings("paper", file)


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(SettingsError, match=r"none\.yaml'.*cannot be read.*No such"):
        load_settings("paper", tmp_path / "none.yaml")


def test_a_folder_is_no_file(tmp_path):
    with pytest.raises(SettingsError, match="cannot be read"):
        load_settings("paper", tmp_path)
