"""Walks learned on plants that are drawn."""

import itertools
from contextlib import closing

import numpy as np
import pytest

from biped_bringup.run_settings import changed_settings, load_settings
from biped_lab.several_plants import (
    LEARNED_ON,
    PLANTS,
    DrawnPlantWalker,
    completed,
    learn,
    on,
)
from learner_node.walking.walks import static_walk
from sim_node.engines import ENGINES

SHORT = ("gait.steps=1", "gait.double_support_s=0.9")
SEED = 71


@pytest.fixture(scope="module")
def settings():
    return changed_settings(load_settings("t_ds_090"), changes=SHORT)


def test_no_plant_is_another_one(settings):
    plants = [on(settings, plant).sim for plant in PLANTS]
    assert {plant.engine for plant in plants} == set(ENGINES)
    assert all(a != b for a, b in itertools.combinations(plants, 2))


def test_what_is_learned_on_drawn_plants_is_walked_on_each(settings):
    plants = LEARNED_ON["either, drawn"]
    session = learn(settings, SEED, plants)
    assert session is not None
    assert [completed(session, settings, plant) for plant in plants] == [True, True]


def test_what_is_not_learned_in_time_is_none(settings, monkeypatch):
    monkeypatch.setattr("biped_lab.several_plants.MOST_EPISODES", 1)
    assert learn(settings, SEED, ["PyBullet"]) is None


def test_a_seed_draws_the_same_plants_again_and_all_of_them(settings):
    stumbling = changed_settings(settings, changes=["sim.limits.zmp_error_m=1.0e-9"])
    plants = [on(stumbling, name) for name in ("MuJoCo", "kinematic")]
    drawn = []
    for _ in range(2):
        engines = []
        with closing(DrawnPlantWalker(plants, np.random.default_rng(3))) as walker:
            for _ in range(12):
                walker.walk(static_walk(settings.learner, walker.walk_ticks))
                engines.append(walker.biped.settings.engine)
        drawn.append(engines)
    assert drawn[0] == drawn[1]
    assert set(drawn[0]) == {"mujoco", "kinematic"}
