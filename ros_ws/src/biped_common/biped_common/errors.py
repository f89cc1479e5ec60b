"""The root of all errors that are the user's to mend, and not the program's."""

from __future__ import annotations


class BipedError(Exception):
    """Something given from outside cannot be used.

    The message is for people: one line that names what and where, and what would do.
    """
