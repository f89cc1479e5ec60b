"""Various daemon related sub-commands."""
