"""A slow graph of processes, its page, and a real browser that looks at it."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image
from playwright.sync_api import Browser as Chromium
from playwright.sync_api import Page
from playwright.sync_api import TimeoutError as PlaywrightTimeout
from tests.graph.domains import MODULE, own_domain

from biped_bringup.node_parameters import node_parameters
from biped_bringup.run_settings import load_settings
from biped_ros.environment import LOCALHOST, node_environment

TIMEOUT_S = 90.0
# A software renderer draws few pixels fast.
COARSE = "?fixedDpr=0.3"
SIZE = {"width": 1000, "height": 620}
ROBOT = {"x": 380, "y": 120, "width": 240, "height": 380}

DOMAIN = own_domain(MODULE + 3)
ENVIRONMENT = os.environ | node_environment(DOMAIN, LOCALHOST)
os.environ.update(node_environment(own_domain(MODULE), LOCALHOST))


def until(condition: Callable[[], object], what: str) -> None:
    """Wait for something to become true."""
    end = time.monotonic() + TIMEOUT_S
    while not condition():
        assert time.monotonic() < end, f"not within {TIMEOUT_S:g} s: {what}"
        time.sleep(0.1)


class Graph:
    """The three nodes as processes, which can be started anew one by one."""

    def __init__(self, folder: Path) -> None:
        parameters = node_parameters(
            load_settings("quick"),
            seed=5,
            listen_s=0.0,
            pace="realtime",
            realtime_factor=0.25,  # slow, so that a busy machine keeps up
            publish_every_ticks=5,
            checkpoint_file=str(folder / "memory.npz"),
        )
        self.folder, self._parameters = folder, parameters.flat()
        self.processes: dict[str, subprocess.Popen[bytes]] = {}
        for name in ("trajectory_node", "learner_node", "sim_node"):
            self.start(name)

    def start(self, name: str) -> None:
        file = self.folder / f"{name}.yaml"
        file.write_text(
            yaml.safe_dump({name: {"ros__parameters": self._parameters[name]}})
        )
        self.processes[name] = subprocess.Popen(
            [sys.executable, "-m", f"{name}.node", "--ros-args", "--params-file",
             str(file)],
            env=ENVIRONMENT,
            stderr=subprocess.DEVNULL,
        )  # fmt: skip

    def end(self, name: str) -> None:
        process = self.processes.pop(name)
        process.terminate()
        try:
            process.wait(20.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait(20.0)


class Browser:
    """One tab, and everything it complained about or asked for."""

    def __init__(self, page: Page, address: str) -> None:
        self.page = page
        self.errors: list[str] = []
        self.asked: set[str] = set()
        page.on(
            "console",
            lambda message: (
                message.type == "error" and self.errors.append(message.text)
            ),
        )
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("request", lambda request: self.asked.add(request.url))
        page.on("websocket", lambda socket: self.asked.add(socket.url))
        page.goto(f"{address}/{COARSE}", timeout=1000 * TIMEOUT_S)

    def shows(self, text: str) -> None:
        """Wait for a text."""
        self.page.get_by_text(text).first.wait_for(timeout=1000 * TIMEOUT_S)

    def soon(self, text: str) -> bool:
        """Return whether a text is shown within a few seconds."""
        try:
            self.page.get_by_text(text).first.wait_for(timeout=5000.0)
        except PlaywrightTimeout:
            return False
        return True

    def press(self, button: str) -> None:
        self.page.get_by_role("button", name=button, exact=True).click(
            timeout=1000 * TIMEOUT_S
        )

    def robot(self) -> np.ndarray:
        """The pixels where the robot is."""
        png = self.page.screenshot(clip=ROBOT, timeout=1000 * TIMEOUT_S)
        return np.asarray(Image.open(BytesIO(png)).convert("L"), dtype=np.int16)


@pytest.fixture(scope="module")
def open_tab(chromium: Chromium) -> Callable[[str], Browser]:
    """Open addresses in tabs of one Chromium."""
    return lambda address: Browser(chromium.new_page(viewport=SIZE), address)


@pytest.fixture(scope="module")
def graph(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Graph]:
    graph = Graph(tmp_path_factory.mktemp("graph"))
    yield graph
    for name in list(graph.processes):
        graph.end(name)


@pytest.fixture(scope="module")
def address(graph: Graph) -> Iterator[str]:
    """Return where the graph's page is, a process as the supervisor starts it."""
    view = subprocess.Popen(
        [sys.executable, "-m", "biped_view.live.node"],
        env=ENVIRONMENT,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert view.stdout is not None
    yield view.stdout.readline().split()[-1]
    view.terminate()
    assert view.wait(20.0) == 0
