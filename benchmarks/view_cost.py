"""What the live page costs: CPU time of its process over wall time.

A walk with all its topics, those of 500 Hz at 500 Hz, is played in real time, again and
again. First nobody looks at the page, then a headless Chromium does; of the browser,
which draws in software here, nothing is counted.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.player import write_walk
from benchmarks.report import Figure
from benchmarks.watched_page import browser, live_page
from biped_ros.environment import private_domain

_WARM_S, _MEASURED_S = 8.0, 12.0
_BOUND_PERCENT = 15.0


def measure() -> list[Figure]:
    """Return the shares of a core that the page takes."""
    domain = private_domain()
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "walk"
        write_walk(bag)
        with live_page(domain) as (process, address):
            player = subprocess.Popen(
                [sys.executable, "-m", "biped_bringup.cli.main", "bag", "play",
                 "--loop", "--domain", str(domain), str(bag)],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )  # fmt: skip
            try:
                alone = _percent(process)
                with browser(address) as page:
                    page.get_by_text("Walking").first.wait_for()
                    watched = _percent(process)
            finally:
                player.terminate()
                player.wait(20.0)
    return [
        Figure("live page, nobody looks", alone, "% of a core"),
        Figure("live page, one browser looks", watched, "% of a core", _BOUND_PERCENT),
    ]


def _percent(pid: int) -> float:
    """Return the CPU time of a process over wall time, once it is warm [%]."""
    time.sleep(_WARM_S)
    begun, before = time.monotonic(), _cpu_s(pid)
    time.sleep(_MEASURED_S)
    return 100.0 * (_cpu_s(pid) - before) / (time.monotonic() - begun)


def _cpu_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
