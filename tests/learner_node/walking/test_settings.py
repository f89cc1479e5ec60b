"""Settings of the learner that cannot be used are refused in one telling line."""

import pytest

from biped_common.settings import SettingsError, from_mapping, to_mapping
from learner_node.states import StateSettings
from learner_node.walking.settings import LearnerSettings
from learner_node.xol.settings import FixedModeSettings, XolSettings

# (dotted key, value, what the message says is allowed)
REFUSED = [
    ("action.alternatives", 1, "must be between 2 and 1001"),
    ("action.alternatives", 15.0, "must be a whole number"),
    ("action.limit_m", 0.0, "must be above 0.0 m"),
    ("action.limit_m", 0.3, "must be at most 0.2 m"),
    ("action.hold_ticks", 0, "must be between 1 and 50 learning ticks"),
    ("action.hold_ticks", True, "must be a whole number"),
    ("inputs.waist_radius_m", 0.0, "must be above 0.0 m"),
    ("inputs.zmp_error_radius_m", -0.03, "must be above 0.0 m"),
    ("inputs.acceleration_radius_m_s2", float("nan"), "must be a finite number"),
    ("inputs.speed_radius_m", 0.1, "unknown key; known here: acceleration_radius"),
    ("cost.torque_reading", "in root", "must be one of in_root, outside_root"),
    ("cost.tolerance", -0.001, "must be between 0.0 and 1.0"),
    ("cost.zmp_limit_m", "6.5e-2", "must be a number"),
    ("rewards.success", float("inf"), "must be a finite number"),
    ("rewards.penalty", 0.0, "must be above 0.0"),
    ("schedule.successes_per_subtask", 0, "must be at least 1 successes"),
    ("schedule.first_target_s", 0.0, "must be at least 0.02 s"),
    ("schedule.extension_s", -1.0, "must be at least 0.02 s"),
    ("schedule.extension_s", None, "must be a number"),
    ("xol.discount", 0.0, "must be above 0.0 per decision"),
    ("xol.discount", 1.5, "must be at most 1.0"),
    ("xol.queue_length", 0, "must be between 1 and 100000 decisions"),
    ("xol.failure_reach", 151, "must be at most queue_length = 150"),
    ("xol.minimum_selections", 0, "must be at least 1 episodes"),
    ("xol.failure_threshold", 1.1, "must be between 0.0 and 1.0"),
    ("xol.base_weight", 0.0, "must be above 0.0"),
    ("xol.decomposed", "yes", "must be true or false"),
    ("states.basis", "radial", "must be one of gaussian, uniform"),
    ("states.activation_threshold", 0.0, "must be above 0.0"),
    ("states.life_episodes", 0, "must be at least 1 episodes"),
    ("method", "sarsa", "must be one of xol, q_lambda"),
    ("q_lambda.discount", 1.5, "must be at most"),
    ("xol.fixed_mode.strategy", "strategy3", "must be one of strategy1, strategy2, no"),
    ("xol.fixed_mode.rewards_to_fix", 0, "must be at least 1 rewards"),
    ("xol.fixed_mode.released_states", -1, "must be at least 0 states"),
    ("xol.fixed_mode.release", "all", "must be one of last_decisions, nearest"),
    ("xol.fixed_mode", "none", "must be a section of keys"),
]


def nested(key, value):
    for part in reversed(key.split(".")):
        value = {part: value}
    return value


@pytest.mark.parametrize(
    "key, value, allowed", REFUSED, ids=[f"{key}={value}" for key, value, _ in REFUSED]
)
def test_a_bad_value_is_refused_with_key_value_and_what_is_allowed(key, value, allowed):
    with pytest.raises(SettingsError) as caught:
        from_mapping(LearnerSettings, nested(key, value))
    message = str(caught.value)
    assert message.startswith(f"{key} = {value!r}: {allowed}")
    assert "\n" not in message


def test_a_shorter_queue_needs_a_shorter_reach_of_failures():
    with pytest.raises(SettingsError, match=r"failure_reach = 40: .*queue_length = 30"):
        from_mapping(LearnerSettings, nested("xol.queue_length", 30))


@pytest.mark.parametrize(
    "make",
    [
        lambda: XolSettings(discount=2.0),
        lambda: StateSettings(life_episodes=0),
        lambda: FixedModeSettings(strategy="both"),
        lambda: LearnerSettings(method="sarsa"),
    ],
    ids=["discount", "life", "strategy", "method"],
)
def test_bad_values_are_refused_in_code_too(make):
    with pytest.raises(SettingsError):
        make()


def test_defaults_are_the_numbers_of_the_paper():
    settings = LearnerSettings()
    assert settings.action.alternatives == 15
    assert settings.action.limit_m == 0.024
    assert settings.xol.minimum_selections == 7
    assert settings.xol.failure_threshold == 0.5
    assert settings.states.life_episodes == 100
    assert settings.cost.zmp_limit_m == 0.065
    assert settings.rewards.success == 10_000.0
    assert settings.rewards.goal == settings.rewards.penalty == 10.0
    assert settings.schedule.first_target_s == 1.875
    assert settings.schedule.extension_s == 0.9375


def test_settings_survive_their_way_through_plain_values():
    changed = from_mapping(LearnerSettings, nested("xol.fixed_mode.release", "nearest"))
    assert from_mapping(LearnerSettings, to_mapping(changed)) == changed
