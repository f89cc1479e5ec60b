"""The rivals as contestants: registered, and the same whether interrupted or not."""

import pytest
from tests.biped_lab.rivals.learners import RIVALS

from biped_bringup.run_settings import changed_settings, load_settings
from biped_lab.contestant import entry

SEED = 7


@pytest.fixture(scope="module")
def run_settings():
    return changed_settings(load_settings("quick"), changes=["sim.engine=kinematic"])


def outcome(contestant):
    table = contestant.table()
    return (
        contestant.figures(),
        {name: column.tolist() for name, column in table.items()},
    )


@pytest.mark.parametrize("name", RIVALS)
def test_one_that_was_interrupted_is_the_same(name, run_settings, tmp_path):
    made = entry(name)
    options = made.options()
    through = made.begin(run_settings, options, SEED)
    for _ in range(5):
        through.episode()
    begun = made.begin(run_settings, options, SEED)
    for _ in range(3):
        begun.episode()
    begun.save(tmp_path / "memory.npz")
    resumed = made.resume(tmp_path / "memory.npz", run_settings, options, SEED)
    for _ in range(2):
        resumed.episode()
    assert outcome(resumed) == outcome(through)
    for contestant in (through, begun, resumed):
        contestant.close()
