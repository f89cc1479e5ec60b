"""Measure and print; exit status 1 where a bound was missed.

`python -m benchmarks` measures everything, `python -m benchmarks NAME ...` parts.
"""

from __future__ import annotations

import argparse
import importlib
import subprocess
import sys

# In this order: what needs the quietest machine comes first.
PARTS = (
    "environment_tick",
    "engine_step",
    "learner_tick",
    "replay",
    "realtime",
    "lockstep",
    "recorder",
    "player",
    "ros2_verbs",
    "view_cost",
    "lab_throughput",
)


def main() -> int:
    """Run the benchmarks that were asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="NAME", help=", ".join(PARTS))
    parts = parser.parse_args().parts or list(PARTS)
    unknown = [part for part in parts if part not in PARTS]
    if unknown:
        parser.error(f"{unknown[0]}: must be one of {', '.join(PARTS)}")
    if len(parts) > 1:
        # One process each: the middleware reads its profile once in a process's life.
        command = [sys.executable, "-m", "benchmarks"]
        ends = [subprocess.run([*command, part]).returncode for part in parts]
        return int(any(ends))  # by a signal, it is negative
    kept = True
    for figure in importlib.import_module(f"benchmarks.{parts[0]}").measure():
        print(figure.line(), flush=True)
        kept = kept and figure.kept
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
