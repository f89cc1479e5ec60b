"""One look for all figures: sizes, lines, and exact bytes.

Figures are as wide as a page; nothing here is pyplot's.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from biped_common.colours import BLUE, INK, PAPER

_OF_THE_PAGE = {INK: "currentColor", PAPER: "var(--paper)", BLUE: "var(--blue)"}
"""Colours that a page may change: in the dark, ours would not be seen."""
WIDTH_IN = 7.2
_DPI = 160

_STYLE: Any = {
    "axes.edgecolor": INK,
    "axes.facecolor": "none",
    "axes.labelcolor": INK,
    "axes.labelsize": 9.0,
    "axes.linewidth": 0.8,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 9.0,
    "axes.titleweight": "bold",
    "figure.facecolor": PAPER,
    "font.family": "DejaVu Sans",
    "font.size": 8.5,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "lines.linewidth": 1.5,
    "svg.fonttype": "path",
    "svg.hashsalt": "biped",
    "text.color": INK,
    "xtick.color": INK,
    "xtick.labelsize": 8.0,
    "ytick.color": INK,
    "ytick.labelsize": 8.0,
}


@contextmanager
def theme() -> Iterator[None]:
    """Draw and write figures in the laboratory's look."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_STYLE)
        yield


def new_figure(height_in: float) -> Figure:
    """Return an empty figure of the page's width."""
    figure = Figure(figsize=(WIDTH_IN, height_in), layout="constrained", dpi=_DPI)
    FigureCanvasAgg(figure)
    return figure


def png(figure: Figure) -> bytes:
    """Return a picture, the same for the same figure."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None})
    return stream.getvalue()


def svg(figure: Figure) -> bytes:
    """Return a drawing without date and maker, the same for the same figure."""
    nothing = dict.fromkeys(("Date", "Creator", "Format", "Type"))
    stream = io.BytesIO()
    figure.savefig(stream, format="svg", metadata=nothing)
    return stream.getvalue()


def inline_svg(drawing: bytes, name: str, title: str) -> str:
    """Return the drawing as an element of a page, in the page's own colours.

    Args:
        drawing: what `svg` returned.
        name: begins every identifier, for a page has several drawings.
        title: what is to be seen, for those who do not see it.
    """
    text = drawing.decode()
    text = text[text.index("<svg") :]
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = text.replace('href="#', f'href="#{name}-').replace("url(#", f"url(#{name}-")
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.DOTALL)
    for colour, name_of_page in _OF_THE_PAGE.items():
        text = text.replace(colour, name_of_page)
    return text.replace("<svg ", f'<svg role="img" aria-label="{title}" ', 1)
