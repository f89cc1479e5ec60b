"""Settings: what a mapping may say, and how it is told off."""

import dataclasses
from dataclasses import dataclass

import pytest
import yaml
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from biped_common.settings import (
    Settings,
    SettingsError,
    from_mapping,
    nested,
    overlay,
    section,
    setting,
    to_mapping,
)


@dataclass(frozen=True)
class Motor(Settings):
    gain: float = setting(0.5, "", "stiffness", above=0.0, upper=1.0)
    teeth: int = setting(12, "teeth", "size of the wheel", lower=3, upper=40)
    braked: bool = setting(False, "", "whether the brake is on")
    mode: str = setting("slow", "", "how it turns", choices=("slow", "fast"))
    stops_rad: tuple[float, ...] = setting((-1.0, 1.0), "rad", "end stops", lower=-3.0)
    sag_m: float = setting(0.0, "m", "belt sag", lower=-0.1)
    heat_k: float = setting(293.0, "K", "temperature", upper=400.0)


@dataclass(frozen=True)
class Arm(Settings):
    motor: Motor = section(Motor)
    mass_kg: float = setting(2.0, "kg", "weight on a scale", above=0.0)

    def check_together(self) -> None:
        if self.motor.braked and self.mass_kg > 1e200:
            raise SettingsError("mass_kg", self.mass_kg, "is too much for the brake")


@dataclass(frozen=True)
class Cell(Settings):
    arm: Arm = section(Arm)
    name: str = setting("cell", "", "what it is called")


motors = st.builds(
    Motor,
    gain=st.floats(0.0, 1.0, exclude_min=True),
    teeth=st.integers(3, 40),
    braked=st.booleans(),
    mode=st.sampled_from(["slow", "fast"]),
    stops_rad=st.lists(st.floats(-3.0, 1e300), max_size=4).map(tuple),
    sag_m=st.floats(-0.1, 1e300),
    heat_k=st.floats(-1e300, 400.0),
)
cells = st.builds(
    Cell,
    arm=st.builds(Arm, motor=motors, mass_kg=st.floats(1e-300, 1e200)),
    name=st.text(),
)


def complaint(cls: type, values: dict) -> SettingsError:
    """Return the error that the values cause."""
    with pytest.raises(SettingsError) as caught:
        from_mapping(cls, values)
    return caught.value


def test_an_empty_mapping_gives_the_defaults():
    assert from_mapping(Cell, {}) == Cell()


def test_a_mapping_changes_what_it_names_and_nothing_else():
    motor = from_mapping(Motor, {"gain": 0.7, "mode": "fast"})
    assert motor == dataclasses.replace(Motor(), gain=0.7, mode="fast")


def test_an_unknown_key_is_named_with_all_known_ones():
    assert str(complaint(Arm, {"speed": 3})) == (
        "speed = 3: unknown key; known here: mass_kg, motor"
    )


def test_a_key_that_is_not_even_text_is_an_unknown_key():
    assert complaint(Arm, {7: 3}).key == "7"


def test_an_error_tells_key_value_and_what_is_allowed_apart():
    error = complaint(Motor, {"teeth": 2})
    assert (error.key, error.value, error.allowed) == (
        "teeth",
        2,
        "must be between 3 and 40 teeth",
    )


def test_an_error_is_one_line_even_if_the_value_is_not():
    assert "\n" not in str(complaint(Motor, {"mode": "very\nfast"}))


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [
        ("gain", "high", "must be a number"),
        ("gain", None, "must be a number"),
        ("gain", [0.5], "must be a number"),
        ("gain", True, "must be a number"),
        ("teeth", 12.0, "must be a whole number"),
        ("teeth", False, "must be a whole number"),
        ("braked", 1, "must be true or false"),
        ("braked", "true", "must be true or false"),
        ("mode", 3, "must be text"),
        ("mode", True, "must be text"),
        ("stops_rad", 1.0, "must be a list of float"),
        ("stops_rad", "12", "must be a list of float"),
        ("stops_rad", [0.0, "far"], "must be a number"),
        ("stops_rad", [0.0, True], "must be a number"),
    ],
)
def test_a_value_of_the_wrong_type_is_refused(key, value, allowed):
    assert complaint(Motor, {key: value}).allowed == allowed


def test_a_whole_number_serves_as_a_number():
    gain = from_mapping(Motor, {"gain": 1}).gain
    assert (gain, type(gain)) == (1.0, float)


@pytest.mark.parametrize("key", ["gain", "teeth"])
def test_text_that_looks_like_a_number_gets_a_hint(key):
    value = yaml.safe_load("1e-3")
    assert complaint(Motor, {key: value}).allowed.endswith(
        "number (YAML wants a dot in the mantissa, as in 1.0e-3)"
    )


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
@pytest.mark.parametrize("key", ["gain", "sag_m", "heat_k"])
def test_a_number_must_be_finite(key, value):
    assert complaint(Motor, {key: value}).allowed == "must be a finite number"


def test_every_number_of_a_list_must_be_finite():
    error = complaint(Motor, {"stops_rad": [0.0, float("nan")]})
    assert error.allowed == "must be a finite number"


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [
        ("teeth", 2, "must be between 3 and 40 teeth"),
        ("teeth", 41, "must be between 3 and 40 teeth"),
        ("sag_m", -0.11, "must be at least -0.1 m"),
        ("heat_k", 400.5, "must be at most 400.0 K"),
        ("gain", 0.0, "must be above 0.0"),
        ("gain", -1.0, "must be above 0.0"),
        ("gain", 1.1, "must be at most 1.0"),
        ("stops_rad", [0.0, -3.5], "must be at least -3.0 rad"),
        ("mode", "backwards", "must be one of slow, fast"),
    ],
)
def test_a_value_out_of_range_is_refused_with_the_range(key, value, allowed):
    assert complaint(Motor, {key: value}).allowed == allowed


@pytest.mark.parametrize(
    ("key", "value"), [("teeth", 3), ("teeth", 40), ("sag_m", -0.1), ("heat_k", 400.0)]
)
def test_the_bounds_themselves_are_allowed(key, value):
    assert getattr(from_mapping(Motor, {key: value}), key) == value


@pytest.mark.parametrize(
    ("motor", "key"),
    [
        ({"speed": 1}, "arm.motor.speed"),
        ({"gain": "high"}, "arm.motor.gain"),
        ({"gain": 2.0}, "arm.motor.gain"),
    ],
    ids=["unknown", "type", "range"],
)
def test_an_error_in_a_section_has_a_dotted_key(motor, key):
    assert complaint(Cell, {"arm": {"motor": motor}}).key == key


@pytest.mark.parametrize("value", [None, 3, "fast", [1, 2]])
def test_a_section_must_be_a_mapping(value):
    error = complaint(Cell, {"arm": {"motor": value}})
    assert str(error) == f"arm.motor = {value!r}: must be a section of keys"


def test_a_partial_mapping_keeps_what_the_base_says():
    base = Cell(arm=Arm(motor=Motor(gain=0.9, teeth=20), mass_kg=5.0))
    changed = from_mapping(Cell, {"arm": {"motor": {"teeth": 30}}}, base)
    assert changed == Cell(arm=Arm(motor=Motor(gain=0.9, teeth=30), mass_kg=5.0))


def test_a_base_is_held_to_the_same_rules():
    with pytest.raises(SettingsError, match=r"^arm\.motor\.speed = 1: unknown key"):
        from_mapping(Cell, {"arm": {"motor": {"speed": 1}}}, Cell())


@hypothesis_settings(deadline=None, max_examples=50)
@given(cells)
def test_settings_come_back_from_their_mapping(cell):
    assert from_mapping(Cell, to_mapping(cell)) == cell


@hypothesis_settings(deadline=None, max_examples=50)
@given(cells, cells)
def test_a_full_mapping_leaves_nothing_of_the_base(cell, base):
    assert from_mapping(Cell, to_mapping(cell), base) == cell


def test_a_mapping_holds_plain_values_only():
    assert to_mapping(Arm()) == {
        "motor": {
            "gain": 0.5,
            "teeth": 12,
            "braked": False,
            "mode": "slow",
            "stops_rad": [-1.0, 1.0],
            "sag_m": 0.0,
            "heat_k": 293.0,
        },
        "mass_kg": 2.0,
    }


def test_settings_come_back_from_yaml():
    cell = Cell(arm=Arm(motor=Motor(gain=1e-5, stops_rad=(0.1, 0.2, 0.3))))
    text = yaml.safe_dump(to_mapping(cell))
    assert from_mapping(Cell, yaml.safe_load(text)) == cell


@pytest.mark.parametrize(
    "values",
    [
        {"gain": 0.0},
        {"gain": float("nan")},
        {"teeth": 41},
        {"mode": "backwards"},
        {"stops_rad": (0.0, -4.0)},
        {"gain": "0.5"},
        {"gain": True},
        {"gain": None},
        {"teeth": 12.0},
        {"teeth": True},
        {"braked": 1},
        {"mode": 3},
        {"stops_rad": 1.0},
        {"stops_rad": (0.0, "far")},
    ],
    ids=str,
)
def test_an_invalid_object_cannot_be_made_in_code_either(values):
    with pytest.raises(SettingsError):
        Motor(**values)


def test_values_at_odds_with_one_another_are_refused():
    values = {"arm": {"motor": {"braked": True}, "mass_kg": 1e300}}
    assert str(complaint(Cell, values)) == (
        "arm.mass_kg = 1e+300: is too much for the brake"
    )


def test_a_value_out_of_range_is_told_before_those_at_odds():
    values = {"motor": {"braked": True}, "mass_kg": float("inf")}
    assert complaint(Arm, values).allowed == "must be a finite number"


def test_settings_cannot_be_changed():
    with pytest.raises(dataclasses.FrozenInstanceError):
        Motor().gain = 0.7


def test_an_overlay_merges_sections_key_by_key():
    base = {"arm": {"motor": {"gain": 0.5, "teeth": 12}, "mass_kg": 2.0}, "name": "a"}
    changes = {"arm": {"motor": {"gain": 0.9}}, "speed": 1}
    assert overlay(base, changes) == {
        "arm": {"motor": {"gain": 0.9, "teeth": 12}, "mass_kg": 2.0},
        "name": "a",
        "speed": 1,
    }


def test_an_overlay_leaves_its_base_alone():
    base = {"arm": {"motor": {"gain": 0.5}}}
    overlay(base, {"arm": {"motor": {"gain": 0.9}}})
    assert base == {"arm": {"motor": {"gain": 0.5}}}


@pytest.mark.parametrize(
    ("base", "changes"), [({"a": {"b": 1}}, {"a": 2}), ({"a": 2}, {"a": {"b": 1}})]
)
def test_a_section_and_a_value_replace_each_other(base, changes):
    assert overlay(base, changes) == changes


@pytest.mark.parametrize("key", ["arm.motor.gain", "name", "arm..motor", "arm."])
def test_a_dotted_key_is_a_way_through_nested_sections(key):
    found = nested(key, 0.7)
    for part in key.split("."):
        found = found[part]
    assert found == 0.7


@pytest.mark.parametrize("values", [None, 3, "fast", [1, 2]])
def test_settings_must_be_a_mapping(values):
    assert complaint(Cell, values).allowed == "must be a section of keys"


def test_code_may_give_whole_numbers_and_lists_too():
    motor = Motor(gain=1, stops_rad=[-1, 1])
    assert (repr(motor.gain), repr(motor.stops_rad)) == ("1.0", "(-1.0, 1.0)")


@pytest.mark.parametrize("number", [10**400, -(10**400)], ids=["positive", "negative"])
@pytest.mark.parametrize("key", ["gain", "sag_m", "heat_k"])
def test_a_whole_number_too_large_for_a_number_is_refused(key, number):
    assert complaint(Motor, {key: number}).allowed == "must be a finite number"


def test_a_whole_number_too_large_is_refused_in_a_list():
    error = complaint(Motor, {"stops_rad": [0.0, 10**400]})
    assert error.allowed == "must be a finite number"


@pytest.mark.parametrize(
    ("field", "value"),
    [("teeth", 16**5000), ("gain", 16**5000), ("stops_rad", [16**5000])],
    ids=["whole number", "number", "list"],
)
def test_a_number_of_thousands_of_digits_is_refused_in_one_line(field, value):
    said = str(complaint(Motor, {field: value}))
    assert "a whole number of thousands of digits: must be " in said
    assert len(said.splitlines()) == 1
