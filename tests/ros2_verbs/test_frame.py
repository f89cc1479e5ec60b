"""`ros2` itself: commands, completion, the hand-over to a real installation."""

import io
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import ros2_verbs
from biped_common.verbs import entry_points
from ros2_verbs.main import COMMANDS, main, make_parser
from ros2_verbs.real_ros2 import HANDED_OVER, find, foreign_environment

OURS = "#!/somewhere/python\nfrom ros2_verbs.main import main\n"
TIMEOUT_S = 60.0


def program(folder: Path, text: str) -> Path:
    folder.mkdir(exist_ok=True)
    file = folder / "ros2"
    file.write_text(text)
    file.chmod(0o755)
    return file


def completions(line: str, tmp_path: Path) -> list[str]:
    """Return what TAB offers behind a line, by argcomplete's protocol."""
    answer = tmp_path / "answer"
    environment = os.environ | {
        "_ARGCOMPLETE": "1",
        "_ARGCOMPLETE_IFS": "\n",
        "_ARGCOMPLETE_STDOUT_FILENAME": str(answer),
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
    }
    subprocess.run(
        [sys.executable, "-m", "ros2_verbs.main"],
        env=environment,
        timeout=TIMEOUT_S,
        check=True,
    )
    return [word.strip() for word in answer.read_text().splitlines()]


def test_every_module_that_is_a_verb_is_offered_as_one() -> None:
    folder = Path(ros2_verbs.__file__).parent
    written = {
        f"ros2_verbs.{file.parent.name}.{file.stem}"
        for file in folder.glob("*/[a-z]*.py")
        if "\ndef main(" in file.read_text()
    }
    offered = {
        point.module
        for command in entry_points(COMMANDS)
        for point in entry_points(f"ros2.{command}_verbs").values()
    }
    assert written == offered


def test_only_the_chosen_verb_has_its_options() -> None:
    parser = make_parser(["topic", "list"])
    assert parser.parse_args(["topic", "list", "-t"]).show_types
    with pytest.raises(SystemExit):
        parser.parse_args(["topic", "info", "/x"])


def test_without_a_verb_the_help_is_printed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["topic"]) == 0
    assert "Print the average receiving rate to screen" in capsys.readouterr().out


@pytest.mark.parametrize("command", [None, *entry_points(COMMANDS)])
def test_help_lists_each_verb_with_one_line(
    command: str | None, capsys: pytest.CaptureFixture[str]
) -> None:
    verbs = entry_points(f"ros2.{command}_verbs" if command else COMMANDS)
    with pytest.raises(SystemExit) as ended:
        main([*([command] if command else []), "--help"])
    assert ended.value.code == 0
    shown, errors = capsys.readouterr()
    assert errors == ""
    for verb in verbs:
        assert re.search(rf"^    {verb} +[A-Z]", shown, re.MULTILINE), verb


def test_an_unknown_verb_is_wrong_usage(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["topic", "lst"])
    assert ended.value.code == 2
    assert "invalid choice: 'lst'" in capsys.readouterr().err


def test_verbs_are_completed(tmp_path: Path) -> None:
    assert completions("ros2 topic e", tmp_path) == ["echo"]


def test_types_are_completed(tmp_path: Path) -> None:
    offered = completions("ros2 topic pub /x geometry_msgs/msg/Twist", tmp_path)
    assert offered[:2] == ["geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"]


def test_a_reader_that_leaves_ends_the_verb_in_silence() -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "ros2_verbs.main", "interface", "list"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stdout is not None and process.stderr is not None
    process.stdout.close()
    assert process.wait(TIMEOUT_S) == 1
    assert process.stderr.read() == b""
    process.stderr.close()


def test_a_real_ros2_further_on_the_path_is_found(tmp_path: Path) -> None:
    ours = program(tmp_path / "venv", OURS)
    real = program(tmp_path / "opt", "#!/bin/sh\n")
    assert find(f"{ours.parent}:{tmp_path / 'nowhere'}:{real.parent}") == real


def test_copies_of_ours_are_passed_over(tmp_path: Path) -> None:
    program(tmp_path / "venv", OURS)
    program(tmp_path / "other_venv", OURS)
    assert find(f"{tmp_path / 'venv'}:{tmp_path / 'other_venv'}") is None


def test_the_wheels_environment_is_cleaned() -> None:
    clean = foreign_environment(
        {
            "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1",
            "LD_LIBRARY_PATH": "/venv/lib:/opt/ros/jazzy/lib:/venv/lib/ros_rcl.libs",
            "PYTHONPATH": "/venv/lib/python3.11/site-packages",
            "AMENT_PREFIX_PATH": "/opt/ros/jazzy",
            "ROS_DOMAIN_ID": "7",
        },
        prefix="/venv",
    )
    assert clean == {
        "LD_LIBRARY_PATH": "/opt/ros/jazzy/lib",
        "AMENT_PREFIX_PATH": "/opt/ros/jazzy",
        "ROS_DOMAIN_ID": "7",
        HANDED_OVER: "1",
    }


def test_a_real_ros2_is_started_instead_with_our_words(tmp_path: Path) -> None:
    real = program(tmp_path / "opt", '#!/bin/sh\necho "$@"\nenv\nexit 7\n')
    answer = subprocess.run(
        [sys.executable, "-m", "ros2_verbs.main", "topic", "list", "-t"],
        env=os.environ | {"PATH": f"{real.parent}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    words, *environment = io.StringIO(answer.stdout).read().splitlines()
    assert (answer.returncode, words) == (7, "topic list -t")
    assert not [line for line in environment if "_ROS_WHEELS_BOOTSTRAP" in line]
    libraries = [line for line in environment if line.startswith("LD_LIBRARY_PATH=")]
    assert not any(sys.prefix in line for line in libraries)
