"""The simulated robot on ROS: waist segments in, observations and 500 Hz topics out."""

from __future__ import annotations

import math
import sys
import time
import uuid
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from std_srvs.srv import SetBool, Trigger

from biped_common.seeds import robot_stream
from biped_description.robot import Robot
from biped_ros.cdr import string_message, string_text
from biped_ros.guarded import GuardedNode
from biped_ros.messages import SegmentReader
from biped_ros.running import claim_processor, run_node
from biped_ros.sole_publisher import Publishers
from msgs_json import topics
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation
from msgs_json.segment import WaistSegment
from msgs_json.walk_plan import WalkPlan
from msgs_json.wire import RefusedMessageError, decode, encode
from sim_node.biped import SimulatedBiped
from sim_node.control_tick import ControlTick
from sim_node.engines import plant_of
from sim_node.markers import MarkerPublisher
from sim_node.pace_watch import PaceWatch
from sim_node.pilot import Pilot, check_stance
from sim_node.planned_walk import PlannedWalk
from sim_node.realtime import Punctuality, RealtimeLoop
from sim_node.settings import ROBOT, SimNodeSettings
from sim_node.tick_publisher import TickPublisher

NAME = topics.SIM_NODE
_WATCH_PERIOD_S = 0.1
# After a stranger has left, until all have found each other again.
_CALM_S = 0.5
_PACE_REPORTS_S = 10.0
_READY_REPORTS_S = 10.0
# A push that a user asks for: on the torso's CoM, sideways.
_PUSH_FORCE_N = 20.0
_PUSH_TICKS = 50


class SimNode(GuardedNode):
    """Lockstep: the robot walks a segment when it comes, as fast as all can."""

    def __init__(self, **options: Any) -> None:
        """Wait for the plan, then stand and begin the first walk.

        Args:
            options: of `rclpy.node.Node`, such as `parameter_overrides`.

        Raises:
            EngineMissingError: the physics engine is not installed.
        """
        super().__init__(NAME, **options)
        settings = self.settings_from_parameters(SimNodeSettings, self._on_settings)
        claim_processor(self, settings.processor)
        self._settings = settings
        self._robot = Robot(settings.robot)
        if settings.sim.engine != ROBOT:
            plant_of(settings.sim.engine)  # one that is missing is refused here
        self._rng = np.random.default_rng(robot_stream(settings.seed))
        self._walk: PlannedWalk | None = None
        self._pilot: Pilot | None = None
        self._loop: RealtimeLoop | None = None
        self._paused = False
        self._held: bytes | None = None
        self._frozen: bool | None = None
        self._frozen_walk: bool | None = None
        """Whether the learner is frozen, and was when the present walk began."""
        self._push_n, self._push_ticks = 0.0, 0
        """Force to the left, and for how many more control ticks."""
        self._offered = False
        """The present walk was begun, and no other is to be begun before its end."""
        self._ownership = Publishers(self)
        self._disturbed_at = -math.inf
        self._heard = time.monotonic()
        self._punctuality = Punctuality()
        self._pace = PaceWatch(self._punctuality)
        self._observed_ns = time.monotonic_ns()
        self._ticks = TickPublisher(self, settings.publish_every_ticks)
        self._markers = MarkerPublisher(
            self,
            settings.robot,
            settings.sim.limits.zmp_error_m,
            settings.markers_every_ticks,
        )
        self._observations = self.publisher(topics.OBSERVATION)
        description = self.publisher(topics.ROBOT_DESCRIPTION)
        description.publish(string_message(self._robot.urdf))
        self._segments = SegmentReader()
        self.listen(topics.PLAN, self._on_plan)
        self.listen(topics.WAIST_REFERENCE, self._on_segment)
        self.listen(topics.EPISODE, self._on_episode)
        self.listen(topics.LEARNER_STATUS, self._on_learner_status)
        self.create_timer(_WATCH_PERIOD_S, self._watch_peers)
        if settings.pace == "realtime":
            self.create_timer(_WATCH_PERIOD_S, self._watch_pace)
        self.create_service(SetBool, f"{NAME}/pause", self._on_pause)
        self.create_service(Trigger, f"{NAME}/reset", self._on_reset)
        self.create_service(SetBool, f"{NAME}/push", self._on_push)

    def close(self) -> None:
        """End the world."""
        if self._loop is not None:
            self._loop.stop()
        if self._pilot is not None:
            self._pilot.biped.close()

    def figures(self) -> dict[str, str]:
        """Return rate, lateness and missed deadlines."""
        return self._punctuality.figures()

    def _on_settings(self, settings: SimNodeSettings) -> None:
        """Take over what may change while the robot walks."""
        self._settings = settings
        self._ticks.every_ticks = settings.publish_every_ticks
        self._markers.every_ticks = settings.markers_every_ticks
        if self._loop is not None:
            self._loop.set_factor(settings.realtime_factor)

    # -- messages ------------------------------------------------------------------

    def _on_plan(self, message: bytes) -> None:
        plan = decode(WalkPlan, string_text(message))
        if self._walk is None:
            walk = PlannedWalk(plan)
            check_stance(self._robot, walk.stance)
            self._walk = walk
            self._stand(walk)
        elif plan != self._walk.plan:
            raise RefusedMessageError(
                "another plan than is walked; start sim_node anew to change it"
            )

    def _stand(self, walk: PlannedWalk) -> None:
        """Build the world around the robot in its stance."""
        biped = SimulatedBiped(
            self._robot,
            self._settings.sim,
            walk.stance,
            self._rng,
            self._on_tick,
            name=uuid.uuid4().hex[:8],
        )
        self._pilot = Pilot(biped)
        if self._settings.pace == "realtime":
            self._loop = RealtimeLoop(
                self._pilot,
                walk.plan.walk_ticks,
                self._settings.realtime_factor,
                self._publish,
                self._punctuality,
            )
            self._loop.start()

    def _on_tick(self, tick: ControlTick) -> None:
        """Publish a control tick, in the thread that walks."""
        self._punctuality.ticks += 1
        self._ticks.publish(tick)
        if self._pilot is not None and self._push_ticks > 0:
            self._push_ticks -= 1
            self._pilot.biped.world.push((0.0, self._push_n, 0.0))
        if self._pilot is not None and self._pilot.segment is not None:
            self._markers.publish(tick, self._pilot.segment, self._pilot.biped.world)

    def _on_segment(self, message: bytes) -> None:
        if self._paused and self._loop is None:
            self._held = message
            return
        positions, clock_ticks = self._segments.read(message)
        if self._pilot is None or self._walk is None:
            raise RefusedMessageError("no plan is known yet")
        answered = self._pilot.answered(clock_ticks)
        segment = self._walk.segment(answered.control_tick, positions)
        if self._loop is None:
            latency_ns = time.monotonic_ns() - self._observed_ns
            self._publish(self._pilot.execute(clock_ticks, segment))
            self._punctuality.segment(latency_ns)
        else:
            self._loop.request(lambda: self._follow(clock_ticks, segment))

    def _follow(self, clock_ticks: int, segment: WaistSegment) -> None:
        """Take over a segment, in the thread of the real-time loop."""
        if self._pilot is None or self._loop is None:
            return
        try:
            self._pilot.follow(clock_ticks, segment)
        except RefusedMessageError as error:
            self.refuse(topics.WAIST_REFERENCE, "refused", error)
        else:
            self._heard = time.monotonic()
            self._loop.segment_arrived()

    def _on_episode(self, message: bytes) -> None:
        result = decode(EpisodeResult, string_text(message))
        if self._pilot is None:
            raise RefusedMessageError("no walk has begun yet")
        self._pilot.check_result(result)
        self._begin()

    def _on_learner_status(self, message: bytes) -> None:
        frozen = decode(LearnerStatus, string_text(message)).frozen
        if self._frozen is None:  # heard for the first time, and so since it is there
            self._frozen_walk = frozen
        self._frozen = frozen

    def _begin(self) -> None:
        """Begin the next walk, unless somebody would not follow it from its start."""
        calm_s = time.monotonic() - self._disturbed_at
        in_order = self._connected() and self._ready()
        if self._disturbed() or calm_s < _CALM_S or not in_order:
            self._offered = False  # until `_watch_peers` finds all in order
            return
        self._offered = True
        self._frozen_walk, self._push_ticks = self._frozen, 0
        self._heard = time.monotonic()
        if self._loop is not None:
            self._loop.request(self._loop.begin)
        elif self._pilot is not None:
            self._publish(self._pilot.begin())

    def _end(self, cause: EndCause) -> bool:
        """End the walk from outside; return whether one was under way."""
        if self._pilot is None or not self._pilot.walking:
            return False
        if self._loop is not None:
            loop = self._loop
            loop.request(lambda: loop.end(cause))
            return True
        observation = self._pilot.end(cause)
        if observation is not None:
            self._publish(observation)
        return observation is not None

    # -- peers ---------------------------------------------------------------------

    def _watch_pace(self) -> None:
        text = self._pace.look(self._settings.realtime_factor)
        if text is not None:
            self.get_logger().warning(text, throttle_duration_sec=_PACE_REPORTS_S)
            self.remark(DiagnosticStatus.WARN, "pace", text)

    def _watch_peers(self) -> None:
        if self._pilot is None or self._paused:
            return
        if self._disturbed():
            self._end(EndCause.DISTURBED)
            self._offered = False
            self._heard = self._disturbed_at = time.monotonic()
            return
        if not self._offered:
            self._begin()
        if not self._offered and self._connected() and not self._ready():
            self._heard = time.monotonic()  # nobody else is to blame
            text = "no walk can begin before somebody calls /robot_hardware/begin"
            self.get_logger().info(text, throttle_duration_sec=_READY_REPORTS_S)
            self.remark(DiagnosticStatus.OK, "robot", text)
            return
        silent_s = time.monotonic() - self._heard
        if silent_s < self._settings.timeout_s:
            return
        peer = self._silent_peer()
        what = "the walk is given up" if self._offered else "no walk can begin"
        text = f"{peer} has been silent for {silent_s:.1f} s; {what}"
        self.get_logger().error(text)
        self.remark(DiagnosticStatus.ERROR, "silent peer", text)
        # A walk cut short is reported first; if nobody reacts, a new one is offered.
        self._heard = time.monotonic()
        if not self._end(EndCause.PEER_SILENT):
            self._begin()

    def _disturbed(self) -> bool:
        """Return whether a stranger publishes on any control topic."""
        found = False
        for topic in topics.CONTROL:
            text = self._ownership.strangers(topic)
            self.stranger(topic, text)
            found = found or text is not None
        return found

    def _connected(self) -> bool:
        """Return whether all who follow a walk will hear of its beginning."""
        # Learner and trajectory listen once their own answers get through.
        peers = (topics.LEARNER_NODE, topics.TRAJECTORY_NODE)
        if not self.reaches(self._observations, *peers):
            return False
        # They may have stopped to listen to each other, for a stranger.
        for topic, listener in (
            (topics.CORRECTION, topics.TRAJECTORY_NODE),
            (topics.WAIST_REFERENCE, NAME),
            (topics.EPISODE, NAME),
        ):
            listening = self.get_subscriptions_info_by_topic(topic.name)
            if listener not in {info.node_name for info in listening}:
                return False
        first = self._pilot is not None and self._pilot.walks == 0
        waited_s = time.monotonic() - self._heard
        if not first or waited_s >= self._settings.timeout_s:
            return True
        # What is published before a recorder is there would be lost.
        recorders = self._settings.recorders
        listeners = self._observations.get_subscription_count()
        return (
            self._ticks.listeners() >= recorders and listeners >= len(peers) + recorders
        )

    def _ready(self) -> bool:
        """Return whether the robot is on its feet; a real one is put there by hand."""
        return self._pilot is not None and self._pilot.biped.world.ready()

    def _silent_peer(self) -> str:
        for topic, peer in (
            (topics.CORRECTION, topics.LEARNER_NODE),
            (topics.WAIST_REFERENCE, topics.TRAJECTORY_NODE),
        ):
            if self.count_publishers(topic.name) == 0:
                return f"{peer} (not on the graph)"
        return "learner_node or trajectory_node"

    def _publish(self, observation: Observation) -> None:
        if self._loop is None:
            self._heard = time.monotonic()
            self._observed_ns = time.monotonic_ns()
        self._observations.publish(string_message(encode(observation)))

    # -- services ------------------------------------------------------------------

    def _on_pause(
        self, request: SetBool.Request, response: SetBool.Response
    ) -> SetBool.Response:
        if self._settings.sim.engine == ROBOT:
            response.message = "a real robot cannot be stopped in the middle of a walk"
            return response
        self._paused = request.data
        self._heard = time.monotonic()
        if self._loop is not None:
            loop, paused = self._loop, request.data
            loop.request(lambda: loop.pause(paused))
        elif not self._paused and self._held is not None:
            held, self._held = self._held, None
            self._observed_ns = time.monotonic_ns()
            self.guarded(topics.WAIST_REFERENCE, self._on_segment, held)
        response.success = True
        response.message = "paused" if request.data else "walking"
        return response

    def _on_reset(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        response.success = self._end(EndCause.RESET)
        self._held = None  # it was for the walk that has ended
        response.message = "walk ended" if response.success else "no walk to end"
        return response

    def _on_push(
        self, request: SetBool.Request, response: SetBool.Response
    ) -> SetBool.Response:
        """Push the robot: true to its left, false to its right.

        Only where nothing is learned: a walk that was pushed by hand would teach what
        nobody can repeat.
        """
        if self._pilot is None or not self._pilot.walking:
            response.message = "no walk to push"
        elif self._settings.sim.engine == ROBOT:
            response.message = "a real robot is pushed by hand"
        elif not (self._frozen and self._frozen_walk):
            response.message = (
                "this walk is learned from; freeze the learner, and push the next one"
            )
        else:
            self._push_n = _PUSH_FORCE_N if request.data else -_PUSH_FORCE_N
            self._push_ticks = _PUSH_TICKS
            response.success = True
            response.message = f"pushed to the {'left' if request.data else 'right'}"
        return response


def main() -> int:
    """Run the node as a process."""
    return run_node(SimNode)


if __name__ == "__main__":
    sys.exit(main())
