"""How the arms of a study stand in its figures: places, series, colours, rivals.

one factor     its values side by side, such as K (Figures 2 and 3 of the paper)
two factors    the first side by side, the second in colours (Figures 4 to 6)
otherwise      the arms by name
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from biped_common.colours import BLUE, CYCLE, INK, VERMILLION
from biped_lab.results import PlannedArm, PlannedStudy
from biped_lab.study import Value

NO_FIXED_MODE = "none"
_LABELS = {"strategy2": "Strategy 2", "strategy1": "Strategy 1"}
_SERIES_COLOURS = {"strategy2": VERMILLION, NO_FIXED_MODE: BLUE}
"""As in the paper's Figures 4 to 6."""


@dataclass(frozen=True)
class Arrangement:
    """Where and how each arm is drawn; mappings are by the arm's name."""

    axis: str
    """Name of the factor along the axis; empty where arms stand by name."""
    places: Mapping[str, str]
    """What stands below the arm's bar."""
    series: Mapping[str, str]
    """Which of the bars of a place it is; empty where a place has one."""
    colours: Mapping[str, str]
    rivals: Mapping[str, str | None]
    """The arm that it is compared with."""

    @property
    def grouped(self) -> bool:
        """Whether a place has several bars, one per series."""
        return any(self.series.values())

    def title(self, arm: str) -> str:
        """Return what the arm is called in figures, shorter than its name."""
        if not self.series[arm]:
            return arm
        return f"{self.axis} = {self.places[arm]}, {self.series[arm]}"

    def in_series(self, series: str) -> list[str]:
        """Return the arms of a series, in order."""
        return [arm for arm, name in self.series.items() if name == series]


def arrange(study: PlannedStudy) -> Arrangement:
    """Return how a study's arms are drawn."""
    names = [arm.name for arm in study.arms]
    factors = {tuple(arm.factors) for arm in study.arms}
    keys = factors.pop() if len(factors) == 1 else ()
    if len(keys) == 2 and len(names) > 1:
        return _grouped(study, *keys)
    axis = keys[0] if len(keys) == 1 else ""
    baseline = study.baseline
    others = [name for name in names if name != baseline]
    colours = {name: CYCLE[i % len(CYCLE)] for i, name in enumerate(others)}
    return Arrangement(
        axis,
        {arm.name: str(arm.factors[axis]) if axis else arm.name for arm in study.arms},
        dict.fromkeys(names, ""),
        {name: colours.get(name, INK) for name in names},
        {name: None if name == baseline else baseline for name in names},
    )


def _grouped(study: PlannedStudy, axis: str, key: str) -> Arrangement:
    values: list[Value] = []
    for arm in study.arms:
        if arm.factors[key] not in values:
            values.append(arm.factors[key])
    free = iter(c for c in CYCLE if c not in _SERIES_COLOURS.values())
    colours = {
        value: _SERIES_COLOURS.get(str(value)) or next(free, INK) for value in values
    }
    return Arrangement(
        axis,
        {arm.name: str(arm.factors[axis]) for arm in study.arms},
        {arm.name: _label(key, arm.factors[key]) for arm in study.arms},
        {arm.name: colours[arm.factors[key]] for arm in study.arms},
        {arm.name: _rival(study, arm, axis, key) for arm in study.arms},
    )


def _label(key: str, value: Value) -> str:
    if value == NO_FIXED_MODE:
        return "no fixed mode"
    return _LABELS.get(str(value), f"{key} = {value}")


def _rival(study: PlannedStudy, arm: PlannedArm, axis: str, key: str) -> str | None:
    """Return the arm without fixed mode that is like this one, or the baseline."""
    for other in study.arms:
        alike = other.factors[axis] == arm.factors[axis]
        if alike and other.factors[key] == NO_FIXED_MODE != arm.factors[key]:
            return other.name
    return None if arm.name == study.baseline else study.baseline
