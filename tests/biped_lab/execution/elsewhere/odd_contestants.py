"""Contestants of somebody else's package: one counts, the others misbehave."""

import os
import signal
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_info

from biped_bringup.walker import WalkedTicks
from biped_common.atomic_file import atomic_file
from biped_common.settings import Settings, setting
from biped_lab.contestant import Entry


@dataclass(frozen=True)
class Misdeed(Settings):
    """What it does wrong."""

    kind: str = setting("none", "", "in its third episode: none, raise or die")


class Odd:
    """Walks nothing; draws a number an episode."""

    def __init__(self, kind: str, seed: int, drawn: list[float]) -> None:
        self.ticks, self.cpu_s = WalkedTicks(), 0.0
        self._kind = kind
        self._drawn = drawn
        self._rng = np.random.default_rng(seed)
        self._rng.random(len(drawn))

    @property
    def episodes(self) -> int:
        return len(self._drawn)

    def episode(self) -> None:
        if self.episodes == 2 and self._kind == "raise":
            raise ZeroDivisionError("one leg\ntoo few")
        if self.episodes == 2 and self._kind == "die":
            os.kill(os.getpid(), signal.SIGKILL)
        self._drawn.append(self._rng.random())

    def milestone(self, name: str) -> int | None:
        return None

    def table(self) -> dict[str, np.ndarray]:
        return {"drawn": np.array(self._drawn)}

    def figures(self) -> dict[str, int]:
        return {"threads": max(pool["num_threads"] for pool in threadpool_info())}

    def save(self, path: Path) -> None:
        with atomic_file(path) as stream:
            np.save(stream, self._drawn)

    def close(self) -> None:
        pass


ODD = Entry(
    Misdeed,
    lambda settings, own, seed: Odd(own.kind, seed, []),
    lambda path, settings, own, seed: Odd(own.kind, seed, np.load(path).tolist()),
    "odd_contestants",
)
