"""Verbs are modules: only the one that is called for is loaded.

Most of them bring ROS, the physics or compiled code with them, which takes seconds that
the others need not wait for. Where no verb is named, as in a call for help, all are.
"""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import Any


def add_verbs(
    parsers: Any, modules: str, names: Sequence[str], words: Sequence[str]
) -> None:
    """Add the parser of the verb that the words begin with, or of all verbs.

    Args:
        parsers: what `add_subparsers` returned.
        modules: prefix of the modules' names; each has `add_parser(parsers, words)`.
        names: of the verbs, in the order of the help.
        words: of the command line, from the verb on.
    """
    chosen = [name for name in names if name in words[:1]] or names
    for name in chosen:
        module = importlib.import_module(f"{modules}{name}")
        module.add_parser(parsers, words[1:])
