"""Check ROS setup and other potential issues.

Exit status: 0 all checks passed; 1 one found an error, or a warning where these count.
What was found goes to stderr, the summary and reports to stdout.
"""

from __future__ import annotations

import argparse
import sys

from ros2_verbs.doctor.area import complaints, report, summary
from ros2_verbs.options import add_node_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    what = parser.add_mutually_exclusive_group()
    what.add_argument("-r", "--report", action="store_true", help="print all reports")
    what.add_argument(
        "-rf",
        "--report-failed",
        action="store_true",
        help="print reports of failed checks",
    )
    parser.add_argument(
        "-iw",
        "--include-warnings",
        action="store_true",
        help="include warnings as failed checks",
    )
    add_node_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Examine and report."""
    # Not above: the help of `ros2` alone need not wait for rclpy.
    from ros2_verbs.doctor.examination import examine

    areas = examine(args)
    if args.report:
        for area in areas:
            print(report(area))
        return 0
    for line in complaints(areas):
        print(line, file=sys.stderr)
    warnings = args.include_warnings
    print(summary(areas, include_warnings=warnings))
    failed = [area for area in areas if area.failed(include_warnings=warnings)]
    if args.report_failed:
        for area in failed:
            print(report(area))
    return 1 if failed else 0
