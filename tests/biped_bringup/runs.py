"""Training runs to compare: two that agree in their record did the very same."""

from dataclasses import dataclass
from typing import Any

from biped_bringup.run_settings import RunSettings, load_settings
from biped_bringup.training import TrainingRun
from learner_node.memory import arrays_sha256

# One step, learned in three subtasks of one success each.
SHORT = ("gait.steps=1", "learner.schedule.successes_per_subtask=1")
DISTURBED = (
    "sim.disturbances.push_force_n=10",
    "sim.disturbances.push_time_s=0.3",
    "sim.disturbances.mass_error=0.05",
    "sim.disturbances.position_noise_m=0.002",
    "sim.disturbances.zmp_noise_m=0.002",
    "sim.disturbances.acceleration_noise_m_s2=0.1",
)


def quick(*changes: str) -> RunSettings:
    """The quick preset with some changes."""
    return load_settings("quick", None, changes)


@dataclass(frozen=True)
class Record:
    """All that a run has done and learned so far, but not how long it took."""

    memory_sha256: str
    trajectory_sha256: str
    log_sha256: str
    tally: dict[str, Any]
    progress: dict[str, Any]


def record(run: TrainingRun) -> Record:
    """Take the record of a run."""
    return Record(
        memory_sha256=run.session.memory_sha256(),
        trajectory_sha256=run.tally.trajectories_sha256,
        log_sha256=arrays_sha256(run.log.arrays()),
        tally=dict(vars(run.tally)),
        progress=run.session.header()["progress"],
    )


def learn(run: TrainingRun, episodes: int) -> TrainingRun:
    """Go on until so many episodes have been walked in all."""
    while run.episodes < episodes:
        run.episode()
    return run


class UninterruptedRun:
    """A run that is neither saved nor loaded, and what it was after each episode."""

    def __init__(self, settings: RunSettings, seed: int = 0) -> None:
        self.run = TrainingRun(settings, seed)
        self._records = [record(self.run)]

    def after(self, episodes: int) -> Record:
        """Its record after that many episodes, walked when first asked for."""
        while len(self._records) <= episodes:
            self.run.episode()
            self._records.append(record(self.run))
        return self._records[episodes]
