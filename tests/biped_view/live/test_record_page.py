"""The page of a recorded walk in a real browser: a time slider instead of a graph."""

import threading
from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest
from tests.biped_view.live.conftest import until
from tests.graph.players import SAMPLE
from tests.robots import SHIPPED

from biped_view.live.page import Page, PortError
from biped_view.live.record_source import (
    NoPoseError,
    RecordSource,
    moment_at,
    traces_of,
)
from biped_view.walk_record import WalkRecord
from biped_view.walk_sources import read_walk
from msgs_json.end_cause import EndCause

TICKS = 1000


def leaning_walk():
    """Return a robot that leans ahead on both feet until it fails."""
    static_waist, left, right = (
        np.tile(point, (TICKS, 1))
        for point in ((0.0, 0.0, 0.475), (0.0, 0.09, 0.0), (0.0, -0.09, 0.0))
    )
    waist = static_waist.copy()
    waist[:, 0] = np.linspace(0.0, 0.1, TICKS)
    q = SHIPPED.leg_joint_positions(waist, left, right)
    upright = np.tile((1.0, 0.0, 0.0, 0.0), (TICKS, 1))
    both = np.ones(TICKS, dtype=np.bool_)
    return WalkRecord(
        robot=SHIPPED.settings,
        zmp_limit_m=0.065,
        walk_ticks=5625,
        joint_position_rad=q,
        joint_velocity_rad_s=np.zeros_like(q),
        joint_torque_nm=np.zeros_like(q),
        joint_reference_rad=q,
        torso_position_m=waist,
        torso_quaternion=upright,
        zmp_m=waist[:, :2],
        zmp_reference_m=static_waist[:, :2],
        waist_m=waist,
        static_waist_m=static_waist,
        left_foot_m=left,
        right_foot_m=right,
        right_support=both,
        double_support=both,
        step_index=np.zeros(TICKS, dtype=np.int64),
        correction_m=np.full((TICKS, 2), np.nan),
        end_cause=EndCause.ZMP_ERROR,
        result=None,
    )


def test_of_a_sparse_recording_all_that_is_known_is_shown():
    record = read_walk(SAMPLE).record  # of every fourth control tick
    rows = record.known_rows()
    assert 0 < len(rows) < record.ticks / 3
    moment = moment_at(record, int(rows[100]))
    assert np.isfinite(moment.joint_position_rad).all()
    traces = traces_of(record)
    assert len(traces.time_s) == 563
    assert np.isfinite(traces.zmp_error_m).all()
    peak_m = np.nanmax(np.linalg.norm(record.zmp_error_m, axis=1))
    assert traces.zmp_error_m.max() == peak_m
    assert traces.until(1.0).time_s[-1] == 1.0


def test_a_walk_without_poses_is_refused():
    record = leaning_walk()
    unknown = np.full_like(record.torso_position_m, np.nan)
    page = Page("a walk", port=0)
    with closing(page), pytest.raises(NoPoseError, match="were not recorded"):
        RecordSource(page, replace(record, torso_position_m=unknown))


def test_a_port_that_is_taken_is_refused():
    with closing(Page("a walk", port=0)) as page:
        port = int(page.address.rpartition(":")[2])
        with pytest.raises(PortError, match=f"port {port} on 127.0.0.1: Address"):
            Page("another", port)


@pytest.fixture
def record_address():
    page = Page("a walk", port=0)
    source = RecordSource(page, leaning_walk())
    over = threading.Event()
    loop = threading.Thread(target=page.run, args=(source.turn, over.is_set))
    loop.start()
    yield page.address
    over.set()
    loop.join()
    page.close()


@pytest.mark.thorough
def test_a_walk_plays_stops_and_is_scrubbed(record_address, open_tab):
    tab = open_tab(record_address)
    tab.shows("Playing")
    tab.press("Stop")
    tab.shows("Stopped")
    time_s = tab.page.locator("input[inputmode=decimal], input[type=text]").first
    time_s.fill("0.4")
    time_s.press("Enter")
    tab.shows("0.40 s, double support, right")
    until(lambda: np.ptp(tab.robot()) > 100, "the robot is drawn")
    upright = tab.robot()
    time_s.fill("1.998")
    time_s.press("Enter")
    tab.shows("ended: zmp error at 2.00 s")
    until(lambda: (abs(tab.robot() - upright) > 15).sum() > 50, "the robot leans")
    tab.page.evaluate(
        "[...document.querySelectorAll('input[type=checkbox]')].pop().click()"
    )
    until(lambda: tab.robot()[0].mean() < 100, "it is dark")
    assert tab.errors == []
