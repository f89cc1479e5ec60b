"""`biped walk`: one walk without learning, greedy or uncorrected."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import yaml

from biped_bringup.cli.options import (
    add_settings_options,
    gone_on_with,
    settings_of,
)
from biped_bringup.training import TrainingRun
from biped_bringup.walker import Walker
from biped_bringup.zmp_figure import FIGURE_SUFFIXES, ZmpTrace, draw_zmp
from biped_common.command_line import (
    DONE,
    NOT_ACHIEVED,
    CommandError,
    add_json_option,
    natural,
    print_json,
)
from biped_common.timing import seconds
from learner_node.walking.walks import greedy_walk, static_walk
from msgs_json.episode_result import EpisodeResult


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "walk",
        help="walk once, greedily from a memory or uncorrected",
        description="Walk the whole walk once, without learning, and report how it "
        "ended, the peak ZMP error [m] and the six terms of T_err. Exit status 0 when "
        "the walk was completed, 1 when it failed.",
    )
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument(
        "--memory", type=Path, metavar="FILE", help="what `biped learn` wrote"
    )
    source.add_argument(
        "--static",
        action="store_true",
        help="the static walk, without correction; at the default difficulty it leaves "
        "its ZMP limit, and does not fall",
    )
    parser.add_argument(
        "--tds",
        type=float,
        metavar="S",
        help="double support time [s] (short for --set gait.double_support_s=S)",
    )
    parser.add_argument(
        "--seed",
        type=natural,
        default=0,
        help="of the disturbances, if any (default 0)",
    )
    parser.add_argument(
        "--figure", type=Path, metavar="PNG", help="draw the ZMP of the walk"
    )
    add_settings_options(parser)
    add_json_option(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Walk and report."""
    if options.tds is not None:
        options.changes.append(f"gait.double_support_s={_yaml_number(options.tds)}")
    if options.figure is not None:
        _check_figure(options.figure)
    learned = None
    if options.memory is not None:
        learned = gone_on_with(options, options.memory, learns=False)
        learned.close()
    result, sha256 = _walk(options, learned)
    if options.json:
        print_json(_summary(result, sha256))
    else:
        if learned is not None and learned.setting_changes:
            print(f"other settings       {learned.setting_changes}")
        _print(result, sha256)
        if options.figure is not None:
            print(f"picture of the ZMP   {options.figure}")
    return DONE if result.completed else NOT_ACHIEVED


def _yaml_number(value: float) -> str:
    """Return a number as YAML 1.1 understands it: 1e-05 would be text."""
    return str(yaml.safe_dump(value)).split()[0]


def _check_figure(path: Path) -> None:
    """Refuse a picture that could not be written, before the walk is walked."""
    if path.suffix not in FIGURE_SUFFIXES:
        raise CommandError(f"--figure {path}: must end in {', '.join(FIGURE_SUFFIXES)}")
    if path.is_dir() or not path.parent.is_dir():
        raise CommandError(f"--figure {path}: must be a file in a folder that exists")


def _walk(
    options: argparse.Namespace, learned: TrainingRun | None
) -> tuple[EpisodeResult, str]:
    settings = settings_of(options) if learned is None else learned.settings
    trace = ZmpTrace()
    walker = Walker(settings, np.random.default_rng(options.seed), trace.add)
    try:
        if learned is not None:
            session = learned.session
            responder = greedy_walk(
                settings.learner, walker.walk_ticks, session.learner, session.task
            )
        else:
            responder = static_walk(settings.learner, walker.walk_ticks)
        result = walker.walk(responder)
        if options.figure is not None:
            draw_zmp(
                trace,
                walker.reference.plan,
                settings.robot,
                settings.sim.limits,
                options.figure,
            )
        return result, walker.biped.trajectory_sha256
    finally:
        walker.close()


def _summary(result: EpisodeResult, sha256: str) -> dict[str, Any]:
    return {
        "end_cause": str(result.end_cause),
        "end_time_s": seconds(result.control_ticks),
        "control_ticks": result.control_ticks,
        "completed": result.completed,
        "peak_zmp_error_m": result.peak_zmp_error_m,
        "peak_joint_velocity_rad_s": result.peak_joint_velocity_rad_s,
        "t_err": None if result.cost is None else result.cost.total,
        "t_err_terms": msgspec.to_builtins(result.cost),
        "trajectory_sha256": sha256,
    }


def _print(result: EpisodeResult, sha256: str) -> None:
    print(
        f"end                  {result.end_cause} after "
        f"{seconds(result.control_ticks):.3f} s of {seconds(result.target_ticks):g} s\n"
        f"peak ZMP error       {1000 * result.peak_zmp_error_m:.1f} mm\n"
        f"peak joint velocity  {result.peak_joint_velocity_rad_s:.2f} rad/s"
    )
    if result.cost is not None:
        print(f"T_err                {result.cost.total:.4f}, the sum of")
        for name, value in msgspec.to_builtins(result.cost).items():
            print(f"  {name:<18} {value:.5f}")
    print(f"trajectory SHA-256   {sha256}")
