"""The report of a study: figures, tables, and one HTML page that needs nothing else.

`write_report` in `write.py` is the way in.
"""
