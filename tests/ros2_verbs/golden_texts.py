"""Texts that the verbs must print; golden/README.md says whence."""

from pathlib import Path

FOLDER = Path(__file__).parent / "golden"


def golden(name: str) -> str:
    """Return the text of a file, with its last line's end."""
    return (FOLDER / f"{name}.txt").read_text()
