"""Kill processes of a learning run at random moments; is anything lost, or left behind?

    python -m benchmarks.kills --kills 100 --seed 0

`biped up` learns, as fast as it can, and with `kill -9` any of its processes is ended,
the supervisor included, which is then started again with --resume. Runs end as they
would, and the next one begins; each memory is compared with that of as many episodes
that were learned in one process and never interrupted.

Exit status 1 when a node outlived its supervisor, when a checkpoint held fewer episodes
than an earlier one or could not be read, or when a memory differed; 130 when
interrupted.
"""

from __future__ import annotations

import argparse
import os
import random
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from signal import SIGKILL

from benchmarks.report import Figure
from benchmarks.up_run import SUPERVISOR, UpRun, alive, up, wait_until
from biped_bringup.cli.learn import MEMORY_FILE
from biped_bringup.run_settings import load_settings
from biped_bringup.supervisor.supervisor import START_ORDER
from biped_bringup.training import TrainingRun
from biped_common.command_line import DONE, INTERRUPTED, NOT_ACHIEVED
from learner_node.checkpoint import CheckpointError

_PRESET = "quick"
_EPISODES = 60
_LONGEST_PAUSE_S = 8.0
_ORPHANS_S = 15.0
_RUN_S = 600.0


@dataclass
class Tally:
    """What came of the kills so far."""

    kills: int = 0
    orphans: int = 0
    """Nodes that were there 15 s after their supervisor had been killed."""
    unreadable: int = 0
    """Checkpoints that could not be read."""
    lost: int = 0
    """Episodes that were in a checkpoint and in a later one no more."""
    runs: int = 0
    same: int = 0
    """Runs that learned what one process learns without interruption."""
    failed: list[str] = field(default_factory=list)
    """Runs that ended otherwise than they should."""

    def figures(self) -> list[Figure]:
        """Return what was counted, with its bounds."""
        return [
            Figure("kills", self.kills, "", at_least=1.0),
            Figure("orphans", self.orphans, "", 0.0),
            Figure("checkpoints that cannot be read", self.unreadable, "", 0.0),
            Figure("episodes lost that were saved", self.lost, "", 0.0),
            Figure("runs to their end", self.runs, "", at_least=1.0),
            Figure("memories that differ", self.runs - self.same, "", 0.0),
            Figure("runs that failed", len(self.failed), "", 0.0),
        ]


class KilledRun:
    """One learning run, however many supervisors it takes."""

    def __init__(
        self, folder: Path, seed: int, kills: int, chance: random.Random, tally: Tally
    ) -> None:
        """Prepare a run in an empty folder.

        Args:
            folder: for memory, bags and logs.
            seed: of the run.
            kills: after so many, in all runs, it is left in peace.
            chance: says who is killed, and when.
            tally: counts.
        """
        self._folder = folder
        self._memory_file = folder / MEMORY_FILE
        self._seed = seed
        self._kills = kills
        self._chance = chance
        self._tally = tally
        self._saved = 0

    def to_its_end(self) -> None:
        """Learn, be killed, and go on until all is learned; then compare."""
        ended = None
        while ended is None:
            options = ["--episodes", str(_EPISODES)]
            if self._memory_file.exists():
                options.append("--resume")
            else:
                options += ["--preset", _PRESET, "--seed", str(self._seed)]
            with up(self._folder, *options) as run:
                ended = self._beset(run)
        self._look_at_checkpoint()
        if ended in (DONE, NOT_ACHIEVED):
            self._compare()
        else:
            log = self._folder / "up.log"
            self._tally.failed.append(f"exit status {ended}: {log.read_text()}")

    def _beset(self, run: UpRun) -> int | None:
        """Kill at random; return the run's exit status, None if it was killed."""
        end = time.monotonic() + _RUN_S
        while time.monotonic() < end:
            pause_s = self._chance.uniform(0.0, _LONGEST_PAUSE_S)
            spared = self._tally.kills >= self._kills
            victim = self._chance.choice((SUPERVISOR, *START_ORDER))
            if wait_until(
                lambda: run.process.poll() is not None, _RUN_S if spared else pause_s
            ):
                return run.process.returncode
            processes = run.processes()
            if victim not in processes:
                continue  # it is just being started
            os.kill(processes.pop(victim), SIGKILL)
            self._tally.kills += 1
            print(
                f"{self._tally.kills:3d}  {victim}, {pause_s:.1f} s later", flush=True
            )
            if victim == SUPERVISOR:
                self._count_orphans(list(processes.values()))
            self._look_at_checkpoint()
            if victim == SUPERVISOR:
                return None
        return run.process.poll()

    def _count_orphans(self, nodes: list[int]) -> None:
        """Wait for the nodes to end with their supervisor."""
        wait_until(lambda: not any(map(alive, nodes)), _ORPHANS_S)
        for node in filter(alive, nodes):
            self._tally.orphans += 1
            os.kill(node, SIGKILL)

    def _look_at_checkpoint(self) -> None:
        """See that nothing has gone from what was saved."""
        if not self._memory_file.exists():
            return
        try:
            run = TrainingRun.load(self._memory_file)
        except CheckpointError as error:
            self._tally.unreadable += 1
            print(error, flush=True)
            return
        run.close()
        self._tally.lost += max(0, self._saved - run.episodes)
        self._saved = run.episodes

    def _compare(self) -> None:
        """Learn the same in this process."""
        learned = TrainingRun.load(self._memory_file)
        learned.close()
        undisturbed = TrainingRun(load_settings(_PRESET), self._seed)
        undisturbed.run(learned.episodes, False, lambda _: True)
        undisturbed.close()
        same = _hashes(learned) == _hashes(undisturbed)
        self._tally.runs += 1
        self._tally.same += same
        verdict = "the same memory" if same else "ANOTHER MEMORY"
        print(f"seed {self._seed}: {verdict} after {learned.episodes} episodes")


def _hashes(run: TrainingRun) -> tuple[str, str]:
    return run.session.memory_sha256(), run.tally.trajectories_sha256


def main() -> int:
    """Kill, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    tally = Tally()
    try:
        while not tally.runs or (tally.kills < options.kills and not tally.failed):
            with tempfile.TemporaryDirectory() as name:
                seed = options.seed + tally.runs
                KilledRun(Path(name), seed, options.kills, chance, tally).to_its_end()
    except KeyboardInterrupt:
        return INTERRUPTED
    print("\n".join([*tally.failed, *(figure.line() for figure in tally.figures())]))
    return 0 if all(figure.kept for figure in tally.figures()) else 1


if __name__ == "__main__":
    sys.exit(main())
