"""What `biped up` says at its end: what came out, and what to try next."""

from __future__ import annotations

import argparse
from pathlib import Path

from biped_bringup.cli.figures import figures_text
from biped_bringup.supervisor.supervisor import Supervisor
from biped_common.command_line import DONE, INTERRUPTED, NOT_ACHIEVED
from biped_common.timing import seconds


def report(
    supervisor: Supervisor,
    options: argparse.Namespace,
    memory_file: Path,
    bag: Path | None,
    interrupted: bool,
) -> int:
    """Print the summary; return the exit status.

    Args:
        supervisor: of the run.
        options: of the command.
        memory_file: of the learner.
        bag: that was recorded, if any.
        interrupted: by a signal.
    """
    lines, achieved = (_walked if options.greedy else _learned)(supervisor)
    if lines and not options.greedy:
        lines.append(f"memory  {memory_file}")
    lines += [f"stranger  {text}" for text in supervisor.graph.strangers.values()]
    print("\n".join(lines))
    if interrupted:
        print(f"interrupted; go on with biped up --resume --out {options.out}")
        return INTERRUPTED
    steps = _next_steps(options, bag, achieved)
    for word, (command, what) in zip(
        ("next", *[""] * len(steps)), steps.items(), strict=False
    ):
        print(f"{word:<7} {command}  # {what}")
    return DONE if achieved else NOT_ACHIEVED


def _walked(supervisor: Supervisor) -> tuple[list[str], bool]:
    result, unseen = supervisor.graph.result, supervisor.graph.unseen
    if unseen is not None:
        line = f"the robot's observations do not bear out: {unseen.end_cause}"
        return [f"{line} after {seconds(unseen.control_ticks):g} s"], False
    if result is None:
        return [], False
    line = (
        f"greedy walk: {result.end_cause} after {seconds(result.control_ticks):g} s, "
        f"peak ZMP error {1000 * result.peak_zmp_error_m:.1f} mm"
    )
    return [line], result.completed


def _learned(supervisor: Supervisor) -> tuple[list[str], bool]:
    status = supervisor.graph.status
    if status is None:
        return [], False
    line = (
        f"{'learned' if status.learned else 'not learned yet'}: "
        f"{status.episodes} episodes, {status.simulated_s:.1f} simulated s, "
        f"{figures_text(status.figures)}"
    )
    return [line], status.learned


def _next_steps(
    options: argparse.Namespace, bag: Path | None, achieved: bool
) -> dict[str, str]:
    """Return commands to try, and what for."""
    steps = {}
    if not options.greedy and achieved:
        steps[f"biped up --greedy --pace realtime --out {options.out}"] = (
            "walk it once at 500 Hz"
        )
    elif not options.greedy:
        steps[f"biped up --resume --out {options.out}"] = "go on learning"
    if bag is not None:
        steps[f"biped bag info {bag}"] = "what was recorded"
        steps[f"biped bag verify {bag}"] = "is every correction the learner's own?"
        steps[f"biped bag play {bag}"] = "replay it; look with ros2 topic echo"
    return steps
