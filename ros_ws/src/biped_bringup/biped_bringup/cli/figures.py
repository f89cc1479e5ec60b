"""A learner's own figures, as the commands show them."""

from __future__ import annotations

from collections.abc import Mapping


def figures_text(figures: Mapping[str, float]) -> str:
    """Return figures in words, such as `basis states 40, fixed states 12`."""
    return ", ".join(
        f"{name.replace('_', ' ')} {value:g}" for name, value in figures.items()
    )
