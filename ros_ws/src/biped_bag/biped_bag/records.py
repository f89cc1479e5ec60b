"""What a bag tells of its run beside the messages: records, and remarks.

Records are MCAP metadata, texts by name. The first of them is made here, by whoever
starts the run; the recorder makes the others as the run goes on.
"""

from __future__ import annotations

import json
import platform
import shlex
import subprocess
import sys
from collections.abc import Mapping, Sequence
from datetime import datetime, timezone
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from biped_common.plain_yaml import yaml_text

RUN_RECORD = "biped.run"
"""At the head of every file: everything that is needed to do the run again."""
EPISODE_RECORD = "biped.episode"
"""One for each walk that has ended: how, and where in the bag it is."""
COUNTS_RECORD = "biped.counts"
"""At the end: what was received, written and lost, by topic."""
# In metadata.yaml; a bag without them was not ended in order.
STATE_KEY, LOST_KEY = "biped.recording", "biped.lost"
COMPLETE = "complete"
"""Value of STATE_KEY where everything was written."""

FROM_NOTHING = "nothing"
"""What a run begins with that does not go on from a memory."""
_PACKAGES = (
    "biped",
    "mcap",
    "msgspec",
    "mujoco-core",
    "numba",
    "numpy",
    "pybullet",
    "ros-jazzy-rclpy",
    "zstandard",
)
_GIT_TIMEOUT_S = 5.0


def run_record(
    settings: Mapping[str, Any],
    seed: int,
    *,
    preset: str,
    pace: str,
    frozen: bool,
    max_episodes: int,
    memory_file: Path | None,
) -> dict[str, str]:
    """Return the RUN_RECORD of a run that begins now.

    Args:
        settings: of the run, as a preset's YAML holds them.
        seed: of every random draw.
        preset: that the settings were laid over; empty if they are the memory's.
        pace: lockstep or realtime.
        frozen: walks are greedy, nothing is learned.
        max_episodes: after which it ends; 0: when learned.
        memory_file: that the learner goes on from; None: from the seed alone.
    """
    return {
        "start": datetime.now(timezone.utc).isoformat(timespec="milliseconds"),
        "seed": str(seed),
        "preset": preset,
        "settings": yaml_text(dict(settings)),
        "begins_with": FROM_NOTHING if memory_file is None else memory_file.name,
        "frozen": "true" if frozen else "false",
        "pace": pace,
        "max_episodes": str(max_episodes),
        "command": shlex.join([Path(sys.argv[0]).name, *sys.argv[1:]]),
        **_checkout(),
        "python": platform.python_version(),
        "versions": json.dumps({name: _version(name) for name in _PACKAGES}),
    }


def _checkout() -> dict[str, str]:
    """Return commit and dirty flag if this file lies in a checkout."""
    try:
        _git(["ls-files", "--error-unmatch", Path(__file__).name])
        commit = _git(["rev-parse", "HEAD"])
        changed = _git(["status", "--porcelain", "--untracked-files=no"])
    except (OSError, subprocess.SubprocessError):
        return {}
    return {"git_commit": commit, "git_dirty": "true" if changed else "false"}


def _git(arguments: Sequence[str]) -> str:
    done = subprocess.run(
        ["git", *arguments],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        check=True,
        timeout=_GIT_TIMEOUT_S,
    )
    return done.stdout.strip()


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
