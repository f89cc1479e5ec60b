"""All settings of the recorder node."""

from __future__ import annotations

import re
from dataclasses import dataclass

from biped_bag.selection import Selection, from_root
from biped_common.settings import Settings, SettingsError, setting


@dataclass(frozen=True)
class RecorderSettings(Settings):
    """What is recorded, and where to."""

    folder: str = setting("", "", "of the bag; must not be one yet")
    number_if_taken: bool = setting(
        False,
        "",
        "if the folder is a bag, take FOLDER_2, FOLDER_3, ... instead",
    )
    topics: str = setting("", "", "record these, separated by blanks; empty: all")
    regex: str = setting("", "", "record what matches this as a whole; empty: all")
    topic_types: str = setting(
        "", "", "record topics of these types, too, separated by blanks"
    )
    exclude_topics: str = setting("", "", "do not record these, separated by blanks")
    exclude_regex: str = setting("", "", "do not record what matches this as a whole")
    include_hidden: bool = setting(
        False, "", "record topics with a name part that begins with _, too"
    )
    sim_time: bool = setting(
        False,
        "",
        "log_time is the time of /clock; nothing is recorded before it is heard",
    )
    start_paused: bool = setting(
        False, "", "record nothing until the service resume is called; offer pause, too"
    )
    expect_biped: bool = setting(
        False,
        "",
        "listen to the biped's topics before anybody publishes them, so that their "
        "first messages are not missed",
    )
    make_tf: bool = setting(
        False,
        "",
        "record /tf, made of torso pose, joint states and robot description, where "
        "these are recorded",
    )
    split: str = setting(
        "none",
        "",
        "when a new file is begun: never, by size, after so many episodes",
        choices=("none", "size", "episode"),
    )
    max_file_mb: int = setting(512, "MB", "size of a file, for split = size", lower=1)
    episodes_per_file: int = setting(
        1, "episodes", "in a file, for split = episode", lower=1
    )
    run: str = setting("{}", "", "JSON object of texts, kept in the bag as biped.run")
    attachment: str = setting("", "", "file kept in the bag, the memory begun with")

    def selection(self) -> Selection:
        """Return which topics are recorded.

        Raises:
            SettingsError: a pattern is not a regular expression.
        """
        return Selection(
            names=from_root(self.topics.split()),
            types=frozenset(self.topic_types.split()),
            pattern=_pattern("regex", self.regex),
            excluded_names=from_root(self.exclude_topics.split()),
            excluded_pattern=_pattern("exclude_regex", self.exclude_regex),
            include_hidden=self.include_hidden,
        )


def _pattern(key: str, text: str) -> re.Pattern[str] | None:
    try:
        return re.compile(text) if text else None
    except re.error as error:
        raise SettingsError(key, text, f"is no regular expression, {error}") from None
