"""Output the status of the daemon."""

from __future__ import annotations

import argparse


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add no options: there are none."""


def main(_: argparse.Namespace) -> int:
    """Print that there is none: every verb looks around by itself."""
    print("The daemon is not running")
    return 0
