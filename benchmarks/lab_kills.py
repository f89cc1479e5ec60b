"""Kill drivers and workers of the laboratory at random moments; is anything lost?

    python -m benchmarks.lab_kills --kills 20 --seed 0

`biped lab run` carries out a small study with two workers; with `kill -9` the driver or
one of the workers is ended, and the command is started again. At the end all files must
be those of the same study that was never disturbed, byte for byte.

Exit status 1 when they differ, when a worker outlived its driver, or when something was
left behind; 130 when interrupted.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path
from signal import SIGKILL

from benchmarks.report import Figure
from benchmarks.up_run import alive, wait_until
from biped_common.command_line import INTERRUPTED
from biped_lab.results import RUNS
from biped_lab.run_folder import is_taken

_STUDY = {
    "title": "killed",
    "preset": "quick",
    "settings": {"gait.steps": 2},
    "most_episodes": 40,
    "seeds": {"first": 1, "count": 3},
    "arms": {
        "fixed": None,
        "free": {"settings": {"learner.xol.fixed_mode.strategy": "none"}},
    },
}
_LONGEST_PAUSE_S = 6.0
_START_S = 300.0
_ORPHANS_S = 15.0
_RUN_S = 3600.0


def main() -> int:
    """Kill, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=20, help="at most")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as name:
        try:
            figures = _killed(Path(name), options.kills, chance)
        except KeyboardInterrupt:
            return INTERRUPTED
    print("\n".join(figure.line() for figure in figures))
    return 0 if all(figure.kept for figure in figures) else 1


class _Kills:
    """A study that is killed until it ends, and what was counted."""

    def __init__(self, folder: Path, most: int, chance: random.Random) -> None:
        self._folder, self._most, self._chance = folder, most, chance
        self.drivers, self.workers, self.orphans = 0, 0, 0

    def to_its_end(self) -> None:
        """Start a driver after the other."""
        ended = False
        while not ended:
            with _driver(self._folder) as driver:
                ended = self._beset(driver)

    def _beset(self, driver: subprocess.Popen[bytes]) -> bool:
        """Kill at random; return whether the driver came to its own end."""
        while True:
            wait_until(
                lambda: driver.poll() is not None or _works(self._folder), _START_S
            )
            spared = self.drivers + self.workers >= self._most
            pause_s = _RUN_S if spared else self._chance.uniform(0, _LONGEST_PAUSE_S)
            if wait_until(lambda: driver.poll() is not None, pause_s):
                return True
            workers = _workers(driver.pid)
            if self._chance.random() < 0.5:
                driver.kill()
                self.drivers += 1
                print(f"driver, after {pause_s:.1f} s", flush=True)
                self.orphans += _alive_for_long(workers)
                return False
            if workers:
                os.kill(workers[0], SIGKILL)
                self.workers += 1
                print(f"worker, after {pause_s:.1f} s", flush=True)


def _killed(top: Path, most: int, chance: random.Random) -> list[Figure]:
    """Carry the study out undisturbed, and killed; compare."""
    (top / "study.yaml").write_text(json.dumps(_STUDY))
    undisturbed, folder = top / "undisturbed", top / "killed"
    with _driver(undisturbed) as driver:
        driver.wait(_RUN_S)
    kills = _Kills(folder, most, chance)
    kills.to_its_end()
    same, hidden = _files(folder) == _files(undisturbed), list(folder.rglob(".*"))
    return [
        Figure("drivers killed", kills.drivers, "", at_least=1.0),
        Figure("workers killed", kills.workers, "", at_least=1.0),
        Figure("workers that outlived their driver by 15 s", kills.orphans, "", 0.0),
        Figure("files left behind", len(hidden), "", 0.0),
        Figure("studies with the files of an undisturbed one", same, "", at_least=1.0),
    ]


def _driver(folder: Path) -> subprocess.Popen[bytes]:
    words = ["lab", "run", str(folder.parent / "study.yaml"), "--out", str(folder)]
    words += ["--workers", "2", "--checkpoint-every", "0.5"]
    return subprocess.Popen([sys.executable, "-m", "biped_bringup.cli.main", *words])


def _works(folder: Path) -> bool:
    return any(map(is_taken, (folder / RUNS).glob("*")))


def _workers(driver: int) -> list[int]:
    """Return the processes that compute, without the one that tracks resources."""
    found = []
    for children in Path(f"/proc/{driver}/task").glob("*/children"):
        for child in map(int, children.read_text().split()):
            words = Path(f"/proc/{child}/cmdline").read_bytes()
            if b"spawn_main" in words:
                found.append(child)
    return found


def _alive_for_long(workers: list[int]) -> int:
    """Give workers time to end; return how many have not."""
    wait_until(lambda: not any(map(alive, workers)), _ORPHANS_S)
    return sum(map(alive, workers))


def _files(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for name in ("study.json", "run.json", "end.json", "episodes.parquet")
        for path in folder.rglob(name)
    }


if __name__ == "__main__":
    sys.exit(main())
