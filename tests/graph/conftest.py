"""Nodes on a real graph, each test on a domain of its own."""

import itertools
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import yaml
from tests.graph.domains import MODULE, SHARED, own_domain

from biped_ros.environment import LOCALHOST, node_environment

# The middleware reads its profile once, before the first node of a process.
os.environ.update(node_environment(own_domain(MODULE), LOCALHOST))


@pytest.fixture(scope="session")
def numbers() -> Iterator[int]:
    """Return the numbers of the shared domains, again and again."""
    return itertools.cycle(range(SHARED))


@pytest.fixture
def domain(numbers: Iterator[int]) -> int:
    """Return a ROS domain that no test running at the same time uses."""
    return own_domain(next(numbers))


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
