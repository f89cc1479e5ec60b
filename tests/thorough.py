"""Which parameters of a test are for `make thorough`."""

from collections.abc import Iterable
from typing import Any

import pytest


def first_always(values: Iterable[Any]) -> list[Any]:
    """Return parameters of which all but the first are for `make thorough` only."""
    first, *others = values
    return [first, *(pytest.param(each, marks=pytest.mark.thorough) for each in others)]
