"""The player: a bag on the graph again, as it was recorded."""
