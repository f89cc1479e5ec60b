"""All settings of a run: presets, changes by `--set`, checks across packages."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from biped_common.plain_yaml import YamlError, read_yaml, read_yaml_file
from biped_common.settings import (
    Settings,
    SettingsError,
    dotted,
    from_mapping,
    nested,
    overlay,
    section,
    to_mapping,
)
from biped_description.settings import RobotSettings
from learner_node.walking.settings import LearnerSettings
from sim_node.settings import SimSettings
from trajectory_node.settings import CorrectionSettings, GaitSettings

PRESETS = ("paper", "coarse", "quick", "literal", "directed", "t_ds_090", "t_ds_080")
DEFAULT_PRESET = "paper"


@dataclass(frozen=True)
class RunSettings(Settings):
    """Robot, gait, correction, simulation and learner."""

    robot: RobotSettings = section(RobotSettings)
    gait: GaitSettings = section(GaitSettings)
    correction: CorrectionSettings = section(CorrectionSettings)
    sim: SimSettings = section(SimSettings)
    learner: LearnerSettings = section(LearnerSettings)

    def check_together(self) -> None:
        """Refuse combinations that no part can see alone."""
        first = self.learner.schedule.first_target_s
        if first > self.gait.duration_s:
            raise SettingsError(
                "learner.schedule.first_target_s",
                first,
                f"must be at most the walk's {self.gait.duration_s:g} s",
            )
        blame = self.learner.blame
        if blame.directed:
            for key in ("knot_spacing_s", "order"):
                known, there = getattr(blame, key), getattr(self.correction, key)
                if known != there:
                    raise SettingsError(
                        f"learner.blame.{key}",
                        known,
                        f"must be correction.{key} = {there:g} where blame is directed",
                    )


def preset_text(name: str) -> str:
    """Return a preset's YAML."""
    if name not in PRESETS:
        raise SettingsError("preset", name, f"must be one of {', '.join(PRESETS)}")
    return resources.files(__package__).joinpath(f"presets/{name}.yaml").read_text()


def load_settings(
    preset: str = DEFAULT_PRESET,
    file: Path | None = None,
    changes: Iterable[str] = (),
) -> RunSettings:
    """Return the settings of a preset, with a YAML file and `key=value`s laid over.

    Args:
        preset: one of PRESETS.
        file: YAML of the presets' form; may be partial.
        changes: dotted settings such as `learner.action.alternatives=9`, each once.

    Raises:
        SettingsError: naming key, value and what is allowed.
    """
    return _laid_over(read_yaml(preset_text(preset)), file, changes)


def changed_settings(
    settings: RunSettings, file: Path | None = None, changes: Iterable[str] = ()
) -> RunSettings:
    """Return the settings with a YAML file and `key=value`s laid over.

    Raises:
        SettingsError: naming key, value and what is allowed.
    """
    return _laid_over(to_mapping(settings), file, changes)


def differences(
    one: Mapping[str, Any], other: Mapping[str, Any]
) -> dict[str, tuple[Any, Any]]:
    """Return both values of each setting in which two runs differ, by dotted key."""
    before, after = dotted(one), dotted(other)
    return {
        key: (before.get(key), after.get(key))
        for key in before | after
        if before.get(key) != after.get(key)
    }


def changes_in_words(one: Mapping[str, Any], other: Mapping[str, Any]) -> str:
    """Return the differences as people read them, such as `gait.steps 5 -> 2`."""
    return ", ".join(
        f"{key} {old} -> {new}" for key, (old, new) in differences(one, other).items()
    )


def _laid_over(
    values: Mapping[str, Any], file: Path | None, changes: Iterable[str]
) -> RunSettings:
    if file is not None:
        values = overlay(values, _content(file))
    given: set[str] = set()
    for text in changes:
        change = _change(text)
        keys = dotted(change)
        for key in keys:
            if key in given:
                raise SettingsError("--set", text, f"gives {key} a second time")
        given.update(keys)
        values = overlay(values, change)
    return from_mapping(RunSettings, values)


def _content(file: Path) -> Mapping[str, Any]:
    try:
        values = read_yaml_file(file)
    except OSError as error:
        raise SettingsError("file", str(file), f"cannot be read: {error}") from None
    except YamlError as error:
        raise SettingsError("file", str(file), f"is not YAML: {error}") from None
    if values is None:
        return {}
    if not isinstance(values, Mapping):
        raise SettingsError("file", str(file), "must hold sections of settings")
    return values


def _change(text: str) -> dict[str, Any]:
    """Return `a.b=value` as nested mappings."""
    key, separator, value = text.partition("=")
    if not separator or not key:
        raise SettingsError("--set", text, "must have the form section.key=value")
    try:
        return nested(key, read_yaml(value))
    except YamlError:
        raise SettingsError("--set", text, "the value is not YAML") from None
