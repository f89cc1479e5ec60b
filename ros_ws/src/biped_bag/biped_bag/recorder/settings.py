"""All settings of the recorder node."""

from __future__ import annotations

from dataclasses import dataclass

from biped_common.settings import Settings, setting


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
    exclude_regex: str = setting("", "", "do not record what matches this as a whole")
    include_hidden: bool = setting(
        False, "", "record topics with a name part that begins with _, too"
    )
    expect_biped: bool = setting(
        False,
        "",
        "listen to the biped's topics before anybody publishes them, so that their "
        "first messages are not missed",
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
