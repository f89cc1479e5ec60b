"""One look for all that is shown: what each colour means, on light and on dark ground.

Colours of Okabe and Ito ("Color Universal Design", 2008), told apart by people with any
common colour blindness. What stands for one thing has one colour everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

Colour = tuple[int, int, int]
"""Red, green, blue, from 0 to 255."""

_BLUE, _VERMILLION, _GREEN = (0, 114, 178), (213, 94, 0), (0, 158, 115)
_PURPLE, _ORANGE, _SKY = (204, 121, 167), (230, 159, 0), (86, 180, 233)


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
    static_waist: Colour = (140, 144, 150)
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
    dark=False, ink=(27, 29, 33), soft=(205, 210, 217), paper=(254, 254, 254)
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
