"""What `ros2 run` can run: executables of ament packages, nodes installed by pip.

An ament package keeps its executables in lib/<package> of its prefix. Where this
project was installed by pip there is no such folder; its nodes are entry points of the
group `biped.nodes`, named <package>/<executable>, and are run as modules.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from ament_index_python.packages import (
    PackageNotFoundError,
    get_package_prefix,
    get_packages_with_prefixes,
)

from biped_common.entry_points import entry_points
from ros2_verbs.errors import VerbError

_GROUP = "biped.nodes"


def packages() -> list[str]:
    """Return the names of all packages that are installed either way."""
    by_pip = {name.partition("/")[0] for name in entry_points(_GROUP)}
    return sorted(by_pip.union(get_packages_with_prefixes()))


def executables(package: str) -> dict[str, list[list[str]]]:
    """Return the commands that run each executable of a package, by its name.

    More than one when executables of one name lie in several folders.

    Raises:
        VerbError: there is no such package.
    """
    found: dict[str, list[list[str]]] = {}
    modules = _modules(package)
    try:
        folder = Path(str(get_package_prefix(package))) / "lib" / package
    except (PackageNotFoundError, ValueError):
        folder = None
    if folder is not None:
        for path in _executable_files(folder):
            found.setdefault(path.name, []).append([str(path)])
    elif not modules:
        raise VerbError(f"Package '{package}' not found")
    for name, module in modules.items():
        found.setdefault(name, [[sys.executable, "-m", module]])
    return found


def command_of(package: str, executable: str) -> list[str]:
    """Return the command that runs an executable.

    Raises:
        VerbError: there is no such package or executable, or there are several.
    """
    commands = executables(package).get(executable, [])
    if not commands:
        raise VerbError("No executable found")
    if len(commands) > 1:
        paths = " ".join(f"- {command[0]}" for command in commands)
        raise VerbError(f"Multiple executables found: {paths}")
    return commands[0]


def _executable_files(folder: Path) -> list[Path]:
    return sorted(
        path
        for path in folder.rglob("*")
        if path.is_file()
        and os.access(path, os.X_OK)
        and not any(
            part.startswith(".") for part in path.relative_to(folder).parent.parts
        )
    )


def _modules(package: str) -> dict[str, str]:
    return {
        name.removeprefix(f"{package}/"): point.module
        for name, point in entry_points(_GROUP).items()
        if name.startswith(f"{package}/")
    }
