"""Output the interface definition."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator
from typing import Any

from ros2_verbs.errors import VerbError
from ros2_verbs.messages.types import KINDS, all_interfaces, definition_file
from ros2_verbs.options import completed

_PRIMITIVE = re.compile(r"(bool|byte|char|float(32|64)|u?int(8|16|32|64)|w?string)\b")
_TYPE = re.compile(r"\s*(?P<name>[A-Za-z][\w/]*)")
# A comment begins at a # that is not in a quoted default value.
_CODE = re.compile(r"""(?:[^#'"]|"[^"]*"|'[^']*'|['"])*""")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    comments = parser.add_mutually_exclusive_group()
    comments.add_argument(
        "--all-comments",
        action="store_true",
        help="show all comments, including for nested interface definitions",
    )
    comments.add_argument(
        "--no-comments", action="store_true", help="show no comments or whitespace"
    )
    completed(
        parser.add_argument(
            "type", help="type, e.g. std_msgs/msg/String; - reads it from a pipe"
        ),
        _complete_types,
    )


def main(args: argparse.Namespace) -> int:
    """Print the definition, nested ones below their fields.

    Raises:
        VerbError: there is no such interface.
    """
    name = args.type
    if name == "-":
        if sys.stdin.isatty():
            raise VerbError("expected stdin pipe")
        name = sys.stdin.readline().strip()
    for line in definition_lines(
        name, comments=not args.no_comments, nested_comments=args.all_comments
    ):
        print(line)
    return 0


def definition_lines(
    name: str, *, comments: bool, nested_comments: bool, depth: int = 0
) -> Iterator[str]:
    """Yield the lines of a definition.

    Args:
        name: of the interface, package/kind/Type.
        comments: whether to keep comments and empty lines.
        nested_comments: the same, in the definitions of the fields' types.
        depth: tabs before each line.
    """
    package = name.split("/")[0]
    for line in definition_file(name).read_text().splitlines():
        code = code_of(line)
        shown = line.rstrip() if comments else code
        if shown or comments:
            yield "\t" * depth + shown if shown else ""
        nested = nested_type(package, code)
        if nested is not None:
            yield from definition_lines(
                nested,
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
    if match is None or _PRIMITIVE.match(code):
        return None
    owner, _, name = match.group("name").rpartition("/")
    return f"{owner.removesuffix('/msg') or package}/msg/{name}"


def _complete_types(**_: Any) -> list[str]:
    return [name for kind in KINDS for name in all_interfaces(kind)]
