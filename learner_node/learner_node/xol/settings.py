"""Constants of the learner (Sections 2, 3), and the readings of what is left open."""

from __future__ import annotations

from dataclasses import dataclass

from biped_common.settings import Settings, SettingsError, section, setting


@dataclass(frozen=True)
class FixedModeSettings(Settings):
    """When a state becomes fixed, and when it is released (Section 3.3)."""

    strategy: str = setting(
        "strategy1",
        "",
        "strategy1: after K rewards; strategy2: at the end of a subtask; none: never",
        choices=("strategy1", "strategy2", "none"),
    )
    rewards_to_fix: int = setting(
        15, "rewards", "K of Strategy 1: rewards after which a state is fixed", lower=1
    )
    fixes: str = setting(
        "best",
        "",
        "what a fixed state does: the best that it knows, or what it did when it was "
        "last rewarded (beyond the paper)",
        choices=("best", "rewarded"),
    )
    counted: str = setting(
        "queue_then_episode",
        "",
        "states whose TUC a reward raises: those still in the queue, all that the "
        "episode visited, or the latter only once the whole task is learned",
        choices=("queue", "episode", "queue_then_episode"),
    )
    released_states: int = setting(
        3, "states", "how many fixed states ahead of a penalty are released", lower=0
    )
    patience_episodes: int = setting(
        30,
        "failures",
        "after this many failures in a row, and again after as many more, the nearest "
        "fixed states in the queue are released; 0: never",
        lower=0,
    )
    release: str = setting(
        "last_decisions",
        "",
        "released are the fixed states among the last decisions, or the nearest "
        "fixed states within the queue",
        choices=("last_decisions", "nearest"),
    )


@dataclass(frozen=True)
class XolSettings(Settings):
    """Constants of online profit sharing with penalty avoidance (Section 3)."""

    discount: float = setting(
        0.98, "per decision", "gamma of the eligibility trace", above=0.0, upper=1.0
    )
    queue_length: int = setting(
        150,
        "decisions",
        "decisions that a reward reaches back (Section 3.2)",
        lower=1,
        upper=100_000,
    )
    penalty_reach: int = setting(
        3, "decisions", "decisions whose penalty weight P grows by eq. (1)", lower=1
    )
    failure_reach: int = setting(
        40,
        "decisions",
        "decisions whose failure count a penalty raises; must outlast the plant's lag",
        lower=1,
    )
    minimum_selections: int = setting(
        7, "episodes", "N0: selections before a sub-rule may be a penalty rule", lower=1
    )
    selection_memory: int = setting(
        28,
        "episodes",
        "a sub-rule selected so often has its selections and failures halved; 0: never",
        lower=0,
    )
    failure_threshold: float = setting(
        0.5, "", "lambda: failure rate above which a sub-rule is a penalty rule",
        lower=0.0, upper=1.0,
    )  # fmt: skip
    base_weight: float = setting(
        100.0,
        "",
        "added to every Q in the roulette, so that the first reward does not lock in",
        above=0.0,
    )
    decomposed: bool = setting(
        True, "", "sub-rules per component (Section 3.4) instead of joint rules"
    )
    redraw: str = setting(
        "decision",
        "",
        "a state in normal mode draws at every decision, or once an episode (beyond "
        "the paper)",
        choices=("decision", "episode"),
    )
    blame_share: float = setting(
        0.1,
        "",
        "where blame is directed: the least share of the strongest push that is judged",
        lower=0.0,
        upper=1.0,
    )
    fixed_mode: FixedModeSettings = section(FixedModeSettings)

    def check_together(self) -> None:
        """Refuse reaches beyond the queue, and memories too short to judge by."""
        if self.failure_reach > self.queue_length:
            raise SettingsError(
                "failure_reach",
                self.failure_reach,
                f"must be at most queue_length = {self.queue_length}",
            )
        # Halved counts must still be enough to judge by.
        if 0 < self.selection_memory < 2 * self.minimum_selections:
            raise SettingsError(
                "selection_memory",
                self.selection_memory,
                "must be 0 or at least twice minimum_selections = "
                f"{self.minimum_selections}",
            )
