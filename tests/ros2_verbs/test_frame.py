"""`ros2` itself: commands, completion, the hand-over to a real installation."""

import argparse
import io
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import ros2_verbs
from biped_common.entry_points import entry_points
from ros2_verbs import doctor
from ros2_verbs.doctor import hello
from ros2_verbs.errors import VerbError
from ros2_verbs.graph.names import print_listed
from ros2_verbs.main import COMMANDS, main, make_parser, run
from ros2_verbs.options import completed
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


def test_what_verbs_print_cannot_act_on_a_terminal(
    capsys: pytest.CaptureFixture[str],
) -> None:
    def fail(_: argparse.Namespace) -> int:
        print("\x1b[2J")
        raise VerbError("\x9b1m")

    assert run(argparse.Namespace(run=fail)) == 1
    assert capsys.readouterr() == ("\\x1b[2J\n", "\\x9b1m\n")


def test_names_on_the_graph_make_no_lines_of_their_own(
    capsys: pytest.CaptureFixture[str],
) -> None:
    print_listed(argparse.Namespace(only_count=False), ["/a\n/b\t\x1b"])
    assert capsys.readouterr().out == "/a\\n/b\\t\\x1b\n"


def test_names_that_act_on_a_terminal_are_not_completed() -> None:
    parser = argparse.ArgumentParser()
    action = parser.add_argument("name")
    completed(action, lambda **_: ["/good", "/bad\x1b[2J"])
    assert action.completer() == ["/good"]  # type: ignore[attr-defined]


def test_a_command_can_be_called_itself_and_have_verbs() -> None:
    parser = make_parser(["doctor"])
    assert parser.parse_args(["doctor", "-r"]).run is doctor.main
    parser = make_parser(["wtf", "hello"])
    assert parser.parse_args(["wtf", "hello", "-1"]).run is hello.main


def test_there_is_no_daemon(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["daemon", "status"]) == 0
    assert capsys.readouterr().out == "The daemon is not running\n"
