"""What is said of a walk in numbers and words: peaks, settings, where it comes from."""

from __future__ import annotations

import numpy as np

from biped_bringup.run_settings import PRESETS, differences, load_settings
from biped_common.settings import to_mapping
from biped_common.timing import seconds
from biped_description.joints import JOINT_NAMES
from biped_description.robot import Robot
from biped_view.walk_record import LoadedWalk, Rows, WalkRecord
from learner_node.walking.waist_plane import learned_states


def key_figures(walk: LoadedWalk) -> list[tuple[str, str]]:
    """Return the few numbers that a walk is judged by, each with its name."""
    record, result = walk.record, walk.record.result
    zmp = _peak(np.linalg.norm(record.zmp_error_m, axis=1)[:, None])
    speed = _peak(np.abs(record.joint_velocity_rad_s))
    if result is not None:  # also of ticks that were not recorded
        zmp, speed = result.peak_zmp_error_m, result.peak_joint_velocity_rad_s
    found = [
        ("walked", f"{seconds(record.ticks):.2f} of {seconds(record.walk_ticks):g} s"),
        ("largest ZMP error", f"{1000 * zmp:.2f} of {1000 * record.zmp_limit_m:g} mm"),
        (
            "fastest joint",
            f"{speed:.2f} of {record.robot.velocity_limit_rad_s:.1f} rad/s",
        ),
        ("largest torque", _largest_torque(record)),
    ]
    if result is not None and result.cost is not None:
        found.append(("T_err", f"{result.cost.total:.3f}"))
    if walk.session is not None:
        states = learned_states(walk.session)
        fixed, count = states.fixed.sum(), len(states.fixed)
        learned = f"{walk.session.episodes} episodes, {fixed} of {count} states fixed"
        found.append(("learned", learned))
    return [(name, text) for name, text in found if "nan" not in text]


def provenance(walk: LoadedWalk) -> list[tuple[str, str]]:
    """Return where a walk comes from, and which settings are no preset's."""
    preset, changed = _nearest_preset(walk)
    return [
        *walk.facts.items(),
        (
            "settings",
            f"the preset {preset}" + (", but for" if changed else " as it is"),
        ),
        *changed,
    ]


def _nearest_preset(walk: LoadedWalk) -> tuple[str, list[tuple[str, str]]]:
    """Return the preset with the fewest other settings, and these."""
    own = to_mapping(walk.settings)
    found = {
        name: differences(to_mapping(load_settings(name)), own) for name in PRESETS
    }
    nearest = min(found, key=lambda name: len(found[name]))
    return nearest, [
        (key, f"{value} (there {usual})")
        for key, (usual, value) in found[nearest].items()
    ]


def _largest_torque(record: WalkRecord) -> str:
    share = np.abs(record.joint_torque_nm) / Robot(record.robot).torque_limit_nm
    peak = _peak(share)
    if np.isnan(peak):
        return "nan"
    joint = int(np.argwhere(share == peak)[0, 1])
    return f"{peak:.0%} of limit, {JOINT_NAMES[joint].replace('_', ' ')}"


def _peak(rows: Rows) -> float:
    """Return the largest value that was recorded, NaN if none was."""
    known = rows[np.isfinite(rows)]
    return float(known.max()) if len(known) else float("nan")
