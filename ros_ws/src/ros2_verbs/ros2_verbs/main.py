"""`ros2 COMMAND VERB`: find the verb, run it, turn failures into a line and a status.

Exit status: 0 done; 1 the verb failed, with one line on stderr; 2 wrong usage; 130
interrupted; 143 terminated. When the reader of a pipe goes away, the verb ends at once
and in silence with 1. Only the chosen verb is imported, since most of the time of a
short verb is its start.
"""

from __future__ import annotations

import argparse
import io
import os
import signal
import sys
from collections.abc import Sequence
from importlib.metadata import EntryPoint
from typing import Any

from biped_common.command_line import INTERRUPTED
from biped_common.entry_points import entry_points
from biped_common.errors import BipedError
from biped_common.signals import loading
from biped_common.terminal_text import printable_output
from biped_common.verbs import docstring_of, use_verbs
from ros2_verbs import real_ros2
from ros2_verbs.environment import prepare_environment

FAILED = 1
TERMINATED = 143

COMMANDS = "ros2.commands"
"""Group of entry points; the docstring of `ros2_verbs` says what they are."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    if arguments is None:
        real_ros2.hand_over()
        arguments = sys.argv[1:]
    prepare_environment()
    completing = "_ARGCOMPLETE" in os.environ
    words = _words_to_complete() if completing else arguments
    try:
        with loading():
            parser = make_parser(words)
    except BipedError as error:
        return _failed(error)
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
    with printable_output():
        return _status_of(args)


def _status_of(args: argparse.Namespace) -> int:
    try:
        status: int = args.run(args)
        sys.stdout.flush()
    except BrokenPipeError:
        # Whoever read the output has seen enough; Python must not flush it again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except KeyboardInterrupt:
        return INTERRUPTED
    except (BipedError, RuntimeError, OSError) as error:
        # Errors of rclpy's C library are RuntimeErrors.
        return _failed(error)
    return status


def make_parser(words: Sequence[str]) -> argparse.ArgumentParser:
    """Return a parser for a command line, without the options of other verbs.

    Args:
        words: behind `ros2`, perhaps unfinished.

    Raises:
        CommandError: the chosen command or verb cannot be loaded.
    """
    names = [word for word in words if not word.startswith("-")]
    top = argparse.ArgumentParser(
        prog="ros2", description="ros2 is an extensible command-line tool for ROS 2."
    )
    top.set_defaults(run=None, parser=top)
    commands = top.add_subparsers(
        title="Commands",
        metavar="Call `ros2 <command> -h` for more detailed usage.",
    )
    _add_verbs(commands, COMMANDS, names)
    return top


def _add_verbs(parsers: Any, group: str, names: Sequence[str]) -> None:
    def add(point: EntryPoint, called: bool) -> None:
        # What was not called for is not run, not even for its help.
        module: Any = point.load() if called else None
        text = module.__doc__ or "" if called else docstring_of(point)
        text = text.partition("\n")[0].rstrip(".")
        parser = parsers.add_parser(point.name, help=text, description=text)
        # Not the run of a command above it, should it be found to be meant after all.
        parser.set_defaults(parser=parser, run=None)
        if not called:
            return
        below = f"ros2.{point.name}_verbs"
        has_verbs = group == COMMANDS and bool(entry_points(below))
        if hasattr(module, "main") or not has_verbs:
            module.add_arguments(parser)
            parser.set_defaults(run=module.main)
        if has_verbs:
            verbs = parser.add_subparsers(
                title="Verbs",
                metavar=f"Call `ros2 {point.name} <verb> -h` for more detailed usage.",
            )
            _add_verbs(verbs, below, names[1:])

    use_verbs(group, names, add)


def _failed(error: Exception) -> int:
    print(" ".join(str(error).split()), file=sys.stderr)
    return FAILED


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
