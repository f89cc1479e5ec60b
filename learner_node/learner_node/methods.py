"""The learners there are, by the name that the setting `learner.method` gives them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from biped_common.settings import Settings, section, setting
from learner_node.learner import Learner
from learner_node.problem import Problem
from learner_node.q_lambda import QLambda, QLambdaSettings
from learner_node.states import StateSettings
from learner_node.xol.agent import XolAgent
from learner_node.xol.settings import XolSettings

METHODS = ("xol", "q_lambda")


@dataclass(frozen=True)
class MethodSettings(Settings):
    """Which learner, how inputs become its states, and each learner's constants."""

    method: str = setting(
        "xol",
        "",
        "xol: exploitation-oriented learning with fixed-mode states (Section 3); "
        "q_lambda: Watkins's Q(lambda) on the same states and sub-rules",
        choices=METHODS,
    )
    states: StateSettings = section(StateSettings)
    xol: XolSettings = section(XolSettings)
    q_lambda: QLambdaSettings = section(QLambdaSettings)


MakeLearner = Callable[[MethodSettings, Problem, np.random.Generator], Learner]
"""Makes a learner that knows nothing yet; see `make_learner`."""


def make_learner(
    settings: MethodSettings, problem: Problem, rng: np.random.Generator
) -> Learner:
    """Return a learner that knows nothing yet.

    Args:
        settings: which one, and its constants.
        problem: inputs, actions and penalties.
        rng: source of every random choice.
    """
    if settings.method == "q_lambda":
        return QLambda(settings.q_lambda, settings.states, problem, rng)
    return XolAgent(settings.xol, settings.states, problem, rng)
