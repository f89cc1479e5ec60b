"""Contracts between the nodes: topic names, QoS and typed JSON payloads."""
