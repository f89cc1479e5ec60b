"""Verbs that come with a package outside this repository."""

import subprocess
import sys
from pathlib import Path

import pytest

BIPED = "biped_bringup.cli.main"


@pytest.fixture
def stranger(tmp_path: Path) -> Path:
    """Install a package of somebody else's that adds verbs, one of them broken."""
    (tmp_path / "stranger.py").write_text(
        "def add_parser(verbs, words):\n"
        "    parser = verbs.add_parser('dance', help='shake a leg')\n"
        "    parser.add_argument('--times', type=int, default=1)\n"
        "    parser.set_defaults(run=run)\n"
        "def run(options):\n"
        "    print('dance ' * options.times)\n"
        "    return 0\n"
    )
    metadata = tmp_path / "stranger-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: stranger\n")
    (metadata / "entry_points.txt").write_text(
        "[biped.verbs]\ndance = stranger:add_parser\nlimp = no_such_module:add_parser\n"
        "[biped.bag_verbs]\ndance = stranger:add_parser\n"
    )
    return tmp_path


def command(
    folder: Path, module: str, *words: str
) -> "subprocess.CompletedProcess[str]":
    """Run a command with what lies in a folder on its path."""
    return subprocess.run(
        [sys.executable, "-m", module, *words],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=60.0,
    )


def test_a_verb_of_somebody_elses_is_run(stranger: Path) -> None:
    done = command(stranger, BIPED, "dance", "--times", "2")
    assert (done.returncode, done.stdout.split()) == (0, ["dance", "dance"])


def test_a_verb_of_somebody_elses_is_in_the_help(stranger: Path) -> None:
    assert "shake a leg" in command(stranger, BIPED, "--help").stdout


def test_a_sub_verb_of_somebody_elses_is_run(stranger: Path) -> None:
    assert command(stranger, BIPED, "bag", "dance").stdout.split() == ["dance"]


def test_a_verb_that_cannot_be_loaded_is_named_with_its_package(
    stranger: Path,
) -> None:
    done = command(stranger, BIPED, "limp")
    assert done.returncode == 2
    assert done.stderr.startswith("biped: verb limp of stranger cannot be loaded")
    assert done.stderr.count("\n") == 1


def test_a_verb_that_cannot_be_loaded_leaves_the_others_alone(stranger: Path) -> None:
    done = command(stranger, BIPED, "--help")
    assert done.returncode == 0
    assert "learn" in done.stdout
    assert "left out: verb limp of stranger" in done.stderr
