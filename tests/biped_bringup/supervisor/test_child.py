"""A node as a child process."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from biped_bringup.supervisor.child import Child

# Starts a module that prints one line and ends, and prints what came of it.
START = """
import os, sys
from pathlib import Path
from biped_bringup.supervisor.child import Child
folder = Path(sys.argv[1])
child = Child("node", "platform", (), os.environ, folder / "log",
              lambda name, line: None)
child.start()
assert child.wait(30.0)
print(os.getpid(), child.exit_status, child.last_line)
"""


def own_processes() -> list[str]:
    """Return the words that give a command process ids of its own, from 1 on."""
    words = ["unshare", "--pid", "--fork", "--mount-proc"]
    if shutil.which("unshare") is None:
        pytest.skip("no unshare here")
    if subprocess.run([*words, "true"], capture_output=True).returncode != 0:
        pytest.skip("no name spaces for process ids here")
    return words


def started(folder: Path, *words: str) -> list[str]:
    done = subprocess.run(
        [*words, sys.executable, "-c", START, str(folder)],
        capture_output=True,
        text=True,
        timeout=60.0,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split(maxsplit=2)


def test_on_a_full_disk_all_that_a_child_prints_is_shown(tmp_path, monkeypatch) -> None:
    lines = 5000  # more than fits into the pipe of a reader that has stopped
    (tmp_path / "talker.py").write_text(f"for n in range({lines}): print('line', n)")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    shown: list[str] = []
    child = Child(
        "node", "talker", (), os.environ, Path("/dev/full"),
        lambda _, line: shown.append(line),
    )  # fmt: skip
    child.start()
    assert child.wait(30.0)
    assert (len(shown), child.exit_status) == (lines, 0)
    assert child.log_failure == "/dev/full: No space left on device"


def test_a_child_runs_and_its_last_line_is_kept(tmp_path: Path) -> None:
    _, status, line = started(tmp_path)
    assert status == "0"
    assert line.startswith("Linux")


def test_process_1_of_a_container_can_supervise(tmp_path: Path) -> None:
    pid, status, line = started(tmp_path, *own_processes())
    assert (pid, status) == ("1", "0")
    assert line.startswith("Linux")
