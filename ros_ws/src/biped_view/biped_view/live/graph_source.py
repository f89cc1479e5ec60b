"""A running graph as a source of the page: listens to topics, calls services.

Of the 500 Hz topics only the last message of a frame is looked at. The page may come
and go, and so may the graph: who starts anew is shown anew.

/biped/observation is listened to only once a walk is seen: before its first walk the
robot counts who listens there, and must not take this node for the recorder.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
import rclpy
from rcl_interfaces.srv import GetParameters
from rclpy.parameter import parameter_value_to_python
from std_srvs.srv import SetBool, Trigger

from biped_common.errors import BipedError
from biped_common.settings import from_mapping, nested, overlay, to_mapping
from biped_common.timing import seconds
from biped_description.joints import JOINT_NAMES
from biped_description.links import TORSO
from biped_description.robot import Robot
from biped_ros.cdr import string_text
from biped_ros.markers import torso_pose_template
from biped_ros.messages import correction_template, joint_state_template
from biped_ros.parameters import flattened
from biped_view.live.marker_reader import MarkerReader
from biped_view.live.memory import MemoryFile, figures_of, show_states
from biped_view.live.moment import Array, Course, Episodes, Moment, Traces
from biped_view.live.page import Page
from biped_view.live.polled import PolledService, PolledTopic
from msgs_json import topics
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation
from msgs_json.walk_plan import WalkPlan
from msgs_json.wire import MalformedMessageError, decode
from trajectory_node.settings import TrajectorySettings
from trajectory_node.waist_reference import WaistReference

NAME: Final = "view"
_SILENT_S: Final = 2.0
_MARKERS: Final = {"zmp_limit", "zmp", "zmp_reference", "waist_planned"}
_NOTHING: Final = np.zeros((0, 3))
_ASK_AGAIN_S: Final = 2.0
_COURSE_PARAMETERS: Final = ("robot.", "gait.", "correction.")


class GraphSource:
    """A node that only listens, and asks for what a user presses."""

    def __init__(self, page: Page, domain: int, memory: Path | None = None) -> None:
        """Join the graph, and add the buttons.

        Args:
            page: to fill.
            domain: of the graph.
            memory: file that the learner writes, for its states and former episodes.
        """
        self._page, self._domain = page, domain
        self._memory = None if memory is None else MemoryFile(memory)
        self._context = rclpy.Context()
        rclpy.init(
            context=self._context,
            domain_id=domain,
            signal_handler_options=rclpy.signals.SignalHandlerOptions.NO,
        )
        self._node = node = rclpy.create_node(
            NAME,
            context=self._context,
            start_parameter_services=False,
            enable_rosout=False,
        )
        self._torso = PolledTopic(node, topics.TORSO_POSE, last_only=True)
        self._joints = PolledTopic(node, topics.JOINT_STATES, last_only=True)
        self._markers = PolledTopic(node, topics.MARKERS, last_only=True)
        self._descriptions = PolledTopic(node, topics.ROBOT_DESCRIPTION)
        self._plans = PolledTopic(node, topics.PLAN)
        self._statuses = PolledTopic(node, topics.LEARNER_STATUS)
        self._results = PolledTopic(node, topics.EPISODE)
        self._corrections = PolledTopic(node, topics.CORRECTION)
        self._observations: PolledTopic | None = None
        self._torso_template = torso_pose_template(TORSO)
        self._joint_template = joint_state_template(JOINT_NAMES, with_effort=True)
        self._correction_template = correction_template()
        self._marker_reader = MarkerReader()
        self._parameters = PolledService(
            node, GetParameters, f"/{topics.TRAJECTORY_NODE}/get_parameters"
        )
        self._services = {
            name: PolledService(node, kind, f"/{name}")
            for name, kind in (
                (f"{topics.SIM_NODE}/pause", SetBool),
                (f"{topics.SIM_NODE}/reset", Trigger),
                (f"{topics.SIM_NODE}/push", SetBool),
                (f"{topics.LEARNER_NODE}/freeze", SetBool),
                (f"{topics.LEARNER_NODE}/save_memory", Trigger),
            )
        }
        self._joint_position: Array | None = None
        self._drawn: dict[str, Array] = {}
        """Points of the last markers, by name."""
        self._marker_message: bytes | None = None
        self._torso_pose = np.zeros(7)
        """Position [m] and quaternion (x, y, z, w)."""
        self._limit_m: float | None = None
        self._walk = "", 0
        self._seen: list[Observation] = []
        self._chosen: dict[int, Array] = {}
        self._waist: list[Array] = []
        self._urdf: str | None = None
        self._plan: WalkPlan | None = None
        self._status: LearnerStatus | None = None
        self._last_walk = ""
        self._episodes: dict[int, tuple[float, bool]] = {}
        """T_err, and whether the target was reached, by number."""
        self._heard_at = -_SILENT_S
        self._paused = False
        self._staged: tuple[str, float, WalkPlan] | None = None
        self._course_asked_at: float | None = None
        self._add_buttons()

    def turn(self) -> None:
        """Take in what has come since the last turn."""
        for service in (*self._services.values(), self._parameters):
            service.take()
        try:
            self._take_latched()
            self._take_walk()
            self._take_moment()
        except MalformedMessageError as error:
            self._page.show_state("Not understood", str(error), good=False)
            return
        self._look_at_memory()
        self._show_state()

    def close(self) -> None:
        """Leave the graph."""
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    # -- buttons ---------------------------------------------------------------------

    def _add_buttons(self) -> None:
        add = self._page.add_buttons
        add("Robot", ("Pause", "Resume", "Reset"), self._pressed)
        add("Push it", ("to its left", "to its right"), self._pressed)
        add("Learner", ("Freeze", "Learn", "Save"), self._pressed)

    def _pressed(self, button: str) -> None:
        name, fields = {
            "Pause": (f"{topics.SIM_NODE}/pause", {"data": True}),
            "Resume": (f"{topics.SIM_NODE}/pause", {"data": False}),
            "Reset": (f"{topics.SIM_NODE}/reset", {}),
            "to its left": (f"{topics.SIM_NODE}/push", {"data": True}),
            "to its right": (f"{topics.SIM_NODE}/push", {"data": False}),
            "Freeze": (f"{topics.LEARNER_NODE}/freeze", {"data": True}),
            "Learn": (f"{topics.LEARNER_NODE}/freeze", {"data": False}),
            "Save": (f"{topics.LEARNER_NODE}/save_memory", {}),
        }[button]

        def answered(response: Any) -> None:
            if button in ("Pause", "Resume") and response.success:
                self._paused = button == "Pause"
            self._page.say(button, response.message)

        if not self._services[name].ask(answered, **fields):
            self._page.say(button, f"nobody offers /{name}")

    # -- messages --------------------------------------------------------------------

    def _take_latched(self) -> None:
        description = self._descriptions.last()
        if description is not None:  # the robot has come, or come anew
            self._urdf, self._staged = string_text(description), None
            self._course_asked_at, self._paused = None, False
            self._joint_position = self._marker_message = self._limit_m = None
            self._forget()
        plan = self._plans.last()
        if plan is not None:
            self._plan = decode(WalkPlan, string_text(plan))
            self._course_asked_at = None
        status = self._statuses.last()
        if status is not None:
            former, self._status = (
                self._status,
                decode(LearnerStatus, string_text(status)),
            )
            if former is not None and former.seed != self._status.seed:
                self._episodes.clear()  # another run
            walk_s = None if self._plan is None else seconds(self._plan.walk_ticks)
            self._page.show_learner(figures_of(self._status, walk_s))
        for message in self._results.take():
            self._take_result(decode(EpisodeResult, string_text(message)))

    def _take_result(self, result: EpisodeResult) -> None:
        self._last_walk = (
            f"last walk: {str(result.end_cause).replace('_', ' ')} after "
            f"{seconds(result.control_ticks):.2f} s"
        )
        counts = result.learning and not result.end_cause.from_outside
        if counts and result.cost is not None and self._status is not None:
            number = self._status.episodes
            self._episodes[number] = result.cost.total, result.completed
            self._show_episodes()

    def _look_at_memory(self) -> None:
        memory = None if self._memory is None else self._memory.look()
        if memory is None:
            return
        show_states(self._page, memory, "As of the last checkpoint")
        former = memory.episodes
        rows = zip(
            former.number.astype(int),
            former.t_err.tolist(),
            former.completed.tolist(),
            strict=True,
        )
        self._episodes |= {number: (t_err, done) for number, t_err, done in rows}
        if self._episodes:
            self._show_episodes()

    def _show_episodes(self) -> None:
        numbers = sorted(self._episodes)
        t_err, completed = zip(*(self._episodes[n] for n in numbers), strict=True)
        self._page.show_episodes(
            Episodes(
                np.array(numbers, dtype=np.float64),
                np.array(t_err, dtype=np.float64),
                np.array(completed, dtype=np.bool_),
            )
        )

    def _take_walk(self) -> None:
        """Take in observations and corrections."""
        for message in self._corrections.take():
            read = self._correction_template.read(message)
            if read is not None:
                self._chosen[read[1]] = read[0]
        observations = [] if self._observations is None else self._observations.take()
        for message in observations:
            seen = decode(Observation, string_text(message))
            if (seen.simulation, seen.episode) != self._walk:
                self._forget()
                self._walk = seen.simulation, seen.episode
            self._seen.append(seen)
        if observations:
            self._page.show_traces(self._traces)

    def _take_moment(self) -> None:
        """Take in where the robot is; markers are read when somebody looks."""
        joints, torso = self._joints.last(), self._torso.last()
        self._marker_message = self._markers.last() or self._marker_message
        if joints is not None and (read := self._joint_template.read(joints)):
            self._joint_position = read[0][: len(JOINT_NAMES)]
        read = None if torso is None else self._torso_template.read(torso)
        if read is None:
            return
        self._heard_at, self._paused = time.monotonic(), False
        if self._observations is None:
            self._observations = PolledTopic(self._node, topics.OBSERVATION)
        self._torso_pose = read[0]
        self._waist.append(read[0][:3])
        if self._limit_m is None:
            self._read_markers()
        if self._joint_position is not None and self._on_stage():
            self._page.show_moment(self._moment)

    def _moment(self) -> Moment:
        """Return what was heard last."""
        assert self._joint_position is not None
        self._read_markers()
        x, y, z, w = self._torso_pose[3:]
        return Moment(
            torso_position_m=self._torso_pose[:3],
            torso_quaternion=np.array((w, x, y, z)),
            joint_position_rad=self._joint_position,
            zmp_m=self._drawn["zmp"][0, :2],
            zmp_reference_m=self._drawn["zmp_reference"][0, :2],
            support_m=self._drawn.get("support_polygon", _NOTHING)[:, :2],
            waist_m=np.array(self._waist),
            waist_ahead_m=self._drawn["waist_planned"],
        )

    def _read_markers(self) -> None:
        """Read the last markers, if they are the robot's."""
        if self._marker_message is None:
            return
        drawn = self._marker_reader.read(self._marker_message)
        if drawn.keys() >= _MARKERS:
            self._drawn, self._limit_m = drawn, self._marker_reader.limit_m

    # -- the stage -------------------------------------------------------------------

    def _on_stage(self) -> bool:
        """Put the robot on the floor once all is known; return whether it is there."""
        if self._urdf is None or self._limit_m is None or self._plan is None:
            return False
        staged = self._urdf, self._limit_m, self._plan
        if self._staged != staged:
            self._staged = staged
            walk_s = seconds(self._plan.walk_ticks)
            self._page.set_stage(self._urdf, self._limit_m, walk_s)
        self._ask_for_course()
        return True

    def _ask_for_course(self) -> None:
        """Ask the trajectory for its settings, until it has answered."""
        now = time.monotonic()
        if self._course_asked_at is not None and now < self._course_asked_at:
            return
        names = [
            name
            for name in flattened(to_mapping(TrajectorySettings()))
            if name.startswith(_COURSE_PARAMETERS)
        ]

        def answered(response: Any) -> None:
            self._course_asked_at = float("inf")
            values: Mapping[str, Any] = {}
            for name, value in zip(names, response.values, strict=True):
                plain = parameter_value_to_python(value)
                plain = list(plain) if hasattr(plain, "tolist") else plain
                values = overlay(values, nested(name, plain))
            try:
                self._page.set_course(_course(values))
            except BipedError as error:
                self._page.say("Planned waist", str(error))

        self._parameters.forget()
        self._parameters.ask(answered, names=names)
        self._course_asked_at = now + _ASK_AGAIN_S

    # -- what is shown ---------------------------------------------------------------

    def _forget(self) -> None:
        """Forget the walk that was under way."""
        self._walk = "", 0
        self._seen, self._chosen, self._waist = [], {}, []

    def _traces(self) -> Traces:
        unknown = np.full(2, np.nan)
        return Traces(
            np.array([seconds(each.control_tick) for each in self._seen]),
            np.array([each.worst_zmp_error_m for each in self._seen]),
            np.array(
                [self._chosen.get(each.clock_ticks, unknown) for each in self._seen]
            ),
        )

    def _show_state(self) -> None:
        show = self._page.show_state
        silent_s = time.monotonic() - self._heard_at
        if self._paused:
            show("Paused", self._detail(), good=None)
        elif silent_s < _SILENT_S:
            show("Walking", self._detail(), good=True)
        elif self._urdf is None:
            show("Waiting", f"no robot on ROS_DOMAIN_ID={self._domain} yet", good=None)
        else:
            show("Silent", f"no robot is heard; {self._last_walk}", good=None)

    def _detail(self) -> str:
        if not self._seen or self._plan is None:
            return self._last_walk
        now_s = seconds(self._seen[-1].control_tick)
        return (
            f"{now_s:.1f} of {seconds(self._plan.walk_ticks):.2f} s; {self._last_walk}"
        )


def _course(values: Mapping[str, Any]) -> Course:
    """Return the course of a trajectory's settings.

    Raises:
        BipedError: they make no walk.
    """
    settings = from_mapping(TrajectorySettings, values)
    reference = WaistReference(
        Robot(settings.robot), settings.gait, settings.correction
    )
    rows = slice(reference.ticks)
    return Course(
        reference.static_waist[rows],
        reference.plan.left_foot[rows],
        reference.plan.right_foot[rows],
    )
