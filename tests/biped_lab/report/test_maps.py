from pathlib import Path

import numpy as np
import pytest
from tests.biped_lab.report.made_results import made_results, runs_of

from biped_bringup.run_settings import load_settings
from biped_bringup.training import TrainingRun
from biped_lab.report.finished import finished_runs
from biped_lab.report.maps import (
    NoMapError,
    draw_maps,
    learned_maps,
    median_run,
    read_map,
)
from biped_lab.run_folder import MEMORY_FILE

EPISODES = 8


@pytest.fixture(scope="module")
def learned(tmp_path_factory: pytest.TempPathFactory) -> tuple[TrainingRun, Path]:
    run = TrainingRun(load_settings("quick"), seed=31)
    for _ in range(EPISODES):
        run.episode()
    path = tmp_path_factory.mktemp("memory") / MEMORY_FILE
    run.save(path)
    run.close()
    return run, path


def test_a_map_has_the_states_of_the_memory(
    learned: tuple[TrainingRun, Path],
) -> None:
    run, path = learned
    found, figures = read_map(path), run.session.learner.figures()
    assert len(found.waist_m) == figures["basis_states"]
    assert found.fixed.sum() == figures["fixed_states"] > 0
    assert found.penalty.sum() == figures["penalty_states"]
    alternatives = run.settings.learner.action.alternatives
    assert found.visits.min() >= 1
    assert found.visits.max() <= EPISODES * alternatives


def test_the_corrections_are_what_the_learner_would_choose_there(
    learned: tuple[TrainingRun, Path],
) -> None:
    run, path = learned
    found, memory = read_map(path), run.session.learner.memory()
    radii = np.array(run.settings.learner.inputs.radii)
    for k, correction_m in enumerate(found.correction_m):
        centre = radii * memory["state_centers"][k]
        chosen = run.session.learner.greedy(
            np.concatenate([memory["state_discrete"][k], centre])
        )
        assert chosen is not None
        assert np.array_equal(correction_m, run.session.task.correction_m(chosen))
        assert np.array_equal(found.waist_m[k], centre[:2])


def test_a_memory_of_another_learner_has_no_map(tmp_path: Path) -> None:
    settings = load_settings("quick", changes=["learner.method=q_lambda"])
    run = TrainingRun(settings, seed=31)
    run.save(tmp_path / MEMORY_FILE)
    run.close()
    with pytest.raises(NoMapError, match="not one of profit sharing"):
        read_map(tmp_path / MEMORY_FILE)


def test_the_run_in_the_middle_is_shown(tmp_path: Path) -> None:
    finished = finished_runs(made_results(tmp_path, runs_of("K = 3", 9, 12, 8)))
    assert median_run(finished, "K = 3") == (11, "K=3-11")


def test_memories_that_are_absent_or_damaged_are_told(
    tmp_path: Path, learned: tuple[TrainingRun, Path]
) -> None:
    runs = [run for arm in ("K = 1", "K = 3", "K = none") for run in runs_of(arm, 5)]
    results = made_results(tmp_path, runs)
    content = learned[1].read_bytes()
    (results.run_folder("K=1-11") / MEMORY_FILE).write_bytes(content)
    (results.run_folder("K=3-11") / MEMORY_FILE).write_bytes(content[:1000])
    finished = finished_runs(results)
    maps, missing = learned_maps(finished)
    assert list(maps) == [("K = 1", 11)]
    assert len(draw_maps(finished, maps).axes) == 3 + 1
    damaged, absent = missing
    assert "K = 3, seed 11" in damaged
    assert absent == "K = none, seed 11: its memory is not there."
