"""`ros2 COMMAND VERB`: find the verb, run it, turn failures into a line and a status.

Exit status: 0 done; 1 the verb failed, with one line on stderr; 2 wrong usage; 130
interrupted; 143 terminated. When the reader of a pipe goes away, the verb ends at once
and in silence with 1. Only the chosen verb is imported, since most of the time of a
short verb is its start.
"""

from __future__ import annotations

import argparse
import importlib
import io
import os
import pkgutil
import signal
import sys
from collections.abc import Sequence
from types import ModuleType
from typing import Any

from biped_common.command_line import INTERRUPTED
from biped_common.signals import loading
from ros2_verbs import real_ros2
from ros2_verbs.environment import prepare_environment

FAILED = 1
TERMINATED = 143

COMMANDS = {
    "bag": "Various rosbag related commands",
    "doctor": "Check ROS setup and other potential issues",
    "interface": "Show information about ROS interfaces",
    "node": "Various node related sub-commands",
    "param": "Various param related sub-commands",
    "run": "Run a package specific executable",
    "service": "Various service related sub-commands",
    "topic": "Various topic related sub-commands",
}
"""Name and help of each command; see the package's docstring."""

_PACKAGE = "ros2_verbs"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    if arguments is None:
        real_ros2.hand_over()
        arguments = sys.argv[1:]
    prepare_environment()
    completing = "_ARGCOMPLETE" in os.environ
    words = _words_to_complete() if completing else arguments
    with loading():
        parser = make_parser(words)
    if completing:
        import argcomplete

        argcomplete.autocomplete(parser, exclude=["-h", "--help"])
    args = parser.parse_args(arguments)
    if args.run is None:
        args.parser.print_help()
        return 0
    return run(args)


def run(args: argparse.Namespace) -> int:
    """Run the chosen verb; return the exit status."""
    signal.signal(signal.SIGTERM, _terminate)
    if isinstance(sys.stdout, io.TextIOWrapper):
        # Whoever reads a pipe sees each message when it comes.
        sys.stdout.reconfigure(line_buffering=True)
    try:
        status: int = args.run(args)
        sys.stdout.flush()
    except BrokenPipeError:
        # Whoever read the output has seen enough; Python must not flush it again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except KeyboardInterrupt:
        return INTERRUPTED
    except (RuntimeError, OSError) as error:
        # VerbError is one of them, and so are the errors of rclpy.
        print(" ".join(str(error).split()), file=sys.stderr)
        return FAILED
    return status


def make_parser(words: Sequence[str]) -> argparse.ArgumentParser:
    """Return a parser that knows all names, but only the chosen verb's options.

    Args:
        words: the command line behind `ros2`, perhaps unfinished.
    """
    names = [word for word in words if not word.startswith("-")][:2]
    chosen = names[0] if names and names[0] in COMMANDS else None
    top = argparse.ArgumentParser(
        prog="ros2", description="ros2 is an extensible command-line tool for ROS 2."
    )
    top.set_defaults(run=None, parser=top)
    commands = top.add_subparsers(
        title="Commands",
        metavar="Call `ros2 <command> -h` for more detailed usage.",
    )
    for name, description in COMMANDS.items():
        command = commands.add_parser(name, help=description, description=description)
        command.set_defaults(parser=command)
        if name == chosen:
            _add_command(command, name, names[1:])
    return top


def verbs_of(command: str) -> list[str] | None:
    """Return the verbs of a command, None if it is itself one."""
    path = getattr(importlib.import_module(f"{_PACKAGE}.{command}"), "__path__", None)
    if path is None:
        return None
    return sorted(module.name for module in pkgutil.iter_modules(path))


def _add_command(
    command: argparse.ArgumentParser, name: str, rest: Sequence[str]
) -> None:
    verbs = verbs_of(name)
    if verbs is None:
        _add_verb(command, importlib.import_module(f"{_PACKAGE}.{name}"))
        return
    parsers = command.add_subparsers(
        title="Verbs",
        metavar=f"Call `ros2 {name} <verb> -h` for more detailed usage.",
    )
    chosen = rest[0] if rest and rest[0] in verbs else None
    for verb in verbs:
        # With a verb chosen the help of the others is not shown.
        if chosen not in (verb, None):
            parsers.add_parser(verb)
            continue
        module = importlib.import_module(f"{_PACKAGE}.{name}.{verb}")
        description = (module.__doc__ or "").partition("\n")[0].rstrip(".")
        parser = parsers.add_parser(verb, help=description, description=description)
        parser.set_defaults(parser=parser)
        if verb == chosen:
            _add_verb(parser, module)


def _add_verb(parser: argparse.ArgumentParser, module: ModuleType) -> None:
    module.add_arguments(parser)
    parser.set_defaults(run=module.main)


def _words_to_complete() -> list[str]:
    from argcomplete.lexers import split_line

    line = os.environ["COMP_LINE"]
    _, _, _, words, _ = split_line(line, int(os.environ["COMP_POINT"]))
    return list(words[1:])


def _terminate(number: int, _: Any) -> None:
    # As an exception, so that the node leaves the graph in order.
    sys.exit(TERMINATED)


if __name__ == "__main__":
    sys.exit(main())
