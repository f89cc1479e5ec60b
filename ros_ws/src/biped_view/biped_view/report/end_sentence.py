"""How a walk ended, in a sentence: what, when, in which phase, and who is to blame."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from biped_bringup.run_settings import RunSettings
from biped_common.timing import seconds
from biped_description.joints import JOINT_NAMES
from biped_description.robot import Robot
from biped_view.phases import phase_in_words
from biped_view.walk_record import WalkRecord
from msgs_json.end_cause import EndCause

_DIAGONAL = 2 / 3
"""From this share of the larger component on, the smaller one is named, too."""


def end_sentence(record: WalkRecord, settings: RunSettings) -> str:
    """Return how a walk of at least one control tick ended.

    What ended a walk from outside is said to be no fault of who walked.
    """
    if record.end_cause is None:
        return (
            f"The recording ends before the walk, {_when(record)}: until then nothing "
            "had failed."
        )
    return _SENTENCES[record.end_cause](record, settings)


def _completed(record: WalkRecord, _: RunSettings) -> str:
    walked, whole = seconds(record.ticks), seconds(record.walk_ticks)
    if record.ticks < record.walk_ticks:
        return (
            f"The walk reached its target time of {walked:g} s; the whole walk takes "
            f"{whole:g} s."
        )
    sentence = f"The walk was completed, all {whole:g} s of it"
    if record.result is None:
        return f"{sentence}."
    peak, limit = 1000 * record.result.peak_zmp_error_m, 1000 * record.zmp_limit_m
    return f"{sentence}; its ZMP error was {peak:.2f} of {limit:g} mm at most."


def _zmp_error(record: WalkRecord, _: RunSettings) -> str:
    return (
        f"The ZMP left its {1000 * record.zmp_limit_m:g} mm limit {_when(record)}, "
        f"{_where(record)}{_direction(record)}."
    )


def _joint_velocity(record: WalkRecord, _: RunSettings) -> str:
    limit = record.robot.velocity_limit_rad_s
    joint = _foremost(np.abs(record.joint_velocity_rad_s))
    return (
        f"A joint{joint} reached its speed limit of {limit:.1f} rad/s {_when(record)}, "
        f"{_where(record)}."
    )


def _ik_unreachable(record: WalkRecord, _: RunSettings) -> str:
    return (
        f"The corrected waist was out of the legs' reach {_when(record)}, "
        f"{_where(record)}: no leg pose leads there."
    )


def _ik_joint_limit(record: WalkRecord, _: RunSettings) -> str:
    return (
        f"The corrected waist asked for a joint beyond its limits {_when(record)}, "
        f"{_where(record)}."
    )


def _torque_saturation(record: WalkRecord, settings: RunSettings) -> str:
    limits = Robot(record.robot).torque_limit_nm
    joint = _foremost(np.abs(record.joint_torque_nm) / limits)
    return (
        f"A joint{joint} had been at its torque limit for "
        f"{settings.sim.limits.torque_saturation_s:g} s {_when(record)}, "
        f"{_where(record)}."
    )


def _feet_unloaded(record: WalkRecord, settings: RunSettings) -> str:
    return (
        f"Neither foot had carried load for {settings.sim.limits.unloaded_feet_s:g} s "
        f"{_when(record)}, {_where(record)}: the robot had lost the floor."
    )


def _foot_through_floor(record: WalkRecord, settings: RunSettings) -> str:
    depth = 1000 * settings.sim.limits.foot_penetration_m
    return (
        f"A sole was more than {depth:g} mm deep in the floor {_when(record)}, "
        f"{_where(record)}: from there on the physics cannot be trusted. Nothing is "
        "learned from such a walk."
    )


def _physics_nan(record: WalkRecord, _: RunSettings) -> str:
    return (
        f"The physics gave numbers that are none {_when(record)}, {_where(record)}: it "
        "cannot be trusted. Nothing is learned from such a walk."
    )


def _late(record: WalkRecord, _: RunSettings) -> str:
    return (
        f"The machine was late: {_when(record)} the waist reference was not there when "
        "it was due. The walk was ended by that, by no failure of robot or learner."
    )


def _peer_silent(record: WalkRecord, _: RunSettings) -> str:
    return (
        f"The walk was given up {_when(record)}, because who guides the robot fell "
        "silent. Neither robot nor learner had failed."
    )


def _reset(record: WalkRecord, _: RunSettings) -> str:
    return (
        f"A user ended the walk by a reset {_when(record)}. Neither robot nor learner "
        "had failed."
    )


def _disturbed(record: WalkRecord, _: RunSettings) -> str:
    return (
        f"The walk was given up {_when(record)}, because a stranger published what "
        "only one node may. Neither robot nor learner had failed."
    )


def _sensors_silent(record: WalkRecord, _: RunSettings) -> str:
    return (
        f"The robot's sensors fell silent {_when(record)}, {_where(record)}, and the "
        "walk was given up. Neither robot nor learner had failed to walk."
    )


def _sensors_invalid(record: WalkRecord, _: RunSettings) -> str:
    return (
        f"The robot's sensors read what cannot be {_when(record)}, {_where(record)}, "
        "and the walk was given up. Neither robot nor learner had failed to walk."
    )


def _emergency_stop(record: WalkRecord, _: RunSettings) -> str:
    return (
        f"The emergency stop was pressed {_when(record)}, {_where(record)}. Neither "
        "robot nor learner had failed."
    )


def _not_standing(_: WalkRecord, __: RunSettings) -> str:
    return (
        "The robot did not stand on both feet when the walk was to begin. Neither "
        "robot nor learner had failed to walk."
    )


def _not_following(record: WalkRecord, settings: RunSettings) -> str:
    return (
        f"A joint was off by {settings.sim.sensors.following_limit_rad:g} rad or more "
        f"{_when(record)}, {_where(record)}, and the walk was given up: the robot did "
        "not do what it was sent. Neither robot nor learner had failed to walk."
    )


def _tilt(record: WalkRecord, settings: RunSettings) -> str:
    return (
        f"The torso tilted by more than {settings.sim.sensors.tilt_limit_rad:g} rad "
        f"{_when(record)}, {_where(record)}: the robot was falling."
    )


_SENTENCES: Mapping[EndCause, Callable[[WalkRecord, RunSettings], str]] = {
    EndCause.COMPLETED: _completed,
    EndCause.ZMP_ERROR: _zmp_error,
    EndCause.JOINT_VELOCITY: _joint_velocity,
    EndCause.IK_UNREACHABLE: _ik_unreachable,
    EndCause.IK_JOINT_LIMIT: _ik_joint_limit,
    EndCause.TORQUE_SATURATION: _torque_saturation,
    EndCause.FEET_UNLOADED: _feet_unloaded,
    EndCause.FOOT_THROUGH_FLOOR: _foot_through_floor,
    EndCause.PHYSICS_NAN: _physics_nan,
    EndCause.LATE: _late,
    EndCause.PEER_SILENT: _peer_silent,
    EndCause.RESET: _reset,
    EndCause.DISTURBED: _disturbed,
    EndCause.SENSORS_SILENT: _sensors_silent,
    EndCause.SENSORS_INVALID: _sensors_invalid,
    EndCause.EMERGENCY_STOP: _emergency_stop,
    EndCause.NOT_STANDING: _not_standing,
    EndCause.TILT: _tilt,
    EndCause.NOT_FOLLOWING: _not_following,
}


def _when(record: WalkRecord) -> str:
    return f"at {seconds(record.ticks):.2f} s"


def _where(record: WalkRecord) -> str:
    return f"in {phase_in_words(record, record.ticks - 1)}"


def _direction(record: WalkRecord) -> str:
    """Return whither the ZMP went from its reference, as far as that is recorded."""
    error = record.zmp_error_m
    known = np.flatnonzero(np.isfinite(error).all(axis=1))
    if not len(known):
        return ""
    x, y = error[known[-1]]
    ways = {
        "forward" if x > 0 else "backward": abs(x),
        "to the left" if y > 0 else "to the right": abs(y),
    }
    largest = max(ways.values())
    named = [way for way, size in ways.items() if size >= _DIAGONAL * largest]
    return f", {' and '.join(named)}"


def _foremost(load: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> str:
    """Return the joint with the largest load at the last tick that is recorded.

    Args:
        load: (n, 12), comparable between joints.
    """
    known = np.flatnonzero(np.isfinite(load).all(axis=1))
    if not len(known):
        return ""
    return f", {JOINT_NAMES[int(np.argmax(load[known[-1]]))].replace('_', ' ')},"
