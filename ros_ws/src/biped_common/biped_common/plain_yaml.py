"""YAML as settings and bags use it: a tree of plain values, read within bounds.

Refused, since a few lines of it can take all memory or hide a value: aliases (ROS's own
parameter files have none either), a key that stands twice in a section, nesting beyond
50 levels, more than 100,000 values, and more than a million bytes.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml
from yaml.constructor import ConstructorError, SafeConstructor

from biped_common.errors import BipedError

MOST_BYTES = 1_000_000
_MOST_VALUES = 100_000
_MOST_LEVELS = 50
_MOST_DIGITS = 100
_NUMBERS = ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float")


class YamlError(BipedError, ValueError):
    """A text is no YAML of this kind; the message is one line that says where."""


def read_yaml(text: str) -> Any:
    """Return the plain values that a YAML text holds.

    Raises:
        YamlError: it is no YAML, or of a form that is refused.
    """
    if len(text) > MOST_BYTES:
        raise YamlError(f"is longer than {MOST_BYTES} characters")
    try:
        _check_form(text)
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        raise YamlError(_place_and_reason(error)) from None
    except (
        yaml.YAMLError, ArithmeticError, AttributeError, LookupError, ValueError
    ) as error:  # fmt: skip
        # A tag or a date that its value does not fit can raise almost anything.
        reason = " ".join(str(error).split())
        raise YamlError(reason or type(error).__name__) from None


def read_yaml_file(path: Path) -> Any:
    """Return the plain values that a YAML file holds.

    Raises:
        YamlError: see `read_yaml`; also, where it is not UTF-8.
        OSError: it cannot be read.
    """
    with path.open("rb") as stream:
        content = stream.read(MOST_BYTES + 1)
    if len(content) > MOST_BYTES:
        raise YamlError(f"is larger than {MOST_BYTES} bytes")
    try:
        return read_yaml(content.decode())
    except UnicodeDecodeError as error:
        raise YamlError(f"is not UTF-8 at byte {error.start}") from None


def yaml_text(values: Any) -> str:
    """Return plain values as YAML, equal ones written out each time."""
    text: str = yaml.dump(values, Dumper=_Dumper, sort_keys=False)
    return text


def _check_form(text: str) -> None:
    """Refuse what must not even be built: the library would, until memory ends."""
    levels = values = 0
    for event in yaml.parse(text, Loader=yaml.CSafeLoader):
        if isinstance(event, yaml.AliasEvent):
            raise _refused(event, f"*{event.anchor}: aliases are not read")
        levels += isinstance(event, yaml.CollectionStartEvent)
        levels -= isinstance(event, yaml.CollectionEndEvent)
        values += isinstance(event, yaml.NodeEvent)
        if levels > _MOST_LEVELS:
            raise _refused(event, f"nested deeper than {_MOST_LEVELS} levels")
        if values > _MOST_VALUES:
            raise _refused(event, f"more than {_MOST_VALUES} values")


def _refused(where: Any, reason: str) -> ConstructorError:
    return ConstructorError(None, None, reason, where.start_mark)


def _place_and_reason(error: yaml.MarkedYAMLError) -> str:
    mark = error.problem_mark or error.context_mark
    place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
    return place + " ".join(str(error.problem or error.context).split())


class _Loader(yaml.CSafeLoader):
    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        mapping: dict[Any, Any] = super().construct_mapping(node, deep=deep)
        seen = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if key in seen:
                name = key_node.value[:_MOST_DIGITS]
                raise _refused(key_node, f"the key {name} stands twice")
            seen.add(key)
        return mapping


def _number(loader: _Loader, node: yaml.ScalarNode) -> Any:
    # 1:1:1 is a number to the base 60, which takes the square of its length to read.
    if len(node.value) > _MOST_DIGITS:
        raise _refused(node, f"a number of {len(node.value)} characters")
    return SafeConstructor.yaml_constructors[node.tag](loader, node)


for _tag in _NUMBERS:
    _Loader.add_constructor(_tag, _number)


class _Dumper(yaml.SafeDumper):
    def ignore_aliases(self, data: Any) -> bool:
        return True
