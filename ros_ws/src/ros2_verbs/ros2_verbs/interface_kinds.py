"""The options that choose messages, services or actions."""

from __future__ import annotations

import argparse

from ros2_verbs.message_types import KINDS


def add_kind_arguments(parser: argparse.ArgumentParser) -> None:
    """Add --only-msgs, --only-srvs and --only-actions."""
    for letter, name, noun in (
        ("m", "msgs", "message"),
        ("s", "srvs", "service"),
        ("a", "actions", "action"),
    ):
        parser.add_argument(
            f"-{letter}",
            f"--only-{name}",
            action="store_true",
            help=f"print out only the {noun} types",
        )


def chosen_kinds(args: argparse.Namespace) -> list[str]:
    """Return the kinds asked for, all of them if none was."""
    asked = (args.only_msgs, args.only_srvs, args.only_actions)
    chosen = [kind for kind, is_asked in zip(KINDS, asked, strict=True) if is_asked]
    return chosen or list(KINDS)
