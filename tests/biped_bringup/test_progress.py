"""Progress of a run: what the line says, and that it is one line."""

import io
import re
from collections.abc import Iterator

import pytest
from rich.console import Console
from tests.biped_bringup.runs import DISTURBED, SHORT, learn, quick

from biped_bringup.cli.progress import TrainingProgress
from biped_bringup.training import TrainingRun
from msgs_json.episode_result import EpisodeResult


def go_on(_: EpisodeResult) -> bool:
    return True


@pytest.fixture(scope="module")
def run() -> Iterator[TrainingRun]:
    """Learn a little."""
    run = TrainingRun(quick(), seed=0)
    yield learn(run, 6)
    run.close()


@pytest.fixture
def plain() -> Console:
    """Build what a log file or a pipe is to the progress."""
    return Console(file=io.StringIO())


def test_the_line_tells_the_state_of_the_run(run, plain):
    line = TrainingProgress(run, plain).line()
    schedule, figures = run.session.task.schedule, run.session.learner.figures()
    assert f"target {schedule.target_ticks * 0.002:5.2f} s" in line
    assert f"successes {schedule.successes} " in line
    assert "episodes 6 " in line
    assert f"survival {100 * run.log.survival():.0f} %" in line
    assert f"basis states {figures['basis_states']}, fixed states" in line
    assert re.search(r"\d+\.\d simulated s/s$", line)


def test_the_line_tells_how_much_was_replayed(run, plain):
    share = 100 * run.walker.ticks.replayed_share
    assert f"  replayed {share:.0f} %  " in TrainingProgress(run, plain).line()


def test_the_line_says_where_nothing_is_replayed(training, plain):
    run = training(quick(*SHORT, *DISTURBED))
    assert "  replay off  " in TrainingProgress(run, plain).line()


def test_the_line_says_when_the_schedule_is_complete(training, plain):
    run = training(quick(*SHORT))
    progress = TrainingProgress(run, plain)
    assert "schedule complete" not in progress.line()
    run.run(max_episodes=100, stop_at_schedule=True, after_episode=go_on)
    assert "target  3.75 s (whole walk, schedule complete)" in progress.line()


def test_a_run_that_goes_on_is_not_credited_with_what_it_did_before(run, plain):
    assert TrainingProgress(run, plain).line().endswith(" 0.0 simulated s/s")


def test_a_run_without_an_episode_has_a_line(training, plain):
    assert (
        "episodes 0  survival 0 %" in TrainingProgress(training(quick()), plain).line()
    )


def test_the_line_is_one_line(run, plain):
    assert len(TrainingProgress(run, plain).line().splitlines()) == 1


def test_without_a_terminal_the_last_state_stays_as_one_line(run, plain):
    with TrainingProgress(run, plain):
        pass
    (line,) = plain.file.getvalue().splitlines()
    assert line.startswith("target")
    assert line.endswith("simulated s/s")


def test_without_a_terminal_no_control_characters_are_written(run, plain):
    with TrainingProgress(run, plain) as progress:
        progress.update()
    written = plain.file.getvalue()
    assert written.replace("\n", "").isprintable()
