"""`biped check`: is this configuration sound, and what does it say?"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

import yaml

from biped_bringup.cli.options import add_settings_options, settings_of
from biped_common.command_line import add_json_option, print_json
from biped_common.settings import to_mapping
from biped_common.timing import seconds
from biped_description.robot import Robot
from learner_node.walking.schedule import LearningSchedule
from trajectory_node.waist_reference import WaistReference


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "check",
        help="validate a configuration without running it",
        description="Validate settings: every key, range and unit, and whether the "
        "robot can reach the gait's footholds. Exit status 2 and one line if not.",
    )
    add_settings_options(parser)
    parser.add_argument(
        "--show", action="store_true", help="print all settings as YAML (SI units)"
    )
    parser.add_argument(
        "--urdf", action="store_true", help="print the URDF of the robot"
    )
    add_json_option(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Check and report."""
    settings = settings_of(options)
    robot = Robot(settings.robot)
    reference = WaistReference(robot, settings.gait, settings.correction)
    schedule = LearningSchedule(settings.learner.schedule, reference.ticks)
    if options.json:
        print_json(
            {
                "valid": True,
                "walk_s": seconds(reference.ticks),
                "targets_s": [seconds(ticks) for ticks in schedule.targets],
                "settings": to_mapping(settings),
            }
        )
    elif options.urdf:
        print(robot.urdf, end="")
    elif options.show:
        print(yaml.safe_dump(to_mapping(settings), sort_keys=False), end="")
    else:
        print(
            f"valid: a walk of {seconds(reference.ticks):g} s in {settings.gait.steps} "
            f"steps, learned in {len(schedule.targets)} subtasks"
        )
    return 0
