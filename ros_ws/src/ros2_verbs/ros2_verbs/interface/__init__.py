"""Verbs on message, service and action types."""
