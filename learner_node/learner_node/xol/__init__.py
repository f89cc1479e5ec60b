"""Exploitation-oriented learning with fixed-mode states (Sections 2 and 3).

Knows nothing of robots: any number of discrete and continuous inputs, of action
components and alternatives, and of penalties.
"""
