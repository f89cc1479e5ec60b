"""Statistics of time to success: censored, with intervals, paired by seed.

Pure functions on arrays and tables. docs/statistics.md says which figure answers which
question, what it assumes, and how often its intervals and tests were found to err.
"""
