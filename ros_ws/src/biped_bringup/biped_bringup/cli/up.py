"""`biped up`: the nodes on ROS 2, supervised."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from rich.console import Console

from biped_bag.records import run_record
from biped_bringup.cli.learn import MEMORY_FILE, report_nothing
from biped_bringup.cli.options import (
    add_settings_options,
    gone_on_with,
    preset_of,
    settings_of,
)
from biped_bringup.cli.real_time import add_real_time_options, real_time_parameters
from biped_bringup.cli.recording import (
    add_recording_options,
    bag_folder,
    recorder_parameters,
)
from biped_bringup.cli.status_screen import StatusScreen
from biped_bringup.cli.up_report import EndedRun, report
from biped_bringup.node_parameters import node_parameters
from biped_bringup.run_settings import RunSettings
from biped_bringup.supervisor.graph_watch import FOXGLOVE, NAME, TF_NODE, GraphWatch
from biped_bringup.supervisor.live_page import LivePage
from biped_bringup.supervisor.supervisor import (
    RECORDER,
    START_ORDER,
    NodeFailureError,
    Supervisor,
)
from biped_bringup.training import TrainingRun
from biped_common.command_line import (
    DONE,
    NOT_ACHIEVED,
    CommandError,
    add_json_option,
    natural,
    positive,
    tcp_port,
    writable_folder,
)
from biped_common.exclusive_folder import exclusive_folder
from biped_common.settings import SettingsError, to_mapping
from biped_common.signals import stop_requests
from biped_description.robot import Robot
from biped_ros.environment import (
    DISCOVERY_RANGES,
    LAST_DOMAIN,
    node_environment,
    private_domain,
)
from msgs_json.topics import LEARNER_NODE
from trajectory_node.waist_reference import WaistReference

# On a busy machine a peer can be too late in real time, which is not the walk's fault.
_ATTEMPTS = 5
_DEFAULT_OUT = Path("bags/up")
_FOXGLOVE_PORT = 8765
# By the setting of a node that each gives.
_OPTIONS = {
    "publish_every_ticks": "--publish-every",
    "seed": "--seed",
    "fifo_priority": "--fifo",
    "nice": "--nice",
    "cores": "--cores",
    "look_ahead_ticks": "--look-ahead",
    "realtime_factor": "--factor",
}
_ALL_NODES = ",".join(name.removesuffix("_node") for name in START_ORDER)


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "up",
        help="learn, or walk, on the ROS 2 graph: three nodes, supervised",
        description="Start a live page, a recorder of every topic, trajectory_node, "
        "learner_node and sim_node as processes, watch them, restart them, and end "
        "them all, the recorder last. A page or a recorder that cannot go on (disk "
        "full, folder unusable) does not stop the walk. Ends when the walk is learned, "
        "or after --episodes. Exit status 0 when learned (or walked, with --greedy or "
        "--static), 1 when not, or when something could not be saved, 2 for wrong "
        "input, 3 when a node could not be kept running, 130 when interrupted.",
    )
    parser.add_argument(
        "--pace",
        choices=("lockstep", "realtime"),
        default="lockstep",
        help="as fast as all can (default), or 500 Hz in real time",
    )
    once = parser.add_mutually_exclusive_group()
    once.add_argument(
        "--greedy",
        action="store_true",
        help=f"walk once, greedily, from the {MEMORY_FILE} in --out; learn nothing; "
        "--seed is that of the disturbances, if any",
    )
    once.add_argument(
        "--static",
        action="store_true",
        help="walk once, without correction; learn nothing, and leave a "
        f"{MEMORY_FILE} in --out as it is",
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help=f"go on from the {MEMORY_FILE} in --out, with its settings and seed; with "
        "--set or --config, as another run under other settings",
    )
    parser.add_argument(
        "--fresh",
        action="store_true",
        help=f"delete a {MEMORY_FILE} that is in --out, and learn anew",
    )
    parser.add_argument("--seed", type=natural, metavar="N", help="default 0")
    parser.add_argument(
        "--episodes", type=positive, metavar="N", help="end after N learning episodes"
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
        help="default: ROS_DOMAIN_ID if it is set, or else one of this run's own",
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
    add_page_option(parser)
    parser.add_argument(
        "--plain", action="store_true", help="plain lines instead of a live line"
    )
    parser.add_argument(
        "--foxglove",
        nargs="?",
        type=tcp_port,
        const=_FOXGLOVE_PORT,
        metavar="PORT",
        help="show the graph to Foxglove, on this port of 127.0.0.1 (default "
        f"{_FOXGLOVE_PORT}); needs the extra foxglove",
    )
    parser.add_argument(
        "--tf", action="store_true", help="publish /tf, so that rviz2 moves the robot"
    )
    add_real_time_options(parser)
    add_recording_options(parser)
    add_settings_options(parser)
    add_json_option(parser)
    parser.set_defaults(run=run)


def add_page_option(parser: argparse.ArgumentParser) -> None:
    """Add the option that leaves out the live page."""
    parser.add_argument(
        "--no-view",
        action="store_true",
        help="no live page (http://127.0.0.1:8080, or the next free port)",
    )


def run(options: argparse.Namespace) -> int:
    """Supervise and report."""
    return supervise(options, report)


def supervise(
    options: argparse.Namespace,
    told: Callable[[EndedRun], int],
    page: LivePage | None = None,
) -> int:
    """Run the nodes to their end.

    Args:
        options: of the command.
        told: of the run that has ended; returns the exit status.
        page: that shows this run and others; None: one of its own, unless `--no-view`.
    """
    names = _nodes(options.nodes)
    out = options.out.resolve()
    memory_file = out / MEMORY_FILE
    learned = _learned(options, memory_file)
    if learned is not None and not options.greedy and LEARNER_NODE in names:
        nothing = learned.nothing_to_do(options.episodes, stop_at_schedule=False)
        if nothing is not None:
            report_nothing(learned, nothing, memory_file, json=options.json)
            return DONE if learned.learned else NOT_ACHIEVED
    settings, seed = _settings_and_seed(options, learned)
    # Refuses here a gait that the robot cannot walk.
    WaistReference(Robot(settings.robot), settings.gait, settings.correction)
    bag = bag_folder(options, names)
    if options.foxglove is not None and find_spec("foxglove") is None:
        raise CommandError("--foxglove: needs pip install 'biped[foxglove]'")
    domain = domain_of(options.domain)
    one_walk = options.greedy or options.static
    max_episodes = 1 if one_walk else options.episodes or 0
    try:
        parameters = node_parameters(
            settings,
            seed,
            # Greedy out of an empty memory is no correction at all.
            checkpoint_file="" if options.static else str(memory_file),
            max_episodes=max_episodes,
            publish_every_ticks=options.publish_every,
            pace=options.pace,
            frozen=one_walk,
            recorders=0 if bag is None else 1,
            **real_time_parameters(options),
        ).flat()
    except SettingsError as error:
        option = _OPTIONS.get(error.key, error.key)
        raise CommandError(f"{option} {error.value}: {error.allowed}") from None
    if bag is None:
        names = [name for name in names if name != RECORDER]
    else:
        begun_with = memory_file if options.greedy or options.resume else None
        run_data = run_record(
            to_mapping(settings),
            seed,
            preset=preset_of(options) if begun_with is None else "",
            pace=options.pace,
            frozen=one_walk,
            max_episodes=max_episodes,
            memory_file=begun_with,
        )
        parameters[RECORDER] = recorder_parameters(
            bag, run_data, begun_with, options.record_split
        )
    if options.foxglove is not None:
        names.append(FOXGLOVE)
        parameters[FOXGLOVE] = {"port": options.foxglove}
    if options.tf:
        names.append(TF_NODE)
        parameters[TF_NODE] = {}
    with exclusive_folder(writable_folder(out)):
        # A learner that finds its memory goes on from it.
        changes = "" if learned is None else learned.setting_changes
        if options.fresh:
            memory_file.unlink(missing_ok=True)
        elif learned is not None and changes and not options.greedy:
            learned.save(memory_file)
        supervisor, interrupted, failure = _supervise(
            options,
            {name: parameters[name] for name in names},
            domain,
            out,
            changes,
            page,
        )
        return told(
            EndedRun(
                supervisor,
                options,
                memory_file,
                bag,
                to_mapping(settings),
                interrupted,
                failure,
            )
        )


def _supervise(
    options: argparse.Namespace,
    parameters: Mapping[str, Mapping[str, Any]],
    domain: int,
    folder: Path,
    changes: str,
    page: LivePage | None,
) -> tuple[Supervisor, bool, str | None]:
    """Run the nodes to their end.

    Args:
        options: of the command.
        parameters: of the nodes to start, by node.
        domain: of the run.
        folder: for parameter files and logs.
        changes: settings that are not those of the memory, in words.
        page: that shows this run and others; it is looked after, and stays.

    Returns:
        The supervisor, whether a signal ended it, and why a node could not be kept
        running.
    """
    environment = node_environment(domain, options.discovery)
    os.environ.update(environment)  # the supervisor's own node, too
    screen = StatusScreen(Console(stderr=True), not options.plain)
    own_page = None
    failure = None
    with stop_requests() as stops, screen:
        if page is None and not options.no_view:
            page = own_page = LivePage(
                environment, folder, folder / MEMORY_FILE, screen.line
            )
            page.start()
        screen.line(NAME, f"for other terminals: export ROS_DOMAIN_ID={domain}")
        if changes:
            screen.line(NAME, f"other settings: {changes}")
        supervisor = Supervisor(parameters, environment, folder, screen.line)
        graph = supervisor.graph

        def stopped() -> bool:
            screen.update(supervisor)
            if page is not None:
                page.look_after()
            return bool(stops)

        def done() -> bool:
            if options.greedy or options.static:
                return _walked(graph)
            status = graph.status
            return status is not None and (
                status.learned or status.episodes >= (options.episodes or float("inf"))
            )

        try:
            supervisor.run(done, stopped)
        except NodeFailureError as error:
            failure = str(error)
        finally:
            supervisor.stop()
            if own_page is not None:
                own_page.stop()
        screen.update(supervisor)
    return supervisor, bool(stops), failure


def domain_of(given: int | None) -> int:
    """Return the domain of the run: as given, of the environment, or one of its own.

    Raises:
        CommandError: it is none that ROS 2 has.
    """
    name, text = "--domain", None if given is None else str(given)
    if text is None:
        name, text = "ROS_DOMAIN_ID", os.environ.get("ROS_DOMAIN_ID")
    if not text:
        return private_domain()
    if not (text.isdecimal() and int(text) <= LAST_DOMAIN):
        raise CommandError(f"{name} {text}: must be from 0 to {LAST_DOMAIN}")
    return int(text)


def _walked(graph: GraphWatch) -> bool:
    """Return whether the walk is over; one that ended from outside is repeated."""
    result = graph.result
    if graph.unseen is not None:
        return True
    return result is not None and (
        not result.end_cause.from_outside or graph.results >= _ATTEMPTS
    )


def _nodes(text: str) -> list[str]:
    names = [f"{name.strip()}_node" for name in text.split(",")]
    unknown = [name for name in names if name not in START_ORDER]
    if unknown:
        raise CommandError(f"--nodes {text}: must be among {_ALL_NODES}")
    return names


def _learned(options: argparse.Namespace, memory_file: Path) -> TrainingRun | None:
    """Return the run that is gone on with, under the options' settings, if any."""
    if options.static:
        if options.fresh or options.resume:
            raise CommandError("--static: not with --fresh or --resume")
        return None
    if options.greedy or options.resume:
        if options.fresh:
            raise CommandError("--fresh: cannot be given with --greedy or --resume")
        learned = gone_on_with(options, memory_file, learns=not options.greedy)
        learned.close()
        return learned
    if memory_file.exists() and not options.fresh:
        raise CommandError(
            f"{memory_file}: is there already; give --resume to go on with it, "
            "--fresh to replace it, or another --out"
        )
    return None


def _settings_and_seed(
    options: argparse.Namespace, learned: TrainingRun | None
) -> tuple[RunSettings, int]:
    if learned is None:
        return settings_of(options), options.seed or 0
    return learned.settings, learned.seed if options.seed is None else options.seed
