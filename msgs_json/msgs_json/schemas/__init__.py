"""JSON Schema of every payload, generated from its struct.

The files beside this module are the contract for programs that do not read Python.
`python -m msgs_json.schemas` writes them anew; a test keeps them in agreement. Two
things that `wire.decode` refuses JSON Schema cannot tell: NaN, which JSON does not
know, and 2.0 in the place of 2.
"""

from __future__ import annotations

import ast
import inspect
import json
import re
from enum import Enum
from typing import Any, get_args, get_origin

import msgspec

from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation, StampedPhase
from msgs_json.walk_plan import WalkPlan

PAYLOADS: tuple[type[msgspec.Struct], ...] = (
    StampedPhase,
    Observation,
    EpisodeResult,
    LearnerStatus,
    WalkPlan,
)
_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def file_name(payload: type[msgspec.Struct]) -> str:
    """Return the name of a payload's file, such as stamped_phase.schema.json."""
    words = re.findall("[A-Z][a-z]*", payload.__name__)
    return f"{'_'.join(words).lower()}.schema.json"


def schema_text(payload: type[msgspec.Struct]) -> str:
    """Return the content of a payload's file."""
    return json.dumps(schema_of(payload), indent=2, ensure_ascii=False) + "\n"


def schema_of(payload: type[msgspec.Struct]) -> dict[str, Any]:
    """Return the schema of a payload.

    Every field is described by the docstring under it, and the version is a constant.
    """
    schema = msgspec.json.schema(payload)
    structs = _structs(payload)
    for name, definition in schema["$defs"].items():
        definition["description"] = inspect.cleandoc(definition["description"])
        properties = definition.get("properties", {})
        if "version" in properties:
            (version,) = properties["version"]["enum"]
            properties["version"] = {
                "const": version,
                "description": f"Version of {name}.",
            }
        for field, text in _field_docstrings(structs.get(name)).items():
            properties[field]["description"] = text
        for field, words in _key_words(structs.get(name)).items():
            properties[field]["propertyNames"] = {"$ref": f"#/$defs/{words}"}
    return {"$schema": _DIALECT, **schema}


def _structs(kind: Any) -> dict[str, type[msgspec.Struct]]:
    """Return all structs in a type, by name."""
    if not (isinstance(kind, type) and issubclass(kind, msgspec.Struct)):
        inner = [_structs(each) for each in get_args(kind)]
        return {name: struct for found in inner for name, struct in found.items()}
    found = {kind.__name__: kind}
    for field in msgspec.structs.fields(kind):
        found.update(_structs(field.type))
    return found


def _key_words(struct: type[msgspec.Struct] | None) -> dict[str, str]:
    """Return the enumeration of each mapping's keys, which msgspec leaves out."""
    found = {}
    for field in () if struct is None else msgspec.structs.fields(struct):
        kind = get_args(field.type)[0] if get_args(field.type) else field.type
        key = get_args(kind)[0] if get_origin(kind) is dict else None
        if isinstance(key, type) and issubclass(key, Enum):
            found[field.name] = key.__name__
    return found


def _field_docstrings(struct: type[msgspec.Struct] | None) -> dict[str, str]:
    """Return the docstring under each field of a struct, which Python itself drops."""
    if struct is None or struct is msgspec.Struct:
        return {}
    texts = _field_docstrings(struct.__base__)
    (body,) = ast.parse(inspect.getsource(struct)).body
    assert isinstance(body, ast.ClassDef)
    for field, after in zip(body.body, body.body[1:], strict=False):
        match field, after:
            case (
                ast.AnnAssign(target=ast.Name(id=name)),
                ast.Expr(value=ast.Constant(value=str(text))),
            ):
                texts[name] = inspect.cleandoc(text)
    return texts
