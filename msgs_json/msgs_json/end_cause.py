"""Why a walk ended: one word for logs, results and penalties alike."""

from __future__ import annotations

from enum import Enum


class EndCause(str, Enum):
    """Reasons for an episode's end.

    The first is success. The next two are the penalties of Table 1. The `ik_` and
    `torque_` ones are the further failures that Section 4 names. `tilt` is
    the fall of a robot that is known by its sensors. `foot_through_floor` and
    `physics_nan` mean that the physics itself can no longer be trusted. All others come
    from outside: in real time, a reference was not there when it was due, so that
    nobody knows what the walk would have been; who guides the robot fell silent; a user
    asked for it; a stranger published what only one node may; a robot's sensors fell
    silent, or read what cannot be; somebody pressed the emergency stop; it did not
    stand when its walk was to begin; or its joints are not where they were asked to be.

    Memory files know a cause by its place in this order: new ones come last.
    """

    COMPLETED = "completed"
    ZMP_ERROR = "zmp_error"
    JOINT_VELOCITY = "joint_velocity"
    IK_UNREACHABLE = "ik_unreachable"
    IK_JOINT_LIMIT = "ik_joint_limit"
    TORQUE_SATURATION = "torque_saturation"
    FEET_UNLOADED = "feet_unloaded"
    FOOT_THROUGH_FLOOR = "foot_through_floor"
    PHYSICS_NAN = "physics_nan"
    LATE = "late"
    PEER_SILENT = "peer_silent"
    RESET = "reset"
    DISTURBED = "disturbed"
    SENSORS_SILENT = "sensors_silent"
    SENSORS_INVALID = "sensors_invalid"
    EMERGENCY_STOP = "emergency_stop"
    NOT_STANDING = "not_standing"
    TILT = "tilt"
    NOT_FOLLOWING = "not_following"

    @property
    def from_outside(self) -> bool:
        """Whether the walk says nothing of who chose it: it is walked again."""
        return self in _FROM_OUTSIDE

    def __str__(self) -> str:
        """Return the word itself."""
        return self.value


_FROM_OUTSIDE = frozenset(
    (
        EndCause.LATE,
        EndCause.PEER_SILENT,
        EndCause.RESET,
        EndCause.DISTURBED,
        EndCause.SENSORS_SILENT,
        EndCause.SENSORS_INVALID,
        EndCause.EMERGENCY_STOP,
        EndCause.NOT_STANDING,
        EndCause.NOT_FOLLOWING,
    )
)
