"""One look for all that is shown: what each colour means, on light and on dark ground.

What stands for one thing has one
colour everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from biped_common import colours

Colour = tuple[int, int, int]
"""Red, green, blue, from 0 to 255."""


def _rgb(colour: str) -> Colour:
    red, green, blue = bytes.fromhex(colour.removeprefix("#"))
    return red, green, blue


_BLUE, _VERMILLION = _rgb(colours.BLUE), _rgb(colours.VERMILLION)
_GREEN, _PURPLE = _rgb(colours.GREEN), _rgb(colours.PURPLE)
_ORANGE, _SKY, _GREY = _rgb(colours.ORANGE), _rgb(colours.SKY), _rgb(colours.GREY)


@dataclass(frozen=True)
class Theme:
    """Colours by what they stand for."""

    dark: bool
    ink: Colour
    """Text, axes."""
    soft: Colour
    """What stays behind: the floor's lines, grids."""
    paper: Colour
    """The ground on which all is drawn."""
    zmp: Colour = _VERMILLION
    """Measured ZMP, and its error."""
    zmp_reference: Colour = _BLUE
    limit: Colour = _PURPLE
    """The bound at which a walk fails."""
    support: Colour = _SKY
    """Support polygon."""
    static_waist: Colour = _GREY
    """The planned waist without corrections."""
    waist: Colour = _GREEN
    """The corrected waist."""
    waist_ahead: Colour = _ORANGE
    """The corrected waist, not walked yet."""
    left: Colour = _BLUE
    right: Colour = _VERMILLION
    exploring: Colour = _SKY
    """States whose actions are still chosen by chance."""
    fixed: Colour = _GREEN
    """States in fixed mode."""
    penalty: Colour = _VERMILLION
    """Penalty states."""


LIGHT: Final = Theme(
    dark=False, ink=_rgb(colours.INK), soft=(205, 210, 217), paper=_rgb(colours.PAPER)
)
DARK: Final = Theme(
    dark=True,
    ink=(231, 233, 236),
    soft=(62, 69, 78),
    paper=(21, 24, 28),
    zmp_reference=_SKY,
    left=_SKY,
    support=_BLUE,
)


def css(colour: Colour, opacity: float = 1.0) -> str:
    """Return a colour as style sheets and plots write it."""
    red, green, blue = colour
    return f"rgba({red}, {green}, {blue}, {opacity:g})"
