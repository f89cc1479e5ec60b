"""The study by which the rivals' constants are chosen names what there is, fairly."""

from collections import Counter
from importlib.resources import files

import pytest
import yaml

from biped_bringup.run_settings import changed_settings, load_settings
from biped_common.settings import from_mapping
from biped_lab.contestant import entry

STUDY = yaml.safe_load(
    (files("biped_lab") / "studies" / "rivals_tuning.yaml").read_text()
)
ARMS = STUDY["arms"]


def method(arm):
    """Who learns in an arm, its constants aside."""
    settings = arm.get("settings", {})
    chosen = ("learner.method", "learner.xol.fixed_mode.strategy")
    return arm.get("contestant"), *(settings.get(key) for key in chosen)


@pytest.mark.parametrize("name", ARMS)
def test_contestant_options_and_settings_of_an_arm_exist(name):
    arm = ARMS[name]
    contestant = entry(arm.get("contestant", STUDY["contestant"]))
    from_mapping(contestant.options, arm.get("options", {}))
    settings = {**STUDY["settings"], **arm.get("settings", {})}
    changed_settings(
        load_settings(STUDY["preset"]),
        changes=[f"{key}={value}" for key, value in settings.items()],
    )


def test_every_rival_that_has_constants_has_four_settings():
    fixed = {method(ARMS[STUDY["baseline"]]), method(ARMS["random"])}
    counts = Counter(method(arm) for arm in ARMS.values())
    assert {count for who, count in counts.items() if who not in fixed} == {4}


def test_its_seeds_are_those_for_tuning():
    assert STUDY["seeds"] == {"first": 2101, "count": 4}
