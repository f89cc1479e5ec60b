"""Where walks come from: a bag, a memory, or the folder of a run."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from biped_bag.storage.layout import holds_bag
from biped_bringup.cli.learn import MEMORY_FILE
from biped_lab.run_folder import RUN_FILE, read_spec
from biped_lab.study import BY_SETTINGS
from biped_view.bag_walk import walk_of_bag
from biped_view.walk_record import LoadedWalk
from biped_view.walked_here import NoWalkError, walk_of_memory

_BAG_SUFFIX, _MEMORY_SUFFIX = ".mcap", ".npz"


def is_bag(path: Path) -> bool:
    """Return whether a path is a bag, or has been begun as one."""
    return path.suffix == _BAG_SUFFIX or (path.is_dir() and holds_bag(path))


def memory_of(path: Path) -> Path | None:
    """Return the memory from which `read_walk` has a walk; None if it is recorded."""
    if is_bag(path):
        return None
    return path / MEMORY_FILE if path.is_dir() else path


def read_walk(path: Path, walk: int | None = None) -> LoadedWalk:
    """Return a walk, and what its source tells of it.

    Args:
        path: a bag (folder or MCAP file), a memory (`memory.npz`), or the folder of a
            run, of the laboratory or not, with a memory in it.
        walk: of a bag, 1 for its first; its last by default.

    Raises:
        BipedError: there is no walk there; one line that says why.
    """
    if is_bag(path):
        return walk_of_bag(path, walk)
    if not path.exists():
        raise NoWalkError(f"{path}: no such file or folder")
    if walk is not None:
        raise NoWalkError(f"{path}: not a bag; it has one walk, the greedy one")
    if path.is_dir():
        return _walk_of_run(path)
    if path.suffix != _MEMORY_SUFFIX:
        raise NoWalkError(f"{path}: neither a bag nor a memory (*{_MEMORY_SUFFIX})")
    return walk_of_memory(path)


def _walk_of_run(folder: Path) -> LoadedWalk:
    memory = folder / MEMORY_FILE
    if not memory.is_file():
        raise NoWalkError(f"{folder}: neither a bag nor a run, it has no {MEMORY_FILE}")
    facts = {"run": str(folder)}
    if (folder / RUN_FILE).is_file():
        spec = read_spec(folder)
        if spec.contestant != BY_SETTINGS:
            raise NoWalkError(
                f"{folder}: a run of {spec.contestant}, whose memory is no learner's "
                "that walks by itself"
            )
        packages = ", ".join(f"{name} {at}" for name, at in spec.packages.items())
        facts |= {"code": spec.code, "packages": packages}
    loaded = walk_of_memory(memory)
    return replace(loaded, facts={**facts, **loaded.facts})
