"""The learner on ROS: an observation in, a correction or an episode's result out.

What failures do:
    the checkpoint cannot be written: learning goes on, log and /diagnostics say so, and
        it is tried again when the next one is due; a service that asked is told.
    a walk is joined in its middle, or ends from outside: it is given up, neither an
        episode nor learned from, and walked again.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.publisher import Publisher
from std_srvs.srv import SetBool, Trigger

from biped_common.settings import from_json, to_mapping
from biped_ros.cdr import string_message, string_text
from biped_ros.environment import LEASE_S
from biped_ros.guarded import GuardedNode
from biped_ros.messages import correction_template
from biped_ros.observation_gaps import ObservationGaps
from biped_ros.process import process_name
from biped_ros.running import claim_processor, run_node
from biped_ros.sole_publisher import Publishers
from learner_node.checkpoint import (
    CheckpointError,
    read_checkpoint,
    taking_over,
    write_checkpoint,
)
from learner_node.settings import LearnerNodeSettings
from learner_node.walking.session import LearningSession
from msgs_json import topics
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation
from msgs_json.wire import RefusedMessageError, decode, encode

NAME = topics.LEARNER_NODE
NOT_SAVED = "not saved"
"""In /diagnostics: why the last checkpoint could not be written; empty if it was."""
_STATUS_PERIOD_S = 1.0
_LOOK_PERIOD_S = 0.1
# Until a learner that was killed is off the graph.
_PREDECESSOR_S = LEASE_S + 2.0


class LearnerNode(GuardedNode):
    """A learning session between two topics."""

    def __init__(self, **options: Any) -> None:
        """Go on from the checkpoint, if there is one.

        Args:
            options: of `rclpy.node.Node`, such as `parameter_overrides`.

        Raises:
            SettingsError: a parameter is wrong.
            CheckpointError: the file is there, but cannot be used.
        """
        super().__init__(NAME, **options)
        settings = self.settings_from_parameters(LearnerNodeSettings, self._on_settings)
        claim_processor(self, settings.processor)
        self._settings = settings
        # Who walks with the memory needs to know the gait, too; the learner does not.
        self._run_settings = {
            **from_json("run_settings", settings.run_settings, dict[str, Any]),
            "learner": to_mapping(settings.learner),
        }
        self._started = time.monotonic()
        self.instance = f"learner-{time.time_ns()}-{process_name()}"
        self.session = LearningSession(
            settings.learner, settings.walk_ticks, settings.seed
        )
        self._file = (
            Path(settings.checkpoint_file) if settings.checkpoint_file else None
        )
        if self._file is not None and self._file.exists():
            with taking_over(self._file):
                self.session.restore(*read_checkpoint(self._file))
        self.session.frozen = settings.frozen
        self._done = False
        self._save_due = False
        self._saved_episodes: int | None = None
        self._not_saved = ""
        """Why the last checkpoint could not be written."""
        self._anew()
        self._template = correction_template()
        self._corrections: Publisher | None = None
        self.create_service(Trigger, f"{NAME}/save_memory", self._on_save)
        self.create_service(SetBool, f"{NAME}/freeze", self._on_freeze)
        self._ownership = Publishers(self)
        self._waiting = self.create_timer(settings.listen_s, self._take_part)

    def _take_part(self) -> None:
        """Answer observations from now on, unless another learner does.

        One that was killed stays on the graph for a while. Until then this one
        publishes nothing, so as not to disturb the other's walks.
        """
        self._waiting.cancel()
        other = self._ownership.any_on(topics.CORRECTION)
        if other is None:
            self._corrections = self.publisher(topics.CORRECTION)
            self._episodes = self.publisher(topics.EPISODE)
            self._status = self.publisher(topics.LEARNER_STATUS)
            self.create_timer(_STATUS_PERIOD_S, self._publish_status)
            self.listen(
                topics.OBSERVATION,
                self._on_observation,
                {
                    self._corrections: topics.TRAJECTORY_NODE,
                    self._episodes: topics.SIM_NODE,
                },
                self._anew,
            )
            self._publish_status()
        elif time.monotonic() - self._started < _PREDECESSOR_S:
            self._waiting = self.create_timer(_LOOK_PERIOD_S, self._take_part)
        else:
            self.failure = f"another learner is on this graph already: {other}"

    def _anew(self) -> None:
        """Forget the robot that was heard."""
        self._gaps = ObservationGaps()
        self._seen = ("", -1)

    def close(self) -> None:
        """Save what was learned, without the walk under way, once it has taken part."""
        if self._corrections is not None:
            self.session.cut_off(EndCause.RESET)
            self.save()

    def save(self) -> str | None:
        """Write the checkpoint, if one is kept; return why it could not be written."""
        if self._file is None or self._settings.frozen:
            return None
        header = {"settings": self._run_settings, **self.session.header()}
        try:
            write_checkpoint(self._file, header, self.session.arrays())
        except (OSError, CheckpointError) as error:
            text = (
                f"{self._file}: cannot be written: {error.strerror}"
                if isinstance(error, OSError)
                else str(error)
            )
            self.get_logger().error(text)
            self.remark(DiagnosticStatus.ERROR, "checkpoint", text)
            self._not_saved = text
            return text
        self._saved_episodes = self.session.episodes
        self._not_saved = ""
        return None

    def figures(self) -> dict[str, str]:
        """Return how much has been learned, and how much of it is saved."""
        saved = self._saved_episodes
        return {
            "episodes": str(self.session.episodes),
            "episodes saved": "none" if saved is None else str(saved),
            NOT_SAVED: self._not_saved,
        }

    def _on_settings(self, settings: LearnerNodeSettings) -> None:
        """Take over what may change while the learner learns."""
        self._settings = settings

    def _on_observation(self, message: bytes) -> None:
        if self._done:
            return  # the walk that the robot offers now is nobody's
        observation = decode(Observation, string_text(message))
        self.dropped(topics.OBSERVATION, self._gaps.before(observation))
        simulation, clock_ticks = self._seen
        if observation.simulation == simulation and (
            observation.clock_ticks <= clock_ticks
        ):
            raise RefusedMessageError(
                f"observation of clock tick {observation.clock_ticks} comes after that "
                f"of {clock_ticks}"
            )
        self._seen = (observation.simulation, observation.clock_ticks)
        if self.session.over(observation):
            return
        answer = self.session.respond(observation)
        if isinstance(answer, EpisodeResult):
            self._finish(answer)
        elif self._corrections is not None:
            self._corrections.publish(
                self._template.fill(np.asarray(answer), observation.clock_ticks)
            )

    def _finish(self, result: EpisodeResult) -> None:
        every = self._settings.checkpoint_every_episodes
        session = self.session
        frozen = self._settings.frozen
        walked = session.tally.evaluations if frozen else session.episodes
        counts = not result.end_cause.from_outside
        enough = 0 < self._settings.max_episodes <= walked and not session.trial_due
        self._done = counts and enough
        if self._save_due or self._done or (counts and session.episodes % every == 0):
            self.save()
            self._save_due = False
        self._publish_status()
        self._episodes.publish(string_message(encode(result)))

    def _publish_status(self) -> None:
        # Within a walk nothing is settled, and to hash a large memory takes too long.
        if not self.session.walking:
            self._settled = self.session.status(self.instance)
        status = msgspec.structs.replace(self._settled, frozen=self.session.frozen)
        self._status.publish(string_message(encode(status)))

    def _on_save(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        problem = self._saving_problem()
        if problem is None and self.session.walking:
            self._save_due = True
            response.message = f"will be saved to {self._file} at the walk's end"
        elif problem is None:
            problem = self.save()
            response.message = f"saved to {self._file}"
        if problem is not None:
            response.message = problem
        response.success = problem is None
        return response

    def _saving_problem(self) -> str | None:
        """Return why nothing can be saved, as far as that can be told beforehand."""
        if self._file is None:
            return "no checkpoint file was given at the start"
        if self._settings.frozen:
            return "this learner was started frozen: there is nothing new to save"
        if not os.access(self._file.parent, os.W_OK | os.X_OK):
            return f"{self._file}: its folder is not there, or cannot be written to"
        return None

    def _on_freeze(
        self, request: SetBool.Request, response: SetBool.Response
    ) -> SetBool.Response:
        self.session.frozen = request.data
        response.success = True
        word = "frozen: greedy walks" if request.data else "learning"
        response.message = f"{word} from the next walk on"
        return response


def main() -> int:
    """Run the node as a process."""
    return run_node(LearnerNode)


if __name__ == "__main__":
    sys.exit(main())
