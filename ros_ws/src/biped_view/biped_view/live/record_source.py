"""A recorded walk as a source of the page: it is played, or scrubbed by a slider."""

from __future__ import annotations

import time
from typing import Final

import numpy as np

from biped_common.errors import BipedError
from biped_common.timing import CONTROL_PERIOD_US, TICKS_PER_LEARNING_TICK, seconds
from biped_description.robot import Robot
from biped_view.floor_scene import sole_corners
from biped_view.live.moment import Course, Moment, Traces
from biped_view.live.page import Page
from biped_view.phases import standing_feet
from biped_view.walk_record import WalkRecord, last_known

_SPEEDS: Final = {"¼": 0.25, "1": 1.0, "2": 2.0}
_AHEAD_TICKS: Final = 60
_WAY_STRIDE_TICKS: Final = 20
_REST_S: Final = 1.0
"""A walk stays at its end for so long before it begins again."""
_PERIOD_S: Final = CONTROL_PERIOD_US / 1e6


class NoPoseError(BipedError):
    """A walk of which it is not known where the robot was."""


class RecordSource:
    """Plays a recorded walk again and again, until a user moves the slider."""

    def __init__(self, page: Page, record: WalkRecord) -> None:
        """Put the robot on the page, at the walk's beginning, and walk.

        Args:
            page: to fill.
            record: of at least one control tick.

        Raises:
            NoPoseError: it does not tell where the robot was.
        """
        self._rows = record.known_rows()
        if not len(self._rows):
            raise NoPoseError("poses, joints or ZMP of the walk were not recorded")
        self._page, self._record = page, record
        self._last_s = seconds(record.ticks - 1)
        self._time_s, self._speed, self._playing = 0.0, 1.0, True
        self._turned_at = time.monotonic()
        self._ended_at: float | None = None
        page.set_stage(
            Robot(record.robot), record.zmp_limit_m, seconds(record.walk_ticks)
        )
        page.set_course(
            Course(record.static_waist_m, record.left_foot_m, record.right_foot_m)
        )
        self._traces = traces_of(record)
        self._set_slider = page.add_time_slider(self._last_s, 0.02, self._moved)
        page.add_buttons("Walk", ("Play", "Stop"), self._pressed)
        page.add_buttons("Speed", tuple(_SPEEDS), self._paced)
        self._show(0.0)

    def turn(self) -> None:
        """Play on."""
        now = time.monotonic()
        passed_s, self._turned_at = now - self._turned_at, now
        if not self._playing:
            return
        if self._ended_at is not None:
            if now - self._ended_at < _REST_S:
                return
            self._ended_at, self._time_s = None, 0.0
        else:
            self._time_s = min(self._last_s, self._time_s + self._speed * passed_s)
            if self._time_s == self._last_s:
                self._ended_at = now
        self._set_slider(round(self._time_s, 2))
        self._show(self._time_s)

    def _moved(self, time_s: float) -> None:
        self._playing, self._ended_at, self._time_s = False, None, time_s
        self._show(time_s)

    def _pressed(self, button: str) -> None:
        self._playing = button == "Play"
        self._show(self._time_s)

    def _paced(self, button: str) -> None:
        self._speed = _SPEEDS[button]

    def _show(self, time_s: float) -> None:
        record, page = self._record, self._page
        tick = min(record.ticks - 1, round(time_s / _PERIOD_S))
        row = int(last_known(self._rows, [tick])[0])
        page.show_moment(lambda: moment_at(record, row))
        page.show_traces(lambda: self._traces.until(seconds(tick + 1)))
        phase = "double support" if record.double_support[tick] else "single support"
        side = "right" if record.right_support[tick] else "left"
        detail = f"{time_s:.2f} s, {phase}, {side}"
        if tick == record.ticks - 1 and record.end_cause is not None:
            cause = str(record.end_cause).replace("_", " ")
            detail = f"ended: {cause} at {time_s:.2f} s"
        page.show_state("Playing" if self._playing else "Stopped", detail, good=True)


def moment_at(record: WalkRecord, row: int) -> Moment:
    """Return what is to be seen of a walk at a row of which all is known."""
    feet = np.array(standing_feet(record, row)).reshape(-1, 2)
    return Moment(
        torso_position_m=record.torso_position_m[row],
        torso_quaternion=record.torso_quaternion[row],
        joint_position_rad=record.joint_position_rad[row],
        zmp_m=record.zmp_m[row],
        zmp_reference_m=record.zmp_reference_m[row],
        support_m=sole_corners(record.robot, feet),
        waist_m=record.waist_m[: row + 1 : _WAY_STRIDE_TICKS],
        waist_ahead_m=record.waist_m[row : row + _AHEAD_TICKS],
    )


def traces_of(record: WalkRecord) -> Traces:
    """Return what was measured along a walk, a row per learning tick.

    The ZMP error is the worst of those that were recorded in the learning tick; NaN
    where none was.
    """
    ends = np.arange(TICKS_PER_LEARNING_TICK, record.ticks, TICKS_PER_LEARNING_TICK)
    ends = np.append(ends, record.ticks)  # also of the piece in which it ended
    error = np.linalg.norm(record.zmp_error_m, axis=1)
    worst = np.fmax.reduceat(error, ends - np.diff(ends, prepend=0))
    time_s = np.array([seconds(int(end)) for end in ends])
    return Traces(time_s, worst, record.correction_m[ends - 1])
