"""The wheel: all packages with their data, no tests, and a `biped` that works."""

import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[1]
PACKAGES = sorted(file.parent for file in TOP.glob("ros_ws/src/*/package.xml"))
PATIENCE_S = 240.0


def pip(*arguments: object) -> None:
    """Run this environment's pip, without a look at the network."""
    subprocess.run(
        [sys.executable, "-m", "pip", "--quiet", *map(str, arguments)],
        check=True,
        capture_output=True,
        timeout=PATIENCE_S,
    )


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the wheel."""
    folder = tmp_path_factory.mktemp("wheel")
    pip("wheel", "--no-deps", "--no-index", "--no-build-isolation", "-w", folder, TOP)
    (file,) = folder.glob("*.whl")
    return file


def test_the_wheel_contains_code_and_data_of_all_packages(wheel: Path) -> None:
    wanted = {
        file.relative_to(package).as_posix()
        for package in PACKAGES
        for file in package.glob(f"{package.name}/**/*")
        if file.is_file() and "__pycache__" not in file.parts
    }
    assert wanted - set(zipfile.ZipFile(wheel).namelist()) == set()


def test_the_wheel_contains_nothing_else(wheel: Path) -> None:
    folders = {name.split("/")[0] for name in zipfile.ZipFile(wheel).namelist()}
    (metadata,) = (folder for folder in folders if folder.endswith(".dist-info"))
    assert folders - {metadata} == {package.name for package in PACKAGES}


@pytest.mark.thorough
def test_biped_works_from_the_wheel(wheel: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "venv"
    venv.create(elsewhere, symlinks=True)
    paths = {"base": str(elsewhere), "platbase": str(elsewhere)}
    site_packages = Path(sysconfig.get_path("purelib", vars=paths))
    # What the wheel depends on is borrowed from here. A path in a .pth file is taken
    # without the .pth files in that folder, so that the checkout is not seen.
    borrowed = site_packages / "borrowed.pth"
    borrowed.write_text(sysconfig.get_path("purelib") + "\n")
    python = elsewhere / "bin" / "python"
    pip("--python", python, "install", "--no-deps", "--no-index", wheel)
    shown = subprocess.run(
        [python, "-c", "import biped_bringup; print(biped_bringup.__file__)"],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert Path(shown.stdout.strip()).is_relative_to(site_packages)
    checked = subprocess.run(
        [elsewhere / "bin" / "biped", "check", "--preset", "quick"],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert checked.returncode == 0, checked.stderr
    assert checked.stdout.startswith("valid")
