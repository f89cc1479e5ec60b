"""A learner for short walks: first target 3 learning ticks, then 2 more at a time."""

from learner_node.walking.settings import (
    ActionSettings,
    LearnerSettings,
    ScheduleSettings,
)
from learner_node.xol.settings import XolSettings

SETTINGS = LearnerSettings(
    xol=XolSettings(
        discount=0.5,
        queue_length=20,
        failure_reach=2,
        minimum_selections=1000,
        selection_memory=0,
    ),
    action=ActionSettings(alternatives=5),
    schedule=ScheduleSettings(
        successes_per_subtask=2, first_target_s=0.06, extension_s=0.04
    ),
)
