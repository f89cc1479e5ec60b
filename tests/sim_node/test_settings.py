"""What the simulated robot's settings allow."""

import dataclasses
import math

import pytest

from biped_common.settings import SettingsError, from_mapping, to_mapping
from biped_description.settings import RobotSettings
from sim_node.settings import (
    DisturbanceSettings,
    HardwareNodeSettings,
    LimitSettings,
    SimNodeSettings,
    SimSettings,
)

FIELDS = [
    (cls, field.name)
    for cls in (LimitSettings, DisturbanceSettings)
    for field in dataclasses.fields(cls)
]
EVERY_FIELD = pytest.mark.parametrize(
    ("cls", "name"), FIELDS, ids=[name for _, name in FIELDS]
)


def test_the_limits_of_the_paper_are_the_defaults():
    found = LimitSettings().zmp_error_m, RobotSettings().velocity_limit_rad_s
    assert found == (0.065, pytest.approx(20 * math.pi))


def test_settings_come_back_from_their_mapping():
    settings = SimSettings(
        limits=LimitSettings(zmp_error_m=0.05),
        disturbances=DisturbanceSettings(friction=0.3),
    )
    assert from_mapping(SimSettings, to_mapping(settings)) == settings


def test_an_error_has_a_dotted_key():
    with pytest.raises(SettingsError, match=r"^limits\.zmp_error_m = 0\.0: must be"):
        from_mapping(SimSettings, {"limits": {"zmp_error_m": 0.0}})


@EVERY_FIELD
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_every_number_must_be_finite(cls, name, value):
    with pytest.raises(SettingsError, match=f"^{name} = {value}: must be a finite"):
        cls(**{name: value})


@EVERY_FIELD
def test_no_number_may_be_negative(cls, name):
    with pytest.raises(SettingsError, match=f"^{name} = -0.5: must be"):
        cls(**{name: -0.5})


@EVERY_FIELD
def test_every_setting_says_what_it_means(cls, name):
    assert cls.__dataclass_fields__[name].metadata["doc"]


@pytest.mark.parametrize(
    ("name", "value"),
    [("friction", 11.0), ("mass_error", 0.31), ("torque_limit_factor", 1.1)],
)
def test_a_disturbance_beyond_reason_is_refused(name, value):
    with pytest.raises(SettingsError, match=f"^{name} = "):
        DisturbanceSettings(**{name: value})


def test_settings_of_the_node_come_back_from_their_mapping():
    settings = SimNodeSettings(timeout_s=2.0, publish_every_ticks=10)
    assert from_mapping(SimNodeSettings, to_mapping(settings)) == settings


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("publish_every_ticks", 0),
        ("publish_every_ticks", 10.0),
        ("publish_every_ticks", 1001),
        ("timeout_s", 0.0),
        ("timeout_s", math.inf),
    ],
)
def test_settings_of_the_node_out_of_range_are_refused(name, value):
    with pytest.raises(SettingsError, match=f"^{name} = "):
        SimNodeSettings(**{name: value})


@pytest.mark.parametrize("value", ["0.5", True, None])
def test_a_setting_made_in_code_has_the_right_type(value):
    with pytest.raises(SettingsError, match=r"^friction = .*: must be a number"):
        DisturbanceSettings(friction=value)


@pytest.mark.parametrize("name", ["mass_error", "push_force_n", "zmp_noise_m"])
def test_a_robot_that_is_played_refuses_what_has_no_effect_on_it(name):
    sim = SimSettings(disturbances=DisturbanceSettings(**{name: 0.1}))
    message = rf"^sim\.disturbances\.{name} = 0.1: must be 0.0: it has no effect"
    with pytest.raises(SettingsError, match=message):
        HardwareNodeSettings(sim=sim)
    slippery = SimSettings(disturbances=DisturbanceSettings(friction=0.5))
    assert HardwareNodeSettings(sim=slippery).sim.disturbances.friction == 0.5


def test_a_robot_that_keeps_its_own_time_takes_no_other_pace():
    sim = SimSettings(engine="robot", observations="sensors")
    assert SimNodeSettings(sim=sim).pace == "lockstep"
    message = r"^pace = 'realtime': must be lockstep with sim.engine = robot, "
    with pytest.raises(SettingsError, match=message):
        SimNodeSettings(sim=sim, pace="realtime")
