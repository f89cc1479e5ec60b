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

_DOMAIN = 121
_WARM_S, _MEASURED_S = 8.0, 12.0
_BOUND_PERCENT = 15.0
_CHROMIUM = "/usr/bin/chromium"
_FLAGS = [
    "--no-sandbox",
    "--disable-background-networking",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]
# Few pixels: what the browser takes, the page's process would have to wait for.
_COARSE = "?fixedDpr=0.1"


def measure() -> list[Figure]:
    """Return the shares of a core that the page takes."""
    from playwright.sync_api import sync_playwright

    from biped_ros.environment import node_environment

    os.environ.update(node_environment(_DOMAIN, "LOCALHOST"))
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        bag = Path(folder) / "walk"
        write_walk(bag)
        view = subprocess.Popen(
            [sys.executable, "-m", "biped_view.live.node"],
            stdout=subprocess.PIPE,
            text=True,
        )
        assert view.stdout is not None
        address = view.stdout.readline().split()[-1]
        player = subprocess.Popen(
            [sys.executable, "-m", "biped_bringup.cli.main", "bag", "play", "--loop",
             "--domain", str(_DOMAIN), str(bag)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )  # fmt: skip
        try:
            alone = _percent(view.pid)
            browser = playwright.chromium.launch(executable_path=_CHROMIUM, args=_FLAGS)
            page = browser.new_page(viewport={"width": 1280, "height": 800})
            page.goto(f"{address}/{_COARSE}")
            page.get_by_text("Walking").first.wait_for()
            watched = _percent(view.pid)
            browser.close()
        finally:
            for process in (player, view):
                process.terminate()
                process.wait(20.0)
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
