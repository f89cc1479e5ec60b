"""PPO as a contestant: without its extra, and resumed with it."""

import sys
from contextlib import closing

import pytest

from biped_bringup.run_settings import changed_settings, load_settings
from biped_common.errors import BipedError
from biped_lab.contestant import entry
from learner_node.checkpoint import CheckpointError

SETTINGS = load_settings(changes=("gait.steps=2",))
PPO = entry("stable_baselines")
OPTIONS = PPO.options()


@pytest.mark.parametrize("missing", ["stable_baselines3", "torch"])
def test_without_its_extra_the_error_says_which(missing, monkeypatch):
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(BipedError, match=r"^[^\n]*pip install 'biped\[sb3\]'[^\n]*$"):
        PPO.begin(SETTINGS, OPTIONS, 1)


def test_a_resumed_ppo_is_the_uninterrupted_one(tmp_path, monkeypatch):
    pytest.importorskip("stable_baselines3")
    monkeypatch.setenv("SB3_LOGDIR", str(tmp_path / "log"))
    file = tmp_path / "ppo.npz"
    with closing(PPO.begin(SETTINGS, OPTIONS, 1)) as whole:
        for episode in range(30):  # more than the 2,048 decisions of an update
            if episode == 20:
                whole.save(file)
            whole.episode()
        figures = whole.figures()
        assert {*whole.table()["target_ticks"]} == {SETTINGS.gait.walk_ticks}
    with closing(PPO.resume(file, SETTINGS, OPTIONS, 1)) as resumed:
        assert resumed.episodes == 20
        for _ in range(10):
            resumed.episode()
        assert resumed.figures() == figures
    assert [*tmp_path.iterdir()] == [file]


def test_a_file_of_another_ppo_is_refused_before_anything_is_learned(tmp_path):
    pytest.importorskip("stable_baselines3")
    file = tmp_path / "ppo.npz"
    with closing(PPO.begin(SETTINGS, OPTIONS, 1)) as ppo:
        ppo.episode()
        ppo.save(file)
    changed = changed_settings(SETTINGS, changes=("gait.steps=3",))
    for settings, options, what in (
        (SETTINGS, PPO.options(decisions=512), "options"),
        (changed, OPTIONS, "settings"),
    ):
        with pytest.raises(CheckpointError, match=f"it has other {what}$"):
            PPO.resume(file, settings, options, 1)


def test_its_constants_change_what_it_learns():
    pytest.importorskip("stable_baselines3")
    learned = set()
    for options in (OPTIONS, PPO.options(decisions=64), PPO.options(learning_rate=0.1)):
        with closing(PPO.begin(SETTINGS, options, 1)) as ppo:
            while ppo.figures()["simulated_ticks"] < 2100 * 10:
                ppo.episode()
            learned.add(ppo.figures()["memory_sha256"])
    assert len(learned) == 3
