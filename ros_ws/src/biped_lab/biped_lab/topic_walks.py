"""Learned walks of a robot behind ros2_control's topics, by the nodes as processes.

    python -m biped_lab.topic_walks --seeds 5

Learns the walk from sensors with noise and one tick of delay, in this process and under
a limit that is 15 mm stricter than the one it is walked with. Then `biped up --greedy`
walks what was learned, once in lockstep and in the robot's own time: the robot is
`sim_node.hardware_node`, and this process stands in for the person beside it, who puts
it on its feet and asks for each walk. A walk that the machine was too late for says
nothing of who learned it; `biped up` walks again, up to five times. Prints a table in
Markdown: of all walks, how many were completed, left the limit, were late, or ended
otherwise, and the peaks of the ZMP error of those that were completed, as the robot's
sensors have it. In real time, the figures are of the machine and what else it does.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Final, NamedTuple

import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String
from std_srvs.srv import Trigger

from biped_bringup.run_settings import PRESETS, RunSettings, load_settings
from biped_bringup.training import TrainingRun
from biped_common.command_line import DONE, NOT_ACHIEVED, positive
from biped_common.timing import seconds
from biped_lab.markdown import Table
from biped_lab.robustness import MOST_EPISODES, SENSED, limited
from biped_ros.environment import LOCALHOST, node_environment, private_domain
from biped_ros.messages import message_type
from biped_ros.qos import qos_profile
from msgs_json import topics
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.wire import decode
from sim_node.settings import LimitSettings

STRICTER_BY_M: Final = 0.015
SAID: Final = "said.log"
_TIMEOUT_S = 180.0
_ENDING_S = 20.0
_ANSWER_S = 2.0
_TURN_S = 0.05


class Pace(NamedTuple):
    """How time goes on."""

    of_robot: tuple[str, ...]
    """Parameters of the node that plays the robot."""
    of_nodes: tuple[str, ...]
    """Options of `biped up`."""


PACES: Final = {
    # Between two trajectories time stands still, for longer than sensors may be silent.
    "lockstep": Pace(("pace:=lockstep",), ("--set", "sim.sensors.timeout_s=3")),
    "half of real time": Pace(("pace:=realtime", "realtime_factor:=0.5"), ()),
    "real time, `--fifo 50`": Pace(("pace:=realtime",), ("--fifo", "50")),
    "real time": Pace(("pace:=realtime",), ()),
}


class Person:
    """Who stands beside the robot: puts it on its feet, and asks for walks."""

    def __init__(self) -> None:
        """Join the domain of the environment."""
        self.results: list[EpisodeResult] = []
        """Of the walks, as the learner tells them."""
        self._context = rclpy.Context()
        rclpy.init(context=self._context)
        self._node = rclpy.create_node("person", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        topic = topics.EPISODE
        self._node.create_subscription(
            message_type(topic), topic.name, self._on_episode, qos_profile(topic)
        )
        self._reset, self._begin = (
            self._node.create_client(Trigger, name)
            for name in ("simulated_hardware/reset", "robot_hardware/begin")
        )

    def close(self) -> None:
        """Leave the domain."""
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def attend(self, nodes: subprocess.Popen[bytes]) -> None:
        """Have the robot walk whenever the nodes are there for it, until they end.

        Raises:
            TimeoutError: they take too long.
        """
        end = time.monotonic() + _TIMEOUT_S
        walks, to_ask = 0, [self._begin]
        while nodes.poll() is None:
            if time.monotonic() > end:
                raise TimeoutError(f"biped up was not done within {_TIMEOUT_S:g} s")
            if len(self.results) > walks:
                walks, to_ask = len(self.results), [self._reset, self._begin]
            elif to_ask and self._granted(to_ask[0]):
                del to_ask[0]
            self._executor.spin_once(_TURN_S)

    def _granted(self, client: rclpy.client.Client) -> bool:
        """Return whether a service is there and does what it is asked for."""
        if not client.service_is_ready():
            return False
        future = client.call_async(Trigger.Request())
        self._executor.spin_until_future_complete(future, _ANSWER_S)
        if not future.done():
            client.remove_pending_request(future)
            return False
        return bool(future.result().success)

    def _on_episode(self, message: String) -> None:
        self.results.append(decode(EpisodeResult, message.data))


def learn(settings: RunSettings, seed: int, memory_file: Path) -> bool:
    """Learn the walk and save it; return whether it was learned in time."""
    with closing(TrainingRun(settings, seed)) as run:
        run.run(MOST_EPISODES, False, lambda _: True)
        run.save(memory_file)
        return run.learned


def walk(folder: Path, pace: Pace, seed: int, limit_m: float) -> list[EpisodeResult]:
    """Have the nodes walk what was learned; return how each attempt ended.

    Args:
        folder: of the memory; what the processes say is added to `said.log`.
        pace: of the robot and the nodes.
        seed: of the noise of the sensors.
        limit_m: of the ZMP error.

    Raises:
        TimeoutError: it takes too long.
        ChildProcessError: the nodes could not be kept running.
    """
    domain = private_domain()
    os.environ.update(node_environment(domain, LOCALHOST))
    robot = ["-m", "sim_node.hardware_node", "--ros-args"]
    for parameter in (*pace.of_robot, f"seed:={seed}"):
        robot += ["-p", parameter]
    nodes = ["-m", "biped_bringup.cli.main", "up", "--greedy", "--no-view", "--plain"]
    nodes += ["--record", "none", "--domain", str(domain), "--out", str(folder)]
    nodes += ["--set", "sim.engine=robot", "--set", f"sim.limits.zmp_error_m={limit_m}"]
    with closing(Person()) as person:
        with _running(robot, folder), _running([*nodes, *pace.of_nodes], folder) as up:
            person.attend(up)
        if up.returncode not in {DONE, NOT_ACHIEVED}:
            *_, last = ["", *(folder / SAID).read_text().splitlines()]
            raise ChildProcessError(f"biped up: status {up.returncode}: {last}")
        return person.results


@contextmanager
def _running(words: list[str], folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Run Python in a process, which is gone at the end of the block."""
    with (folder / SAID).open("ab") as log:
        process = subprocess.Popen(
            [sys.executable, *words],
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
            start_new_session=True,  # Ctrl-C is for this process, which ends it
        )
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(_ENDING_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def row(results: Sequence[EpisodeResult]) -> tuple[str, ...]:
    """Return in words how walks ended: completed, over the limit, late, otherwise."""
    causes = Counter(result.end_cause for result in results)
    peaks_mm = [1000 * r.peak_zmp_error_m for r in results if r.completed]
    known = (EndCause.COMPLETED, EndCause.ZMP_ERROR, EndCause.LATE)
    late_s = [seconds(r.control_ticks) for r in results if r.end_cause is EndCause.LATE]
    completed, left, late = (str(causes.pop(cause, 0)) for cause in known)
    if peaks_mm:
        completed += f", peaks {min(peaks_mm):.1f} to {max(peaks_mm):.1f} mm"
    if late_s:
        late += f", after {min(late_s):.1f} to {max(late_s):.1f} s"
    others = ", ".join(f"{n} {cause}" for cause, n in causes.items())
    return completed, left, late, others or "0"


def main() -> int:
    """Learn, walk and print."""
    parser = argparse.ArgumentParser(
        prog="python -m biped_lab.topic_walks", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--preset", choices=PRESETS, default="directed")
    parser.add_argument("--seeds", type=positive, default=5, metavar="N")
    parser.add_argument("--first", type=positive, default=8101, metavar="SEED")
    options = parser.parse_args()
    limit_m = LimitSettings().zmp_error_m
    sensed = load_settings(options.preset, changes=[SENSED])
    settings = limited(sensed, limit_m - STRICTER_BY_M)
    ended: dict[str, list[EpisodeResult]] = {name: [] for name in PACES}
    for seed in range(options.first, options.first + options.seeds):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            if not learn(settings, seed, folder / "memory.npz"):
                print(f"seed {seed}: not learned", file=sys.stderr, flush=True)
                continue
            for pace, how in PACES.items():
                results = walk(folder, how, seed, limit_m)
                ended[pace] += results
                said = ", ".join(str(result.end_cause) for result in results)
                print(f"seed {seed}, {pace}: {said}", file=sys.stderr, flush=True)
    head = ("time", "walks", "completed", "left the limit", "late", "otherwise")
    rows = ((name, str(len(all_)), *row(all_)) for name, all_ in ended.items())
    print(Table(head, tuple(rows)).markdown(), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
