"""A run that is stopped, kindly or not, goes on as if nothing had happened."""

import os
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.biped_bringup.runs import Record, quick, record
from tests.conftest import Outcome

from biped_bringup.cli.learn import INTERRUPTED
from biped_bringup.training import TrainingRun
from msgs_json.episode_result import EpisodeResult

PATIENCE_S = 300.0
LEARN = ("learn", "--json", "--preset", "quick", "--out", "out")
MORE = 3  # episodes after the interruption


def wait_for(file: Path, process: subprocess.Popen[str]) -> None:
    """Wait until a running process has made a file."""
    end = time.monotonic() + PATIENCE_S
    while not file.exists():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < end, f"no {file.name} yet"
        time.sleep(0.01)


def stopped(launch, tmp_path: Path, number: signal.Signals) -> Outcome:
    """Learn without end, saving after every episode; stop once something is saved."""
    process = launch(*LEARN, "--checkpoint-every", 0)
    wait_for(tmp_path / "out" / "memory.npz", process)
    process.send_signal(number)
    out, err = process.communicate(timeout=PATIENCE_S)
    return Outcome(process.returncode, out, err)


def record_of(file: Path) -> tuple[int, Record]:
    """Episodes and record of a saved run."""
    run = TrainingRun.load(file)
    run.close()
    return run.episodes, record(run)


def test_a_killed_run_is_as_good_as_its_last_save(
    launch, biped_process, uninterrupted, tmp_path
):
    assert stopped(launch, tmp_path, signal.SIGKILL).status == -signal.SIGKILL
    memory_file = tmp_path / "out" / "memory.npz"
    saved, _ = record_of(memory_file)
    resume = ("learn", "--json", "--resume", memory_file, "--episodes", saved + MORE)
    resumed = biped_process(*resume).values
    alone = uninterrupted(quick()).after(saved + MORE)
    assert resumed["episodes"] == saved + MORE
    assert resumed["memory_sha256"] == alone.memory_sha256
    assert resumed["trajectory_sha256"] == alone.trajectory_sha256


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_run_asked_to_stop_goes_on_where_it_stopped(
    launch, biped, uninterrupted, tmp_path, number
):
    outcome = stopped(launch, tmp_path, number)
    assert outcome.status == INTERRUPTED == 130
    memory_file = tmp_path / "out" / "memory.npz"
    saved, saved_record = record_of(memory_file)
    assert saved == outcome.values["episodes"]
    assert saved_record == uninterrupted(quick()).after(saved)
    biped("learn", "--json", "--resume", memory_file, "--episodes", saved + MORE)
    assert record_of(memory_file)[1] == uninterrupted(quick()).after(saved + MORE)


@pytest.fixture
def interrupted_learning(biped, monkeypatch) -> Callable[..., Outcome]:
    """Learn in this process, with a Ctrl-C in the midst of every episode."""
    episode = TrainingRun.episode

    def interrupted(run: TrainingRun) -> EpisodeResult:
        os.kill(os.getpid(), signal.SIGINT)
        return episode(run)

    monkeypatch.setattr(TrainingRun, "episode", interrupted)
    return lambda *options: biped("learn", "--preset", "quick", *options)


def test_an_interruption_lets_the_running_episode_end(interrupted_learning):
    assert interrupted_learning("--json").values["episodes"] == 1


def test_an_interrupted_run_says_how_to_go_on(interrupted_learning):
    out = interrupted_learning("--out", "mine").out
    assert "interrupted; all episodes so far are saved" in out
    assert "biped learn --resume mine/memory.npz" in out


def test_learning_gives_the_signals_back(interrupted_learning):
    before = [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)]
    interrupted_learning()
    after = [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM)]
    assert after == before
