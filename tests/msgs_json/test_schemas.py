"""The JSON Schema files, judged by a library that knows nothing of our structs."""

import json
import subprocess
import sys
from importlib import resources
from typing import Annotated, get_args, get_origin

import jsonschema
import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.payloads import STATUS

from msgs_json import schemas
from msgs_json.bounds import Digest, Name, Seed
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import CostTerms
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation, PhaseFlags
from msgs_json.schemas import PAYLOADS, file_name, schema_text
from msgs_json.walk_plan import GaitPhase, Point
from msgs_json.wire import MalformedMessageError, decode, encode

FILES = resources.files(schemas)
VALIDATORS = {
    payload: jsonschema.Draft202012Validator(
        json.loads(FILES.joinpath(file_name(payload)).read_text())
    )
    for payload in PAYLOADS
}
EVERY_PAYLOAD = pytest.mark.parametrize("payload", PAYLOADS, ids=lambda p: p.__name__)

# -- payloads of all kinds, by hypothesis ----------------------------------------------

numbers = st.floats(allow_nan=False, allow_infinity=False)
counts = st.integers(0, 10**12)
flags = st.booleans()
FIELD_KINDS = {
    bool: flags,
    float: numbers,
    float | None: st.none() | numbers,
    tuple[float, float]: st.tuples(numbers, numbers),
    Name: st.text(max_size=200),
    Digest: st.text(max_size=64),
    Seed: st.integers(0, 2**63 - 1),
    Point: st.tuples(numbers, numbers, numbers),
    EndCause: st.sampled_from(EndCause),
    EndCause | None: st.none() | st.sampled_from(EndCause),
}


def made(struct):
    """Structs of this kind with any sound values."""
    return st.builds(
        struct, **{f.name: value(f.type) for f in msgspec.structs.fields(struct)}
    )


def value(kind):
    if kind in FIELD_KINDS:
        return FIELD_KINDS[kind]
    if get_origin(kind) is Annotated and get_origin(get_args(kind)[0]) is dict:
        keys, values = get_args(get_args(kind)[0])
        return st.dictionaries(value(keys), value(values), max_size=3)
    if get_origin(kind) is Annotated and get_origin(get_args(kind)[0]) is tuple:
        return st.lists(made(GaitPhase), max_size=3).map(tuple)
    if kind == CostTerms | None:
        return st.none() | made(CostTerms)
    return made(PhaseFlags) if kind is PhaseFlags else counts


payloads = st.one_of(*(made(payload) for payload in PAYLOADS))
anything = st.recursive(
    st.none() | flags | st.integers() | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=3),
    max_leaves=4,
)


def agree(kind, text):
    """Whether decoder and schema say the same; and what they say."""
    try:
        decode(kind, text)
        taken = True
    except MalformedMessageError:
        taken = False
    return VALIDATORS[kind].is_valid(json.loads(text)) == taken, taken


@settings(deadline=None, max_examples=200)
@given(payloads)
def test_what_we_send_is_valid(payload):
    VALIDATORS[type(payload)].validate(json.loads(encode(payload)))


@settings(deadline=None, max_examples=200)
@given(payloads, st.data())
def test_a_field_less_is_judged_alike(payload, data):
    values = json.loads(encode(payload))
    del values[data.draw(st.sampled_from(sorted(values)))]
    assert agree(type(payload), json.dumps(values))[0]


@settings(deadline=None, max_examples=200)
@given(payloads, st.text(max_size=5), anything)
def test_a_field_more_is_judged_alike(payload, name, content):
    values = {name: content, **json.loads(encode(payload))}
    assert agree(type(payload), json.dumps(values))[0]


@settings(deadline=None, max_examples=400)
@given(payloads, st.data(), anything)
def test_another_value_is_judged_alike(payload, data, content):
    values = json.loads(encode(payload))
    values[data.draw(st.sampled_from(sorted(values)))] = content
    assert agree(type(payload), json.dumps(values))[0]


# -- each rule by itself ---------------------------------------------------------------

PHASE = PhaseFlags(
    planned_right_support=True,
    planned_double_support=False,
    measured_right_support=True,
    measured_double_support=False,
    step_index=2,
)
SOUND = json.loads(encode(PHASE))
OBSERVED = {
    "version": 1,
    **dict.fromkeys(("simulation", "trajectory_sha256"), ""),
    **dict.fromkeys(("episode", "clock_ticks", "control_tick"), 0),
    "phase": SOUND,
    "waist_in_support_foot_m": [0.0, 0.0],
    "zmp_error_m": [0.0, 0.0],
    "waist_acceleration_m_s2": [0.0, 0.0],
    **dict.fromkeys(
        (
            "worst_zmp_error_m",
            "worst_joint_velocity_rad_s",
            "zmp_error_integral_m2_s2",
            "joint_error_integral_rad2_s",
            "torque_integral_n2m2_s",
            "mean_joint_error_rad",
            "mean_joint_velocity_error_rad_s",
        ),
        0.0,
    ),
}


def test_an_observation_may_leave_out_its_end_cause():
    assert agree(Observation, json.dumps(OBSERVED)) == (True, True)


@pytest.mark.parametrize(
    "change",
    [
        {"version": 2},
        {"version": "1"},
        {"episode": -1},
        {"episode": 0.5},
        {"simulation": 7},
        {"zmp_error_m": [0.0]},
        {"zmp_error_m": [0.0, 0.0, 0.0]},
        {"zmp_error_m": [0.0, None]},
        {"end_cause": "bored"},
        {"mood": 1},
        {"phase": {**SOUND, "mood": 1}},
        {"phase": {**SOUND, "version": 2}},
        {"phase": {k: v for k, v in SOUND.items() if k != "version"}},
        {"phase": {k: v for k, v in SOUND.items() if k != "step_index"}},
    ],
    ids=str,
)
def test_what_the_decoder_refuses_is_not_valid(change):
    assert agree(Observation, json.dumps(OBSERVED | change)) == (True, False)


@pytest.mark.parametrize("counts", [{"bored": 1}, {"late": -1}, {"late": 0.5}, [], 1])
def test_counts_of_what_are_no_causes_are_not_valid(counts):
    status = json.loads(encode(STATUS)) | {"given_up": counts}
    assert agree(LearnerStatus, json.dumps(status)) == (True, False)


@pytest.mark.parametrize(
    ("payload", "other"),
    [(a, b) for a in PAYLOADS for b in PAYLOADS if a is not b],
    ids=lambda p: p.__name__,
)
@settings(deadline=None, max_examples=5)
@given(data=st.data())
def test_one_payload_is_not_valid_as_another(payload, other, data):
    text = encode(data.draw(made(payload)))
    assert agree(other, text) == (True, False)


# -- the files -------------------------------------------------------------------------


@EVERY_PAYLOAD
def test_the_file_is_what_the_struct_gives(payload):
    # If this fails: python -m msgs_json.schemas
    assert FILES.joinpath(file_name(payload)).read_text() == schema_text(payload)


@EVERY_PAYLOAD
def test_the_file_is_a_sound_schema(payload):
    VALIDATORS[payload].check_schema(VALIDATORS[payload].schema)


def test_there_are_no_other_files():
    found = {f.name for f in FILES.iterdir() if f.name.endswith(".json")}
    assert found == {file_name(payload) for payload in PAYLOADS}


@EVERY_PAYLOAD
def test_every_field_is_described(payload):
    definitions = VALIDATORS[payload].schema["$defs"].values()
    assert not [
        f"{definition['title']}.{name}"
        for definition in definitions
        for name, field in definition.get("properties", {}).items()
        if not field.get("description")
    ]


@EVERY_PAYLOAD
def test_fields_with_a_unit_in_their_name_say_it_in_words(payload):
    properties = VALIDATORS[payload].schema["$defs"][payload.__name__]["properties"]
    units = ("_m", "_s", "_rad", "_rad_s", "_m_s2", "_m2_s2", "_rad2_s", "_n2m2_s")
    assert all(
        properties[name]["description"].endswith("].")
        for name in properties
        if name.endswith(units)
    )


def test_the_command_writes_the_files(tmp_path):
    program = (
        "import sys; from pathlib import Path; import msgs_json.schemas.__main__ as m; "
        "m.FOLDER = Path(sys.argv[1]); m.main()"
    )
    subprocess.run(
        [sys.executable, "-c", program, str(tmp_path)], check=True, capture_output=True
    )
    assert {f.name: f.read_text() for f in tmp_path.iterdir()} == {
        file_name(payload): schema_text(payload) for payload in PAYLOADS
    }
