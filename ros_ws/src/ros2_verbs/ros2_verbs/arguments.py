"""Kinds of numbers that options take."""

from __future__ import annotations

import argparse
import math


def positive_int(text: str) -> int:
    """Parse a whole number above 0."""
    return _checked_int(text, 1, "a positive integer")


def unsigned_int(text: str) -> int:
    """Parse a whole number that is not negative."""
    return _checked_int(text, 0, "a non-negative integer")


def positive_float(text: str) -> float:
    """Parse a finite number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text}: must be a positive number")
    return value


def _checked_int(text: str, least: int, kind: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = least - 1
    if value < least:
        raise argparse.ArgumentTypeError(f"{text}: must be {kind}")
    return value
