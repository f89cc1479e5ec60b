"""`biped up` with a memory whose settings are changed: the nodes get what was asked."""

import pytest
import yaml
from tests.biped_bringup.runs import SHORT, quick

from biped_bringup.training import TrainingRun
from learner_node.checkpoint import read_checkpoint
from msgs_json.end_cause import EndCause

# Enough to throw the ZMP far beyond its limit in the first second.
PUSHED = ("sim.disturbances.push_force_n=200", "sim.disturbances.push_time_s=0.5")


@pytest.fixture
def learned(tmp_path):
    """A folder with the memory of a learned short walk, and after how many episodes."""
    run = TrainingRun(quick(*SHORT), seed=0)
    run.run(None, False, lambda _: True)
    run.save(tmp_path / "memory.npz")
    run.close()
    return run.episodes


@pytest.fixture
def up(biped_process, domain, tmp_path):
    """Run `biped up` in the folder with these changes of settings."""
    fixed = ("--record", "none", "--out", tmp_path, "--domain", domain)

    def run(*options, changes):
        sets = [word for change in changes for word in ("--set", change)]
        return biped_process("up", *fixed, *options, *sets)

    return run


def parameters(folder, node):
    """Return the parameters that a node was started with."""
    (values,) = yaml.safe_load((folder / f"{node}.yaml").read_text()).values()
    return values["ros__parameters"]


@pytest.mark.thorough
def test_a_learned_memory_learns_on_against_a_push_and_a_longer_schedule(
    learned, up, tmp_path
):
    changes = (*PUSHED, "learner.schedule.successes_per_subtask=2")
    ended = up("--resume", "--episodes", learned + 1, changes=changes)
    assert ended.status == 1, ended.err
    assert "other settings: sim.disturbances.push_force_n 0.0 -> 200.0" in ended.err
    sim, learner = (parameters(tmp_path, f"{name}_node") for name in ("sim", "learner"))
    assert sim["sim.disturbances.push_force_n"] == 200.0
    assert learner["learner.schedule.successes_per_subtask"] == 2
    header, arrays = read_checkpoint(tmp_path / "memory.npz")
    assert header["settings"]["sim"]["disturbances"]["push_force_n"] == 200.0
    assert header["settings"]["learner"]["schedule"]["successes_per_subtask"] == 2
    causes = [tuple(EndCause)[cause] for cause in arrays["log/end_cause"]]
    assert causes[learned - 1 : learned + 1] == [EndCause.COMPLETED, EndCause.ZMP_ERROR]


@pytest.mark.thorough
def test_a_greedy_walk_is_pushed_and_leaves_its_memory_as_it_was(learned, up, tmp_path):
    before = (tmp_path / "memory.npz").read_bytes()
    ended = up("--greedy", "--seed", 5, changes=PUSHED)
    assert ended.status == 1, ended.err
    assert "greedy walk: zmp_error after 0.5" in ended.out
    assert parameters(tmp_path, "sim_node")["seed"] == 5
    assert (tmp_path / "memory.npz").read_bytes() == before
