"""The rivals, made for any problem; their states are met as in `lettered_states`."""

from functools import partial

import numpy as np

from biped_lab.rivals.episodic_ps import EpisodicProfitSharing, EpisodicSettings
from biped_lab.rivals.online_ps import OnlineProfitSharing, OnlineSettings
from biped_lab.rivals.parp import Parp, ParpSettings
from biped_lab.rivals.random_choice import RandomChoice
from biped_lab.rivals.sarsa_lambda import SarsaLambda, SarsaSettings
from learner_node.problem import ActionSpace, Problem
from learner_node.states import StateSettings

PENALTY_VALUES = (8.0, 4.0, 2.0)
RIVALS = {
    "episodic_ps": partial(EpisodicProfitSharing, EpisodicSettings(base_weight=0.1)),
    "online_ps": partial(OnlineProfitSharing, OnlineSettings(base_weight=0.1)),
    "parp": partial(Parp, ParpSettings(base_weight=0.1)),
    "random": lambda states, problem, rng: RandomChoice(problem, rng),
    "sarsa_lambda": partial(SarsaLambda, SarsaSettings(exploration=0.3)),
}
"""By the names of their entry points; each takes states, problem, rng."""

OUTWEIGHS_ALL = 1e12
"""A base weight with which the draw alone decides."""


def one_input(alternatives=(2,), decomposed=True):
    return Problem(0, (1.0,), ActionSpace(alternatives, decomposed), PENALTY_VALUES)


def new(kind, alternatives=(2,), rng=None, **settings):
    """A learner of a class, such as (Parp, ParpSettings)."""
    learner, constants = kind
    rng = np.random.default_rng(0) if rng is None else rng
    return learner(constants(**settings), StateSettings(), one_input(alternatives), rng)


def q_of(learner, letter):
    """The first component's row of Q."""
    k = learner.states.find(at(letter), create=False)
    return learner.q[k, 0].tolist()


def at(letter):
    """The input of a state."""
    return np.array([10.0 * (ord(letter) - ord("A"))])
