"""The floors of the house: which package may import which."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[1]

PACKAGES = sorted(file.parent.name for file in TOP.glob("ros_ws/src/*/package.xml"))


def lint_imports(folder: Path) -> subprocess.CompletedProcess[str]:
    """Check the packages that are importable from `folder` by its contracts."""
    return subprocess.run(
        [
            sys.executable,
            "-c",
            "from importlinter.cli import lint_imports_command as lint; lint()",
            "--no-cache",
        ],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder), "COLUMNS": "80"},
        capture_output=True,
        text=True,
    )


@pytest.fixture
def house(tmp_path: Path) -> Path:
    """Build all packages, empty, under the project's own contracts."""
    shutil.copy(TOP / "pyproject.toml", tmp_path)
    for name in PACKAGES:
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").touch()
    return tmp_path


def test_the_packages_keep_the_floors() -> None:
    report = lint_imports(TOP)
    assert report.returncode == 0, report.stdout + report.stderr
    assert "3 kept, 0 broken" in report.stdout


@pytest.mark.parametrize(
    ("module", "imported"),
    [
        ("biped_common/a.py", "msgs_json"),
        ("msgs_json/a.py", "biped_description"),
        ("msgs_json/a.py", "biped_ros"),
        ("biped_ros/a.py", "trajectory_node"),
        ("biped_description/a.py", "sim_node"),
        ("sim_node/a.py", "learner_node"),
        ("trajectory_node/a.py", "sim_node"),
        ("learner_node/a.py", "biped_bringup"),
        ("learner_node/a.py", "biped_bag"),
        ("biped_bag/a.py", "ros2_verbs"),
        ("ros2_verbs/a.py", "biped_bringup"),
        ("biped_bringup/a.py", "biped_lab"),
        ("learner_node/a.py", "pybullet"),
        ("biped_lab/a.py", "pybullet"),
        ("sim_node/a.py", "pybullet"),
        ("sim_node/a.py", "mujoco"),
        ("sim_node/a.py", "rclpy"),
        ("sim_node/a.py", "rclpy.node"),
    ],
)
def test_a_forbidden_import_is_refused(house: Path, module: str, imported: str) -> None:
    (house / module).write_text(f"import {imported}\n")
    report = lint_imports(house)
    assert report.returncode == 1
    assert "2 kept, 1 broken" in report.stdout


@pytest.mark.parametrize(
    ("module", "imported"),
    [
        ("biped_lab/a.py", "msgs_json"),
        ("biped_bringup/a.py", "sim_node"),
        ("sim_node/bullet_api.py", "pybullet"),
        ("sim_node/mujoco_world.py", "mujoco"),
        ("sim_node/node.py", "rclpy"),
        ("sim_node/node.py", "rclpy.node"),
        ("biped_ros/a.py", "rclpy"),
        ("biped_bag/a.py", "learner_node"),
    ],
)
def test_a_downward_import_is_let_through(
    house: Path, module: str, imported: str
) -> None:
    (house / module).write_text(f"import {imported}\n")
    report = lint_imports(house)
    assert report.returncode == 0, report.stdout + report.stderr
