"""`biped`: its verbs are entry points of the group `biped.verbs`.

Exit status: 0 done; 1 an honest "not achieved" (walk not learned, walk failed);
2 wrong input; 130 interrupted.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

import argcomplete
from argcomplete.finders import safe_actions

from biped_common.command_line import (
    INTERRUPTED,
    WRONG_INPUT,
    CommandError,
    CommandParser,
    StoreOnce,
)
from biped_common.errors import BipedError
from biped_common.signals import loading
from biped_common.terminal_text import printable
from biped_common.verbs import add_verbs


def parser(words: Sequence[str] = ()) -> argparse.ArgumentParser:
    """Return the parser for a command line; without words that of all verbs."""
    top = CommandParser(
        prog="biped",
        description="A simulated biped learns the waist trajectory of dynamic walking "
        "by exploitation-oriented learning with fixed-mode states.",
        epilog="exit status: 0 done, 1 not achieved, 2 wrong input, 130 interrupted",
    )
    verbs = top.add_subparsers(dest="verb", required=True, metavar="VERB")
    add_verbs(verbs, "biped.verbs", words)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit status."""
    words = sys.argv[1:] if arguments is None else arguments
    try:
        with loading():
            commands = parser(words)
    except CommandError as error:
        print(f"biped: {error}", file=sys.stderr)
        return WRONG_INPUT
    safe_actions.add(StoreOnce)
    argcomplete.autocomplete(commands)
    options = commands.parse_args(arguments)
    try:
        status: int = options.run(options)
        sys.stdout.flush()
    except BipedError as error:
        print(f"biped {options.verb}: {printable(str(error))}", file=sys.stderr)
        return WRONG_INPUT
    except BrokenPipeError:
        # Whoever read the output has seen enough; Python must not flush it again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return INTERRUPTED
    except OSError as error:
        # A disk that is full, a folder that has gone: what was saved before stays.
        print(f"biped {options.verb}: cannot go on: {error}", file=sys.stderr)
        return WRONG_INPUT
    except KeyboardInterrupt:
        return INTERRUPTED
    return status


if __name__ == "__main__":
    sys.exit(main())
