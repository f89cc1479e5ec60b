"""Verbs of `biped` that show something."""
