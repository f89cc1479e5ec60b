"""The install: exactly what is locked, whatever the index or pip's settings say."""

import hashlib
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parents[1]
PATIENCE_S = 120.0


def add_release(index: Path, name: str, version: str, *requirements: str) -> str:
    """Put a wheel into a folder that serves as an index; return its lock line."""
    wheel = index / name / f"{name}-{version}-py3-none-any.whl"
    wheel.parent.mkdir(parents=True, exist_ok=True)
    info = f"{name}-{version}.dist-info"
    metadata = [f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n"]
    metadata += [f"Requires-Dist: {each}\n" for each in requirements]
    metadata += ["Provides-Extra: more\n"]
    with zipfile.ZipFile(wheel, "w") as file:
        file.writestr(f"{name}.py", f"version = {version!r}\n")
        file.writestr(f"{info}/METADATA", "".join(metadata))
        file.writestr(
            f"{info}/WHEEL",
            "Wheel-Version: 1.0\nGenerator: t\nRoot-Is-Purelib: true\n"
            "Tag: py3-none-any\n",
        )
        file.writestr(f"{info}/RECORD", "")
    links = "".join(
        f'<a href="{each.name}">{each.name}</a>\n'
        for each in sorted(wheel.parent.glob("*.whl"))
    )
    (wheel.parent / "index.html").write_text(f"<!DOCTYPE html>\n{links}")
    digest = hashlib.sha256(wheel.read_bytes()).hexdigest()
    return f"{name}=={version} --hash=sha256:{digest}\n"


class Checkout:
    """The project's Makefile over a lock of two toy packages."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "checkout"
        self.index = folder / "index"
        (self.folder / "requirements").mkdir(parents=True)
        shutil.copy(TOP / "Makefile", self.folder)
        shutil.copytree(
            TOP / "requirements", self.folder / "requirements", dirs_exist_ok=True
        )
        # As pytest-cov asks for coverage[toml]: an extra makes pip resolve anew.
        lock = add_release(self.index, "alpha", "1.0", "beta[more]>=1.0")
        lock += add_release(self.index, "beta", "1.0")
        (self.folder / "requirements" / "run.lock").write_text(lock)
        add_release(self.index, "setuptools", "0.0", "no-such-package")
        (self.folder / "pyproject.toml").write_text(
            '[build-system]\nrequires = []\nbackend-path = ["."]\n'
            'build-backend = "backend"\n[project]\nname = "toy"\nversion = "1"\n'
        )
        shutil.copy(
            Path(__file__).with_name("toy_backend.py"), self.folder / "backend.py"
        )

    def make(
        self,
        target: str,
        uv: str = f"UV={TOP}/.venv/installer/bin/uv",
        **environment: str,
    ) -> subprocess.CompletedProcess[str]:
        """Run make; uv itself is the project's own, and not fetched again."""
        settings = os.environ | {"UV_DEFAULT_INDEX": self.index.as_uri()} | environment
        for name in ("MAKEFLAGS", "MAKELEVEL", "VIRTUAL_ENV"):
            settings.pop(name, None)
        return subprocess.run(
            ["make", "-s", target, uv],
            cwd=self.folder,
            env=settings,
            capture_output=True,
            text=True,
            timeout=PATIENCE_S,
        )

    def installed(self) -> dict[str, str]:
        """Return the versions in the checkout's environment."""
        script = (
            "from importlib.metadata import distributions as d\n"
            "print(*(f'{e.name}={e.version}' for e in d()))"
        )
        done = subprocess.run(
            [self.folder / ".venv" / "bin" / "python", "-c", script],
            check=True,
            capture_output=True,
            text=True,
        )
        found = dict(word.split("=") for word in done.stdout.split())
        return {name: found[name] for name in ("alpha", "beta", "toy") if name in found}


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    """Return a checkout that nothing was installed for."""
    return Checkout(tmp_path)


LOCKED = {"alpha": "1.0", "beta": "1.0", "toy": "1"}


@pytest.mark.thorough
def test_a_newer_release_in_the_index_changes_nothing(checkout: Checkout) -> None:
    add_release(checkout.index, "beta", "2.0")
    done = checkout.make("install")
    assert (done.returncode, done.stderr) == (0, "")
    assert checkout.installed() == LOCKED


@pytest.mark.thorough
def test_settings_of_pip_and_uv_neither_speak_nor_count(
    checkout: Checkout, tmp_path: Path
) -> None:
    add_release(checkout.index, "beta", "2.0")
    constraint = tmp_path / "constraints.txt"
    constraint.write_text("beta>=2\n")
    settings = tmp_path / "pip.conf"
    settings.write_text(
        f"[global]\nconstraint = {constraint}\nextra-index-url = file:///nowhere\n"
    )
    (checkout.folder / "uv.toml").write_text(
        '[pip]\nextra-index-url = ["file:///nowhere"]\nupgrade = true\n'
    )
    done = checkout.make(
        "install", PIP_CONFIG_FILE=str(settings), PIP_FIND_LINKS="/nowhere"
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("\n") == 1
    assert checkout.installed() == LOCKED


@pytest.mark.thorough
def test_a_lock_that_lacks_a_package_is_refused(checkout: Checkout) -> None:
    lock = checkout.folder / "requirements" / "run.lock"
    lock.write_text(lock.read_text().partition("\n")[0] + "\n")
    done = checkout.make("install")
    assert done.returncode != 0
    assert "beta" in done.stderr


@pytest.mark.thorough
def test_a_file_that_was_exchanged_is_refused(checkout: Checkout) -> None:
    add_release(checkout.index, "alpha", "1.0", "beta", "gamma")
    done = checkout.make("install")
    assert done.returncode != 0
    assert "hash mismatch" in done.stderr.lower()


def test_what_only_developers_need_is_not_in_the_users_lock() -> None:
    lock = (TOP / "requirements" / "run.lock").read_text()
    names = {line.partition("==")[0] for line in lock.splitlines() if "==" in line}
    assert {"pybullet", "ros-rclpy"} <= names
    assert names.isdisjoint(
        {"pin", "pytest", "mypy", "colcon-core", "hypothesis", "ruff", "distributed"}
    )


def test_an_environment_of_another_python_is_not_begun(
    checkout: Checkout, tmp_path: Path
) -> None:
    tools = tmp_path / "tools"
    tools.mkdir()
    for tool in ("python3", "python3.11"):
        (tools / tool).write_text("#!/bin/sh\nexit 1\n")
        (tools / tool).chmod(0o755)
    done = checkout.make("install", PATH=f"{tools}:{os.environ['PATH']}")
    assert done.returncode != 0
    assert "no Python 3.11 found" in done.stderr
    assert "docs/install.md" in done.stderr
    assert not (checkout.folder / ".venv").exists()


def test_an_environment_of_another_python_is_not_gone_on_with(
    checkout: Checkout,
) -> None:
    # Without wheels for it, an hour of compiling would begin.
    python = checkout.folder / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text("#!/bin/sh\nexit 1\n")
    python.chmod(0o755)
    uv = f"UV={checkout.folder}/.venv/installer/bin/uv"
    done = checkout.make("install", uv)
    assert done.returncode != 0
    assert ".venv is not of Python 3.11" in done.stderr


def test_this_environment_holds_what_is_locked() -> None:
    done = subprocess.run(
        [TOP / ".venv/installer/bin/uv", "pip", "check", "--python", sys.executable],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert done.returncode == 0, done.stderr


def test_what_users_have_stays_when_developers_packages_come() -> None:
    script = "import gymnasium, pybullet, pytest, rclpy, std_msgs.msg"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True)
    assert done.returncode == 0, done.stderr
