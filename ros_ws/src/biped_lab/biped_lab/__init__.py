"""The laboratory: Gymnasium environments, learners on other tasks, studies.

Gymnasium finds no environments by entry points any more (since its version 1.0): this
import registers ours, and `gymnasium.make("biped_lab:BipedWaist-v0")` does both.
"""

import gymnasium

gymnasium.register(id="BipedWaist-v0", entry_point="biped_lab.waist_env:BipedWaistEnv")
gymnasium.register(
    id="BicycleBalance-v0",
    entry_point="biped_lab.bicycle_env:BicycleBalanceEnv",
    max_episode_steps=1000,
)
