"""Starts the nodes as processes, watches them, restarts them, and ends them all."""
