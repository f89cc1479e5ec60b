"""The options that choose messages, services or actions."""

from __future__ import annotations

import argparse

from ros2_verbs.messages.types import KINDS


def add_kind_arguments(parser: argparse.ArgumentParser) -> None:
    """Add --only-msgs, --only-srvs and --only-actions."""
    for kind, noun in KINDS.items():
        parser.add_argument(
            f"-{kind[0]}",
            f"--only-{kind}s",
            dest="kinds",
            action="append_const",
            const=kind,
            help=f"print out only the {noun} types",
        )


def chosen_kinds(args: argparse.Namespace) -> list[str]:
    """Return the kinds asked for, all of them if none was."""
    return [kind for kind in KINDS if not args.kinds or kind in args.kinds]
