"""Experiments, baselines, other tasks and figures."""
