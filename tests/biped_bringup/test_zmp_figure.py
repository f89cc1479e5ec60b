"""The picture of a walk is drawn however far the walk came."""

from pathlib import Path

import numpy as np
import pytest
from tests.biped_bringup.runs import SHORT, quick

from biped_bringup.walker import Walker
from biped_bringup.zmp_figure import ZmpTrace, draw_zmp
from learner_node.walking.walks import FrozenWalk, static_walk

SETTINGS = quick(*SHORT)


@pytest.fixture
def drawn(tmp_path: Path):
    """Walk for so many control ticks and draw it; return the trace and the picture."""
    trace = ZmpTrace()
    walker = Walker(SETTINGS, np.random.default_rng(0), trace.add)

    def draw(responder: FrozenWalk | None, name: str = "zmp.png") -> Path:
        if responder is not None:
            walker.walk(responder)
        picture = tmp_path / name
        draw_zmp(
            trace,
            walker.reference.plan,
            SETTINGS.robot,
            SETTINGS.sim.limits,
            picture,
        )
        return picture

    draw.trace, draw.walk_ticks = trace, walker.walk_ticks
    yield draw
    walker.close()


def test_a_completed_walk_is_drawn(drawn):
    picture = drawn(static_walk(SETTINGS.learner, drawn.walk_ticks))
    assert len(drawn.trace.error_m) == drawn.walk_ticks
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_walk_that_failed_is_drawn_as_far_as_it_came(drawn):
    leaning = FrozenWalk(SETTINGS.learner, 10_000, lambda _: np.array([0.2, 0.2]))
    picture = drawn(leaning)
    assert 0 < len(drawn.trace.error_m) < drawn.walk_ticks
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_walk_of_one_learning_tick_is_drawn(drawn):
    walked = drawn(static_walk(SETTINGS.learner, 10))
    assert walked.read_bytes().startswith(b"\x89PNG")


def test_a_walk_that_never_began_is_drawn(drawn):
    assert drawn(None).read_bytes().startswith(b"\x89PNG")


def test_the_suffix_gives_the_format(drawn):
    assert b"<svg" in drawn(None, "zmp.svg").read_bytes()


def test_the_trace_has_what_was_measured(drawn):
    drawn(static_walk(SETTINGS.learner, 100))
    zmp = np.array(drawn.trace.zmp_m)
    assert zmp.shape == (100, 2)
    # Standing still, the ZMP stays between the feet and near its reference.
    assert np.abs(zmp).max() < 0.1
    assert max(drawn.trace.error_m) < 0.065
