"""One run in its folder, which is named by the run's address.

    run.json          what it is (`RunSpec`)
    memory.npz        checkpoint: all that was learned, and all it takes to go on
    episodes.parquet  a row per episode, when the run has ended
    end.json          how it ended; there once the run is done, the same in every run
    cost.json         what it took, which depends on machine and interruptions

What failures do: a run that is killed goes on from its checkpoint, bit for bit; one
that is done is never run again; a folder in which another process runs is left to it.
"""

from __future__ import annotations

import fcntl
import platform
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import pyarrow as pa
import pyarrow.parquet as pq
from threadpoolctl import threadpool_limits

from biped_common.atomic_file import atomic_file
from biped_common.command_line import CommandError
from biped_common.errors import BipedError
from biped_common.exclusive_folder import LOCK_FILE, exclusive_folder
from biped_common.settings import from_mapping
from biped_lab.contestant import MILESTONES, Contestant, entry
from biped_lab.study import RunSpec, run_code

RUN_FILE, MEMORY_FILE, EPISODES_FILE = "run.json", "memory.npz", "episodes.parquet"
END_FILE, COST_FILE = "end.json", "cost.json"
CHECKPOINT_EVERY_S = 10.0
_WHAT_TO_DO = "remove the run's folder, and it begins anew"
_Content = TypeVar("_Content")


class RunError(BipedError, RuntimeError):
    """A run that cannot be carried out here."""


class TakenError(RunError):
    """Another process is in the folder."""


class End(msgspec.Struct, frozen=True):
    """How a run ended."""

    episodes: int
    schedule: int | None
    greedy: int | None
    figures: dict[str, Any]
    """The contestant's own; see `Contestant.figures`."""


class Cost(msgspec.Struct, frozen=True):
    """What a run has taken so far."""

    episodes: int = 0
    computed_ticks: int = 0
    replayed_ticks: int = 0
    cpu_s: float = 0.0
    sittings: int = 0
    """How often it was begun or gone on with."""
    processor: str = ""
    """That of the last sitting. Another kind may round otherwise."""


def plan(runs: Path, spec: RunSpec) -> Path:
    """Make the folder of a run, unless it is there; return it."""
    folder = runs / spec.address
    if not (folder / RUN_FILE).exists():
        folder.mkdir(parents=True, exist_ok=True)
        _write(folder / RUN_FILE, spec)
    return folder


def is_done(folder: Path) -> bool:
    """Return whether the run of a folder has ended."""
    return (folder / END_FILE).exists()


def is_taken(folder: Path) -> bool:
    """Return whether a process is in the folder, on whichever machine."""
    try:
        with (folder / LOCK_FILE).open() as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except FileNotFoundError:
        return False
    except BlockingIOError:
        return True
    return False  # left behind by a process that was killed


def read_end(folder: Path) -> End:
    """Return how a run ended."""
    return _read(folder / END_FILE, End)


def check_end(folder: Path) -> None:
    """See that what a run that is done wrote at its end is whole.

    Raises:
        RunError: it is not.
    """
    end, path = read_end(folder), folder / EPISODES_FILE
    try:
        rows = pq.read_metadata(path).num_rows
    except (OSError, ValueError) as error:
        words = " ".join(str(error).split())
        raise RunError(f"{path}: cannot be read: {words}; {_WHAT_TO_DO}") from None
    if rows != end.episodes:
        raise RunError(f"{path}: {rows} of {end.episodes} episodes; {_WHAT_TO_DO}")


def read_cost(folder: Path) -> Cost:
    """Return what a run has taken so far; nothing, if it was never begun."""
    path = folder / COST_FILE
    return _read(path, Cost) if path.exists() else Cost()


def read_spec(folder: Path) -> RunSpec:
    """Return what the run of a folder is."""
    return _read(folder / RUN_FILE, RunSpec)


def carry_out(
    folder: Path,
    stop: Callable[[], bool],
    checkpoint_every_s: float = CHECKPOINT_EVERY_S,
) -> bool:
    """Go on with a run until it is done, or has to stop; return whether it is done.

    Args:
        folder: of the run; `plan` made it.
        stop: asked after every episode.
        checkpoint_every_s: real time between checkpoints.

    Raises:
        TakenError: another process is in the folder.
        RunError: the code here is not the run's, or a file is not what a run wrote.
        CheckpointError: the checkpoint is not.
    """
    if is_done(folder):
        return True
    if stop():
        return False
    spec = read_spec(folder)
    _check_code(folder, spec)
    with _to_itself(folder), threadpool_limits(1):
        if is_done(folder):  # by whoever was in the folder just now
            return True
        sittings = read_cost(folder).sittings + 1
        with closing(_contestant(folder, spec)) as contestant:
            _keep_cost(folder, contestant, sittings)
            saved = time.monotonic()
            while not _is_over(contestant, spec):
                if stop():
                    _keep(folder, contestant, sittings)
                    return False
                contestant.episode()
                if time.monotonic() - saved >= checkpoint_every_s:
                    _keep(folder, contestant, sittings)
                    saved = time.monotonic()
            _keep(folder, contestant, sittings)
            _finish(folder, contestant)
    return True


@contextmanager
def _to_itself(folder: Path) -> Iterator[None]:
    """Keep others out; remove what a killed process was just writing."""
    with ExitStack() as stack:
        try:
            stack.enter_context(exclusive_folder(folder))
        except CommandError as error:
            raise TakenError(str(error)) from None
        for half_written in folder.glob(".*.*"):
            half_written.unlink()
        yield


def _contestant(folder: Path, spec: RunSpec) -> Contestant:
    who = entry(spec.contestant)
    settings, options = spec.run_settings(), from_mapping(who.options, spec.options)
    memory = folder / MEMORY_FILE
    if memory.exists():
        try:
            return who.resume(memory, settings, options, spec.seed)
        except BipedError as error:
            raise RunError(f"{error}; {_WHAT_TO_DO}") from None
    return who.begin(settings, options, spec.seed)


def _is_over(contestant: Contestant, spec: RunSpec) -> bool:
    return (
        contestant.milestone(spec.goal) is not None
        or contestant.episodes >= spec.most_episodes
    )


def _check_code(folder: Path, spec: RunSpec) -> None:
    here = run_code(spec.contestant, spec.run_settings())
    if here != (spec.code, spec.packages):
        raise RunError(
            f"{folder}: was planned with code {spec.code} and packages "
            f"{spec.packages}; here are {here.code} and {here.packages}"
        )


def _keep(folder: Path, contestant: Contestant, sittings: int) -> None:
    contestant.save(folder / MEMORY_FILE)
    _keep_cost(folder, contestant, sittings)


def _keep_cost(folder: Path, contestant: Contestant, sittings: int) -> None:
    cost = Cost(
        contestant.episodes,
        contestant.ticks.computed,
        contestant.ticks.replayed,
        round(contestant.cpu_s, 3),
        sittings,
        _processor(),
    )
    _write(folder / COST_FILE, cost)


@cache
def _processor() -> str:
    """Return what the kernel calls the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2] for line in lines if line.startswith("model name"))
    return next(names, platform.machine()).strip()


def _finish(folder: Path, contestant: Contestant) -> None:
    """Write table and end; the end last, since it says that the run is done."""
    table = pa.table(
        {"episode": list(range(1, contestant.episodes + 1)), **contestant.table()}
    )
    with atomic_file(folder / EPISODES_FILE) as stream:
        # Archives of many runs compress better what is not compressed one by one.
        pq.write_table(table, stream, compression="none", store_schema=False)
    milestones = {name: contestant.milestone(name) for name in MILESTONES}
    _write(
        folder / END_FILE,
        End(contestant.episodes, **milestones, figures=contestant.figures()),
    )


def _write(path: Path, content: msgspec.Struct) -> None:
    with atomic_file(path) as stream:
        stream.write(msgspec.json.format(msgspec.json.encode(content), indent=1))


def _read(path: Path, kind: type[_Content]) -> _Content:
    try:
        return msgspec.json.decode(path.read_bytes(), type=kind)
    except OSError as error:
        raise RunError(f"{path}: cannot be read: {error}") from None
    except (msgspec.DecodeError, RecursionError) as error:
        raise RunError(
            f"{path}: is not what a run wrote: {error}; {_WHAT_TO_DO}"
        ) from None
