"""Definitions of interfaces as text, with those of their fields' types below them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ros2_verbs.message_types import definition_file

_SEPARATOR = "---"
_PRIMITIVE = re.compile(r"(bool|byte|char|float(32|64)|u?int(8|16|32|64)|w?string)\b")
_TYPE = re.compile(r"\s*(?P<name>[A-Za-z][\w/]*)")
# A comment begins at a # that is not in a quoted default value.
_CODE = re.compile(r"""(?:[^#'"]|"[^"]*"|'[^']*'|['"])*""")


def definition_lines(
    package: str, text: str, *, comments: bool, nested_comments: bool, depth: int = 0
) -> Iterator[str]:
    """Yield the lines of a definition.

    Args:
        package: in which types without a package's name are.
        text: of the definition.
        comments: whether to keep comments and empty lines.
        nested_comments: the same, in the definitions of the fields' types.
        depth: tabs before each line.
    """
    for line in text.splitlines():
        shown = line.rstrip()
        code = code_of(shown)
        if not comments:
            shown = code
        if shown or comments:
            yield "\t" * depth + shown if shown else ""
        nested = nested_type(package, code)
        if nested is not None:
            yield from definition_lines(
                nested.split("/")[0],
                definition_file(nested).read_text(),
                comments=nested_comments,
                nested_comments=nested_comments,
                depth=depth + 1,
            )


def code_of(line: str) -> str:
    """Return a line without its comment and the space around."""
    match = _CODE.match(line)
    return match.group().strip() if match else ""


def nested_type(package: str, code: str) -> str | None:
    """Return the full name of the message type of a field, None for plain numbers.

    Args:
        package: in which types without a package's name are.
        code: a line without comment.
    """
    match = _TYPE.match(code)
    if match is None or code == _SEPARATOR or _PRIMITIVE.match(code):
        return None
    owner, _, name = match.group("name").rpartition("/")
    return f"{owner.removesuffix('/msg') or package}/msg/{name}"
