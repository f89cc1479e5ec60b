"""`biped check` and `--help`: what there is to set, and in which unit."""

import re

import pytest
import yaml

from biped_bringup.cli.main import parser
from biped_bringup.run_settings import PRESETS, RunSettings, load_settings
from biped_common.command_line import duration_s, natural, positive
from biped_common.settings import from_mapping, to_mapping
from biped_description.robot import Robot
from biped_description.settings import RobotSettings

# Options that take a number with a unit, and how their help names it.
UNITS = {
    "learn": {
        "--checkpoint-every": "seconds",
        "--episodes": "episodes",
        "--replay-mb": "MB",
    },
    "walk": {"--tds": "[s]"},
    "up": {
        "--episodes": "episodes",
        "--publish-every": "control ticks",
        "--factor": "simulated seconds per second",
    },
    "check": {},
    "demo": {"--episodes": "episodes"},
    "report": {},
    "view": {},
}


def test_a_sound_configuration_is_said_to_be_valid(biped):
    outcome = biped("check")
    assert outcome.status == 0
    assert outcome.out == (
        "valid: a walk of 11.25 s in 5 steps, learned in 11 subtasks\n"
    )


@pytest.mark.parametrize("preset", PRESETS)
def test_every_preset_is_sound(biped, preset):
    assert biped("check", "--preset", preset).status == 0


@pytest.mark.parametrize("preset", PRESETS)
def test_the_settings_shown_are_the_settings(biped, preset):
    shown = yaml.safe_load(biped("check", "--preset", preset, "--show").out)
    assert from_mapping(RunSettings, shown) == load_settings(preset)


def test_the_settings_shown_have_the_changes_in_them(biped):
    shown = yaml.safe_load(biped("check", "--show", "--set", "gait.steps=2").out)
    assert shown["gait"]["steps"] == 2


def test_the_settings_shown_serve_as_a_configuration(biped, tmp_path):
    shown = biped("check", "--preset", "quick", "--show").out
    (tmp_path / "mine.yaml").write_text(shown)
    assert biped("check", "--config", "mine.yaml", "--show").out == shown


def test_the_urdf_printed_is_that_of_the_robot_described(biped):
    outcome = biped("check", "--urdf", "--set", "robot.thigh_length_m=0.25")
    assert outcome.out == Robot(RobotSettings(thigh_length_m=0.25)).urdf


def test_a_gait_out_of_the_robots_reach_is_refused_in_one_line(biped):
    outcome = biped("check", "--set", "robot.thigh_length_m=0.1")
    assert (outcome.status, len(outcome.err.splitlines())) == (2, 1)
    assert outcome.err.startswith(
        "biped check: the robot cannot walk this gait: tick 0"
    )


def test_the_json_of_a_check_has_all_settings(biped):
    values = biped("check", "--json", "--preset", "quick").values
    assert values["settings"] == to_mapping(load_settings("quick"))


def test_the_json_of_a_check_has_the_targets_of_the_schedule(biped):
    values = biped("check", "--json").values
    assert values["valid"]
    assert len(values["targets_s"]) == 11
    assert values["targets_s"] == sorted(values["targets_s"])
    assert values["targets_s"][-1] == values["walk_s"] == 11.25


def test_a_check_writes_nothing(biped, tmp_path):
    biped("check")
    assert list(tmp_path.iterdir()) == []


def test_help_names_every_verb_and_every_exit_status(biped):
    outcome = biped("--help")
    assert outcome.status == 0
    for word in (*UNITS, "0 done", "1 not achieved", "2 wrong input", "130"):
        assert word in outcome.out


@pytest.mark.parametrize("verb", UNITS)
def test_every_verb_has_help(biped, verb):
    outcome = biped(verb, "--help")
    assert (outcome.status, outcome.err) == (0, "")
    assert outcome.out.startswith(f"usage: biped {verb}")


@pytest.mark.parametrize(
    ("verb", "option", "unit"),
    [(verb, *pair) for verb, options in UNITS.items() for pair in options.items()],
)
def test_a_number_has_its_unit_in_the_help(biped, verb, option, unit):
    described = re.search(
        rf"^  {option} \S+\s+(.*?)(?=\n  -|\n\n)",
        biped(verb, "--help").out,
        re.DOTALL | re.MULTILINE,
    )
    assert described is not None
    assert unit in described[1]


def test_every_option_that_takes_a_number_of_units_is_looked_at():
    (verbs,) = (a for a in parser()._actions if a.dest == "verb")
    numbers = {
        (verb, action.option_strings[-1])
        for verb, options in verbs.choices.items()
        for action in options._actions
        if action.type in (float, natural, positive, duration_s)
    }
    without_unit = {
        ("learn", "--seed"),
        ("walk", "--seed"),
        ("up", "--seed"),
        ("up", "--domain"),
        ("report", "--walk"),
        ("view", "--domain"),
        ("view", "--walk"),
    }
    looked_at = {(verb, option) for verb in UNITS for option in UNITS[verb]}
    assert numbers - without_unit == looked_at


@pytest.mark.parametrize("verb", sorted(UNITS.keys() - {"demo", "view"}))
def test_the_help_says_how_settings_are_changed(biped, verb):
    assert "gait.double_support_s=1.0 [s]" in biped(verb, "--help").out
