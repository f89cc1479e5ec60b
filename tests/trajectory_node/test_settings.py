"""What gait and correction settings allow."""

import dataclasses

import pytest

from biped_common.settings import SettingsError, from_mapping, to_mapping
from trajectory_node.settings import (
    CorrectionSettings,
    GaitSettings,
    TrajectorySettings,
)

EACH = pytest.mark.parametrize(
    "settings", [GaitSettings, CorrectionSettings, TrajectorySettings]
)


def test_the_default_walk_takes_11_25_s():
    assert GaitSettings().duration_s == 11.25


def test_a_step_is_a_double_and_a_single_support():
    gait = GaitSettings(step_period_s=1.5, double_support_s=0.9)
    assert gait.single_support_s == pytest.approx(0.6)


def test_the_walk_is_one_step_period_longer_than_its_steps():
    assert GaitSettings(steps=3, step_period_s=2.0).duration_s == 8.0


@EACH
def test_settings_come_back_from_their_mapping(settings):
    assert from_mapping(settings, to_mapping(settings())) == settings()


@EACH
def test_every_setting_says_what_it_means(settings):
    declared = [field.metadata for field in dataclasses.fields(settings)]
    assert all(metadata["doc"] for metadata in declared if metadata)


@pytest.mark.parametrize("double_support_s", [1.875, 2.0])
def test_a_double_support_must_leave_time_to_swing(double_support_s):
    message = r"^double_support_s = .*: must be below step_period_s = 1\.875 s$"
    with pytest.raises(SettingsError, match=message):
        GaitSettings(double_support_s=double_support_s)


def test_standing_must_be_no_longer_than_a_single_support():
    message = r"^stand_s = 0\.9: must be at most the single support of 0\.825 s, or no"
    with pytest.raises(SettingsError, match=message):
        GaitSettings(stand_s=0.9)


@pytest.mark.parametrize("field", [f.name for f in dataclasses.fields(GaitSettings)])
def test_no_part_of_a_gait_can_be_nan(field):
    with pytest.raises(SettingsError, match=f"^{field} = nan"):
        GaitSettings(**{field: float("nan")})


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("step_period_s", 0.0),
        ("step_period_s", 10.1),
        ("double_support_s", 0.0),
        ("stand_s", -0.1),
        ("steps", 0),
        ("steps", 51),
        ("step_length_m", 0.51),
        ("step_length_m", -0.51),
        ("swing_height_m", -0.01),
        ("swing_height_m", 0.21),
        ("waist_height_m", 0.0),
        ("waist_height_m", 2.1),
    ],
)
def test_a_gait_out_of_range_is_refused(field, value):
    with pytest.raises(SettingsError, match=f"^{field} = "):
        GaitSettings(**{field: value})


@pytest.mark.parametrize(
    ("field", "value"),
    [("knot_spacing_s", 0.19), ("knot_spacing_s", 2.1), ("order", 2), ("order", 5)],
)
def test_a_correction_out_of_range_is_refused(field, value):
    with pytest.raises(SettingsError, match=f"^{field} = "):
        CorrectionSettings(**{field: value})


def test_a_double_support_lasts_at_least_a_tenth_of_a_second():
    with pytest.raises(SettingsError, match=r"^double_support_s = 0\.09: must be"):
        GaitSettings(double_support_s=0.09)


def test_a_single_support_lasts_at_least_a_tenth_of_a_second():
    message = (
        r"^double_support_s = 1\.78: must leave 0\.1 s of single support in a step$"
    )
    with pytest.raises(SettingsError, match=message):
        GaitSettings(double_support_s=1.78, stand_s=0.0)


@pytest.mark.parametrize("period_s", [0.2, 0.3, 0.7, 1.1])
@pytest.mark.parametrize("single_support_s", [0.1, None])
def test_phases_of_a_tenth_of_a_second_are_allowed(period_s, single_support_s):
    double_support_s = 0.1 if single_support_s is None else period_s - 0.1
    gait = GaitSettings(
        step_period_s=period_s, double_support_s=double_support_s, stand_s=0.1
    )
    assert min(gait.single_support_s, gait.double_support_s) == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("correction_limit_m", 0.0),
        ("correction_limit_m", 0.21),
        ("correction_limit_m", float("nan")),
        ("look_ahead_ticks", 0),
        ("look_ahead_ticks", 601),
        ("look_ahead_ticks", 1.5),
    ],
)
def test_settings_of_the_node_out_of_range_are_refused(field, value):
    with pytest.raises(SettingsError, match=f"^{field} = "):
        TrajectorySettings(**{field: value})


def test_an_error_in_the_gait_has_a_dotted_key():
    with pytest.raises(SettingsError, match=r"^gait\.steps = 2\.5: must be a whole"):
        from_mapping(TrajectorySettings, {"gait": {"steps": 2.5}})


def test_a_gait_made_in_code_has_a_whole_number_of_steps():
    with pytest.raises(SettingsError, match=r"^steps = 2\.5: must be a whole number$"):
        GaitSettings(steps=2.5)
