"""A trajectory of joints, read as a joint_trajectory_controller reads it.

From where the joints are asked to be now straight to the first point, from there to the
next one, and where the last one leads to, for as long as nothing else is asked for. A
point may be of the past: a trajectory that is late is joined where it should be by now;
one that has ended by then is refused. A stamp of 0 means now.
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

    def __init__(self, message: Any, now_ns: int, position: Array) -> None:
        """Read a trajectory_msgs/JointTrajectory.

        Args:
            message: as it came.
            now_ns: the robot's time.
            position: (12,) that the joints are asked for now [rad].

        Raises:
            RefusedMessageError: it does not name these joints and no others, has no
                point, a number of it is not finite, its points do not follow one
                another, or the last one is of the past.
        """
        names = list(message.joint_names)
        if sorted(names) != sorted(JOINT_NAMES):
            other = sorted(set(names) ^ set(JOINT_NAMES)) or ["some joint twice"]
            raise RefusedMessageError(f"joints: {', '.join(other)} too many or missing")
        rows = [point.positions for point in message.points]
        if {len(row) for row in rows} != {len(names)}:
            raise RefusedMessageError(
                f"points of {sorted({len(row) for row in rows})} positions for "
                f"{len(names)} joints"
            )
        columns = [names.index(name) for name in JOINT_NAMES]
        positions: Array = np.array(rows, dtype=np.float64)[:, columns]
        if not np.isfinite(positions).all():
            raise RefusedMessageError("a position that is not finite")
        since_ns = np.array([nanoseconds(p.time_from_start) for p in message.points])
        if since_ns[0] < 0 or (np.diff(since_ns) <= 0).any():
            raise RefusedMessageError("points that do not follow one another")
        times_ns = (nanoseconds(message.header.stamp) or now_ns) + since_ns
        if times_ns[-1] < now_ns:
            raise RefusedMessageError("a trajectory that has ended already")
        if times_ns[0] > now_ns:
            times_ns = np.concatenate([[now_ns], times_ns])
            positions = np.vstack([position, positions])
        self._times_ns, self._positions = times_ns, positions

    def at(self, time_ns: int) -> Array:
        """Return the (12,) positions at a time [rad], in the order of JOINT_NAMES."""
        i = int(np.searchsorted(self._times_ns, time_ns, side="right"))
        if i in (0, len(self._times_ns)):
            position: Array = self._positions[max(i - 1, 0)]
            return position
        before, after = self._times_ns[i - 1 : i + 1]
        start, end = self._positions[i - 1 : i + 1]
        share = float((time_ns - before) / (after - before))
        position = start + share * (end - start)
        return position
