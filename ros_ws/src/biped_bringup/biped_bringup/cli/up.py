"""`biped up`: the nodes on ROS 2, supervised."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from biped_bag.records import run_record
from biped_bringup.cli.learn import MEMORY_FILE
from biped_bringup.cli.options import (
    add_settings_options,
    names_settings,
    preset_of,
    settings_of,
)
from biped_bringup.cli.real_time import add_real_time_options, real_time_parameters
from biped_bringup.cli.recording import (
    add_recording_options,
    bag_folder,
    bag_report,
    recorder_parameters,
)
from biped_bringup.cli.status_screen import StatusScreen
from biped_bringup.cli.up_report import report
from biped_bringup.node_parameters import node_parameters
from biped_bringup.run_settings import RunSettings
from biped_bringup.supervisor.graph_watch import NAME, GraphWatch
from biped_bringup.supervisor.supervisor import (
    RECORDER,
    START_ORDER,
    NodeFailureError,
    Supervisor,
)
from biped_bringup.training import TrainingRun
from biped_common.command_line import (
    NODE_FAILURE,
    CommandError,
    natural,
    writable_folder,
)
from biped_common.settings import to_mapping
from biped_common.signals import stop_requests
from biped_description.robot import Robot
from biped_ros.environment import (
    DISCOVERY_RANGES,
    node_environment,
    private_domain,
)
from trajectory_node.waist_reference import WaistReference

# On a busy machine a peer can be too late in real time, which is not the walk's fault.
_ATTEMPTS = 5
_DEFAULT_OUT = Path("bags/up")
_ALL_NODES = ",".join(name.removesuffix("_node") for name in START_ORDER)


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "up",
        help="learn, or walk, on the ROS 2 graph: three nodes, supervised",
        description="Start a recorder of every topic, trajectory_node, learner_node "
        "and sim_node as processes, watch them, restart them, and end them all, the "
        "recorder last. A recorder that cannot go on (disk full, folder unusable) does "
        "not stop the walk. Ends when the walk is learned, or "
        "after --episodes. Exit status 0 when learned (or walked, with --greedy), 1 "
        "when not, 2 for wrong input, 3 when a node could not be kept running, 130 "
        "when interrupted.",
    )
    parser.add_argument(
        "--pace",
        choices=("lockstep", "realtime"),
        default="lockstep",
        help="as fast as all can (default), or 500 Hz in real time",
    )
    parser.add_argument(
        "--greedy",
        action="store_true",
        help=f"walk once, greedily, from the {MEMORY_FILE} in --out; learn nothing",
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help=f"go on from the {MEMORY_FILE} in --out, with its settings and seed",
    )
    parser.add_argument(
        "--fresh",
        action="store_true",
        help=f"delete a {MEMORY_FILE} that is in --out, and learn anew",
    )
    parser.add_argument("--seed", type=natural, metavar="N", help="default 0")
    parser.add_argument(
        "--episodes", type=natural, metavar="N", help="end after N learning episodes"
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=_DEFAULT_OUT,
        metavar="DIR",
        help=f"folder for {MEMORY_FILE}, bags, parameter files and logs "
        f"(default {_DEFAULT_OUT})",
    )
    parser.add_argument(
        "--nodes",
        default=_ALL_NODES,
        metavar="A,B",
        help="which nodes to start here, of recorder,trajectory,learner,sim (default "
        "all); the others may run on another machine, see --domain and --discovery",
    )
    parser.add_argument(
        "--domain",
        type=natural,
        metavar="ID",
        help="ROS_DOMAIN_ID (default: one of this run's own)",
    )
    parser.add_argument(
        "--discovery",
        choices=DISCOVERY_RANGES,
        default=DISCOVERY_RANGES[0],
        help="who may join: processes on this machine (default), or in the subnet",
    )
    parser.add_argument(
        "--publish-every",
        type=natural,
        default=1,
        metavar="TICKS",
        help="control ticks (2 ms) between messages of the fast topics (default 1)",
    )
    parser.add_argument(
        "--no-view", action="store_true", help="plain lines instead of a live screen"
    )
    add_real_time_options(parser)
    add_recording_options(parser)
    add_settings_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Supervise and report."""
    names = _nodes(options.nodes)
    folder = writable_folder(options.out).resolve()
    memory_file = folder / MEMORY_FILE
    settings, seed = _settings_and_seed(options, memory_file)
    # Refuses here a gait that the robot cannot walk.
    WaistReference(Robot(settings.robot), settings.gait, settings.correction)
    bag = bag_folder(options, names)
    max_episodes = 1 if options.greedy else options.episodes or 0
    parameters = node_parameters(
        settings,
        seed,
        checkpoint_file=str(memory_file),
        max_episodes=max_episodes,
        publish_every_ticks=max(1, options.publish_every),
        pace=options.pace,
        frozen=options.greedy,
        recorders=0 if bag is None else 1,
        **real_time_parameters(options),
    ).flat()
    if bag is None:
        names = [name for name in names if name != RECORDER]
    else:
        begun_with = memory_file if options.greedy or options.resume else None
        run_data = run_record(
            to_mapping(settings),
            seed,
            preset=preset_of(options) if begun_with is None else "",
            pace=options.pace,
            frozen=options.greedy,
            max_episodes=max_episodes,
            memory_file=begun_with,
        )
        parameters[RECORDER] = recorder_parameters(
            bag, run_data, begun_with, options.record_split
        )
    if options.fresh:
        # A learner that finds its memory goes on from it.
        memory_file.unlink(missing_ok=True)
    domain = private_domain() if options.domain is None else options.domain
    environment = node_environment(domain, options.discovery)
    os.environ.update(environment)  # the supervisor's own node, too
    screen = StatusScreen(Console(stderr=True), live=not options.no_view)
    with stop_requests() as stops, screen:
        screen.line(NAME, f"ROS_DOMAIN_ID={domain}, {options.discovery}")
        supervisor = Supervisor(
            {name: parameters[name] for name in names},
            environment,
            folder,
            screen.line,
        )
        failure = None
        graph = supervisor.graph

        def done() -> bool:
            screen.update(supervisor)
            if options.greedy:
                return _walked(graph)
            status = graph.status
            return status is not None and (
                status.learned or status.episodes >= (options.episodes or float("inf"))
            )

        try:
            supervisor.run(done, lambda: bool(stops))
        except NodeFailureError as error:
            failure = error
        finally:
            supervisor.stop()
    if bag is not None:
        print("\n".join(bag_report(bag, supervisor)))
    if failure is not None:
        print(f"failed: {failure}; logs are in {folder}")
        return NODE_FAILURE
    return report(supervisor, options, memory_file, bag, interrupted=bool(stops))


def _walked(graph: GraphWatch) -> bool:
    """Return whether the walk is over; one cut short by the machine is repeated."""
    result = graph.result
    return result is not None and (
        not result.end_cause.from_outside or graph.results >= _ATTEMPTS
    )


def _nodes(text: str) -> list[str]:
    names = [f"{name.strip()}_node" for name in text.split(",")]
    unknown = [name for name in names if name not in START_ORDER]
    if unknown:
        raise CommandError(f"--nodes {text}: must be among {_ALL_NODES}")
    return names


def _settings_and_seed(
    options: argparse.Namespace, memory_file: Path
) -> tuple[RunSettings, int]:
    if options.greedy or options.resume:
        if options.fresh:
            raise CommandError("--fresh: cannot be given with --greedy or --resume")
        if names_settings(options) or options.seed is not None:
            raise CommandError(
                "--greedy, --resume: go on with the settings and the seed of the "
                "memory; --preset, --config, --set and --seed cannot be given with them"
            )
        learned = TrainingRun.load(memory_file)
        learned.close()
        return learned.settings, learned.seed
    if memory_file.exists() and not options.fresh:
        raise CommandError(
            f"{memory_file}: is there already; give --resume to go on with it, "
            "--fresh to replace it, or another --out"
        )
    return settings_of(options), options.seed or 0
