"""All settings of the learner node."""

from __future__ import annotations

from dataclasses import dataclass

from biped_common.settings import Settings, section, setting
from biped_ros.processor import ProcessorSettings
from learner_node.walking.settings import LearnerSettings


@dataclass(frozen=True)
class LearnerNodeSettings(Settings):
    """The learner, its seed, and where it is kept."""

    learner: LearnerSettings = section(LearnerSettings)
    processor: ProcessorSettings = section(ProcessorSettings)
    seed: int = setting(0, "", "of every random choice", lower=0, upper=2**63 - 1)
    walk_ticks: int = setting(
        5625, "control ticks", "the whole walk, the last target", lower=1, upper=10**6
    )
    listen_s: float = setting(
        1.5, "s", "listen for another learner before taking part", lower=0.0, upper=60.0
    )
    frozen: bool = setting(False, "", "walk greedily from the start, learn nothing")
    max_episodes: int = setting(
        0, "episodes", "stop answering after so many; 0: never", lower=0
    )
    checkpoint_file: str = setting("", "", "goes on from here, and is kept here")
    checkpoint_every_episodes: int = setting(
        10, "episodes", "learning episodes between saves", lower=1, live=True
    )
    run_settings: str = setting(
        "{}", "", "JSON, sections of the run's settings beside learner, kept with it"
    )
