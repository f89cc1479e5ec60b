"""Nodes on a real graph, each test on a domain of its own."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import yaml

# Parallel test processes must not meet: xdist numbers its workers gw0, gw1, ...
WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["FASTDDS_BUILTIN_TRANSPORTS"] = "UDPv4"
_FIRST_DOMAIN = 40


@pytest.fixture
def domain(request: pytest.FixtureRequest) -> int:
    """Return a ROS domain that no test running at the same time uses."""
    return _FIRST_DOMAIN + 10 * WORKER + hash(request.node.nodeid) % 10


@pytest.fixture
def processes(
    domain: int, tmp_path: Path
) -> Iterator[Callable[[str, dict[str, object]], subprocess.Popen[bytes]]]:
    """Start nodes as processes; they end with the test."""
    started: list[subprocess.Popen[bytes]] = []

    def start(module: str, values: dict[str, object]) -> subprocess.Popen[bytes]:
        name = module.split(".")[0]
        file = tmp_path / f"{name}.yaml"
        file.write_text(yaml.safe_dump({name: {"ros__parameters": values}}))
        process = subprocess.Popen(
            [sys.executable, "-m", module, "--ros-args", "--params-file", str(file)],
            env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
            stderr=subprocess.DEVNULL,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        process.terminate()
    for process in started:
        try:
            process.wait(10.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait(10.0)
