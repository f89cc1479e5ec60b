"""Verbs of `biped lab`."""
