"""All settings of the learner node."""

from __future__ import annotations

from dataclasses import dataclass

from msgs_json.settings import check_ranges, section, setting

from learner_node.walking.settings import LearnerSettings


@dataclass(frozen=True)
class LearnerNodeSettings:
    """The learner, its seed, and where it is kept."""

    learner: LearnerSettings = section(LearnerSettings)
    seed: int = setting(0, "", "of every random choice", lower=0)
    walk_ticks: int = setting(
        5625, "control ticks", "the whole walk, the last target", lower=1
    )
    checkpoint_file: str = setting("", "", "kept here, and gone on from; empty: nowhere")
    checkpoint_every_episodes: int = setting(
        10, "episodes", "learning episodes between saves", lower=1
    )
    max_episodes: int = setting(
        0, "episodes", "stop to answer after so many learning episodes; 0: never", lower=0
    )
    run_settings: str = setting("{}", "", "settings of the whole run, JSON, kept with it")

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_ranges(self)
