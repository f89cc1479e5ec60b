"""A learning run in this process, written down as the nodes would publish it."""

import numpy as np

from biped_bringup.walker import Walker
from biped_common.seeds import robot_stream
from biped_description.joints import JOINT_NAMES
from biped_ros.cdr import string_message
from biped_ros.messages import (
    correction_template,
    joint_state_template,
    point_template,
)
from learner_node.walking.session import LearningSession
from msgs_json import topics
from msgs_json.episode_result import EpisodeResult
from msgs_json.wire import encode

LEARNER = "learner-1"


class RecordedRun:
    """Messages of the graph, in the order in which they would be sent."""

    def __init__(self, settings, seed, *, frozen=False):
        self.settings, self.seed = settings, seed
        self.messages = []
        self._states = joint_state_template(JOINT_NAMES, with_effort=True)
        self._references = joint_state_template(JOINT_NAMES, with_effort=False)
        self._point = point_template()
        self._correction = correction_template()
        rng = np.random.default_rng(robot_stream(seed))
        self._walker = Walker(settings, rng, self._on_tick)
        self.session = self.new_session()
        self.session.frozen = frozen
        self._say_status()

    def new_session(self):
        """Return a learner as it stood when the run began."""
        return LearningSession(
            self.settings.learner, self._walker.walk_ticks, self.seed
        )

    def walk(self, walks):
        """Walk so often; return the messages so far."""
        for _ in range(walks):
            self._walker.walk(self)
        return self.messages

    def respond(self, observation):
        """Stand between robot and learner, and write down what both say."""
        answer = self.session.respond(observation)
        self._say(topics.OBSERVATION, string_message(encode(observation)))
        if isinstance(answer, EpisodeResult):
            self._say_status()
            self._say(topics.EPISODE, string_message(encode(answer)))
        else:
            message = self._correction.fill(answer, observation.clock_ticks)
            self._say(topics.CORRECTION, message)
        return answer

    def close(self):
        """End the world."""
        self._walker.close()

    def _on_tick(self, tick):
        at = tick.clock_ticks
        states = (*tick.joint_position, *tick.joint_velocity, *tick.joint_torque)
        references = (*tick.joint_reference, *tick.joint_velocity_reference)
        self._say(topics.JOINT_STATES, self._states.fill(states, at))
        self._say(topics.JOINT_REFERENCES, self._references.fill(references, at))
        self._say(topics.ZMP, self._point.fill(tick.contact[:2], at))
        self._say(topics.ZMP_REFERENCE, self._point.fill(tick.zmp_reference, at))

    def _say_status(self):
        status = self.session.status(LEARNER)
        self._say(topics.LEARNER_STATUS, string_message(encode(status)))

    def _say(self, topic, message):
        self.messages.append((topic.name, message))
