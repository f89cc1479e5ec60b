"""`colcon build`, and what a fresh shell has after `source install/setup.bash`.

Built once, outside the checkout. A fresh shell has nothing of this process's
environment: neither .venv on its PATH nor what the wheels' start-up leaves behind.
"""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
import tomllib

from biped_bringup.supervisor.graph_watch import GraphWatch
from msgs_json.episode_result import EpisodeResult

TOP = Path(__file__).resolve().parents[1]
WORKSPACE = TOP / "ros_ws"
PACKAGES = sorted(file.parent.name for file in WORKSPACE.glob("src/*/package.xml"))
PROJECT = tomllib.loads((TOP / "pyproject.toml").read_text())["project"]
EXECUTABLES = PROJECT["entry-points"]["biped.nodes"]
COLCON = Path(sys.executable).with_name("colcon")
# No other test uses these; their ports are not among those that Linux gives away.
DOMAIN = 215 + os.getpid() % 18
PATIENCE_S = 240.0

pytestmark = pytest.mark.thorough


@dataclass(frozen=True)
class Workspace:
    """What `colcon build` made, and a home for the shells that use it."""

    install: Path
    home: Path
    sources: dict[str, list[Path]]
    """What each package's module consisted of when the build began."""

    def environment(self) -> dict[str, str]:
        """Return all that a fresh shell knows."""
        return {
            "HOME": str(self.home),
            "PATH": os.defpath,
            "ROS_DOMAIN_ID": str(DOMAIN),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
        }

    def start(self, *command: object) -> "subprocess.Popen[str]":
        """Start a command in a fresh shell, the workspace sourced."""
        script = f'source "{self.install}/setup.bash" && exec "$@"'
        return subprocess.Popen(
            ["bash", "-c", script, "bash", *map(str, command)],
            cwd=self.home,
            env=self.environment(),
            stdout=subprocess.PIPE,
            text=True,
        )

    def output(self, *command: object) -> str:
        """Return what a command prints, which must succeed."""
        with self.start(*command) as process:
            out, _ = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 0
        return out

    def python(self, code: str) -> dict[str, str]:
        """Return the JSON object that a line of Python prints."""
        return json.loads(self.output(sys.executable, "-c", code))

    def executable(self, name: str) -> Path:
        """Return the file that `ros2 run` would start, by package/executable."""
        package, _, file = name.partition("/")
        return self.install / package / "lib" / package / file


def files_of(package: str) -> list[Path]:
    """Return code and data of a package, relative to its folder."""
    folder = WORKSPACE / "src" / package
    return [
        file.relative_to(folder)
        for file in folder.glob(f"{package}/**/*")
        if file.is_file() and "__pycache__" not in file.parts
    ]


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Workspace:
    """Build all packages, anew."""
    pytest.importorskip("colcon_core")
    base = tmp_path_factory.mktemp("ros_ws")
    sources = {name: files_of(name) for name in PACKAGES}
    subprocess.run(
        [
            COLCON, "--log-base", base / "log",
            "build", "--build-base", base / "build",
            "--install-base", base / "install",
        ],
        cwd=WORKSPACE,
        env={"HOME": str(base), "PATH": os.defpath},
        check=True,
        capture_output=True,
        timeout=PATIENCE_S,
    )  # fmt: skip
    return Workspace(base / "install", base, sources)


@dataclass(frozen=True)
class Walk:
    """The first walk of nodes started by ROS name, and what Ctrl-C left of it."""

    result: EpisodeResult | None
    statuses: dict[str, int]
    bag: Path


@pytest.fixture(scope="module")
def walk(workspace: Workspace) -> Iterator[Walk]:
    """Start the nodes from their executables, wait for a walk, interrupt them."""
    bag = workspace.home / "bag"
    # In a new workspace the nodes compile first; they must not give up on each other.
    parameters = {
        "biped_bag/recorder": f"folder:={bag}",
        "sim_node/sim_node": f"timeout_s:={PATIENCE_S}",
    }
    nodes = {
        name: workspace.start(
            workspace.executable(name),
            *(("--ros-args", "-p", parameters[name]) if name in parameters else ()),
        )
        for name in EXECUTABLES
        if name != "biped_bringup/biped"
    }
    with pytest.MonkeyPatch.context() as patch:
        for name, value in workspace.environment().items():
            patch.setenv(name, value)
        graph = GraphWatch(DOMAIN)
    try:
        for _ in range(int(PATIENCE_S)):
            graph.spin(1.0)
            if graph.result or any(node.poll() is not None for node in nodes.values()):
                break
        for node in nodes.values():
            node.send_signal(signal.SIGINT)
        statuses = {name: node.wait(PATIENCE_S) for name, node in nodes.items()}
    finally:
        for node in nodes.values():
            node.kill()
            node.communicate()
        graph.close()
    yield Walk(graph.result, statuses, bag)


def test_every_package_is_in_the_ament_index(workspace: Workspace) -> None:
    prefixes = workspace.python(
        "import json, ament_index_python as index;"
        "print(json.dumps(index.get_packages_with_prefixes()))"
    )
    assert {name: prefixes.get(name) for name in PACKAGES} == {
        name: str(workspace.install / name) for name in PACKAGES
    }


def test_the_packages_of_ros_stay_in_the_ament_index(workspace: Workspace) -> None:
    prefixes = workspace.python(
        "import json, ament_index_python as index;"
        "print(json.dumps(index.get_packages_with_prefixes()))"
    )
    assert prefixes.get("std_msgs") == sys.prefix


def test_where_python_has_no_ros_its_prefix_is_not_added(
    workspace: Workspace, tmp_path: Path
) -> None:
    script = tmp_path / "lib/biped_bringup/biped"
    script.parent.mkdir(parents=True)
    script.write_text("#!/usr/bin/python3\n")
    hook = workspace.install / "biped_bringup/share/biped_bringup/hook/wheels_prefix.sh"
    shown = subprocess.run(
        ["sh", "-c", f'. "{hook}"; echo "$AMENT_PREFIX_PATH"'],
        env={"COLCON_CURRENT_PREFIX": str(tmp_path), "AMENT_PREFIX_PATH": "/opt/ros"},
        check=True,
        capture_output=True,
        text=True,
    )
    assert shown.stdout.strip() == "/opt/ros"


def test_python_imports_the_packages_from_the_install_space(
    workspace: Workspace,
) -> None:
    origins = workspace.python(
        "import json, importlib;"
        f"found = {{n: importlib.import_module(n).__file__ for n in {PACKAGES}}};"
        "print(json.dumps(found))"
    )
    assert [
        name
        for name, file in origins.items()
        if not Path(file).is_relative_to(workspace.install / name)
    ] == []


@pytest.mark.parametrize("package", PACKAGES)
def test_code_and_data_of_a_package_are_installed(
    workspace: Workspace, package: str
) -> None:
    (site_packages,) = workspace.install.glob(f"{package}/lib/python*/site-packages")
    files = workspace.sources[package]
    assert [file for file in files if not (site_packages / file).is_file()] == []


@pytest.mark.parametrize("name", EXECUTABLES)
def test_an_executable_is_where_ros2_run_looks_for_it(
    workspace: Workspace, name: str
) -> None:
    assert os.access(workspace.executable(name), os.X_OK)


def test_the_command_line_finds_its_presets(workspace: Workspace) -> None:
    assert workspace.output("biped", "check", "--preset", "quick").startswith("valid")


def test_both_commands_are_on_the_path(workspace: Workspace) -> None:
    found = workspace.output("bash", "-c", "command -v biped ros2").splitlines()
    assert found == [
        str(workspace.executable("biped_bringup/biped")),
        str(Path(sys.executable).with_name("ros2")),
    ]


def test_sourcing_it_twice_adds_nothing_to_the_path(workspace: Workspace) -> None:
    setup = workspace.install / "setup.bash"
    again = f'before=$PATH; source "{setup}"; [ "$PATH" = "$before" ]'
    assert workspace.output("bash", "-c", again) == ""


def test_the_executables_walk_together(walk: Walk) -> None:
    assert walk.result is not None
    assert walk.result.control_ticks > 0


def test_the_nodes_end_orderly_when_interrupted(walk: Walk) -> None:
    assert set(walk.statuses.values()) == {0}, walk.statuses


def test_the_recorder_is_among_the_executables(walk: Walk) -> None:
    assert (walk.bag / "metadata.yaml").is_file()
