"""Verbs of a command are entry points: whoever installs a package adds verbs by it.

An entry point's name is the verb; what it is to be is said where the command is, for
`biped` a function `add_parser(parsers, words)`. Only the verb that is called for is
loaded: most bring ROS, the physics or compiled code with them, which takes seconds that
the others need not wait for. Where no verb is named, as in a call for help, all are;
one that cannot be loaded is named with its package and left out.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable, Sequence
from importlib.metadata import EntryPoint
from importlib.util import find_spec
from typing import Any

from biped_common.command_line import CommandError
from biped_common.entry_points import entry_points


def docstring_of(point: EntryPoint) -> str:
    """Return the docstring of an entry point's module, without running the module."""
    spec = find_spec(point.module)
    if spec is None:
        raise ModuleNotFoundError(f"No module named '{point.module}'")
    loader: Any = spec.loader
    source = loader.get_source(point.module) or ""
    return ast.get_docstring(ast.parse(source), clean=False) or ""


def add_verbs(parsers: Any, group: str, words: Sequence[str]) -> None:
    """Add the parser of the verb that the words begin with, or of all verbs.

    Args:
        parsers: what `add_subparsers` returned.
        group: of the entry points.
        words: of the command line, from the verb on.

    Raises:
        CommandError: the verb that was called for cannot be loaded.
    """
    use_verbs(group, words, lambda point, _: point.load()(parsers, words[1:]))


def use_verbs(
    group: str, words: Sequence[str], use: Callable[[EntryPoint, bool], object]
) -> None:
    """Do something with the verb that the words begin with, or with each verb.

    Args:
        group: of the entry points.
        words: of the command line, from the verb on.
        use: gets an entry point, and whether the words begin with its name. Where it
            fails, the verb counts as one that cannot be loaded.

    Raises:
        CommandError: the verb that was called for cannot be loaded.
    """
    found = entry_points(group)
    if words and words[0] in found:
        _use(found[words[0]], use, True)
        return
    for name in sorted(found):
        try:
            _use(found[name], use, False)
        except CommandError as error:
            print(f"left out: {error}", file=sys.stderr)


def _use(
    point: EntryPoint, use: Callable[[EntryPoint, bool], object], called: bool
) -> None:
    try:
        use(point, called)
    except CommandError:
        raise  # of a verb below this one
    except (Exception, SystemExit) as error:
        # In one line, whatever the package has to say.
        text = " ".join(str(error).split())
        package = "an unknown package" if point.dist is None else point.dist.name
        raise CommandError(
            f"verb {point.name} of {package} cannot be loaded: "
            f"{type(error).__name__}: {text}"
        ) from error
