"""A folder is one run's at a time."""

import fcntl
import os
import signal
import subprocess
import sys

import pytest

from biped_common.command_line import CommandError
from biped_common.exclusive_folder import exclusive_folder

HOLD = """
import sys
from pathlib import Path
from biped_common.exclusive_folder import exclusive_folder
with exclusive_folder(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def holder(tmp_path):
    """A process that holds the folder."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.communicate()


def test_the_refusal_names_the_process_that_has_the_folder(holder, tmp_path):
    named = pytest.raises(CommandError, match=rf"{tmp_path}: .* process {holder.pid};")
    with named, exclusive_folder(tmp_path):
        pass


def test_a_refusal_leaves_the_holder_its_folder(holder, tmp_path):
    for _ in range(2):
        refused = pytest.raises(CommandError, match=str(holder.pid))
        with refused, exclusive_folder(tmp_path):
            pass


def test_a_process_that_is_killed_leaves_no_lock(holder, tmp_path):
    holder.send_signal(signal.SIGKILL)
    holder.wait()
    with exclusive_folder(tmp_path):
        pass


def test_a_child_does_not_keep_the_lock(tmp_path):
    with exclusive_folder(tmp_path):
        child = subprocess.Popen(["sleep", "60"])
    try:
        with exclusive_folder(tmp_path):
            pass
    finally:
        child.kill()
        child.wait()


def test_who_holds_it_last_is_named(tmp_path):
    (tmp_path / ".lock").write_text("99999999")
    refused = pytest.raises(CommandError, match=f"process {os.getpid()};")
    with exclusive_folder(tmp_path), refused, exclusive_folder(tmp_path):
        pass


def test_a_run_that_has_ended_leaves_nothing_behind(tmp_path):
    with exclusive_folder(tmp_path):
        assert os.listdir(tmp_path) == [".lock"]
    assert os.listdir(tmp_path) == []


def test_a_lock_whose_file_its_holder_has_just_removed_is_none(tmp_path, monkeypatch):
    flock, path = fcntl.flock, tmp_path / ".lock"

    def late_flock(*arguments: int) -> None:
        """Lock, the first time after the holder of the file has ended."""
        monkeypatch.setattr(fcntl, "flock", flock)
        path.unlink()
        flock(*arguments)

    monkeypatch.setattr(fcntl, "flock", late_flock)
    refused = pytest.raises(CommandError, match=str(os.getpid()))
    with exclusive_folder(tmp_path), refused, exclusive_folder(tmp_path):
        pass
