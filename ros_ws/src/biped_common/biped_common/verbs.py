"""Verbs of a command are entry points: whoever installs a package adds verbs by it.

An entry point's name is the verb, its object a function `add_parser(parsers, words)`.
Only the verb that is called for is loaded: most bring ROS, the physics or compiled code
with them, which takes seconds that the others need not wait for. Where no verb is
named, as in a call for help, all are.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from biped_common.command_line import CommandError


def add_verbs(parsers: Any, group: str, words: Sequence[str]) -> None:
    """Add the parser of the verb that the words begin with, or of all verbs.

    Args:
        parsers: what `add_subparsers` returned.
        group: of the entry points.
        words: of the command line, from the verb on.

    Raises:
        CommandError: the verb that was called for cannot be loaded.
    """
    found = {point.name: point for point in entry_points(group=group)}
    chosen = [found[name] for name in words[:1] if name in found]
    if chosen:
        _loaded(chosen[0])(parsers, words[1:])
        return
    for name in sorted(found):
        try:
            _loaded(found[name])(parsers, words[1:])
        except CommandError as error:
            print(f"left out: {error}", file=sys.stderr)


def _loaded(point: EntryPoint) -> Any:
    try:
        return point.load()
    except Exception as error:
        package = point.dist.name if point.dist is not None else "an unknown package"
        raise CommandError(
            f"verb {point.name} of {package} cannot be loaded: "
            f"{type(error).__name__}: {error}"
        ) from error
