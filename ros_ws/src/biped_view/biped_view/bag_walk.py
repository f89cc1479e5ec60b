"""Read a walk out of a bag, as far as it was recorded.

What failures do:
    no bag, cut off, damaged: BagError, as of every reader of bags.
    a topic without which there is no walk to see, no plan, no record of the run, no
    such walk: BagError that says what is missing.
    messages that no node understands are passed over.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from biped_bag.errors import BagError
from biped_bag.records import FROM_NOTHING, RUN_RECORD
from biped_bag.storage.reader import BagReader
from biped_bag.verification.learner import recorded_session
from biped_bag.verification.walks import (
    WANTED,
    ImpossibleWalkError,
    RecordedWalk,
    RecordedWalks,
)
from biped_bringup.run_settings import RunSettings
from biped_common.plain_yaml import YamlError, read_yaml
from biped_common.settings import SettingsError, from_mapping
from biped_common.timing import CONTROL_PERIOD_US, TICKS_PER_LEARNING_TICK
from biped_description.joints import JOINT_NAMES
from biped_description.robot import Robot
from biped_ros.cdr import string_text
from biped_ros.markers import torso_pose_template
from biped_ros.messages import SegmentReader
from biped_view.walk_record import LoadedWalk, Rows, WalkRecord
from learner_node.walking.session import LearningSession
from msgs_json import topics
from msgs_json.observation import Observation
from msgs_json.walk_plan import WalkPlan
from msgs_json.wire import MalformedMessageError, decode
from sim_node.markers import TORSO_FRAME
from trajectory_node.waist_reference import WaistReference

_NEEDED = (
    topics.OBSERVATION,
    topics.PLAN,
    topics.WAIST_REFERENCE,
    topics.ZMP,
    topics.ZMP_REFERENCE,
    topics.JOINT_STATES,
)
_SAID = (
    topics.OBSERVATION,
    topics.PLAN,
    topics.WAIST_REFERENCE,
    topics.TORSO_POSE,
)
_TOLD = ("command", "start", "preset", "seed", "pace", "frozen", "git_commit")
_N = len(JOINT_NAMES)


def walk_of_bag(path: Path, number: int | None = None) -> LoadedWalk:
    """Read one walk of a bag.

    Args:
        path: folder or MCAP file.
        number: 1 for the bag's first walk; None for the last one of which a control
            tick is recorded.

    Raises:
        BagError: see the top of this module.
    """
    bag = BagReader(path)
    for topic in _NEEDED:
        if topic.name not in bag.topics or not bag.topics[topic.name].count:
            raise BagError(
                f"{path}: has no {topic.name}, without which there is no walk to see"
            )
    told = _run_record(bag)
    settings = _settings(bag, told)
    walk, of_walks = _chosen(bag, number)
    references = _references(bag, walk)
    if references.plan is None:
        raise BagError(f"{path}: walk {walk.number}: no plan was recorded before it")
    record, remarks = _record(settings, walk, references, references.plan)
    session, without = _session(bag, told)
    facts = {
        "bag": str(path),
        "walk": f"{walk.number} of {of_walks}",
        "episode": str(walk.episode),
        **{name: told[name] for name in _TOLD if told.get(name)},
        "versions": _versions(told),
        "trajectory SHA-256": walk.observations[-1].trajectory_sha256,
    }
    return LoadedWalk(
        f"Walk {walk.number} of {of_walks} of a bag",
        record,
        settings,
        session,
        {name: text for name, text in facts.items() if text},
        (*remarks, *without),
    )


# -- what the bag says of the run ------------------------------------------------------


def _run_record(bag: BagReader) -> dict[str, str]:
    record = next(bag.records(RUN_RECORD), None)
    if record is None:
        raise BagError(
            f"{bag.path}: has no record {RUN_RECORD}, which says what robot walked: "
            "`biped up --record` writes it, `ros2 bag record` cannot know it"
        )
    return dict(record.metadata)


def _settings(bag: BagReader, told: dict[str, str]) -> RunSettings:
    try:
        return from_mapping(RunSettings, read_yaml(told["settings"]))
    except (KeyError, TypeError, YamlError) as error:
        reason = " ".join(repr(error).split())[:200]
        raise BagError(f"{bag.path}: its record {RUN_RECORD}: {reason}") from None
    except SettingsError as error:
        raise BagError(
            f"{bag.path}: was recorded by another version, with settings that this one "
            f"does not have ({error})"
        ) from None


def _session(
    bag: BagReader, told: dict[str, str]
) -> tuple[LearningSession | None, tuple[str, ...]]:
    """Return the learner of a frozen run, whose memory no walk has changed."""
    if told.get("frozen") != "true" or told.get("begins_with") == FROM_NOTHING:
        return None, ("What the learner knew in this walk is not in the bag.",)
    try:
        return recorded_session(bag), ()
    except BagError as error:
        return None, (f"What the learner knew cannot be read: {error}.",)


def _versions(told: dict[str, str]) -> str:
    try:
        versions = json.loads(told.get("versions", "{}"))
        return ", ".join(f"{name} {at}" for name, at in versions.items() if at)
    except (ValueError, AttributeError, RecursionError):
        return ""


# -- the messages of one walk ----------------------------------------------------------


def _chosen(bag: BagReader, number: int | None) -> tuple[RecordedWalk, int]:
    """Return the walk asked for, and how many the bag has."""
    chosen: RecordedWalk | None = None
    count = 0
    messages = ((each.topic, each.data) for each in bag.messages(WANTED))
    try:
        for walk in RecordedWalks(messages):
            walked = walk.observations[-1].control_tick > 0
            count += walked
            if walk.number == number or (number is None and walked):
                chosen = walk
    except ImpossibleWalkError as error:
        raise BagError(f"{bag.path}: {error}") from None
    if chosen is None:
        which = "no control tick of a walk" if number is None else f"no walk {number}"
        raise BagError(f"{bag.path}: has {which}; it has {count} walks")
    if chosen.observations[-1].control_tick == 0:
        raise BagError(f"{bag.path}: walk {number} has no control tick")
    return chosen, count


@dataclass
class _References:
    """What else was said in a walk; by clock tick."""

    plan: WalkPlan | None = None
    segments: dict[int, Rows] = field(default_factory=dict)
    """(rows, 4, 3) waist, left foot, right foot, reference ZMP [m]."""
    torso: dict[int, Rows] = field(default_factory=dict)
    """(7,) position [m] and quaternion (x, y, z, w)."""


def _references(bag: BagReader, walk: RecordedWalk) -> _References:
    """Gather plan, segments and poses.

    A simulation that is started anew counts its clock from 0 again: what was said
    between the observations of the walk's own simulation counts.
    """
    found = _References()
    first, last = walk.observations[0], walk.observations[-1]
    inside = range(first.clock_ticks, last.clock_ticks + 1)
    reader, pose = SegmentReader(), torso_pose_template(TORSO_FRAME)
    simulation = ""
    for message in bag.messages([topic.name for topic in _SAID]):
        name = message.topic
        try:
            if name == topics.OBSERVATION.name:
                simulation = decode(Observation, string_text(message.data)).simulation
            elif name == topics.PLAN.name:
                if found.plan is None or not found.segments:
                    found.plan = decode(WalkPlan, string_text(message.data))
            elif simulation == first.simulation:
                if name == topics.WAIST_REFERENCE.name:
                    positions, at = reader.read(message.data)
                    if at in inside:
                        found.segments.setdefault(at, positions)
                else:
                    read = pose.read(message.data)
                    if read is not None and read[1] in inside:
                        found.torso.setdefault(read[1], read[0])
        except MalformedMessageError:
            continue
    return found


# -- rows ------------------------------------------------------------------------------


def _record(
    settings: RunSettings, walk: RecordedWalk, said: _References, plan: WalkPlan
) -> tuple[WalkRecord, list[str]]:
    first, last = walk.observations[0], walk.observations[-1]
    begin, n = first.clock_ticks - first.control_tick, last.control_tick
    states = _rows(walk, topics.JOINT_STATES, n, 3 * _N)
    references = _rows(walk, topics.JOINT_REFERENCES, n, 2 * _N)
    followed = _followed(said, begin, n)
    torso, quaternion = _torso(said, begin, n)
    right, double, step = _phases(plan, n)
    zmp = _rows(walk, topics.ZMP, n, 2)
    record = WalkRecord(
        robot=settings.robot,
        zmp_limit_m=settings.sim.limits.zmp_error_m,
        walk_ticks=plan.walk_ticks,
        joint_position_rad=states[:, :_N],
        joint_velocity_rad_s=states[:, _N : 2 * _N],
        joint_torque_nm=states[:, 2 * _N :],
        joint_reference_rad=references[:, :_N],
        torso_position_m=torso,
        torso_quaternion=quaternion,
        zmp_m=zmp,
        zmp_reference_m=_rows(walk, topics.ZMP_REFERENCE, n, 2),
        waist_m=followed[:, 0],
        static_waist_m=_static_waist(settings, plan, n),
        left_foot_m=followed[:, 1],
        right_foot_m=followed[:, 2],
        right_support=right,
        double_support=double,
        step_index=step,
        correction_m=_corrections(walk, begin, n),
        end_cause=last.end_cause if walk.result is None else walk.result.end_cause,
        result=walk.result,
    )
    return record, _remarks(record)


def _rows(walk: RecordedWalk, topic: topics.Topic, n: int, width: int) -> Rows:
    """Return (n, width) values by control tick, NaN where none was recorded."""
    rows = np.full((n, width), np.nan)
    samples = walk.samples.get(topic.name)
    if samples is not None:
        within = samples.control_ticks <= n
        rows[samples.control_ticks[within] - 1] = samples.values[within]
    return rows


def _followed(said: _References, begin: int, n: int) -> Rows:
    """Return the (n, 4, 3) references of waist, feet and ZMP.

    Row i of a segment belongs to the tick i after the observation that it answers; a
    later segment takes over from the look-ahead of the one before.
    """
    rows = np.full((n + 1, 4, 3), np.nan)
    for at, positions in sorted(said.segments.items()):
        start = at - begin + 1
        ahead = positions[1 : max(1, n + 2 - start)]
        rows[start : start + len(ahead)] = ahead
    return rows[1:]


def _torso(said: _References, begin: int, n: int) -> tuple[Rows, Rows]:
    """Return position (n, 3) and quaternion (n, 4), (w, x, y, z), of the torso.

    Between two recorded poses the position is interpolated linearly, the orientation
    along the shortest way. Before the first and behind the last one it is not known.
    """
    position, quaternion = np.full((n, 3), np.nan), np.full((n, 4), np.nan)
    poses = {at - begin: said.torso[at] for at in sorted(said.torso)}
    ticks = np.array([tick for tick in poses if 0 < tick <= n], dtype=np.int64)
    if len(ticks) < 2:
        return position, quaternion
    values = np.array([poses[int(tick)] for tick in ticks])
    between = np.arange(ticks[0], ticks[-1] + 1)
    rows = between - 1
    for axis in range(3):
        position[rows, axis] = np.interp(between, ticks, values[:, axis])
    turned = Slerp(ticks, Rotation.from_quat(values[:, 3:]))(between).as_quat()
    quaternion[rows] = np.roll(turned, 1, axis=1)
    quaternion[ticks - 1] = np.roll(values[:, 3:], 1, axis=1)
    return position, quaternion


def _phases(
    plan: WalkPlan, n: int
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.int64]]:
    """Return right support, double support and step index, (n,) each."""
    right, double = np.zeros(n + 1, dtype=np.bool_), np.ones(n + 1, dtype=np.bool_)
    step = np.zeros(n + 1, dtype=np.int64)
    for phase in plan.phases:
        right[phase.from_tick :] = phase.right_support
        double[phase.from_tick :] = phase.double_support
        step[phase.from_tick :] = phase.step_index
    return right[1:], double[1:], step[1:]


def _static_waist(settings: RunSettings, plan: WalkPlan, n: int) -> Rows:
    """Return the (n, 3) waist without corrections; it is in no message.

    It follows from robot and gait, where the recorded plan is the one they lead to.
    """
    reference = WaistReference(
        Robot(settings.robot), settings.gait, settings.correction
    )
    if reference.walk_plan() != plan:
        return np.full((n, 3), np.nan)
    return reference.static_waist[1 : n + 1]


def _corrections(walk: RecordedWalk, begin: int, n: int) -> Rows:
    rows = np.full((n, 2), np.nan)
    for at, given in walk.corrections.items():
        start = at - begin
        if 0 <= start < n:
            rows[start : start + TICKS_PER_LEARNING_TICK] = given[0]
    return rows


def _remarks(record: WalkRecord) -> list[str]:
    """Say what of a walk was not recorded, or not at every control tick."""
    found = []
    known = np.flatnonzero(np.isfinite(record.joint_position_rad[:, 0]))
    every = round(float(np.median(np.diff(known)))) if len(known) > 1 else 1
    if every > 1:
        hertz = 1_000_000 / (every * CONTROL_PERIOD_US)
        found.append(
            f"Joints and ZMP were recorded at every {every}th control tick, {hertz:g} "
            "times a second; nothing is drawn in between but straight lines."
        )
    if np.isfinite(record.torso_position_m).any():
        found.append(
            "The torso's pose is recorded 25 times a second, and interpolated in "
            "between."
        )
    if not np.isfinite(record.static_waist_m).any():
        found.append("The recorded plan is not the one that its settings lead to.")
    return found
