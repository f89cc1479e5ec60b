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
from typing import Any, get_args

import msgspec

from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation, PhaseFlags
from msgs_json.walk_plan import WalkPlan

PAYLOADS: tuple[type[msgspec.Struct], ...] = (
    PhaseFlags,
    Observation,
    EpisodeResult,
    LearnerStatus,
    WalkPlan,
)
_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def file_name(payload: type[msgspec.Struct]) -> str:
    """Return the name of a payload's file, such as phase_flags.schema.json."""
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


def _field_docstrings(struct: type[msgspec.Struct] | None) -> dict[str, str]:
    """Return the docstring under each field of a struct, which Python itself drops."""
    if struct is None:
        return {}
    (body,) = ast.parse(inspect.getsource(struct)).body
    assert isinstance(body, ast.ClassDef)
    texts = {}
    for field, after in zip(body.body, body.body[1:], strict=False):
        match field, after:
            case (
                ast.AnnAssign(target=ast.Name(id=name)),
                ast.Expr(value=ast.Constant(value=str(text))),
            ):
                texts[name] = inspect.cleandoc(text)
    return texts
