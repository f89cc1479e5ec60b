"""Message definitions as MCAP wants them: a type's text and those of all nested types.

The texts are the installed `share/PACKAGE/msg/TYPE.msg`, found by the ament index; that
of /tf stands here, since its package has no wheel.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from rosidl_adapter.parser import (  # type: ignore[import-untyped]
    parse_message_string,
)

from biped_bag.errors import BagError
from biped_ros.tf_type import TF_DEFINITION, TF_TYPE

_SEPARATOR = "=" * 80


@cache
def message_definition(type_name: str) -> str:
    """Return the text of a message and of everything nested in it.

    Args:
        type_name: as ROS writes it, package/msg/Type.

    Raises:
        BagError: no package of this installation defines it.
    """
    texts: dict[str, str] = {}
    waiting = [type_name]
    while waiting:
        name = waiting.pop(0)
        if name not in texts:
            texts[name] = _own_text(name)
            waiting += _nested_types(name, texts[name])
    whole = texts.pop(type_name).rstrip("\n")
    for name, text in texts.items():
        package, _, message = name.split("/")
        end = "" if whole.endswith("\n") else "\n"
        whole += f"{end}{_SEPARATOR}\nMSG: {package}/{message}\n{text}"
    return whole.rstrip("\n")


def _own_text(type_name: str) -> str:
    parts = type_name.split("/")
    if len(parts) != 3 or not all(parts):
        raise BagError(f"{type_name}: must have the form package/msg/Type")
    package, kind, message = parts
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    for prefix in filter(None, (*prefixes, sys.prefix)):
        share = Path(prefix) / "share"
        index = share / "ament_index/resource_index/packages" / package
        file = share / package / kind / f"{message}.msg"
        if index.exists() and file.exists():
            return file.read_text(encoding="utf-8")
    if type_name == TF_TYPE:
        return TF_DEFINITION
    raise BagError(f"{type_name}: no installed package defines this message")


def _nested_types(type_name: str, text: str) -> Iterator[str]:
    package, _, message = type_name.split("/")
    for field in parse_message_string(package, message, text).fields:
        if not field.type.is_primitive_type():
            yield f"{field.type.pkg_name}/msg/{field.type.type}"
