"""What a learner has learned, as named arrays: their hash, and whether they fit."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]


def arrays_sha256(arrays: Arrays) -> str:
    """Return a hash of names, types, shapes and values."""
    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {array.dtype.str} {array.shape};".encode())
        digest.update(array.tobytes())
    return digest.hexdigest()


def check_memory(memory: Mapping[str, NDArray[Any]], own: Arrays, count: int) -> None:
    """Refuse a memory that does not fit.

    Args:
        memory: arrays by name, with `count` states in their rows.
        own: what the learner itself has; arrays without a shape hold one number.
        count: number of states in the memory.

    Raises:
        ValueError: an array is missing, belongs to another problem, or holds numbers
            that are not finite.
    """
    for name, array in own.items():
        if name not in memory:
            raise ValueError(f"memory: array {name} is missing")
        expected = (count, *array.shape[1:]) if array.shape else ()
        given = memory[name]
        if given.shape != expected or given.dtype != array.dtype:
            raise ValueError(
                f"memory: array {name} is {given.dtype}{given.shape}, "
                f"this problem needs {array.dtype}{expected}"
            )
        if given.dtype.kind == "f" and not np.isfinite(given).all():
            raise ValueError(f"memory: array {name} holds numbers that are not finite")


def count_of_states(memory: Mapping[str, NDArray[Any]]) -> int:
    """Return how many states a memory holds.

    Raises:
        ValueError: it does not tell.
    """
    life = memory.get("state_life")
    if life is None or life.ndim != 1:
        raise ValueError("memory: array state_life is missing or no list")
    return len(life)
