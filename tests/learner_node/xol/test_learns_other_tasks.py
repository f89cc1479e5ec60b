"""The learner knows nothing of walking: any inputs, components and alternatives."""

from dataclasses import dataclass

import numpy as np
import pytest

from learner_node.problem import ActionSpace, Problem
from learner_node.states import StateSettings
from learner_node.xol.agent import XolAgent
from learner_node.xol.settings import FixedModeSettings, XolSettings

SIDE = 3.0
MOST_DECISIONS = 12
FELL, LATE = 0, 1
PENALTY_VALUES = (10.0, 5.0, 10.0)


@dataclass
class Ledge:
    """Cross a ledge from the near corner to the far one, without falling off.

    Inputs: one lamp (+1 or -1) per discrete input, then a position per component in
    [-0.5, SIDE + 0.5]. An action moves each component by -1 to 1; a lamp at -1, which
    is drawn anew for each crossing, reverses its component.
    """

    n_lamps: int
    n_components: int
    n_alternatives: int
    rng: np.random.Generator

    def start(self):
        self.lamps = self.rng.choice((-1.0, 1.0), self.n_lamps)
        self.position = np.zeros(self.n_components)
        self.decisions = 0

    @property
    def inputs(self):
        return np.concatenate([self.lamps, self.position])

    def move(self, chosen):
        step = np.linspace(-1.0, 1.0, self.n_alternatives)[chosen]
        lit = min(self.n_lamps, self.n_components)
        step[:lit] *= self.lamps[:lit]
        self.position = np.minimum(self.position + step, SIDE)
        self.decisions += 1

    @property
    def end(self):
        """None, FELL, LATE or "there"."""
        if (self.position < -0.5).any():
            return FELL
        if (self.position >= SIDE).all():
            return "there"
        return LATE if self.decisions == MOST_DECISIONS else None


def practise(agent, ledge):
    """Cross once, learning; return whether the far corner was reached."""
    ledge.start()
    agent.begin_episode(ledge.inputs)
    while True:
        ledge.move(agent.choose())
        if ledge.end is not None:
            break
        agent.advance(ledge.inputs)
    if ledge.end == "there":
        agent.reward(100.0, counts=True)
    else:
        agent.penalise(ledge.end)
    agent.finish_episode()
    return ledge.end == "there"


def cross_greedily(agent, ledge):
    """Cross once without learning; return whether the far corner was reached."""
    ledge.start()
    while ledge.end is None:
        ledge.move(agent.greedy(ledge.inputs))
    return ledge.end == "there"


def agent_for(ledge, seed=1, **changes):
    changes.setdefault("basis", "gaussian")
    settings = XolSettings(
        discount=0.8,
        queue_length=12,
        penalty_reach=1,
        failure_reach=1,
        minimum_selections=4,
        failure_threshold=changes.get("failure_threshold", 0.5),
        base_weight=1.0,
        decomposed=changes.get("decomposed", True),
        fixed_mode=FixedModeSettings(rewards_to_fix=10),
    )
    return XolAgent(
        settings,
        StateSettings(basis=changes["basis"]),
        Problem(
            ledge.n_lamps,
            (0.7,) * ledge.n_components,
            ActionSpace((ledge.n_alternatives,) * ledge.n_components),
            PENALTY_VALUES,
        ),
        np.random.default_rng(seed),
    )


TASKS = {
    "1 lamp, 1 component, 2 alternatives": (1, 1, 2, {}),
    "no lamp, 2 components, 3 alternatives": (0, 2, 3, {}),
    "2 lamps, 2 components, 3 alternatives": (2, 2, 3, {}),
    "3 lamps, 1 component, 5 alternatives": (3, 1, 5, {}),
    # With three components even the right sub-rule fails in most first steps.
    "no lamp, 3 components, 3 alternatives": (0, 3, 3, {"failure_threshold": 0.9}),
    "joint actions": (1, 2, 3, {"decomposed": False}),
    "uniform grid": (1, 2, 3, {"basis": "uniform"}),
}


@pytest.fixture(params=TASKS.values(), ids=TASKS.keys(), scope="module")
def practised(request):
    """(agent, ledge, successes per episode) after practice."""
    *sizes, changes = request.param
    ledge = Ledge(*sizes, np.random.default_rng(0))
    agent = agent_for(ledge, **changes)
    return agent, ledge, [practise(agent, ledge) for _ in range(400)]


def test_success_becomes_more_frequent(practised):
    _, _, successes = practised
    assert np.mean(successes[-50:]) > np.mean(successes[:20]) + 0.1


def test_the_greedy_policy_arrives(practised):
    agent, ledge, _ = practised
    assert all(cross_greedily(agent, ledge) for _ in range(20))
