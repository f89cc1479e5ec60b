"""What `biped up` says at its end: what came out, what to try next, what was not saved.

What could not be saved comes last, and then the exit status is 1 at best.
"""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from biped_bringup.cli.figures import figures_text
from biped_bringup.cli.learn import LOG_FILE, write_log
from biped_bringup.cli.recording import bag_line, bags_of, not_recorded
from biped_bringup.cli.run_figures import (
    counted,
    given_up_walks,
    missed_deadlines,
    not_saved_because,
)
from biped_bringup.supervisor.graph_watch import GraphWatch
from biped_bringup.supervisor.supervisor import Supervisor
from biped_bringup.training import TrainingRun
from biped_common.command_line import (
    DONE,
    INTERRUPTED,
    NODE_FAILURE,
    NOT_ACHIEVED,
    print_json,
)
from biped_common.terminal_text import printable
from biped_common.timing import seconds
from learner_node.checkpoint import CheckpointError
from msgs_json import topics

# What a run in one process alone measures.
_OF_ONE_PROCESS = frozenset({"replay_off", "computed_ticks", "replayed_ticks", "cpu_s"})


@dataclass(frozen=True)
class EndedRun:
    """A run of `biped up` whose nodes have ended."""

    supervisor: Supervisor
    options: argparse.Namespace
    memory_file: Path
    bag: Path | None
    """That was recorded, if any."""
    settings: Mapping[str, Any]
    """Of the run, as a preset's YAML holds them."""
    interrupted: bool
    """By a signal."""
    failure: str | None
    """Why a node could not be kept running."""

    @property
    def walks_once(self) -> bool:
        """Whether it was one walk, from which nothing is learned."""
        return bool(self.options.greedy or self.options.static)

    @property
    def learns_here(self) -> bool:
        """Whether the learner, and so the memory, is this run's."""
        return topics.LEARNER_NODE in self.supervisor.children


def report(run: EndedRun) -> int:
    """Write the table of episodes, print the summary; return the exit status."""
    summary, status = summarized(run)
    if run.options.json:
        print_json(summary)
    else:
        for line in _lines(run, summary):
            print(printable(line))
    return status


def summarized(run: EndedRun) -> tuple[dict[str, Any], int]:
    """Write the table of episodes; return what came out, and the exit status."""
    summary = _walked(run) if run.walks_once else _learned(run)
    not_saved = summary["not_saved"]
    if run.failure is not None:
        summary["outcome"], status = "node failure", NODE_FAILURE
    elif run.interrupted:
        summary["outcome"] = "interrupted"
        status = NOT_ACHIEVED if not_saved else INTERRUPTED
    else:
        status = DONE if summary["completed"] and not not_saved else NOT_ACHIEVED
    return summary, status


def _walked(run: EndedRun) -> dict[str, Any]:
    graph = run.supervisor.graph
    result, status = graph.result, graph.status
    walk = {} if result is None else {
        "end_cause": result.end_cause.value,
        "end_time_s": seconds(result.control_ticks),
        "peak_zmp_error_m": result.peak_zmp_error_m,
        "trajectory_sha256": result.trajectory_sha256,
    }  # fmt: skip
    unseen = graph.unseen
    completed = result is not None and result.completed and unseen is None
    return {
        "outcome": "walked" if completed else "not walked",
        "completed": completed,
        **walk,
        "not_borne_out": None if unseen is None else unseen.end_cause.value,
        "memory_sha256": None if status is None else status.memory_sha256,
        "memory_file": None if run.options.static else str(run.memory_file),
        **_of_any_run(run),
        "not_saved": _unwritten(run),
    }


def _learned(run: EndedRun) -> dict[str, Any]:
    graph = run.supervisor.graph
    held, not_saved = _held(run) if run.learns_here else (_heard(graph), [])
    walked = 0 if graph.status is None else graph.status.episodes
    lacking = max(0, walked - held["episodes"])
    reason = not_saved_because(graph)
    if run.learns_here and (lacking or reason):
        what = f"{lacking} of {walked} episodes" if lacking else "the last trial"
        not_saved.insert(0, f"{what}: {reason or 'learner_node.log may say why'}")
    return {
        "outcome": "learned" if held["completed"] else "not learned",
        **held,
        "episodes_not_saved": lacking,
        **_of_any_run(run),
        "not_saved": [*not_saved, *_unwritten(run)],
    }


def _held(run: EndedRun) -> tuple[dict[str, Any], list[str]]:
    """Return what the memory file holds, its table written; and what could not be."""
    nothing = {
        "completed": False,
        "episodes": 0,
        "memory_file": str(run.memory_file),
    }
    if not run.memory_file.exists():
        return nothing, []
    try:
        held = TrainingRun.load(run.memory_file)
    except CheckpointError as error:
        return nothing, [str(error)]
    held.close()
    summary = held.summary(run.memory_file)
    summary = {k: v for k, v in summary.items() if k not in _OF_ONE_PROCESS}
    try:
        table = write_log(held.log, run.memory_file.parent)
    except OSError as error:
        return summary, [f"{LOG_FILE}: {error.strerror}"]
    return {**summary, "episode_log": str(table)}, []


def _heard(graph: GraphWatch) -> dict[str, Any]:
    """Return what a learner elsewhere says of itself."""
    status = graph.status
    if status is None:
        return {"completed": False, "episodes": 0}
    return {
        "completed": status.learned,
        "schedule_complete": status.schedule_complete,
        "target_time_s": status.target_time_s,
        "episodes": status.episodes,
        "simulated_s": status.simulated_s,
        "figures": status.figures,
        "seed": status.seed,
        "memory_sha256": status.memory_sha256,
        "trajectory_sha256": status.trajectory_sha256,
    }


def _of_any_run(run: EndedRun) -> dict[str, Any]:
    graph = run.supervisor.graph
    bags = [] if run.bag is None else bags_of(run.bag, run.supervisor)
    return {
        "given_up_walks": given_up_walks(graph),
        "missed_deadlines": missed_deadlines(graph),
        "strangers": list(graph.strangers.values()),
        "bags": [str(bag) for bag in bags],
        "settings": run.settings,
    }


def _unwritten(run: EndedRun) -> list[str]:
    """Return which logs and bags end early, and why."""
    children = run.supervisor.children.values()
    logs = [f"log {child.log_failure}" for child in children if child.log_failure]
    return logs if run.bag is None else [*not_recorded(run.bag, run.supervisor), *logs]


def _lines(run: EndedRun, summary: Mapping[str, Any]) -> Iterator[str]:
    """Return the summary in words."""
    yield from (_walk_lines if run.walks_once else _learning_lines)(run, summary)
    if run.supervisor.graph.result is not None:
        causes = summary["given_up_walks"]
        named = f" ({counted(causes)})" if causes else ""
        yield (
            f"walks   {sum(causes.values())} given up{named}, "
            f"{summary['missed_deadlines']} deadlines missed"
        )
    for stranger in summary["strangers"]:
        yield f"stranger  {stranger}"
    for bag in summary["bags"]:
        yield bag_line(Path(bag))
    if run.failure is not None:
        yield f"failed: {run.failure}; logs are in {run.memory_file.parent}"
    elif run.interrupted and run.options.static:
        yield "interrupted"
    elif run.interrupted and run.memory_file.exists():
        how = "--greedy" if run.options.greedy else "--resume"
        yield f"interrupted; go on with biped up {how} --out {_out(run)}"
    elif run.interrupted:
        yield "interrupted; nothing is saved yet"
    else:
        steps = _next_steps(run, summary["completed"])
        for word, (command, what) in zip(
            ("next", *[""] * len(steps)), steps.items(), strict=False
        ):
            yield f"{word:<7} {command}  # {what}"
    for what in summary["not_saved"]:
        yield f"not saved: {what}"


def _walk_lines(run: EndedRun, summary: Mapping[str, Any]) -> Iterator[str]:
    if summary["not_borne_out"] is not None:
        yield (
            "the robot's observations do not bear out: "
            f"the walk ended as {summary['not_borne_out']}"
        )
    elif "end_cause" in summary:
        kind = "static" if run.options.static else "greedy"
        yield (
            f"{kind} walk: {summary['end_cause']} after {summary['end_time_s']:g} s, "
            f"peak ZMP error {1000 * summary['peak_zmp_error_m']:.1f} mm"
        )


def _learning_lines(_: EndedRun, summary: Mapping[str, Any]) -> Iterator[str]:
    episodes, lacking = summary["episodes"], summary["episodes_not_saved"]
    line = f"{'learned' if summary['completed'] else 'not learned yet'}: "
    line += f"{episodes} episodes"
    if "figures" in summary:
        line += f", {summary['simulated_s']:.1f} simulated s, "
        line += figures_text(summary["figures"])
    yield line
    if "memory_file" in summary:
        walked = f": {episodes} of {episodes + lacking} episodes" if lacking else ""
        yield f"memory  {summary['memory_file']}{walked}"
    if "episode_log" in summary:
        yield f"table   {summary['episode_log']}: {episodes} episodes"


def _next_steps(run: EndedRun, achieved: bool) -> dict[str, str]:
    """Return commands to try, and what for."""
    steps = {}
    if not run.walks_once and achieved:
        steps[f"biped up --greedy --pace realtime --out {_out(run)}"] = (
            "walk it once at 500 Hz"
        )
    elif run.memory_file.exists() and not run.walks_once:
        steps[f"biped up --resume --out {_out(run)}"] = "go on learning"
    if run.bag is not None:
        bag = shlex.quote(str(run.bag))
        steps[f"biped bag info {bag}"] = "what was recorded"
        steps[f"biped bag verify {bag}"] = "is every correction the learner's own?"
        steps[f"biped bag play {bag}"] = "replay it; look with ros2 topic echo"
    return steps


def _out(run: EndedRun) -> str:
    return shlex.quote(str(run.options.out))
