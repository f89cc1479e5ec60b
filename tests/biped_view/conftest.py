"""A memory of a few episodes and a bag of its walk, made once for all tests."""

import pytest
from tests.biped_view.recorded_walk import FrozenRun, WalkedTwice, write_bag

from biped_bringup.run_settings import load_settings
from biped_bringup.training import TrainingRun
from biped_view.walked_here import walk_without_learner


@pytest.fixture(scope="session")
def walked_twice(tmp_path_factory):
    folder = tmp_path_factory.mktemp("walked_twice")
    training = TrainingRun(load_settings("quick"), seed=1)
    for _ in range(3):
        training.episode()
    memory = folder / "memory.npz"
    training.save(memory)
    run = FrozenRun(training)
    run.walk(1)
    yield WalkedTwice(run, memory, write_bag(folder / "bag", run))
    run.close()
    training.close()


@pytest.fixture(scope="session")
def static_walk():
    return walk_without_learner(load_settings())
