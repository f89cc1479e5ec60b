"""Hand over to a real `ros2`, where one is installed.

The wheels' environment must not reach it: its Python would load our libraries. A
variable marks that it was handed over to, so that a wrapper around this very command
does not lead in a circle.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path

BOOTSTRAPPED = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
HANDED_OVER = "_BIPED_ROS2_HANDED_OVER"

# What every copy of our console script, in whatever environment, says.
_OURS = b"ros2_verbs"
_HEAD_BYTES = 4096


def hand_over() -> None:
    """Replace this process by the real `ros2` of the PATH; return if there is none."""
    if os.environ.get(HANDED_OVER):
        return
    program = find(os.environ.get("PATH", ""))
    if program is not None:
        sys.stdout.flush()
        os.execve(program, [str(program), *sys.argv[1:]], foreign_environment())


def find(path: str) -> Path | None:
    """Return the first `ros2` of a search path that is not one of ours."""
    for folder in path.split(os.pathsep):
        program = Path(folder or ".") / "ros2"
        if os.access(program, os.X_OK) and program.is_file() and not _is_ours(program):
            return program
    return None


def foreign_environment(
    environment: Mapping[str, str] = os.environ, prefix: str = sys.prefix
) -> dict[str, str]:
    """Return the environment without what the wheels' start-up put into it.

    Args:
        environment: of this process.
        prefix: the folder of this Python environment; whatever lies in it goes.
    """
    clean = dict(environment)
    clean.pop(BOOTSTRAPPED, None)
    for name in ("LD_LIBRARY_PATH", "PYTHONPATH", "AMENT_PREFIX_PATH"):
        kept = [
            entry
            for entry in clean.get(name, "").split(os.pathsep)
            if entry and not Path(entry).is_relative_to(prefix)
        ]
        if kept:
            clean[name] = os.pathsep.join(kept)
        else:
            clean.pop(name, None)
    clean[HANDED_OVER] = "1"
    return clean


def _is_ours(program: Path) -> bool:
    with program.open("rb") as file:
        return _OURS in file.read(_HEAD_BYTES)
