"""Wiring: presets, the in-process walk, training and the command line."""
