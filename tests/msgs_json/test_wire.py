"""JSON on the wire: what goes out comes back, and nothing else is let in."""

import json
import math

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.payloads import OBSERVATION, PHASE, RESULT, STAMPED_PHASE, STATUS

from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation, StampedPhase
from msgs_json.wire import MalformedMessageError, NotFiniteError, decode, encode

PAYLOADS = (PHASE, STAMPED_PHASE, OBSERVATION, RESULT, STATUS)
VERSIONS = {StampedPhase: 2, LearnerStatus: 3}
COUNTS = (
    (PHASE, ("step_index",)),
    (STAMPED_PHASE, ("step_index", "clock_ticks")),
    (OBSERVATION, ("episode", "clock_ticks", "control_tick")),
    (RESULT, ("episode", "control_ticks", "target_ticks", "subtask")),
    (
        STATUS,
        (
            "seed",
            "subtask",
            "subtasks",
            "successes",
            "episodes",
        ),
    ),
)
numbers = st.floats(allow_nan=False, allow_infinity=False)


def name_of(payload):
    return type(payload).__name__


EVERY_PAYLOAD = pytest.mark.parametrize("payload", PAYLOADS, ids=name_of)
# Fields that can be null, by kind of payload.
NULLABLE = {
    ("Observation", "end_cause"),
    ("EpisodeResult", "cost"),
    ("EpisodeResult", "t_err_estimate"),
    ("LearnerStatus", "t_err_estimate"),
}
OPTIONAL = {("Observation", "end_cause")}


def every_field_but(excepted):
    return pytest.mark.parametrize(
        ("payload", "field"),
        [
            pytest.param(payload, field, id=f"{name_of(payload)}.{field}")
            for payload in PAYLOADS
            for field in payload.__struct_fields__
            if (name_of(payload), field) not in excepted
        ],
    )


def changed(payload, **fields):
    """The JSON of a payload with other values in some fields."""
    return json.dumps(json.loads(encode(payload)) | fields)


def without(payload, field):
    values = json.loads(encode(payload))
    del values[field]
    return json.dumps(values)


def refusal(payload, text):
    """What is said when the text is taken for a payload of this kind."""
    with pytest.raises(MalformedMessageError) as caught:
        decode(type(payload), text)
    return str(caught.value)


# -- round trip ------------------------------------------------------------------------


@EVERY_PAYLOAD
def test_a_payload_comes_back(payload):
    assert decode(type(payload), encode(payload)) == payload


@EVERY_PAYLOAD
def test_a_payload_comes_back_from_bytes(payload):
    assert decode(type(payload), encode(payload).encode()) == payload


@EVERY_PAYLOAD
def test_a_payload_says_its_version(payload):
    version = VERSIONS.get(type(payload), 1)
    assert json.loads(encode(payload))["version"] == version


@settings(deadline=None, max_examples=200)
@given(numbers, numbers)
def test_numbers_come_back_to_the_last_bit(x, y):
    values = json.loads(encode(OBSERVATION)) | {"zmp_error_m": [x, y]}
    sent = decode(Observation, json.dumps(values))
    back = decode(Observation, encode(sent)).zmp_error_m
    assert [(n, math.copysign(1.0, n)) for n in back] == [
        (n, math.copysign(1.0, n)) for n in (x, y)
    ]


# -- refusals --------------------------------------------------------------------------


@EVERY_PAYLOAD
def test_the_kind_of_payload_is_named(payload):
    assert refusal(payload, "{}").startswith(f"{name_of(payload)}: ")


@EVERY_PAYLOAD
@pytest.mark.parametrize("version", [0, 4, "1", None, 1.5, True])
def test_an_unknown_version_is_refused(payload, version):
    assert "version" in refusal(payload, changed(payload, version=version))


@EVERY_PAYLOAD
def test_a_missing_version_is_refused(payload):
    assert "version" in refusal(payload, without(payload, "version"))


@every_field_but(OPTIONAL)
def test_a_missing_field_is_refused(payload, field):
    assert f"`{field}`" in refusal(payload, without(payload, field))


@EVERY_PAYLOAD
def test_an_unknown_field_is_refused(payload):
    assert "`mood`" in refusal(payload, changed(payload, mood=1))


@every_field_but({})
def test_a_value_of_the_wrong_type_is_refused(payload, field):
    assert f"$.{field}" in refusal(payload, changed(payload, **{field: {"a": []}}))


@every_field_but(NULLABLE)
def test_null_where_a_value_must_be_is_refused(payload, field):
    assert f"$.{field}" in refusal(payload, changed(payload, **{field: None}))


@pytest.mark.parametrize("literal", ["NaN", "Infinity", "-Infinity"])
def test_a_number_that_is_none_is_refused(literal):
    text = encode(OBSERVATION).replace("20.0", literal)
    assert "invalid character" in refusal(OBSERVATION, text)


def test_a_number_too_large_is_refused():
    text = encode(OBSERVATION).replace("20.0", "1e999")
    assert "out of range" in refusal(OBSERVATION, text)


@pytest.mark.parametrize(
    "field", ["waist_in_support_foot_m", "zmp_error_m", "waist_acceleration_m_s2"]
)
@pytest.mark.parametrize("pair", [[], [0.1], [0.1, 0.2, 0.3]], ids=len)
def test_a_pair_of_another_length_is_refused(field, pair):
    assert f"$.{field}" in refusal(OBSERVATION, changed(OBSERVATION, **{field: pair}))


@pytest.mark.parametrize(
    ("payload", "field"),
    [(payload, field) for payload, fields in COUNTS for field in fields],
)
@pytest.mark.parametrize("count", [-1, 0.5, "1"])
def test_a_count_that_is_none_is_refused(payload, field, count):
    assert f"$.{field}" in refusal(payload, changed(payload, **{field: count}))


def test_an_error_inside_another_payload_is_named():
    phase = json.loads(encode(PHASE)) | {"step_index": -1}
    text = changed(OBSERVATION, phase=phase)
    assert "$.phase.step_index" in refusal(OBSERVATION, text)


@pytest.mark.parametrize("field", ["planned_right_support", "step_index"])
def test_a_field_missing_inside_another_payload_is_named(field):
    phase = json.loads(encode(PHASE))
    del phase[field]
    said = refusal(OBSERVATION, changed(OBSERVATION, phase=phase))
    assert ("$.phase" in said, field in said) == (True, True)


def test_a_cause_that_is_no_word_of_ours_is_refused():
    assert "$.end_cause" in refusal(
        OBSERVATION, changed(OBSERVATION, end_cause="bored")
    )


def test_a_count_of_a_cause_that_is_no_word_of_ours_is_refused():
    assert "$.given_up" in refusal(STATUS, changed(STATUS, given_up={"bored": 1}))


@EVERY_PAYLOAD
def test_truncated_json_is_refused(payload):
    text = encode(payload)
    for end in range(len(text)):
        assert refusal(payload, text[:end])


@EVERY_PAYLOAD
def test_json_with_something_after_it_is_refused(payload):
    assert refusal(payload, encode(payload) + "}")


@pytest.mark.parametrize("text", ["", "null", "[]", "1", '"a"', "walk", b"\xff\xfe"])
def test_what_is_no_payload_at_all_is_refused(text):
    assert refusal(OBSERVATION, text).startswith("Observation: ")


def test_one_payload_is_not_taken_for_another():
    assert refusal(OBSERVATION, encode(RESULT))


# -- what has no JSON ------------------------------------------------------------------


def replaced(payload, place, value):
    """The payload with another value at a place such as ("cost", "zmp")."""
    name, *rest = place
    inner = getattr(payload, name)
    if rest and isinstance(inner, tuple):
        value = tuple(value if i == rest[0] else x for i, x in enumerate(inner))
    elif rest:
        value = replaced(inner, rest, value)
    return msgspec.structs.replace(payload, **{name: value})


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize(
    ("payload", "place", "named"),
    [
        (OBSERVATION, ["worst_zmp_error_m"], "$.worst_zmp_error_m"),
        (OBSERVATION, ["zmp_error_m", 1], "$.zmp_error_m[1]"),
        (RESULT, ["cost", "joint_torque"], "$.cost.joint_torque"),
        (RESULT, ["t_err_estimate"], "$.t_err_estimate"),
        (STATUS, ["survival"], "$.survival"),
    ],
)
def test_a_number_that_is_not_finite_is_not_sent(payload, place, named, number):
    with pytest.raises(NotFiniteError) as caught:
        encode(replaced(payload, place, number))
    assert str(caught.value) == f"{name_of(payload)}: not a finite number: {named}"


def test_a_payload_within_another_must_say_its_version():
    phase = json.loads(without(PHASE, "version"))
    said = refusal(OBSERVATION, changed(OBSERVATION, phase=phase))
    assert said.endswith("missing required field `version` - at `$.phase`")


# -- hostile texts ---------------------------------------------------------------------


@pytest.mark.parametrize("depth", [100, 1_000, 40_000])
@pytest.mark.parametrize("bracket", ["[]", '{"a":}'])
def test_a_text_nested_without_end_is_malformed(depth, bracket):
    before, after = bracket[:-1], bracket[-1]
    assert refusal(OBSERVATION, before * depth + after * depth)


def test_a_text_nested_within_a_payload_is_malformed():
    nested = json.dumps(json.loads(encode(STATUS))).replace(
        '"figures": {', '"figures": {"deep": ' + "[" * 20_000 + "]" * 20_000 + ", "
    )
    assert "figures" in nested
    assert refusal(STATUS, nested)


def test_a_text_longer_than_any_payload_is_not_even_read():
    said = refusal(OBSERVATION, " " * 1_000_000 + encode(OBSERVATION))
    assert "characters" in said


@pytest.mark.parametrize("number", [10**12 + 1, 2**63, 10**30])
@pytest.mark.parametrize(
    ("payload", "field"),
    [(p, f) for p, fields in COUNTS for f in fields if f != "seed"],
)
def test_a_count_that_no_run_reaches_is_refused(payload, field, number):
    assert field in refusal(payload, changed(payload, **{field: number}))


@pytest.mark.parametrize("seed", [2**63, 10**30])
def test_a_seed_that_no_parameter_can_hold_is_refused(seed):
    assert "seed" in refusal(STATUS, changed(STATUS, seed=seed))
