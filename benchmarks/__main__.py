"""Measure everything and print it; exit status 1 where a bound was missed."""

from __future__ import annotations

import sys

from benchmarks import environment_tick, learner_tick


def main() -> int:
    """Run all benchmarks."""
    figures = [
        figure for part in (environment_tick, learner_tick) for figure in part.measure()
    ]
    for figure in figures:
        print(figure.line())
    return 0 if all(figure.kept for figure in figures) else 1


if __name__ == "__main__":
    sys.exit(main())
