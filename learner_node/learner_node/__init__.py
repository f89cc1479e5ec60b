"""Exploitation-oriented learning of the waist correction."""
