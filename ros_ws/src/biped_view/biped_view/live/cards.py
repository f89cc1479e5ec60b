"""Cards of the page as HTML: what goes on, learner, map of its states, legend.

Colours that follow light and dark are those of the page's own style sheet.
"""

from __future__ import annotations

from html import escape
from typing import Final

import numpy as np

from biped_view.live.moment import LearnerFigures
from biped_view.theme import Colour, Theme, css
from learner_node.walking.waist_plane import LearnedStates

_SOFT: Final = "var(--mantine-color-dimmed)"
_LINE: Final = "var(--mantine-color-default-border)"
# The plane of the map: the waist around the support foot [m].
_MAP_M: Final = (-0.12, 0.12, -0.16, 0.16)
_MAP_PX: Final = (300, 196)
_MAP_MARGIN_PX: Final = (34, 8, 8, 26)  # left, top, right, bottom


def headline(state: str, detail: str, colour: Colour) -> str:
    """Return what goes on: a dot, a state in a word or two, and a line below."""
    return (
        '<div style="padding:4px 10px 0">'
        f'<span style="display:inline-block;width:10px;height:10px;border-radius:5px;'
        f'background:{css(colour)};margin-right:8px"></span>'
        f'<b style="font-size:15px">{escape(state)}</b>'
        f'<div style="font-size:12px;color:{_SOFT};min-height:18px;margin-top:2px">'
        f"{escape(detail)}</div></div>"
    )


def learner_card(figures: LearnerFigures, theme: Theme) -> str:
    """Return how far a learner has come."""
    of_walk = f" of {figures.walk_time_s:.2f} s" if figures.walk_time_s else ""
    rows = [
        ("Target time", f"{figures.target_time_s:.2f} s{of_walk}"),
        (
            "Subtask",
            f"{figures.subtask + 1} of {figures.subtasks}, "
            f"{figures.successes} successes",
        ),
        ("Episodes", f"{figures.episodes:,}"),
        ("Survival", f"{100 * figures.survival:.0f} % of the target"),
    ]
    if figures.t_err_estimate is not None:
        rows.append(("T_err to beat", f"{figures.t_err_estimate:.4g}"))
    rows.append(("Walked to learn", f"{figures.simulated_s:,.0f} s"))
    if figures.computed_s is not None and figures.replayed_s is not None:
        rows.append(
            ("… computed, replayed",
             f"{figures.computed_s:,.0f} s, {figures.replayed_s:,.0f} s")
        )  # fmt: skip
    if figures.given_up:
        rows.append(("Walks given up", f"{figures.given_up:,}"))
    share = figures.target_time_s / (figures.walk_time_s or figures.target_time_s)
    return (
        f'<div style="padding:0 8px"><b>{escape(figures.state)}</b>'
        + _bar([(share, css(theme.fixed))])
        + _table(rows)
        + _states(figures, theme)
        + "</div>"
    )


def state_map(learned: LearnedStates, as_of: str, theme: Theme) -> str:
    """Return a map of the states over the waist plane, coloured by mode.

    Args:
        learned: the states of a memory.
        as_of: how old it is, in words.
        theme: of the colours.
    """
    width, height = _MAP_PX
    left, top, right, bottom = _MAP_MARGIN_PX
    x_low, x_high, y_low, y_high = _bounds(learned)

    def px(x_m: float) -> float:
        return left + (x_m - x_low) / (x_high - x_low) * (width - left - right)

    def py(y_m: float) -> float:
        return top + (y_high - y_m) / (y_high - y_low) * (height - top - bottom)

    parts = []
    for value in np.arange(np.ceil(x_low / 0.05), np.floor(x_high / 0.05) + 1) * 0.05:
        parts.append(
            f'<line x1="{px(value):.1f}" x2="{px(value):.1f}" y1="{top}" '
            f'y2="{height - bottom}" stroke="{_LINE}"/>'
            f'<text x="{px(value):.1f}" y="{height - bottom + 11}" '
            f'text-anchor="middle">{100 * value:.0f}</text>'
        )
    for value in np.arange(np.ceil(y_low / 0.05), np.floor(y_high / 0.05) + 1) * 0.05:
        parts.append(
            f'<line x1="{left}" x2="{width - right}" y1="{py(value):.1f}" '
            f'y2="{py(value):.1f}" stroke="{_LINE}"/>'
            f'<text x="{left - 5}" y="{py(value) + 3:.1f}" '
            f'text-anchor="end">{100 * value:.0f}</text>'
        )
    for mode, which in learned.modes.items():
        colour = getattr(theme, mode)
        parts += [
            f'<circle cx="{px(x):.1f}" cy="{py(y):.1f}" r="4.5" '
            f'fill="{css(colour, 0.75)}" stroke="{css(colour)}"/>'
            for x, y in learned.waist_m[which]
        ]
    parts.append(
        f'<text x="{(left + width - right) / 2}" y="{height - 3}" '
        'text-anchor="middle">ahead of the support foot [cm]</text>'
        f'<text x="10" y="{(top + height - bottom) / 2}" text-anchor="middle" '
        f'transform="rotate(-90 10 {(top + height - bottom) / 2})">to the left [cm]'
        "</text>"
    )
    return (
        f'<div style="padding:0 8px"><svg viewBox="0 0 {width} {height}" width="100%" '
        f'font-size="10" fill="{_SOFT}" style="display:block">{"".join(parts)}</svg>'
        + _keys(
            [
                (theme.exploring, "exploring"),
                (theme.fixed, "fixed"),
                (theme.penalty, "penalty"),
            ]
        )
        + f'<div style="font-size:11px;color:{_SOFT}">{escape(as_of)}</div></div>'
    )


def legend(theme: Theme) -> str:
    """Return what the colours of the scene mean."""
    return (
        '<div style="padding:0 8px">'
        + _keys(
            [
                (theme.zmp, "ZMP"),
                (theme.zmp_reference, "its reference"),
                (theme.limit, "limit of its error"),
                (theme.support, "support polygon"),
                (theme.static_waist, "planned waist"),
                (theme.waist, "corrected waist"),
                (theme.waist_ahead, "waist, ahead"),
                (theme.left, "left foot"),
                (theme.right, "right foot"),
            ]
        )
        + "</div>"
    )


def _bounds(learned: LearnedStates) -> tuple[float, float, float, float]:
    """Return what of the plane is shown [m]: the usual part, or more if need be."""
    x_low, x_high, y_low, y_high = _MAP_M
    if len(learned.waist_m):
        lowest = learned.waist_m.min(axis=0) - 0.01
        highest = learned.waist_m.max(axis=0) + 0.01
        x_low, y_low = min(x_low, lowest[0]), min(y_low, lowest[1])
        x_high, y_high = max(x_high, highest[0]), max(y_high, highest[1])
    return float(x_low), float(x_high), float(y_low), float(y_high)


def _states(figures: LearnerFigures, theme: Theme) -> str:
    """Return how many states there are of which kind, as a bar and in words."""
    total = figures.memory.get("basis_states", 0.0)
    if not {"fixed_states", "penalty_states"} <= figures.memory.keys() or not total:
        return _table(
            [(name.replace("_", " "), f"{n:g}") for name, n in figures.memory.items()]
        )
    fixed, penalty = (
        figures.memory[name] for name in ("fixed_states", "penalty_states")
    )
    exploring = max(0.0, total - fixed - penalty)
    shares = [
        (exploring / total, css(theme.exploring)),
        (fixed / total, css(theme.fixed)),
        (penalty / total, css(theme.penalty)),
    ]
    return (
        f'<div style="margin-top:8px">{total:g} states</div>'
        + _bar(shares)
        + _keys(
            [
                (theme.exploring, f"{exploring:g} exploring"),
                (theme.fixed, f"{fixed:g} fixed"),
                (theme.penalty, f"{penalty:g} penalty"),
            ]
        )
    )


def _table(rows: list[tuple[str, str]]) -> str:
    return (
        '<table style="width:100%;font-size:12px;border-spacing:0">'
        + "".join(
            f'<tr><td style="color:{_SOFT};padding:1px 0">{escape(name)}</td>'
            f'<td style="text-align:right;font-variant-numeric:tabular-nums">'
            f"{escape(value)}</td></tr>"
            for name, value in rows
        )
        + "</table>"
    )


def _bar(shares: list[tuple[float, str]]) -> str:
    return (
        f'<div style="display:flex;height:6px;border-radius:3px;overflow:hidden;'
        f'margin:5px 0;background:{_LINE}">'
        + "".join(
            f'<div style="width:{100 * min(share, 1.0):.1f}%;'
            f'background:{colour}"></div>'
            for share, colour in shares
        )
        + "</div>"
    )


def _keys(keys: list[tuple[Colour, str]]) -> str:
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:1px 12px;font-size:11px;'
        f'color:{_SOFT};padding:2px 0">'
        + "".join(
            f'<span style="white-space:nowrap"><span style="display:inline-block;'
            f"width:9px;height:9px;border-radius:2px;margin-right:5px;"
            f'background:{css(colour)}"></span>{escape(text)}</span>'
            for colour, text in keys
        )
        + "</div>"
    )
