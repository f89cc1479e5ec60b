"""The stretches of a walk in which the planned support stays the same."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from biped_view.walk_record import WalkRecord, last_known

_ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh",
             "eighth", "ninth", "tenth")  # fmt: skip


class Phase(NamedTuple):
    """Rows `first` to `last`, both included, of a record."""

    first: int
    last: int
    double_support: bool
    right_support: bool
    """Of a double support: the coming stance leg."""
    number: int
    """1 for the walk's first of its kind, double or single."""


def phases(record: WalkRecord) -> list[Phase]:
    """Return the phases as far as they were walked, in order.

    Neighbouring double supports, such as standing and the shift behind it, are one.
    """
    single = ~record.double_support
    key = np.where(single, 1 + record.right_support, 0) + 3 * np.where(
        single, record.step_index, 0
    )
    begins = np.flatnonzero(np.diff(key, prepend=-1))
    ends = np.append(begins[1:], record.ticks) - 1
    counts = {True: 0, False: 0}
    found = []
    for first, last in zip(begins.tolist(), ends.tolist(), strict=True):
        double = bool(record.double_support[first])
        counts[double] += 1
        found.append(
            Phase(first, last, double, bool(record.right_support[last]), counts[double])
        )
    return found


def phase_in_words(record: WalkRecord, row: int) -> str:
    """Return the phase of a row, such as "the second double support"."""
    phase = next(each for each in phases(record) if each.first <= row <= each.last)
    nth = _ordinal(phase.number)
    if phase.double_support:
        return f"the {nth} double support"
    return f"the {nth} single support, on the {_leg(phase)} leg"


def short_name(phase: Phase) -> str:
    """Return what stands under a phase: "both", "left" or "right"."""
    return "both" if phase.double_support else _leg(phase)


def standing_feet(record: WalkRecord, row: int) -> list[tuple[float, float]]:
    """Return where the feet stand that carry the robot, as planned, world frame [m].

    Points are those under the ankles; none of a foot whose place was not recorded.
    """
    feet = []
    for foot, right in ((record.left_foot_m, False), (record.right_foot_m, True)):
        if record.double_support[row] or record.right_support[row] == right:
            x, y, _ = foot[row].tolist()
            if np.isfinite(x):
                feet.append((x, y))
    return feet


def shown_rows(record: WalkRecord, every_ticks: int) -> list[int]:
    """Return the rows that moving pictures show, the last one included.

    Each is the last row before its time of which pose, joints and ZMP are known; none
    where these were not recorded.
    """
    rows = record.known_rows()
    if not len(rows):
        return []
    wanted = [*range(0, record.ticks - 1, every_ticks), record.ticks - 1]
    return [int(row) for row in last_known(rows, wanted)]


def _leg(phase: Phase) -> str:
    return "right" if phase.right_support else "left"


def _ordinal(number: int) -> str:
    if number <= len(_ORDINALS):
        return _ORDINALS[number - 1]
    teen = number % 100 in (11, 12, 13)
    ending = {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return f"{number}{'th' if teen else ending}"
