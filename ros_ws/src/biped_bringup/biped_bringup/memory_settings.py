"""What may be changed of the settings of a memory, and why the rest may not.

What the robot meets (`sim`: engine, limits, disturbances) and how far it is to walk
(`learner.schedule`) stand in no number of a memory. All other settings say what its
states, actions and values are: under others the same numbers would mean something else.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from biped_bringup.run_settings import RunSettings, changed_settings, differences
from biped_common.settings import SettingsError, to_mapping

_WALKING = ("sim",)
_LEARNING = ("sim", "learner.schedule")
# By section, the innermost first: what of a memory is made by it.
_MADE_BY = {
    "robot": "its corrections are this robot's",
    "gait": "its states are moments of this gait",
    "correction": "its actions are spread by this spline",
    "learner.method": "its tables are this learner's",
    "learner.states": "its states were made by it",
    "learner.inputs": "its states were made by it",
    "learner.action": "its actions are made of it",
    "learner.schedule": "a greedy walk is of the whole walk",
    "learner": "its values were learned with it",
}


def with_changes(
    memory: RunSettings,
    file: Path | None,
    changes: Iterable[str],
    *,
    learns: bool,
) -> RunSettings:
    """Return the settings of a memory with a YAML file and `key=value`s laid over.

    Args:
        memory: settings that it was learned with.
        file: YAML of the presets' form; may be partial.
        changes: dotted settings such as `sim.disturbances.push_force_n=20`.
        learns: learning goes on; else one walk is walked, greedily.

    Raises:
        SettingsError: naming key, value and what is allowed; also where the setting
            belongs to the memory.
    """
    settings = changed_settings(memory, file, changes)
    free = _LEARNING if learns else _WALKING
    changed = differences(to_mapping(memory), to_mapping(settings))
    for key, (own, other) in changed.items():
        if not any(_within(key, section) for section in free):
            reason = next(_MADE_BY[name] for name in _MADE_BY if _within(key, name))
            raise SettingsError(
                key,
                other,
                f"must stay {own!r}, as the memory has it: {reason}; what can be "
                f"changed is in {' and '.join(free)}",
            )
    return settings


def _within(key: str, section: str) -> bool:
    return key == section or key.startswith(f"{section}.")
