"""What directed blame knows of the plant is so on the plant."""

from contextlib import closing

import numpy as np
import pytest

from biped_bringup.run_settings import load_settings
from biped_bringup.walker import Walker
from biped_common.timing import TICKS_PER_LEARNING_TICK
from learner_node.walking.response import zmp_response
from learner_node.walking.settings import BlameSettings
from learner_node.walking.walks import FrozenWalk

STEP = ("gait.steps=1", "sim.limits.zmp_error_m=1.0")
PUSHED_AT, CORRECTION_M = 500, 0.02  # control tick; a single decision


def zmp_y(settings, correction_m):
    """(learning ticks,) ZMP of a walk with one decision other than nought [m]."""
    ticks = []
    walker = Walker(settings, np.random.default_rng(0), ticks.append)
    nowhere, pushed = np.zeros(2), np.array([0.0, correction_m])
    with closing(walker):
        walker.walk(
            FrozenWalk(
                settings.learner,
                walker.walk_ticks,
                lambda seen: pushed if seen.control_tick == PUSHED_AT else nowhere,
            )
        )
    return np.array([tick.contact[1] for tick in ticks])


@pytest.mark.parametrize("engine", ["kinematic", "pybullet"])
@pytest.mark.parametrize("spacing", [0.24, 0.4])
def test_the_zmp_moves_as_foretold(engine, spacing):
    settings = load_settings(
        changes=(*STEP, f"sim.engine={engine}", f"correction.knot_spacing_s={spacing}")
    )
    moved_m = zmp_y(settings, CORRECTION_M) - zmp_y(settings, 0.0)
    foretold_m = CORRECTION_M * zmp_response(BlameSettings(knot_spacing_s=spacing), 1)
    ages = np.arange(1, len(foretold_m) + 1)
    # Half a learning tick before and after: the spline's acceleration jumps at knots.
    at = PUSHED_AT + TICKS_PER_LEARNING_TICK * ages
    seen_m = np.array([moved_m[a - 6 : a + 4].mean() for a in at])
    wrong, largest = np.abs(seen_m - foretold_m), np.abs(foretold_m).max()
    assert np.percentile(wrong, 80.0) < 0.03 * largest
    assert wrong.max() < 0.2 * largest


def test_at_first_the_zmp_moves_the_other_way():
    response = zmp_response(BlameSettings(), 1)
    assert response[0] < 0.0 < response[len(response) // 2]


def test_in_the_end_nothing_is_left_of_a_correction():
    response = zmp_response(BlameSettings(), 1)
    assert len(response) == 60  # three knot spacings of 0.4 s
    assert abs(response[-1]) < 0.2 * np.abs(response).max()


def test_a_held_decision_moves_the_zmp_as_often_as_it_is_carried_out():
    each, held = (zmp_response(BlameSettings(), ticks) for ticks in (1, 5))
    np.testing.assert_allclose(held, each.reshape(-1, 5).sum(axis=1))
