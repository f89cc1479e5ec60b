"""The decorator that compiles the inner loops."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

_Function = TypeVar("_Function", bound=Callable[..., Any])


def compiled(function: _Function) -> _Function:
    """Compile ``function`` to machine code on its first call, and keep it on disk.

    The result keeps the type of ``function`` for the type checker. Global constants
    are frozen into the machine code, and the copy on disk does not notice when another
    module changes: pass what may be tuned, such as dimensions, as arguments.
    """
    return cast(_Function, numba.njit(cache=True)(function))
