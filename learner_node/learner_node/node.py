"""The learner on ROS: an observation in, a correction or an episode's result out."""

from __future__ import annotations

import json
import sys
import time
import uuid
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.publisher import Publisher
from std_srvs.srv import SetBool, Trigger

from learner_node.checkpoint import CheckpointError, read_checkpoint, write_checkpoint
from learner_node.settings import LearnerNodeSettings
from learner_node.walking.session import LearningSession
from msgs_json import topics
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation
from msgs_json.refusal import RefusedMessageError
from msgs_json.ros.cdr import string_message, string_text
from msgs_json.ros.guarded import GuardedNode
from msgs_json.ros.messages import correction_template
from msgs_json.ros.parameters import declared_settings
from msgs_json.ros.running import run_node
from msgs_json.wire import decode, encode

NAME = "learner_node"
_STATUS_PERIOD_S = 1.0


class LearnerNode(GuardedNode):
    """A learning session between two topics."""

    def __init__(self, **options: Any) -> None:
        """Go on from the checkpoint, if there is one.

        Args:
            options: of `rclpy.node.Node`, such as `parameter_overrides`.

        Raises:
            CheckpointError: the file is there, but cannot be used.
        """
        super().__init__(NAME, **options)
        settings = declared_settings(self, LearnerNodeSettings)
        self._settings = settings
        # Names sort by the time of the start: of two learners, the first stays.
        self.instance = f"learner-{time.time_ns()}-{uuid.uuid4().hex[:8]}"
        self.session = LearningSession(
            settings.learner, settings.walk_ticks, settings.seed
        )
        self._file = (
            Path(settings.checkpoint_file) if settings.checkpoint_file else None
        )
        if self._file is not None and self._file.exists():
            header, arrays = read_checkpoint(self._file)
            try:
                self.session.restore(header, arrays)
            except (KeyError, TypeError, ValueError) as error:
                raise CheckpointError(f"{self._file}: does not fit, {error}") from error
        self.session.frozen = settings.frozen
        self._done = False
        self._save_due = False
        self._seen = ("", -1)
        self._template = correction_template(self.instance)
        self._corrections: Publisher | None = None
        self._episodes = self.publisher(topics.EPISODE)
        self._status = self.publisher(topics.LEARNER_STATUS)
        self.listen(topics.LEARNER_STATUS, self._on_status)
        self.create_timer(_STATUS_PERIOD_S, self._publish_status)
        self.create_service(Trigger, f"{NAME}/save_memory", self._on_save)
        self.create_service(SetBool, f"{NAME}/freeze", self._on_freeze)
        self._publish_status()
        if settings.listen_s > 0.0:
            self._listening = self.create_timer(settings.listen_s, self._take_part)
        else:
            self._take_part()

    def _take_part(self) -> None:
        """Answer observations from now on: no other learner has been heard."""
        if self._corrections is None and self.failure is None:
            self._corrections = self.publisher(topics.CORRECTION)
            self.listen(topics.OBSERVATION, self._on_observation)
            self._publish_status()

    def close(self) -> None:
        """Save what was learned, if the session stands between two walks."""
        if not self.session.walking:
            self.save()

    def save(self) -> None:
        """Write the checkpoint, if one is planned."""
        if self._file is not None and not self._settings.frozen:
            run_settings = json.loads(self._settings.run_settings)
            header = {"settings": run_settings, **self.session.header()}
            write_checkpoint(self._file, header, self.session.arrays())

    def _on_observation(self, message: bytes) -> None:
        if self._done:
            return  # the walk that the robot offers now is nobody's
        observation = decode(Observation, string_text(message))
        simulation, clock_ticks = self._seen
        if observation.simulation == simulation and (
            observation.clock_ticks <= clock_ticks
        ):
            raise RefusedMessageError(
                f"observation of clock tick {observation.clock_ticks} comes after that "
                f"of {clock_ticks}"
            )
        self._seen = (observation.simulation, observation.clock_ticks)
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
        walked = session.tally.evaluations if session.frozen else session.episodes
        self._done = 0 < self._settings.max_episodes <= walked and not session.trial_due
        if self._save_due or self._done or session.episodes % every == 0:
            self.save()
            self._save_due = False
        self._publish_status()
        self._episodes.publish(string_message(encode(result)))

    def _on_status(self, message: bytes) -> None:
        status = decode(LearnerStatus, string_text(message))
        if status.instance == self.instance:
            return
        if status.instance < self.instance:
            self.failure = f"learner {status.instance} is on this graph already"
        raise RefusedMessageError(
            f"a second learner is on this graph: {status.instance} beside "
            f"{self.instance}"
        )

    def _publish_status(self) -> None:
        status = self.session.status(
            self.instance, active=self._corrections is not None
        )
        self._status.publish(string_message(encode(status)))

    def _on_save(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        if self._file is None:
            response.message = "no checkpoint file was given at the start"
            return response
        if self.session.walking:
            self._save_due = True
            response.message = f"will be saved to {self._file} at the walk's end"
        else:
            self.save()
            response.message = f"saved to {self._file}"
        response.success = True
        return response

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
