"""Names under which a bag tells of its run, beside the messages."""

RUN_RECORD = "biped.run"
"""MCAP metadata at the head of every file: with what the run began."""
EPISODE_RECORD = "biped.episode"
"""MCAP metadata, one for each walk that has ended."""
COUNTS_RECORD = "biped.counts"
"""MCAP metadata at the end: what was received, written and lost, by topic."""
# In metadata.yaml; a bag without them was not ended in order.
STATE_KEY, LOST_KEY = "biped.recording", "biped.lost"
