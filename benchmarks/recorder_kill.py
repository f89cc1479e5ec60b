"""Kill the recorder with `kill -9` at random moments; what does that cost?

    python -m benchmarks.recorder_kill --kills 50

Every killed bag is recovered and compared with what was sent until the kill. Exit
status 1 when more than 0.2 s were lost, or a report was not right to the message.
"""

from __future__ import annotations

import argparse
import random
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from benchmarks.numbered_publisher import TOPICS, sent_times
from biped_bag.recovery.recover import recover
from biped_bag.storage.reader import BagReader
from biped_ros.environment import node_environment, private_domain

BOUND_S = 0.2
_START_TIMEOUT_S = 60.0
_LONGEST_RECORDING_S = 1.5
# A recorder that writes both topics has more than its first, nearly empty chunk.
_RECORDING_BYTES = 8_000
# While the middleware connects a recorder to a publisher that is already speaking, a
# message or two can be missing between the first ones that come.
_JOINING_MESSAGES = 50
_NUMBER = struct.Struct("<4xQ")  # CDR of UInt64 behind its encapsulation header


@dataclass(frozen=True)
class Kill:
    """One recorder killed, and its bag recovered."""

    recovered: int
    lost: int
    """Messages sent before the kill, after the last one recovered."""
    lost_s: float
    """From when the first of them was sent to the kill."""
    right: bool
    """The report counts what the recovered bag holds, and that is every number from
    when publisher and recorder were connected to the last."""


@contextmanager
def publishing(folder: Path, domain: int) -> Iterator[Path]:
    """Have numbers published; yield the file with the times of sending."""
    file = folder / "sent"
    process = subprocess.Popen(
        [sys.executable, "-m", "benchmarks.numbered_publisher", str(file)],
        env=node_environment(domain, "LOCALHOST"),
    )
    try:
        yield file
    finally:
        process.terminate()
        process.wait(10.0)


def killed_recording(folder: Path, domain: int, sent: Path, after_s: float) -> Kill:
    """Record, kill the recorder some time after it began to write, and recover."""
    bag = folder / "bag"
    command = [sys.executable, "-m", "biped_bag.recorder.node", "--ros-args"]
    command += ["-p", f"folder:={bag}", "-p", f"topics:={' '.join(TOPICS)}"]
    recorder = subprocess.Popen(
        command,
        env=node_environment(domain, "LOCALHOST"),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        _wait_for(bag / "bag_0.mcap", recorder)
        time.sleep(after_s)
        killed_ns = time.time_ns()
    finally:
        recorder.kill()
        recorder.wait()
    return _compared(bag, folder / "recovered", sent, killed_ns)


def _wait_for(file: Path, recorder: subprocess.Popen[bytes]) -> None:
    end = time.monotonic() + _START_TIMEOUT_S
    while not file.exists() or file.stat().st_size < _RECORDING_BYTES:
        if recorder.poll() is not None or time.monotonic() > end:
            raise RuntimeError("the recorder does not record")
        time.sleep(0.01)


def _compared(bag: Path, out: Path, sent: Path, killed_ns: int) -> Kill:
    report = recover(bag, out)
    times = sent_times(sent)
    recovered = lost = 0
    lost_ns = 0
    right = not report.end_known
    reader = BagReader(out)
    for i, topic in enumerate(TOPICS):
        numbers = [_NUMBER.unpack(m.data)[0] for m in reader.messages([topic])]
        told = report.topics[topic]
        right = right and told.recovered == len(numbers) and told.lost == 0
        settled = numbers[_JOINING_MESSAGES:]
        right = right and settled == list(range(settled[0], settled[-1] + 1))
        after = times[numbers[-1] + 1 :, i]
        missing = after[(after > 0) & (after <= killed_ns)]
        recovered += len(numbers)
        lost += len(missing)
        if len(missing):
            lost_ns = max(lost_ns, killed_ns - int(missing[0]))
    return Kill(recovered, lost, lost_ns * 1e-9, right)


def main() -> int:
    """Kill, recover, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    kills: list[Kill] = []
    domain = private_domain()
    with tempfile.TemporaryDirectory() as name, publishing(Path(name), domain) as sent:
        for number in range(options.kills):
            folder = Path(name) / str(number)
            folder.mkdir()
            after_s = chance.uniform(0.0, _LONGEST_RECORDING_S)
            kills.append(killed_recording(folder, domain, sent, after_s))
            print(
                f"{number + 1:3d}  killed {after_s:.3f} s in: {kills[-1]}", flush=True
            )
    losses_s = sorted(kill.lost_s for kill in kills)
    within = sum(lost_s <= BOUND_S for lost_s in losses_s)
    print(
        f"{len(kills)} kills: reports right {sum(kill.right for kill in kills)}, "
        f"at most {BOUND_S} s lost {within}; lost: median "
        f"{statistics.median(losses_s):.3f} s, worst {losses_s[-1]:.3f} s"
    )
    return 0 if within == len(kills) and all(kill.right for kill in kills) else 1


if __name__ == "__main__":
    sys.exit(main())
