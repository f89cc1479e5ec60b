"""A trajectory of joints, read as a joint_trajectory_controller reads it.

Straight from point to point, and where the last one leads to, for as long as nothing
else is asked for. A point may be of the past: a trajectory that is late is joined where
it should be by now.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from biped_common.timing import nanoseconds
from biped_description.joints import JOINT_NAMES
from msgs_json.wire import RefusedMessageError
from sim_node.physics import Array


class FollowedTrajectory:
    """Positions of the joints over time."""

    def __init__(self, message: Any) -> None:
        """Read a trajectory_msgs/JointTrajectory.

        Raises:
            RefusedMessageError: it does not name all joints, has no point, a number of
                it is not finite, or its points do not follow one another.
        """
        place = {name: i for i, name in enumerate(message.joint_names)}
        missing = [name for name in JOINT_NAMES if name not in place]
        if missing:
            raise RefusedMessageError(f"no positions of {', '.join(missing)}")
        rows = [point.positions for point in message.points]
        if {len(row) for row in rows} != {len(message.joint_names)}:
            raise RefusedMessageError(
                f"points of {sorted({len(row) for row in rows})} positions for "
                f"{len(message.joint_names)} joints"
            )
        columns = [place[name] for name in JOINT_NAMES]
        self._positions: Array = np.array(rows, dtype=np.float64)[:, columns]
        self._times_ns = np.array(
            [nanoseconds(each.time_from_start) for each in message.points]
        )
        if not np.isfinite(self._positions).all():
            raise RefusedMessageError("a position that is not finite")
        if (np.diff(self._times_ns) <= 0).any():
            raise RefusedMessageError("points that do not follow one another")
        self._from_ns = nanoseconds(message.header.stamp)

    def begin(self, now_ns: int) -> None:
        """Let it begin now, whatever its stamp says."""
        self._from_ns = now_ns

    def at(self, time_ns: int) -> Array:
        """Return the (12,) positions at a time [rad], in the order of JOINT_NAMES."""
        since_ns = time_ns - self._from_ns
        i = int(np.searchsorted(self._times_ns, since_ns, side="right"))
        if i in (0, len(self._times_ns)):
            i = min(i, len(self._times_ns) - 1)
            share, start, end = 0.0, self._positions[i], self._positions[i]
        else:
            before, after = self._times_ns[i - 1 : i + 1]
            share = (since_ns - before) / (after - before)
            start, end = self._positions[i - 1 : i + 1]
        position: Array = start + share * (end - start)
        return position
