"""How far the learner has come."""

from __future__ import annotations

import msgspec

from msgs_json.observation import Count


class LearnerStatus(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    tag_field="version",
    tag=1,
):
    """State of the schedule and of the memory between two episodes."""

    instance: str
    """Name of the running learner; there must be one on a graph."""
    active: bool
    """Takes part; before, it listens whether another one does."""
    seed: Count
    target_time_s: float
    subtask: Count
    subtasks: Count
    successes: Count
    """RWDforSuc received in the present subtask."""
    episodes: Count
    """Learning episodes so far."""
    survival: float
    """Walked over target time, mean of the last episodes."""
    basis_states: Count
    fixed_states: Count
    penalty_states: Count
    t_err_estimate: float | None
    schedule_complete: bool
    learned: bool
    """The schedule is complete and a frozen greedy walk has succeeded."""
    frozen: bool
    """Learning is switched off by a user; walks are greedy."""
    simulated_s: float
    memory_sha256: str
    trajectory_sha256: str
    """Chained over the learning episodes."""
