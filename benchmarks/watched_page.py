"""The live page of a graph, and a browser that looks at it.

The browser has no graphics card here and draws in software: few pixels, and only when
nobody else wants the processor. What it takes is not the page's.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from playwright.sync_api import Page, ViewportSize, sync_playwright

from biped_ros.environment import LOCALHOST, node_environment

_FLAGS = (
    "--no-sandbox",
    "--disable-background-networking",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
_IDLE_CHROMIUM = '#!/bin/sh\nexec nice -n 19 /usr/bin/chromium "$@"\n'
_COARSE = "?fixedDpr=0.1"
_SIZE: Final[ViewportSize] = {"width": 640, "height": 400}
_END_S = 20.0


@contextmanager
def live_page(domain: int) -> Iterator[tuple[int, str]]:
    """Have a page in a process; give its id and the page's address."""
    process = subprocess.Popen(
        [sys.executable, "-m", "biped_view.live.node"],
        env=os.environ | node_environment(domain, LOCALHOST),
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        yield process.pid, process.stdout.readline().split()[-1]
    finally:
        process.terminate()
        process.wait(_END_S)


@contextmanager
def browser(address: str) -> Iterator[Page]:
    """Have a headless Chromium look at an address."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        chromium = Path(folder) / "chromium"
        chromium.write_text(_IDLE_CHROMIUM)
        chromium.chmod(0o755)
        running = playwright.chromium.launch(
            executable_path=str(chromium), args=list(_FLAGS)
        )
        page = running.new_page(viewport=_SIZE)
        page.goto(f"{address}/{_COARSE}")
        yield page
        running.close()
