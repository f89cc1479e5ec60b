"""`biped demo`: the walk fails, is learned, and is walked, each on the ROS 2 graph.

Three runs of `biped up` on one domain and one live page, told in few lines. It is what
`make run` starts.
"""

from __future__ import annotations

import argparse
import os
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from biped_bringup.cli import main, up
from biped_bringup.cli.learn import MEMORY_FILE
from biped_bringup.cli.up_report import EndedRun, summarized
from biped_bringup.supervisor.live_page import LivePage
from biped_common.command_line import DONE, NOT_ACHIEVED, positive, writable_folder
from biped_common.terminal_text import printable
from biped_ros.environment import LOCALHOST, node_environment
from msgs_json.end_cause import EndCause

_DEFAULT_OUT = Path("bags/quick")
_MOST_EPISODES = 1500  # as many as a run of the published results
_WALKED = (DONE, NOT_ACHIEVED)
"""Exit statuses of a run that came to its own end."""


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "demo",
        help="see the walk fail, be learned, and be walked in real time",
        description="On the ROS 2 graph: walk the static walk, which fails; learn with "
        "the preset `quick`; walk what was learned in real time, or in lockstep where "
        "the machine is late. What was learned in --out before is replaced. Exit "
        "status 0 when the learned walk was walked to its end, 1 when not, 3 when a "
        "node could not be kept running, 130 when interrupted.",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=_DEFAULT_OUT,
        metavar="DIR",
        help=f"folder for {MEMORY_FILE}, bags and logs (default {_DEFAULT_OUT})",
    )
    parser.add_argument(
        "--episodes",
        type=positive,
        default=_MOST_EPISODES,
        metavar="N",
        help="give up learning after N episodes (default %(default)s)",
    )
    up.add_page_option(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Show the three walks; say where everything lies."""
    demo = Demo(options.out, with_page=not options.no_view)
    try:
        return _three_walks(demo, options.episodes)
    finally:
        demo.close()


def _three_walks(demo: Demo, most_episodes: int) -> int:
    print("1 of 3  the walk as it was planned, in real time", flush=True)
    _, status = demo.walk("--static", "--record", "none")
    if status not in _WALKED:
        return status
    print("2 of 3  learning, as fast as the nodes can", flush=True)
    learned, status = demo.up(
        *("--preset", "quick", "--fresh", "--publish-every", "10"),
        *("--episodes", str(most_episodes)),
    )
    if status not in _WALKED:
        return status
    if not learned["completed"]:
        demo.tell(f"not learned yet: {learned['episodes']} episodes")
        return status
    demo.tell(
        f"learned in {learned['episodes']} episodes, "
        f"{learned['simulated_s']:.0f} simulated seconds"
    )
    print("3 of 3  the learned walk, in real time", flush=True)
    walked, status = demo.walk("--greedy")
    if status in _WALKED:
        demo.show_results(walked)
    return status


class Demo:
    """Runs of `biped up` in one folder, on one domain and on one live page."""

    def __init__(self, out: Path, *, with_page: bool) -> None:
        """Start the page, if there is to be one, and say where it is.

        Args:
            out: folder for memory, bags, logs and report.
            with_page: show the runs on a live page.
        """
        self._out = writable_folder(out)
        self._domain = up.domain_of(None)
        self._page = None
        if with_page:
            environment = os.environ | node_environment(self._domain, LOCALHOST)
            self._page = LivePage(environment, out, out / MEMORY_FILE, self._show)
            self._page.start()

    def close(self) -> None:
        """End the page."""
        if self._page is not None:
            self._page.stop()

    def _show(self, _: str, line: str) -> None:
        print(printable(line), flush=True)

    def walk(self, *words: str) -> tuple[dict[str, Any], int]:
        """Walk once in real time, or in lockstep where that is not kept; tell it."""
        walk, status = self.up(*words, "--pace", "realtime", "--fifo", "50")
        if walk.get("end_cause") == EndCause.LATE:
            times = walk["given_up_walks"][EndCause.LATE]
            self.tell(
                f"late {times} times: this machine does not keep 500 Hz now; "
                "the same walk in lockstep, at its own speed:"
            )
            walk, status = self.up(*words)
        if status in _WALKED:
            self.tell(_ended(walk))
        return walk, status

    def up(self, *words: str) -> tuple[dict[str, Any], int]:
        """Run `biped up` with these options; return its summary and exit status."""
        arguments = ["up", *words, "--out", str(self._out), "--no-view"]
        arguments += ["--domain", str(self._domain)]
        options = main.parser(arguments).parse_args(arguments)
        summary: dict[str, Any] = {}

        def keep(ended: EndedRun) -> int:
            told, status = summarized(ended)
            summary.update(told)
            if status not in _WALKED:
                why = ended.failure or told["outcome"]
                self.tell(f"{why}; logs are in {self._out}")
            for what in told["not_saved"]:
                self.tell(f"not saved: {what}")
            return status

        status = up.supervise(options, keep, self._page)
        return summary, status

    def tell(self, text: str) -> None:
        """Print a line about the walk that is shown."""
        print(printable(f"        {text}"), flush=True)

    def show_results(self, walked: dict[str, Any]) -> None:
        """Write the report; say where it, memory and bag lie, and what to try next."""
        out, memory = shlex.quote(str(self._out)), self._out / MEMORY_FILE
        bags = [("bag", self._out / Path(bag).name) for bag in walked["bags"]]
        for name, file in [("memory", memory), *bags]:
            print(printable(f"{name:<10} {file}"), flush=True)
        main.main(["report", str(self._out)])
        steps = {
            f"biped view {out}": "the learned walk again, on a page with a time slider",
            "biped learn --seed 7 --out bags/mine": "as in the paper, in one process",
            f"biped learn --resume {out}/{MEMORY_FILE} --out bags/pushed --set "
            "sim.disturbances.push_force_n=20 --episodes 1000": "the same, with pushes",
        }
        print("next       . .venv/bin/activate")
        for command, what in steps.items():
            print(printable(f"           {command}  # {what}"))


def _ended(walk: dict[str, Any]) -> str:
    """Return how a walk ended, in words."""
    if "end_cause" not in walk:
        return str(walk["outcome"])
    return (
        f"{walk['end_cause']} after {walk['end_time_s']:.2f} s, peak ZMP error "
        f"{1000 * walk['peak_zmp_error_m']:.1f} mm"
    )
