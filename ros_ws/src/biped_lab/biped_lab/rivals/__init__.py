"""Rivals of XoL behind the Learner seam: on its states, sub-rules, rewards, penalties.

`docs/rivals.md` says where each comes from, and how its source is read.
"""
