"""What gait and correction settings allow."""

import dataclasses

import pytest

from msgs_json.settings import SettingsError, from_mapping, to_mapping
from trajectory_node.settings import CorrectionSettings, GaitSettings

BOTH = pytest.mark.parametrize("settings", [GaitSettings, CorrectionSettings])


def test_the_default_walk_takes_11_25_s():
    assert GaitSettings().duration_s == 11.25


def test_a_step_is_a_double_and_a_single_support():
    gait = GaitSettings(step_period_s=1.5, double_support_s=0.9)
    assert gait.single_support_s == pytest.approx(0.6)


def test_the_walk_is_one_step_period_longer_than_its_steps():
    assert GaitSettings(steps=3, step_period_s=2.0).duration_s == 8.0


@BOTH
def test_settings_come_back_from_their_mapping(settings):
    assert from_mapping(settings, to_mapping(settings())) == settings()


@BOTH
def test_every_setting_says_what_it_means(settings):
    assert all(field.metadata["doc"] for field in dataclasses.fields(settings))


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
        ("waist_height_m", 0.19),
        ("waist_height_m", 0.61),
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
