"""Which topics are recorded."""

from __future__ import annotations

import re
from dataclasses import dataclass

from biped_bag.recorder.settings import RecorderSettings
from biped_common.settings import SettingsError


@dataclass(frozen=True)
class Selection:
    """Topics by name, by pattern, or all; patterns match names as a whole.

    A topic is wanted if it is among the names or matches the pattern (if neither is
    given: always), unless it matches the exclusion. Hidden topics are wanted when
    asked for or named.
    """

    names: frozenset[str]
    pattern: re.Pattern[str] | None
    exclusion: re.Pattern[str] | None
    include_hidden: bool

    def wants(self, topic: str) -> bool:
        """Return whether a topic is to be recorded."""
        if self.exclusion is not None and self.exclusion.fullmatch(topic):
            return False
        if topic in self.names:
            return True
        if "/_" in topic and not self.include_hidden:
            return False
        if self.pattern is not None:
            return self.pattern.fullmatch(topic) is not None
        return not self.names


def selection_of(settings: RecorderSettings) -> Selection:
    """Return the selection that the settings describe.

    Raises:
        SettingsError: a pattern is not a regular expression.
    """
    return Selection(
        frozenset(f"/{name.lstrip('/')}" for name in settings.topics.split()),
        _pattern("regex", settings.regex),
        _pattern("exclude_regex", settings.exclude_regex),
        settings.include_hidden,
    )


def _pattern(key: str, text: str) -> re.Pattern[str] | None:
    try:
        return re.compile(text) if text else None
    except re.error as error:
        raise SettingsError(key, text, f"is no regular expression, {error}") from None
