"""Which topics are recorded, or played."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Selection:
    """Topics by name, type or pattern, or all; patterns match names as a whole.

    A topic is wanted if it is among the names, of one of the types or matches the
    pattern (if none of these is given: always), unless it is excluded by name or
    pattern. Hidden topics are wanted when asked for or named.
    """

    names: frozenset[str] = frozenset()
    types: frozenset[str] = frozenset()
    pattern: re.Pattern[str] | None = None
    excluded_names: frozenset[str] = frozenset()
    excluded_pattern: re.Pattern[str] | None = None
    include_hidden: bool = False

    def wants(self, topic: str, types: Collection[str]) -> bool:
        """Return whether a topic is to be recorded or played.

        Args:
            topic: its name, from the root.
            types: its types, of which one counts.
        """
        if topic in self.excluded_names or _matches(self.excluded_pattern, topic):
            return False
        if topic in self.names:
            return True
        if "/_" in topic and not self.include_hidden:
            return False
        if not (self.names or self.types or self.pattern):
            return True
        return not self.types.isdisjoint(types) or _matches(self.pattern, topic)


def from_root(names: Iterable[str]) -> frozenset[str]:
    """Return names of topics as they are on the graph, with a slash in front."""
    return frozenset(f"/{name.lstrip('/')}" for name in names)


def _matches(pattern: re.Pattern[str] | None, topic: str) -> bool:
    return pattern is not None and pattern.fullmatch(topic) is not None
