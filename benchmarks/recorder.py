"""What the recorder costs, and whether it loses anything, at 500 Hz in real time.

The whole graph learns for a minute with all topics on; the share is the recorder's CPU
time, as the kernel counts it, over that minute.
"""

from __future__ import annotations

import json
import os
import tempfile
import time
from pathlib import Path

from mcap.reader import make_reader

from benchmarks.report import Figure
from biped_bag.records import COUNTS_RECORD
from biped_bringup.cli.recording import recorder_parameters
from biped_bringup.node_parameters import node_parameters
from biped_bringup.run_settings import load_settings
from biped_bringup.supervisor.supervisor import RECORDER, Supervisor
from biped_ros.environment import node_environment

_DOMAIN = 121
_DURATION_S = 60.0
_SHARE_BOUND = 15.0


def measure() -> list[Figure]:
    """Return the share of a core, the messages of a minute and those lost."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        supervisor = _supervisor(folder)
        try:
            supervisor.run(lambda: supervisor.graph.results > 0, lambda: False)
            pid = supervisor.children[RECORDER].pid
            assert pid is not None
            begun, cpu_s = time.monotonic(), _cpu_s(pid)
            supervisor.watch(
                lambda: time.monotonic() - begun >= _DURATION_S, lambda: False
            )
            share = 100.0 * (_cpu_s(pid) - cpu_s) / (time.monotonic() - begun)
        finally:
            supervisor.stop()
        counts = _counts(folder / "bag")
    received, lost = (sum(n[key] for n in counts) for key in ("received", "lost"))
    return [
        Figure("recorder, all topics at 500 Hz: of a core", share, "%", _SHARE_BOUND),
        Figure("recorder: messages received", received, ""),
        Figure("recorder: messages lost", lost, "", 0.0),
    ]


def _supervisor(folder: Path) -> Supervisor:
    parameters = node_parameters(
        load_settings("quick"), seed=1, pace="realtime", recorders=1
    ).flat()
    parameters[RECORDER] = recorder_parameters(folder / "bag", {}, None, {})
    environment = node_environment(_DOMAIN, "LOCALHOST")
    os.environ.update(environment)
    return Supervisor(parameters, environment, folder, lambda *_: None)


def _cpu_s(pid: int) -> float:
    """Return the CPU time of all threads of a process."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    user, system = int(fields[11]), int(fields[12])
    return (user + system) / os.sysconf("SC_CLK_TCK")


def _counts(bag: Path) -> list[dict[str, int]]:
    with (bag / f"{bag.name}_0.mcap").open("rb") as file:
        for record in make_reader(file).iter_metadata():
            if record.name == COUNTS_RECORD:
                return [json.loads(text) for text in record.metadata.values()]
    raise ValueError(f"{bag}: was not ended in order")
