"""Filters that users write: a Python expression of `m`, the message."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ros2_verbs.errors import VerbError


def message_filter(expression: str | None) -> Callable[[Any], bool] | None:
    """Return a function that says whether a message passes, None without expression.

    Raises:
        VerbError: it is no expression; or, from the function, it fails on a message.
    """
    if expression is None:
        return None
    try:
        code = compile(expression, "--filter", "eval")
    except SyntaxError as error:
        raise VerbError(f"Invalid filter '{expression}': {error.msg}") from None

    def accepts(message: Any) -> bool:
        try:
            # The user's own words on the user's own machine.
            return bool(eval(code, {"m": message}))
        except Exception as error:
            raise VerbError(f"Invalid filter '{expression}': {error}") from None

    return accepts
