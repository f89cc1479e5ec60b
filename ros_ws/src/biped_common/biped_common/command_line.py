"""What the project's commands have in common: exit statuses, parsers, options, JSON."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn

from biped_common.errors import BipedError

DONE = 0
NOT_ACHIEVED = 1
WRONG_INPUT = 2
NODE_FAILURE = 3
INTERRUPTED = 130

_LAST_PORT = 65_535


class CommandError(BipedError, ValueError):
    """Options that do not go together, or a folder that cannot be used."""


class CommandParser(argparse.ArgumentParser):
    """Refuses in one line; an option that takes a value can be given once.

    Parsers of verbs, which `add_subparsers` makes of it, are of the same kind.
    """

    def __init__(self, **arguments: Any) -> None:
        """Take the arguments of `argparse.ArgumentParser`."""
        super().__init__(**arguments)
        self.given: set[str] = set()
        """Where the options of the command line under way are kept."""
        for name in (None, "store"):
            self.register("action", name, StoreOnce)

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> tuple[Any, list[str]]:
        """Parse, as does `argparse.ArgumentParser`."""
        self.given.clear()
        return super().parse_known_args(args, namespace)

    def error(self, message: str) -> NoReturn:
        """Say in one line what is wrong; exit with status 2."""
        self.exit(WRONG_INPUT, f"{self.prog}: {message} (see {self.prog} --help)\n")


class StoreOnce(argparse.Action):
    """Stores a value; of an option given twice, no value would be the right one."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: object,
        option_string: str | None = None,
    ) -> None:
        """Store the value that the command line has."""
        assert isinstance(parser, CommandParser)
        if option_string is not None:
            if self.dest in parser.given:
                raise argparse.ArgumentError(self, "given twice")
            parser.given.add(self.dest)
        setattr(namespace, self.dest, values)


def add_json_option(parser: argparse.ArgumentParser) -> None:
    """Add --json."""
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object, for scripts"
    )


def print_json(values: dict[str, Any]) -> None:
    """Print one JSON object."""
    print(json.dumps(values, indent=2))


def natural(text: str) -> int:
    """Parse a whole number that is at least 0."""
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"{text}: must be at least 0")
    return value


def tcp_port(text: str) -> int:
    """Parse the number of a TCP port; 0 is any that is free."""
    value = natural(text)
    if value > _LAST_PORT:
        raise argparse.ArgumentTypeError(f"{text}: must be at most {_LAST_PORT}")
    return value


def positive(text: str) -> int:
    """Parse a whole number that is at least 1."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text}: must be at least 1")
    return value


def duration_s(text: str) -> float:
    """Parse a finite number of seconds that is at least 0."""
    value = float(text)
    if not math.isfinite(value) or value < 0:
        raise argparse.ArgumentTypeError(f"{text}: must be at least 0 s")
    return value


def writable_folder(folder: Path) -> Path:
    """Return the folder, made if need be; where that fails, nothing is left of it.

    Raises:
        CommandError: it cannot be made or written to.
    """
    probe = folder / ".writable"
    missing: list[Path] = []
    try:
        missing += (each for each in (folder, *folder.parents) if not each.exists())
        folder.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except OSError as error:
        for made in missing:
            with suppress(OSError):
                made.rmdir()
        raise CommandError(
            f"{folder}: must be a folder that can be written to ({error.strerror})"
        ) from None
    return folder
