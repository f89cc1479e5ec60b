"""Three plots under each other: ZMP error, corrections, T_err per episode."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import viser

from biped_view.live.moment import Episodes, Traces
from biped_view.theme import Colour, Theme, css

_HEIGHT_PX: Final = 168
_MM = 1000.0
_ERROR_HEADROOM: Final = 1.35  # of the limit
_CORRECTION_SCALE: Final[Any] = {"range": (-30.0, 30.0)}  # [mm]
_LOGARITHMIC: Final[Any] = {"distr": 3}
_EMPTY: Final = np.array([0.0, 0.0])
_OF_EPISODES: Final = "T_err by episode"
_FONTS: Final[Any] = {"font": "11px sans-serif", "labelFont": "11px sans-serif"}
_AXES: Final[Any] = ({**_FONTS, "size": 32}, {**_FONTS, "size": 42})


class Plots:
    """The plots of one page, in the tab that is open when they are made."""

    def __init__(self, gui: viser.GuiApi, theme: Theme) -> None:
        """Add empty plots.

        Args:
            gui: of the page.
            theme: of the colours.
        """
        self._limit_mm = self._walk_s = 1.0
        self._wiggle = 0.0
        self._plots = [
            gui.add_uplot(
                (_EMPTY, _EMPTY, _EMPTY),
                series,
                title=title,
                scales={"x": {"time": False}, "y": y_scale},
                axes=_AXES,
                legend={"show": True, "live": False},
                cursor={"show": False},
                height=_HEIGHT_PX,
                padding=(8, 16, 0, 0),
                visible=title != _OF_EPISODES,  # until there are some
            )
            for title, series, y_scale in zip(
                ("ZMP error [mm]", "Correction of the waist [mm]", _OF_EPISODES),
                _series(theme),
                (_error_scale(1.0), _CORRECTION_SCALE, _LOGARITHMIC),
                strict=True,
            )
        ]

    def paint(self, theme: Theme) -> None:
        """Draw in the colours of a theme."""
        for plot, series in zip(self._plots, _series(theme), strict=True):
            plot.series = series

    def set_walk(self, zmp_limit_m: float, walk_s: float) -> None:
        """Fit the plots to a walk.

        Args:
            zmp_limit_m: at which it fails.
            walk_s: time of the whole walk, the width of the plots over time.
        """
        self._limit_mm, self._walk_s = _MM * zmp_limit_m, walk_s
        error = self._plots[0]
        error.scales = {"x": {"time": False}, "y": _error_scale(self._limit_mm)}

    def show_walk(self, traces: Traces) -> None:
        """Draw what was measured along a walk, over the time of the whole walk."""
        nothing = np.full(1, np.nan)
        # uPlot leaves out the ticks of an axis that had no width when it was made,
        # until its scale changes.
        self._wiggle = 1.0 - self._wiggle
        end_s = self._walk_s * (1.0 + 1e-9 * self._wiggle)
        time_s = np.concatenate(([0.0], traces.time_s, [end_s]))
        error, dx, dy = (
            np.concatenate((nothing, _MM * values, nothing))
            for values in (traces.zmp_error_m, *traces.correction_m.T)
        )
        self._plots[0].data = (time_s, error, np.full(len(time_s), self._limit_mm))
        self._plots[1].data = (time_s, dx, dy)

    def show_episodes(self, episodes: Episodes) -> None:
        """Draw T_err of the episodes."""
        if len(episodes.number):
            self._plots[2].visible = True
            self._plots[2].data = (
                episodes.number * (1.0 + 1e-9 * self._wiggle),
                np.where(episodes.completed, episodes.t_err, np.nan),
                np.where(episodes.completed, np.nan, episodes.t_err),
            )


def _series(theme: Theme) -> tuple[Any, Any, Any]:
    """Return what each plot draws."""
    return (
        ({"label": "time"}, _line("error", theme.zmp), _line("limit", theme.limit)),
        (
            {"label": "time"},
            _line("x, ahead", theme.zmp_reference),
            _line("y, to the left", theme.waist_ahead),
        ),
        (
            {"label": "episode"},
            _dots("completed", theme.fixed),
            _dots("failed", theme.penalty),
        ),
    )


def _error_scale(limit_mm: float) -> Any:
    return {"range": (0.0, _ERROR_HEADROOM * limit_mm)}


def _line(label: str, colour: Colour) -> Any:
    return {"label": label, "stroke": css(colour), "width": 1.5,
            "points": {"show": False}}  # fmt: skip


def _dots(label: str, colour: Colour) -> Any:
    return {"label": label, "stroke": css(colour), "width": 0,
            "points": {"show": True, "size": 4, "fill": css(colour)}}  # fmt: skip
