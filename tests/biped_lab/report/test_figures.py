import itertools
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import same_color, to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from tests.biped_lab.report.made_results import (
    BOUND,
    BY_LT,
    STRATEGY_1,
    MadeRun,
    made_results,
    runs_of,
)

from biped_common.colours import BLUE, PAPER, VERMILLION
from biped_lab.report.bars import normalised_and_absolute, one_quantity
from biped_lab.report.curves import fixed_share, learning_curves, share_at_goal
from biped_lab.report.finished import (
    EPISODES,
    FIXED_SHARE,
    SIMULATED,
    FinishedRuns,
    finished_runs,
)
from biped_lab.report.grid import draw_grid, is_grid
from biped_lab.report.theme import svg, theme
from biped_lab.report.walks import draw_end_causes, draw_replay
from biped_lab.study import Value


@pytest.fixture(autouse=True)
def in_the_theme() -> Iterator[None]:
    with theme():
        yield


def rng() -> np.random.Generator:
    return np.random.default_rng(5)


@pytest.fixture
def strategy_1(tmp_path: Path) -> FinishedRuns:
    return finished_runs(made_results(tmp_path, STRATEGY_1))


@pytest.fixture
def strategy_2(tmp_path: Path) -> FinishedRuns:
    times = {1: ((8, 9), (14, 16)), 3: ((11, 10), (30, 29))}
    runs = [
        run
        for name, factors in BY_LT.items()
        for run in runs_of(
            name,
            *times[int(factors["LT"])][factors["strategy"] == "none"],
            fixed=0.0 if factors["strategy"] == "none" else 0.6,
        )
    ]
    return finished_runs(made_results(tmp_path, runs, BY_LT, figure="episodes"))


def dots(axes: Iterable[Axes], kind: str) -> list[Line2D]:
    return [
        line for each in axes for line in each.lines if line.get_label() == f"_{kind}"
    ]


def number(lines: list[Line2D]) -> int:
    return sum(len(line.get_xdata()) for line in lines)


# -- Figure 2 --------------------------------------------------------------------------


def figure_2(finished: FinishedRuns) -> Figure:
    return normalised_and_absolute(finished, "K = none", rng())


def test_an_arm_has_two_bars_relative_to_the_baseline_and_two_absolute_ones(
    strategy_1: FinishedRuns,
) -> None:
    both, time, episodes = figure_2(strategy_1).axes
    assert [len(axes.patches) for axes in (both, time, episodes)] == [6, 3, 3]


def test_every_run_is_a_dot_and_those_stopped_at_the_bound_are_open(
    strategy_1: FinishedRuns,
) -> None:
    axes = figure_2(strategy_1).axes
    stopped = dots(axes, "censored")
    assert number(stopped) == 4 * 3
    assert number(dots(axes, "run")) == 4 * 12
    assert {line.get_markerfacecolor() for line in stopped} == {PAPER}


def test_the_bars_of_the_baseline_are_one(strategy_1: FinishedRuns) -> None:
    heights = [bar.get_height() for bar in figure_2(strategy_1).axes[0].patches]
    assert heights[2::3] == [1.0, 1.0]
    assert all(0 < height < 1 for height in heights[1::3])


def test_bars_of_arms_with_stopped_runs_are_hatched(strategy_1: FinishedRuns) -> None:
    episodes = figure_2(strategy_1).axes[2]
    assert [bool(bar.get_hatch()) for bar in episodes.patches] == [True, False, True]


def test_bars_are_means_and_marks_are_medians(strategy_1: FinishedRuns) -> None:
    episodes = figure_2(strategy_1).axes[2]
    means = [strategy_1.values(arm, EPISODES).mean() for arm in strategy_1.arms]
    medians = [np.median(strategy_1.values(arm, EPISODES)) for arm in strategy_1.arms]
    assert np.allclose([bar.get_height() for bar in episodes.patches], means)
    marks = dots([episodes], "median")
    assert [line.get_ydata()[0] for line in marks] == medians


def test_every_axis_names_its_quantity(strategy_1: FinishedRuns) -> None:
    assert [axes.get_ylabel() for axes in figure_2(strategy_1).axes] == [
        "relative to K = none [ ]",
        "total learning time [s simulated]",
        "episodes to the goal",
    ]


# -- Figures 3 to 6 --------------------------------------------------------------------


def test_arms_that_fix_no_state_have_no_bar_of_fixed_states(
    strategy_1: FinishedRuns,
) -> None:
    (axes,) = one_quantity(strategy_1, FIXED_SHARE, rng()).axes
    assert [label.get_text() for label in axes.get_xticklabels()] == ["1", "3"]
    assert number(dots([axes], "run")) == 10
    assert not dots([axes], "censored")


@pytest.mark.parametrize("column", [EPISODES, SIMULATED])
def test_strategy_2_is_red_beside_blue_at_each_lt(
    strategy_2: FinishedRuns, column: str
) -> None:
    (axes,) = one_quantity(strategy_2, column, rng()).axes
    assert [label.get_text() for label in axes.get_xticklabels()] == ["1", "3"]
    colours = [to_hex(bar.get_facecolor()) for bar in axes.patches]
    assert colours == [VERMILLION, BLUE] * 2


def test_strategy_2_is_compared_with_no_fixed_mode_at_the_same_lt(
    strategy_2: FinishedRuns,
) -> None:
    rivals = strategy_2.arrangement.rivals
    assert rivals["LT = 3, strategy = strategy2"] == "LT = 3, strategy = none"
    assert rivals["LT = 3, strategy = none"] is None


# -- curves ----------------------------------------------------------------------------


@pytest.mark.parametrize(("arm", "at_goal"), [("K = 1", True), ("K = none", False)])
def test_a_run_that_has_ended_goes_on_at_the_goal_or_at_its_last_value(
    tmp_path: Path, arm: str, at_goal: bool
) -> None:
    runs = [*runs_of("K = 1", 9, 9, 9), *runs_of("K = none", BOUND, BOUND, BOUND)]
    finished = finished_runs(made_results(tmp_path, runs))
    axes = learning_curves(finished).axes[list(finished.arms).index(arm)]
    colour = finished.arrangement.colours[arm]
    dotted, median = (
        next(line for line in axes.lines if line.get_linestyle() == style and of(line))
        for style, of in (
            (":", lambda _: True),
            ("-", lambda line: same_color(line.get_color(), colour)),
        )
    )
    walked_s, whole_s = median.get_ydata(), dotted.get_ydata()[0]
    assert len(walked_s) == BOUND
    assert (walked_s[-1] == whole_s) == at_goal


def test_no_two_arms_have_the_same_mark(tmp_path: Path) -> None:
    names = [f"arm {n}" for n in range(17)]
    runs = [run for n, name in enumerate(names) for run in runs_of(name, 5 + n)]
    made = made_results(tmp_path, runs, {name: {} for name in names}, baseline="arm 0")
    (axes,) = draw_replay(finished_runs(made)).axes
    marks = [
        (line.get_marker(), line.get_markerfacecolor())
        for line in axes.lines
        if line.get_linestyle() == "None"
    ]
    assert len(marks) == len(set(marks)) == 17


@pytest.mark.parametrize("arms", [3, 5, 7, 9])
def test_names_of_arms_do_not_run_into_one_another(tmp_path: Path, arms: int) -> None:
    names = [f"CMA-ES, horizon grows {n}" for n in range(arms)]
    runs = [run for name in names for run in runs_of(name, 10, 11)]
    made = made_results(tmp_path, runs, {n: {} for n in names}, baseline=names[0])
    figure = normalised_and_absolute(finished_runs(made), names[0], rng())
    FigureCanvasAgg(figure).draw()
    for axes in figure.axes:
        labels = [label for label in axes.get_xticklabels() if label.get_text()]
        assert len(labels) == arms
        if labels[0].get_rotation() == 0.0:
            extents = [label.get_window_extent() for label in labels]
            assert all(a.x1 < b.x0 for a, b in itertools.pairwise(extents))


def test_each_run_that_was_stopped_has_a_tick(strategy_1: FinishedRuns) -> None:
    panels = share_at_goal(strategy_1).axes
    assert [number(dots([axes], "censored")) for axes in panels] == [2, 0, 1]


def test_the_share_of_fixed_states_is_drawn_for_arms_that_fix_any(
    strategy_1: FinishedRuns,
) -> None:
    titles = [axes.get_title(loc="left") for axes in fixed_share(strategy_1).axes]
    assert titles == ["K = 1", "K = 3"]


# -- walks -----------------------------------------------------------------------------


def test_the_end_causes_of_an_arm_add_up_to_one(strategy_1: FinishedRuns) -> None:
    (axes,) = draw_end_causes(strategy_1).axes
    widths = np.array([bar.get_width() for bar in axes.patches]).reshape(2, 3)
    assert np.allclose(widths.sum(axis=0), 1.0)


def test_interrupted_runs_are_not_among_what_was_computed(
    strategy_1: FinishedRuns,
) -> None:
    strategy_1.runs.loc[strategy_1.runs.index[:4], "sittings"] = 2
    (axes,) = draw_replay(strategy_1).axes
    marks = [line for line in axes.lines if line.get_linestyle() == "None"]
    assert number(marks) == 11


def test_figures_are_laid_out_without_a_warning_and_are_the_same_bytes(
    strategy_1: FinishedRuns, recwarn: pytest.WarningsRecorder
) -> None:
    assert svg(figure_2(strategy_1)) == svg(figure_2(strategy_1))
    assert not recwarn.list


# -- K and LT --------------------------------------------------------------------------


def grid_runs() -> tuple[dict[str, dict[str, Value]], list[MadeRun]]:
    factors: dict[str, dict[str, Value]] = {
        f"LT = {lt}, K = {k}": {"LT": lt, "K": k} for lt in (1, 3) for k in (1, 3, 5)
    }
    runs = [
        MadeRun(name, seed, int(cell["LT"]) * 10 + int(cell["K"]), frozen=seed > 0)
        for name, cell in factors.items()
        for seed in range(4)
    ]
    return factors, runs


def test_two_factors_are_a_grid_of_medians_and_of_frozen_walks(tmp_path: Path) -> None:
    factors, runs = grid_runs()
    finished = finished_runs(made_results(tmp_path, runs, factors))
    assert is_grid(finished)
    episodes, frozen, *_ = draw_grid(finished).axes
    cells = {text.get_position(): text.get_text() for text in episodes.texts}
    assert cells == {
        (x, y): str(10 * lt + k)
        for x, lt in enumerate((1, 3))
        for y, k in enumerate((1, 3, 5))
    }
    assert {text.get_text() for text in frozen.texts} == {"75%"}


def test_cells_that_nobody_has_learned_in_say_so(tmp_path: Path) -> None:
    factors, _ = grid_runs()
    runs = [MadeRun(name, seed, BOUND) for name in factors for seed in range(2)]
    finished = finished_runs(made_results(tmp_path, runs, factors))
    episodes, frozen, *_ = draw_grid(finished).axes
    assert {text.get_text() for text in episodes.texts} == {"∞"}
    assert {text.get_text() for text in frozen.texts} == {"–"}


def test_a_grid_with_a_hole_or_of_two_series_is_none(
    tmp_path: Path, strategy_2: FinishedRuns
) -> None:
    factors, runs = grid_runs()
    some = [run for run in runs if run.arm != "LT = 3, K = 5"]
    assert not is_grid(finished_runs(made_results(tmp_path / "hole", some, factors)))
    assert not is_grid(strategy_2)
