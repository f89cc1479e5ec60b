"""How far the learner has come."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from msgs_json.bounds import Count, Digest, Name, Seed
from msgs_json.end_cause import EndCause


class LearnerStatus(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    tag_field="version",
    tag=3,
):
    """State of the schedule and of the memory between two episodes."""

    instance: Name
    """learner-START_NS-HOST:PROCESS of the one learner of the graph."""
    seed: Seed
    """Of the session's random choices."""
    target_time_s: float
    """Walking time that the present subtask asks for [s]."""
    subtask: Count
    """0-based place in the learning schedule."""
    subtasks: Count
    """How many the schedule has."""
    successes: Count
    """RWDforSuc received in the present subtask."""
    episodes: Count
    """Learning episodes so far."""
    survival: float
    """Walked over target time, mean of the last episodes."""
    figures: Annotated[dict[Name, float], Meta(max_length=50)]
    """What there is to know about the memory, under names of the learner's own."""
    t_err_estimate: float | None
    """T_err-hat of the present subtask; None before its first completed walk."""
    schedule_complete: bool
    """The last subtask has been passed."""
    learned: bool
    """The schedule is complete and a frozen greedy walk has succeeded."""
    frozen: bool
    """Learning is switched off by a user; walks are greedy."""
    given_up: Annotated[dict[EndCause, Count], Meta(max_length=len(EndCause))]
    """Walks that were given up, by what ended them; they are not among the episodes."""
    simulated_s: float
    """Walked in all learning episodes [s]."""
    memory_sha256: Digest
    """Hash of all that was learned."""
    trajectory_sha256: Digest
    """Chained over the learning episodes."""
