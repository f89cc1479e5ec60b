"""Three plots under each other: ZMP error, corrections, T_err per episode."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import viser

from biped_view.live.moment import Array, Episodes, Traces
from biped_view.theme import Theme, css

_HEIGHT_PX: Final = 168
_MM = 1000.0
_ERROR_HEADROOM: Final = 1.35  # of the limit
_CORRECTION_MM: Final = 30.0
_EMPTY: Final = np.array([0.0, 0.0])
_AXIS: Final[dict[str, Any]] = {
    "font": "11px sans-serif",
    "labelFont": "11px sans-serif",
}


class Plots:
    """The plots of one page, in the container that is open when they are made."""

    def __init__(
        self,
        gui: viser.GuiApi,
        tab: viser.GuiTabHandle,
        zmp_limit_m: float,
        walk_s: float,
    ) -> None:
        """Draw nothing before `paint`.

        Args:
            gui: of the page.
            tab: that holds the plots.
            zmp_limit_m: at which a walk fails.
            walk_s: time of the whole walk, the width of the plots over time.
        """
        self._gui, self._tab = gui, tab
        self._limit_mm = _MM * zmp_limit_m
        self._plots: list[viser.GuiUplotHandle] = []
        self._walk_s, self._wiggle = walk_s, 0.0

    def paint(self, theme: Theme) -> None:
        """Make the plots, anew if need be, in the colours of a theme."""
        self.remove()
        with self._tab:
            self._plots = [
                self._over_time(
                    "ZMP error [mm]",
                    ("error", theme.zmp, 1.6),
                    ("limit", theme.limit, 1.2),
                    (0.0, _ERROR_HEADROOM * self._limit_mm),
                    order=1.0,
                ),
                self._over_time(
                    "Correction of the waist [mm]",
                    ("x, ahead", theme.zmp_reference, 1.6),
                    ("y, to the left", theme.waist_ahead, 1.6),
                    (-_CORRECTION_MM, _CORRECTION_MM),
                    order=2.0,
                ),
                self._gui.add_uplot(
                    (_EMPTY, _EMPTY, _EMPTY),
                    (
                        {"label": "episode"},
                        _dots("completed", theme.fixed),
                        _dots("failed", theme.penalty),
                    ),
                    title="T_err by episode",
                    scales={"x": {"time": False}, "y": {"distr": 3}},
                    axes=_axes(),
                    legend={"show": True, "live": False},
                    cursor={"show": False},
                    height=_HEIGHT_PX,
                    padding=(8, 16, 0, 0),
                    order=3.0,
                ),
            ]

    def remove(self) -> None:
        """Take the plots away."""
        for plot in self._plots:
            plot.remove()
        self._plots = []

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
            self._plots[2].data = (
                episodes.number * (1.0 + 1e-9 * self._wiggle),
                np.where(episodes.completed, episodes.t_err, np.nan),
                np.where(episodes.completed, np.nan, episodes.t_err),
            )

    def _over_time(
        self,
        title: str,
        first: tuple[str, tuple[int, int, int], float],
        second: tuple[str, tuple[int, int, int], float],
        y_range: tuple[float, float],
        order: float,
    ) -> viser.GuiUplotHandle:
        nothing: Array = np.array([np.nan, np.nan])
        return self._gui.add_uplot(
            (np.array([0.0, self._walk_s]), nothing, nothing),
            ({"label": "time"}, _line(*first), _line(*second)),
            title=title,
            scales={
                "x": {"time": False},
                "y": {"range": y_range},
            },
            axes=_axes(),
            legend={"show": True, "live": False},
            cursor={"show": False},
            height=_HEIGHT_PX,
            padding=(8, 16, 0, 0),
            order=order,
        )


def _axes() -> tuple[Any, Any]:
    return ({**_AXIS, "size": 32}, {**_AXIS, "size": 42})


def _line(label: str, colour: tuple[int, int, int], width: float) -> Any:
    return {"label": label, "stroke": css(colour), "width": width,
            "points": {"show": False}}  # fmt: skip


def _dots(label: str, colour: tuple[int, int, int]) -> Any:
    return {"label": label, "stroke": css(colour), "width": 0,
            "points": {"show": True, "size": 4, "fill": css(colour)}}  # fmt: skip
