"""One look for all that is shown: what each colour means, on light and on dark ground.

The colours are those of the laboratory's figures. What stands for one thing has one
colour everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from PIL import ImageColor

from biped_lab.report import theme as figures

Colour = tuple[int, int, int]
"""Red, green, blue, from 0 to 255."""


def _rgb(colour: str) -> Colour:
    red, green, blue, *_ = ImageColor.getrgb(colour)
    return red, green, blue


_BLUE, _VERMILLION = _rgb(figures.BLUE), _rgb(figures.VERMILLION)
_GREEN, _PURPLE = _rgb(figures.GREEN), _rgb(figures.PURPLE)
_SKY, _GREY = _rgb(figures.SKY), _rgb(figures.GREY)


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


LIGHT: Final = Theme(
    dark=False, ink=(27, 29, 33), soft=(205, 210, 217), paper=(254, 254, 254)
)
DARK: Final = Theme(
    dark=True,
    ink=(231, 233, 236),
    soft=(62, 69, 78),
    paper=(21, 24, 28),
    zmp_reference=_SKY,
    support=_BLUE,
)
