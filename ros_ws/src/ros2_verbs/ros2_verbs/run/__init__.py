"""Run a package specific executable.

Ctrl-C in a terminal reaches the executable by itself, and SIGTERM is passed on; either
way its end is waited for. Its exit status is this command's, 128 + N if signal N ended
it.
"""

from __future__ import annotations

import argparse
import shlex
import signal
import subprocess
from collections.abc import Sequence
from typing import Any

from ros2_verbs.errors import VerbError
from ros2_verbs.options import completed
from ros2_verbs.run.executables import command_of, executables, packages

_BY_SIGNAL = 128


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "--prefix",
        help="command that goes before the executable, in quotes if it contains "
        "spaces (e.g. --prefix 'gdb -ex run --args')",
    )
    completed(
        parser.add_argument("package_name", help="name of the ROS package"),
        _complete_packages,
    )
    completed(
        parser.add_argument("executable_name", help="name of the executable"),
        _complete_executables,
    )
    parser.add_argument(
        "argv", nargs=argparse.REMAINDER, help="arguments of the executable"
    )


def main(args: argparse.Namespace) -> int:
    """Run it to its end.

    Raises:
        VerbError: there is no such package or executable.
    """
    command = [
        *shlex.split(args.prefix or ""),
        *command_of(args.package_name, args.executable_name),
        *args.argv,
    ]
    status = _run(command)
    if status < 0:
        print("[ros2run]:", signal.strsignal(-status))
        return _BY_SIGNAL - status
    if status > 0:
        print(f"[ros2run]: Process exited with failure {status}")
    return status


def _run(command: Sequence[str]) -> int:
    process: subprocess.Popen[bytes] | None = None
    early: list[int] = []

    def leave_it(number: int, _: Any) -> None:
        """Not SIG_IGN, which would be inherited: the terminal sends it to both."""

    def pass_on(number: int, _: Any) -> None:
        if process is None:
            early.append(number)
        else:
            process.send_signal(number)

    signal.signal(signal.SIGINT, leave_it)
    signal.signal(signal.SIGTERM, pass_on)
    process = subprocess.Popen(command)
    for number in early:
        process.send_signal(number)
    return process.wait()


def _complete_packages(**_: Any) -> list[str]:
    return packages()


def _complete_executables(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    try:
        return list(executables(parsed_args.package_name))
    except VerbError:
        return []
