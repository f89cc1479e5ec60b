"""The same walks and the same memory: in-process, one executor, three processes."""

import time

import pytest
from tests.thorough import first_always

from biped_bringup.node_parameters import node_parameters
from biped_bringup.one_executor import OneExecutor
from biped_bringup.run_settings import load_settings
from biped_bringup.training import TrainingRun

SEED = 5
EPISODES = 20
TIMEOUT_S = 90.0


@pytest.fixture(
    scope="module",
    params=first_always([("quick", "xol"), ("t_ds_080", "xol"), ("quick", "q_lambda")]),
)
def settings(request):
    """Return the settings of a run with either learner, and beyond the paper."""
    preset, method = request.param
    return load_settings(preset, changes=[f"learner.method={method}"])


@pytest.fixture(scope="module")
def in_process(settings):
    """Return memory and trajectory hashes of the episodes learned by plain calls."""
    run = TrainingRun(settings, SEED)
    run.run(EPISODES, False, lambda _: True)
    run.close()
    return run.session.memory_sha256(), run.tally.trajectories_sha256


def test_one_executor_learns_the_same(domain, settings, in_process):
    parameters = node_parameters(
        settings,
        SEED,
        max_episodes=EPISODES,
        publish_every_ticks=10,
        listen_s=0.0,
    )
    with OneExecutor(parameters, domain) as graph:
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes == EPISODES, TIMEOUT_S)
        hashes = session.memory_sha256(), session.tally.trajectories_sha256
    assert hashes == in_process


def test_three_processes_learn_the_same(processes, tmp_path, settings, in_process):
    file = tmp_path / "memory.npz"
    parameters = node_parameters(
        settings, SEED, checkpoint_file=str(file), max_episodes=EPISODES
    )
    for name, values in parameters.flat().items():
        processes(f"{name}.node", values)
    end = time.monotonic() + TIMEOUT_S
    run = None
    while time.monotonic() < end and (run is None or run.episodes < EPISODES):
        time.sleep(0.5)
        if file.exists():
            run = TrainingRun.load(file)
            run.close()
    assert run is not None
    assert (run.session.memory_sha256(), run.tally.trajectories_sha256) == in_process
