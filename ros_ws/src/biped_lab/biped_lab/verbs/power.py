"""Print how many seeds per arm a claim about times to success needs.

Found by simulation, with the test that the laboratory's reports use: 80 % power at the
level of 5 %, corrected by Holm for --comparisons. docs/statistics.md says how. What a
study has measured of its scatter and stuck runs stands in its report.

Exit status:
    0  printed
    2  values that are none
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

import numpy as np

from biped_common.command_line import DONE, positive
from biped_lab.statistics.power import (
    BOUND,
    LEVEL,
    POWER,
    SEEDS_AT_MOST,
    Scenario,
    seeds_needed,
)


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "power",
        help="print how many seeds a claim needs",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--ratio",
        type=float,
        nargs="+",
        default=[1.3, 1.5, 2.0],
        metavar="R",
        help="of median times, slower arm to faster one (default: 1.3 1.5 2)",
    )
    parser.add_argument(
        "--scatter",
        type=float,
        nargs="+",
        default=[0.16, 0.3, 0.4],
        metavar="S",
        help="standard deviation of log(episodes) (default: 0.16 0.3 0.4)",
    )
    parser.add_argument(
        "--stuck",
        type=float,
        default=0.1,
        metavar="SHARE",
        help="of runs that never succeed, in both arms (default: 0.1)",
    )
    parser.add_argument(
        "--comparisons",
        type=positive,
        default=1,
        metavar="M",
        help="in the family that Holm corrects for (default: 1)",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Print."""
    print(
        power_table(options.ratio, options.scatter, options.stuck, options.comparisons)
    )
    return DONE


def power_table(
    ratios: Sequence[float], scatters: Sequence[float], stuck: float, comparisons: int
) -> str:
    """Return seeds per arm as a Markdown table: a row per scatter, a column per ratio.

    The same for the same arguments.
    """
    scenarios = [
        [Scenario(ratio, each, stuck) for ratio in ratios] for each in scatters
    ]
    lines = [
        f"Seeds per arm for {POWER:.0%} power at the level of {LEVEL:.0%}, "
        f"{comparisons} comparison{'s' if comparisons > 1 else ''}, {stuck:.0%} stuck, "
        f"bound at {BOUND:g} medians of the faster arm:",
        "",
        "| scatter of log(episodes) | "
        + " | ".join(f"ratio {ratio:g}" for ratio in ratios)
        + " |",
        "|---" * (len(ratios) + 1) + "|",
    ]
    for row in scenarios:
        found = [seeds_needed(s, comparisons, np.random.default_rng(0)) for s in row]
        cells = [f"> {SEEDS_AT_MOST}" if n is None else str(n) for n in found]
        lines.append(f"| {row[0].scatter:g} | " + " | ".join(cells) + " |")
    return "\n".join(lines)
