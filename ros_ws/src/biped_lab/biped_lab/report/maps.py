"""What a run has learned, over the waist plane: visits, corrections, kinds of states.

States are shown at the centre of their basis function, as far as the plane goes: the
waist relative to the support foot. The other inputs, such as ZMP error and phase, are
not seen, so that several states can lie upon each other.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from biped_bringup.run_settings import RunSettings
from biped_common.colours import BLUE, GREEN, GREY, PAPER, SKY, VERMILLION
from biped_common.settings import from_mapping
from biped_lab.report.finished import EPISODES, FinishedRuns
from biped_lab.report.marks import wrapped
from biped_lab.report.theme import new_figure
from learner_node.checkpoint import CheckpointError, read_checkpoint, taking_over
from learner_node.walking.task import COMPONENTS, WalkTask
from learner_node.walking.waist_plane import waist_of_states
from learner_node.xol.selection import choose_greedy

_PREFIX = "memory/"
_VISITS = LinearSegmentedColormap.from_list("visits", ("#cfe5f3", SKY, BLUE, "#00263d"))
_ROW_IN = 1.45
_ARROW_SCALE = 0.5  # an arrow of 0.02 m is as long as 0.04 m of the plane
_MARGIN_M = 0.05


@dataclass(frozen=True)
class LearnedMap:
    """The states of a memory; n of them."""

    waist_m: NDArray[np.float64]
    """(n, 2) centres, relative to the support foot."""
    visits: NDArray[np.int64]
    """(n,) choices of a sub-rule of dx, each once an episode, as the memory counts."""
    correction_m: NDArray[np.float64]
    """(n, 2) of the greedy action."""
    fixed: NDArray[np.bool_]
    """(n,)"""
    penalty: NDArray[np.bool_]
    """(n,)"""


class NoMapError(LookupError):
    """There is no memory to draw, or none of XoL; the message says which run's."""


def read_map(path: Path) -> LearnedMap:
    """Return the map of a run's checkpoint.

    Raises:
        NoMapError: it holds no memory of XoL.
        CheckpointError: the file is no usable checkpoint.
    """
    header, arrays = read_checkpoint(path)
    memory = {
        name.removeprefix(_PREFIX): array
        for name, array in arrays.items()
        if name.startswith(_PREFIX)
    }
    if not {"selections", "fixed", "avoided"} <= memory.keys():
        raise NoMapError("its memory is not one of profit sharing")
    with taking_over(path):
        settings = from_mapping(RunSettings, header["settings"]).learner
        task = WalkTask(settings, walk_ticks=1)
        return LearnedMap(
            waist_of_states(settings, memory["state_centers"]),
            memory["selections"][:, 0].sum(axis=1),
            _greedy_correction_m(task, memory),
            memory["fixed"],
            memory["penalty_state"],
        )


def _greedy_correction_m(
    task: WalkTask, memory: dict[str, NDArray[np.float64]]
) -> NDArray[np.float64]:
    space = task.problem.space
    sizes = np.array(space.sizes, dtype=np.int64)
    chosen = np.zeros(len(sizes), dtype=np.int64)
    found = np.zeros((len(memory["q"]), len(COMPONENTS)))
    for k in range(len(found)):
        choose_greedy(k, memory["q"], memory["p"], memory["avoided"], sizes, chosen)
        found[k] = task.correction_m(space.alternatives_of(chosen))
    return found


def median_run(finished: FinishedRuns, arm: str) -> tuple[int, str]:
    """Return seed and address of the run in the middle: by episodes, then by seed."""
    runs = finished.of(arm).sort_values([EPISODES, "seed"])
    middle = runs.iloc[(len(runs) - 1) // 2]
    return int(middle["seed"]), str(middle["address"])


def learned_maps(
    finished: FinishedRuns,
) -> tuple[dict[tuple[str, int], LearnedMap], list[str]]:
    """Return maps by arm and seed, and sentences on what could not be read."""
    maps, missing = {}, []
    for arm in finished.arms:
        seed, address = median_run(finished, arm)
        path = finished.results.memory(address)
        try:
            if path is None:
                raise NoMapError("its memory is not there")
            maps[arm, seed] = read_map(path)
        except (NoMapError, CheckpointError) as error:
            missing.append(f"{arm}, seed {seed}: {error}.")
    return maps, missing


def draw_maps(
    finished: FinishedRuns, maps: dict[tuple[str, int], LearnedMap]
) -> Figure:
    """Draw a row for each map: visits, corrections, and kinds of states.

    Seen from above, the robot walking up the page: y grows to the left.
    """
    figure = new_figure(_ROW_IN * len(maps) + 1.0)
    grid = figure.subplots(len(maps), 3, sharex=True, sharey=True, squeeze=False)
    most = max(int(each.visits.max(initial=1)) for each in maps.values())
    dots = None
    for axes, ((arm, seed), each) in zip(grid, maps.items(), strict=True):
        x, y = each.waist_m.T
        dots = axes[0].scatter(
            y, x, c=np.log10(np.maximum(each.visits, 1)), s=20, cmap=_VISITS,
            vmin=0.0, vmax=np.log10(most), linewidths=0.4, edgecolors=PAPER,
        )  # fmt: skip
        dx, dy = each.correction_m.T
        axes[1].plot(y, x, ".", color=GREY, markersize=3.0)
        axes[1].quiver(
            y, x, dy, dx, angles="xy", scale_units="xy", scale=_ARROW_SCALE,
            width=0.007, color=VERMILLION,
        )  # fmt: skip
        _draw_kinds(axes[2], each)
        axes[0].set_ylabel("x [m]")
        title = f"{finished.arrangement.title(arm)}, seed {seed}"
        axes[0].set_title(wrapped(title, 32))
        for panel in axes:
            panel.set_aspect("equal")
    centres = np.concatenate([each.waist_m for each in maps.values()])
    (x_low, y_low), (x_high, y_high) = centres.min(axis=0), centres.max(axis=0)
    grid[0, 0].set_xlim(y_high + _MARGIN_M, y_low - _MARGIN_M)
    grid[0, 0].set_ylim(x_low - _MARGIN_M, x_high + _MARGIN_M)
    for panel in grid[-1]:
        panel.set_xlabel("y [m]")
    assert dots is not None
    scale = figure.colorbar(
        dots, ax=grid, location="bottom", shrink=0.3, anchor=(0.0, 1.0), aspect=25
    )
    ticks = [n for n in (1, 10, 100, 1000, 10_000) if n <= most]
    scale.set_ticks(list(np.log10(ticks)), labels=[str(n) for n in ticks])
    scale.set_label("visits [choices]")
    grid[0, 1].set_title("corrections", fontweight="normal")
    grid[0, 2].set_title("kinds of states", fontweight="normal")
    kinds = [Line2D([], [], label=name, **style) for name, style in _KINDS.items()]
    figure.legend(handles=kinds, loc="outside lower right", ncols=3)
    return figure


_KINDS: dict[str, dict[str, Any]] = {
    "normal": {"linestyle": "", "marker": ".", "color": GREY, "markersize": 5.0},
    "fixed": {
        "linestyle": "", "marker": "o", "color": GREEN, "markersize": 4.5, "alpha": 0.8,
    },
    "penalty state": {
        "linestyle": "", "marker": "x", "color": VERMILLION, "markersize": 5.5,
        "markeredgewidth": 1.4,
    },
}  # fmt: skip


def _draw_kinds(axes: Axes, each: LearnedMap) -> None:
    kinds = {
        "normal": ~each.fixed & ~each.penalty,
        "fixed": each.fixed,
        "penalty state": each.penalty,
    }
    for name, kept in kinds.items():
        x, y = each.waist_m[kept].T
        axes.plot(y, x, **_KINDS[name])
