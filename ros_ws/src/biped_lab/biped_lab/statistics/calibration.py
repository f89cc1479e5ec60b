"""How often the intervals hold the truth and the tests err, by simulated studies.

    python -m biped_lab.statistics.calibration --studies 1000

prints the tables of docs/statistics.md. So it does for two tests
that the laboratory does not use, since they take large samples for granted.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd
from lifelines.statistics import logrank_test
from scipy.stats import mannwhitneyu, norm

from biped_common.command_line import DONE, CommandParser, positive
from biped_lab.statistics.censored import (
    Bools,
    CensoredTimes,
    Estimate,
    Floats,
    completed,
    median,
)
from biped_lab.statistics.improvement import probability_of_improvement
from biped_lab.statistics.permutation import (
    logrank_scores,
    permutation_p,
    relabellings,
    restricted_times,
    swaps,
    wilcoxon_scores,
)
from biped_lab.statistics.power import BOUND, LEVEL, Scenario
from biped_lab.statistics.resampling import ratio_of_medians, resampled
from biped_lab.statistics.running_time import expected_running_time

_SAMPLES = 1_000
_MANY = 200_000

COVERED = [
    *((seeds, Scenario(2.0, 0.4, 0.1)) for seeds in (5, 8, 15, 30)),
    *((seeds, Scenario(1.0, 0.3, 0.1)) for seeds in (15, 30)),
    (15, Scenario(2.0, 0.3, 0.0)),
]
ALIKE = [
    (seeds, Scenario(1.0, 0.3, stuck))
    for seeds, stuck in ((5, 0.1), (8, 0.1), (15, 0.0), (15, 0.1), (30, 0.1))
]
DIFFERENT = [
    (8, Scenario(2.0, 0.4, 0.1)),
    (15, Scenario(1.3, 0.16, 0.0)),
    (15, Scenario(1.3, 0.16, 0.1)),
    (15, Scenario(1.5, 0.3, 0.0)),
    (15, Scenario(1.5, 0.3, 0.1)),
    (30, Scenario(1.3, 0.3, 0.1)),
]


def main() -> int:
    """Print the tables; each line is drawn by itself, and the same every time."""
    parser = CommandParser(
        prog="python -m biped_lab.statistics.calibration",
        description=__doc__.splitlines()[0],
    )
    parser.add_argument(
        "--studies", type=positive, default=1_000, metavar="N", help="per line"
    )
    options: argparse.Namespace = parser.parse_args()
    for title, cases, shares in (
        ("Share of studies whose 95 % interval holds the truth", COVERED, coverage),
        ("No difference: share of studies in which p <= 5 %", ALIKE, rejections),
        ("The same, tests that are not used", ALIKE, careless_rejections),
        ("Difference: share of studies in which p <= 5 %", DIFFERENT, rejections),
    ):
        print(f"\n{title}\n")
        for row, (seeds, scenario) in enumerate(cases):
            found = shares(scenario, seeds, options.studies, np.random.default_rng(0))
            if row == 0:
                head = ["seeds", "ratio", "scatter", "stuck", *found]
                print("| " + " | ".join(head) + " |\n" + "|---" * len(head) + "|")
            case = (seeds, scenario.ratio, scenario.scatter, scenario.stuck)
            cells = [f"{x:g}" for x in case] + [f"{x:.3f}" for x in found.values()]
            print("| " + " | ".join(cells) + " |", flush=True)
    return DONE


def coverage(
    scenario: Scenario, seeds: int, studies: int, rng: np.random.Generator
) -> Mapping[str, float]:
    """Return how often each figure's interval holds what is true of the scenario."""
    truth = true_figures(scenario, np.random.default_rng(1))
    times = zip(*scenario.studies(studies, seeds, rng), strict=True)
    held = [
        {
            name: estimate.low <= truth[name] <= estimate.high
            for name, estimate in _figures(*study, rng)
        }
        for study in times
    ]
    return pd.DataFrame(held).mean().to_dict()  # type: ignore[no-any-return]


def true_figures(scenario: Scenario, rng: np.random.Generator) -> dict[str, float]:
    """Return the figures of the slower arm, and of it against the faster one."""
    (time,), (reached,) = scenario.studies(1, _MANY, rng)
    half = norm.ppf(0.5 / (1 - scenario.stuck))
    return {
        "completed": float(reached[0].mean()),
        "median": scenario.ratio * float(np.exp(scenario.scatter * half)),
        "ratio": scenario.ratio,
        "improvement": float(1 - mannwhitneyu(*time).statistic / _MANY**2),
        "ERT": float(time[0].sum() / reached[0].sum()),
    }


def rejections(
    scenario: Scenario, seeds: int, studies: int, rng: np.random.Generator
) -> Mapping[str, float]:
    """Return how often each test finds a difference at the level of 5 %."""
    time, reached = scenario.studies(studies, seeds, rng)
    pooled = [
        *zip(time.reshape(studies, -1), reached.reshape(studies, -1), strict=True)
    ]
    labels = relabellings(seeds, 2 * seeds, rng)
    wilcoxon, logrank, restricted = (
        np.array([scores(*runs) for runs in pooled])
        for scores in (wilcoxon_scores, logrank_scores, restricted_times)
    )
    p = {
        "Wilcoxon": permutation_p(wilcoxon, labels),
        "in pairs": permutation_p(
            wilcoxon[:, :seeds] - wilcoxon[:, seeds:], swaps(seeds, rng)
        ),
        "log-rank": permutation_p(logrank, labels),
        "RMST": permutation_p(restricted, labels),
    }
    return {name: float((each <= LEVEL).mean()) for name, each in p.items()}


def careless_rejections(
    scenario: Scenario, seeds: int, studies: int, rng: np.random.Generator
) -> Mapping[str, float]:
    """Return the same of tests that take large samples for granted."""
    time, reached = scenario.studies(studies, seeds, rng)
    chi_squared = np.array(
        [
            logrank_test(*each_time, *each_reached).p_value
            for each_time, each_reached in zip(time, reached, strict=True)
        ]
    )
    # Restricted means, by their standard errors.
    difference = time.mean(axis=2) @ [1.0, -1.0]
    error = np.sqrt((time.var(axis=2) / seeds).sum(axis=1))
    z = 2 * norm.sf(np.abs(difference) / error)
    return {
        "log-rank, chi-squared": float((chi_squared <= LEVEL).mean()),
        "RMST, z": float((z <= LEVEL).mean()),
    }


def _figures(
    time: Floats, reached: Bools, rng: np.random.Generator
) -> Iterator[tuple[str, Estimate]]:
    slow, fast = (CensoredTimes(*arm) for arm in zip(time, reached, strict=True))
    draws = resampled(len(slow), rng, _SAMPLES)
    yield "completed", completed(slow)
    yield "median", median(slow)
    yield "ratio", ratio_of_medians(slow, fast, (draws, draws))
    yield "improvement", probability_of_improvement(slow, fast)
    yield "ERT", expected_running_time(slow, BOUND, rng, _SAMPLES)


if __name__ == "__main__":
    sys.exit(main())
