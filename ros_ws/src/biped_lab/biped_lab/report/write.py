"""Write a study's report: one HTML page that asks for nothing, tables, and figures.

In `DIR/STUDY/`:

    report.html   everything, with light and dark looks, for any browser and offline
    table.md      what the arms achieved; the same bytes for the same data
    tests.md      how they differ, by every test, where arms are compared; likewise
    cost.md       what the runs took, which depends on the machine
    figures/      every figure as SVG and PNG; what else lay there is deleted
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import jinja2
import numpy as np

from biped_common.atomic_file import atomic_file
from biped_common.command_line import writable_folder
from biped_lab.report.figures import figures
from biped_lab.report.finished import FinishedRuns, finished_runs
from biped_lab.report.provenance import provenance
from biped_lab.report.tables import (
    arms_table,
    comparisons_table,
    cost_table,
    findings_table,
    runs_table,
)
from biped_lab.report.theme import inline_svg, png, svg, theme
from biped_lab.results import StudyResults

PAGE, FIGURES = "report.html", "figures"
TABLE, TESTS, COST = "table.md", "tests.md", "cost.md"
_SEED = 20_110
"""Of the bootstrap: the same data have the same intervals."""


class _Shown(NamedTuple):
    """A figure on the page."""

    name: str
    title: str
    caption: str
    drawing: str
    """SVG of our own, in which all names are outlines; empty where there is none."""


def write_report(results: StudyResults) -> Path:
    """Write the report of a study; return its page.

    Raises:
        CommandError: the folder cannot be written to.
        ResultsError: the episodes of a run cannot be read.
    """
    folder = writable_folder(results.folder / results.study.name)
    finished = finished_runs(results)
    content: dict[str, Any] = {
        "study": results.study,
        "state": state_in_words(finished),
        "runs": runs_table(finished),
        "provenance": provenance(results),
        "figures": [],
        "findings": None,
        "arms": None,
        "comparisons": None,
    }
    if finished.arms:
        content |= {
            "figures": _write_figures(finished, folder / FIGURES),
            "findings": findings_table(finished, _rng()),
            "findings_note": _findings_note(finished),
            "arms": arms_table(finished, _rng()),
            "arms_note": _ARMS_NOTE,
            "cost": cost_table(finished),
        }
        _write(folder / TABLE, content["arms"].markdown().encode())
        _write(folder / COST, content["cost"].markdown().encode())
        if finished.rivals:
            content |= {
                "comparisons": comparisons_table(finished, _rng()),
                "comparisons_note": _COMPARISONS_NOTE,
            }
            _write(folder / TESTS, content["comparisons"].markdown().encode())
    page = folder / PAGE
    _write(page, _template().render(content).encode())
    return page


def state_in_words(finished: FinishedRuns) -> str:
    """Return how many runs have ended, how, and how many have not."""
    planned, done = len(finished.results.runs), len(finished.runs)
    reached = int(finished.runs["reached"].sum())
    goal = {
        "schedule": "the end of the schedule",
        "greedy": "a frozen greedy walk of the whole way",
    }[finished.results.study.goal]
    if not done:
        return (
            f"None of {planned} runs has ended yet, so that there is nothing to show."
        )
    return (
        f"Goal: {goal}. {done} of {planned} runs have ended: {reached} at the goal, "
        f"{done - reached} stopped at {finished.bound} episodes (censored). "
        f"{planned - done} are unfinished and not counted."
    )


_ARMS_NOTE = (
    "Medians are those of Kaplan and Meier; means are restricted to the bound. In "
    "brackets: 95 % intervals, with fewer than five runs in an arm none. The ratio of "
    "medians and the probability of being faster are of episodes, against the arm in "
    "the column before them; p: permutation test of Wilcoxon scores, corrected after "
    "Holm for all comparisons of the study. Frozen walk: of the runs at the goal, "
    "those whose greedy walk of the whole way, tried once without learning, was "
    "completed, with Wilson's interval. ∞: beyond what was watched."
)


_COMPARISONS_NOTE = (
    "The fraction of runs at the goal, with Wilson's interval. Permutation tests, none "
    "corrected: that of Wilcoxon scores judges, the others are there to be looked at. "
    "Within pairs: of the seeds that both arms have. Means are restricted to the "
    "bound. Frozen walks: Fisher's exact test."
)


def _findings_note(finished: FinishedRuns) -> str:
    rivals = finished.rivals
    if not rivals:
        return "Means restricted to the bound; time in simulated seconds."
    whom = rivals.pop() if len(rivals) == 1 else "the same arm without fixed mode"
    note = f"Time and episodes: mean restricted to the bound, over that of {whom}."
    if finished.runs["reached"].all():
        return note
    return f"{note} Where not all runs are at the goal, the true mean is larger."


def _write_figures(finished: FinishedRuns, folder: Path) -> list[_Shown]:
    folder.mkdir(exist_ok=True)
    shown, written = [], set()
    with theme():
        for name, title, caption, figure in figures(finished, _rng()):
            drawing = ""
            if figure is not None:
                drawn = svg(figure)
                _write(folder / f"{name}.svg", drawn)
                _write(folder / f"{name}.png", png(figure))
                written |= {f"{name}.svg", f"{name}.png"}
                drawing = inline_svg(drawn, name, title)
            shown.append(_Shown(name, title, caption, drawing))
    for file in folder.iterdir():
        if file.suffix in (".svg", ".png") and file.name not in written:
            file.unlink()
    return shown


def _template() -> jinja2.Template:
    return jinja2.Environment(
        loader=jinja2.PackageLoader("biped_lab", "report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
    ).get_template("report.html.j2")


def _rng() -> np.random.Generator:
    return np.random.default_rng(_SEED)


def _write(path: Path, content: bytes) -> None:
    with atomic_file(path) as stream:
        stream.write(content)
