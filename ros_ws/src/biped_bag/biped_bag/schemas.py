"""Message definitions as MCAP wants them: a type's text and those of all nested types.

The texts are the installed `share/PACKAGE/msg/TYPE.msg`, found by the ament index.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from biped_bag.errors import BagError

ENCODING = "ros2msg"
_SEPARATOR = "=" * 80
_PRIMITIVES = frozenset(
    ("bool", "byte", "char", "float32", "float64", "string", "wstring")
) | {f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)}
# A field: its type, possibly an array or a bounded string, then its name.
_FIELD = re.compile(r"^\s*([A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+[A-Za-z]\w*")


@cache
def message_definition(type_name: str) -> str:
    """Return the text of a message and of everything nested in it.

    Args:
        type_name: as ROS writes it, package/msg/Type.

    Raises:
        BagError: no package of this installation defines it.
    """
    texts = {type_name: _own_text(type_name)}
    waiting = [type_name]
    while waiting:
        for nested in _nested_types(waiting.pop(0), texts):
            if nested not in texts:
                texts[nested] = _own_text(nested)
                waiting.append(nested)
    root, *others = texts
    parts = [texts[root].rstrip("\n") + "\n"]
    for nested in others:
        package, _, name = nested.split("/")
        parts.append(f"{_SEPARATOR}\nMSG: {package}/{name}\n{texts[nested]}")
    return "".join(
        part if part.endswith("\n") else f"{part}\n" for part in parts
    ).rstrip("\n")


def _own_text(type_name: str) -> str:
    package, kind, name = _parts(type_name)
    for prefix in _prefixes():
        share = prefix / "share"
        index = share / "ament_index/resource_index/packages" / package
        file = share / package / kind / f"{name}.msg"
        if index.exists() and file.exists():
            return file.read_text(encoding="utf-8")
    raise BagError(f"{type_name}: no installed package defines this message")


def _parts(type_name: str) -> tuple[str, str, str]:
    parts = tuple(type_name.split("/"))
    if len(parts) != 3 or not all(parts):
        raise BagError(f"{type_name}: must have the form package/msg/Type")
    return parts[0], parts[1], parts[2]


def _prefixes() -> list[Path]:
    named = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return [Path(prefix) for prefix in (*named, sys.prefix) if prefix]


def _nested_types(type_name: str, texts: dict[str, str]) -> Iterator[str]:
    package = type_name.split("/")[0]
    for line in texts[type_name].splitlines():
        field = _FIELD.match(line.split("#")[0])
        if field is None or field[1] in _PRIMITIVES:
            continue
        *where, name = field[1].split("/")
        yield f"{where[0] if where else package}/msg/{name}"
