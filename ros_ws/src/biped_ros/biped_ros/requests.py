"""How much a service takes in one request.

The generated code has built a request before anybody is asked; answering is what takes
long and what grows: a description per name, a check and a reason per parameter.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from typing import Any

import numpy as np

# One datagram: ten times what the parameters of any of the nodes take.
REQUEST_LIMIT_BYTES = 65_536
# About a Python object and the reference to it.
_ELEMENT_BYTES = 64


def is_too_large(request: Any) -> bool:
    """Return whether a request takes more than the limit.

    Characters count as one byte, elements of lists as 64. Nothing beyond the limit is
    looked at, so that a request of any size is refused in no time.
    """
    left = REQUEST_LIMIT_BYTES
    for size in _sizes(request):
        left -= size
        if left < 0:
            return True
    return False


def _sizes(value: Any) -> Iterator[int]:
    """Yield the sizes of all that a message holds [bytes], those of lists first."""
    if isinstance(value, str | bytes):
        yield len(value)
    elif isinstance(value, array | np.ndarray):
        yield len(value) * value.itemsize
    elif isinstance(value, list | tuple):
        yield len(value) * _ELEMENT_BYTES
        for element in value:
            yield from _sizes(element)
    elif hasattr(value, "get_fields_and_field_types"):
        for field in value.get_fields_and_field_types():
            yield from _sizes(getattr(value, field))
