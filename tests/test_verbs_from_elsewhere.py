"""Verbs and commands that come with a package outside this repository."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from biped_common.entry_points import entry_points

BIPED = "biped_bringup.cli.main"
ROS2 = "ros2_verbs.main"

MODULES = {
    "stranger": """
def add_parser(verbs, words):
    parser = verbs.add_parser("dance", help="shake a leg")
    parser.add_argument("--times", type=int, default=1)
    parser.set_defaults(run=run)

def run(options):
    print("dance " * options.times)
    return 0
""",
    "waltz": '''
"""Shake a leg in three-four time."""

def add_arguments(parser):
    parser.add_argument("--times", type=int, default=1)

def main(args):
    print("waltz " * args.times)
    return 3
''',
    "ballroom": '"""Various dances."""',
    "lame": """
def add_arguments(parser):
    raise LookupError("no leg\\nto stand on")
""",
    "wading": "def add_arguments(parser): pass",
    "rude": "import sys; sys.exit('not today')",
}
GROUPS = """
[biped.verbs]
dance = stranger:add_parser
limp = no_such_module:add_parser
[biped.bag_verbs]
dance = stranger : add_parser [extra]
[ros2.commands]
waltz = waltz
ballroom = ballroom
limp = no_such_module
[ros2.ballroom_verbs]
waltz = waltz
[ros2.topic_verbs]
waltz = waltz
limp = lame
wade = wading
bow = rude
"""


@pytest.fixture
def stranger(tmp_path: Path) -> Path:
    """Install a package of somebody else's that adds verbs, some of them broken."""
    for name, text in MODULES.items():
        (tmp_path / f"{name}.py").write_text(text.lstrip())
    metadata = tmp_path / "stranger-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: stranger\n")
    (metadata / "entry_points.txt").write_text(GROUPS)
    return tmp_path


def command(
    folder: Path, module: str, *words: str, **variables: str
) -> "subprocess.CompletedProcess[str]":
    """Run a command with what lies in a folder on its path."""
    return subprocess.run(
        [sys.executable, "-m", module, *words],
        cwd=folder,
        env=os.environ | variables,
        capture_output=True,
        text=True,
        timeout=60.0,
    )


def test_a_verb_of_somebody_elses_is_run(stranger: Path) -> None:
    done = command(stranger, BIPED, "dance", "--times", "2")
    assert (done.returncode, done.stdout.split()) == (0, ["dance", "dance"])


@pytest.mark.thorough
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


@pytest.mark.thorough
def test_a_verb_that_cannot_be_loaded_leaves_the_others_alone(stranger: Path) -> None:
    done = command(stranger, BIPED, "--help")
    assert done.returncode == 0
    assert "learn" in done.stdout
    assert "left out: verb limp of stranger" in done.stderr


@pytest.mark.parametrize("words", ["waltz", "ballroom waltz", "topic waltz"])
def test_ros2_runs_commands_and_verbs_of_somebody_elses(
    stranger: Path, words: str
) -> None:
    done = command(stranger, ROS2, *words.split(), "--times", "2")
    assert (done.returncode, done.stdout.split()) == (3, ["waltz", "waltz"])


@pytest.mark.parametrize(
    ("words", "help_line"),
    [
        ("", "    ballroom            Various dances\n"),
        ("", "    topic               Various topic related sub-commands\n"),
        ("ballroom", "    waltz               Shake a leg in three-four time\n"),
        ("topic", "    waltz               Shake a leg in three-four time\n"),
        ("topic", "    hz                  Print the average receiving rate"),
    ],
)
def test_ros2_lists_verbs_of_somebody_elses_among_its_own(
    stranger: Path, words: str, help_line: str
) -> None:
    assert help_line in command(stranger, ROS2, *words.split(), "-h").stdout


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("limp", "ModuleNotFoundError: No module named 'no_such_module'"),
        ("topic limp", "LookupError: no leg to stand on"),
        ("topic bow", "SystemExit: not today"),
        ("topic wade", "AttributeError: module 'wading' has no attribute 'main'"),
    ],
)
def test_ros2_names_what_cannot_be_loaded_with_its_package(
    stranger: Path, words: str, reason: str
) -> None:
    done = command(stranger, ROS2, *words.split())
    name = words.split()[-1]
    error = f"verb {name} of stranger cannot be loaded: {reason}\n"
    assert (done.returncode, done.stdout, done.stderr) == (1, "", error)


def test_what_is_not_there_is_left_out_of_the_help_of_ros2(stranger: Path) -> None:
    done = command(stranger, ROS2, "-h")
    assert (done.returncode, done.stderr) == (
        0,
        "left out: verb limp of stranger cannot be loaded: "
        "ModuleNotFoundError: No module named 'no_such_module'\n",
    )


def test_the_help_of_ros2_runs_nothing_of_somebody_elses(stranger: Path) -> None:
    done = command(stranger, ROS2, "topic", "-h")
    assert (done.returncode, done.stderr) == (0, "")
    assert "    bow\n" in done.stdout


def test_a_verb_that_was_not_called_for_is_not_loaded(stranger: Path) -> None:
    done = command(stranger, ROS2, "interface", "package", "std_srvs")
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("line", "offered"), [("ros2 ballr", "ballroom"), ("ros2 topic wal", "waltz")]
)
def test_verbs_of_somebody_elses_are_completed(
    stranger: Path, line: str, offered: str
) -> None:
    answer = stranger / "answer"
    command(
        stranger,
        ROS2,
        _ARGCOMPLETE="1",
        _ARGCOMPLETE_STDOUT_FILENAME=str(answer),
        COMP_LINE=line,
        COMP_POINT=str(len(line)),
    )
    assert answer.read_text().strip() == offered


def test_of_two_entry_points_of_one_name_the_first_on_the_path_counts(
    stranger: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = stranger / "stranger-1.0.dist-info" / "entry_points.txt"
    file.write_text("[biped.verbs]\nlearn = stranger:add_parser\n")
    monkeypatch.syspath_prepend(str(stranger))
    assert entry_points("biped.verbs")["learn"].module == "stranger"
