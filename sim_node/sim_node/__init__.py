"""The simulated world: physics, servo, measured ZMP and pacing."""
