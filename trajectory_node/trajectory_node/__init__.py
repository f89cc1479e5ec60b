"""Gait, static waist, reference ZMP and the B-spline waist correction."""
