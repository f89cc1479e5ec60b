"""Rivals that search: whole walks are planned ahead and walked open loop.

They see no states, only how far a plan has walked. Plant, actions, ends and budget are
the learner's.
"""
