"""Entry points: how packages offer verbs, contestants and pages to the others."""

from __future__ import annotations

from importlib import metadata
from importlib.metadata import EntryPoint


def entry_points(group: str) -> dict[str, EntryPoint]:
    """Return the entry points of a group by name; as with modules, the first counts."""
    found: dict[str, EntryPoint] = {}
    for point in metadata.entry_points(group=group):
        found.setdefault(point.name, point)
    return found
