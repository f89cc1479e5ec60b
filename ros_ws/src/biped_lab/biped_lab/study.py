"""Studies as data: which runs, with which settings and seeds, and what is asked.

A study is a YAML file, `studies/*.yaml` or one of a user's own:

    title, paper, claim   what is asked, where in the paper, and what is said there
    figure                what the report shows first
    preset, settings      of all runs; settings by dotted key
    goal, most_episodes   a run has arrived with this milestone; else it is censored
    seeds                 first and count; arms are paired by seed
    contestant, options   who learns, and its own constants
    axes                  name: setting and values; every combination is an arm
    arms                  name: settings, contestant, options, seeds, factors of an arm,
                          or of one that the axes have made
    baseline              the arm that others are compared with
    reduced               seeds, most_episodes and arms of a smaller study
    like                  another study: what does not stand here is as there
"""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from biped_bringup.run_settings import RunSettings, load_settings
from biped_common.errors import BipedError
from biped_common.plain_yaml import YamlError, read_yaml
from biped_common.settings import (
    SettingsError,
    dotted,
    from_mapping,
    nested,
    overlay,
    to_mapping,
)
from biped_lab.code_identity import CodeIdentity, code_identity
from biped_lab.contestant import UnknownContestantError, entry
from sim_node.engines import ENGINES

_OTHER_FOLDERS = ("runs", "slurm")
"""What a laboratory's folder holds beside its studies."""
BY_SETTINGS = "by_settings"
"""The contestant whom the setting `learner.method` names."""
Goal = Literal["schedule", "greedy"]
Leading = Literal["episodes", "learning time", "fixed states"]
Value = int | float | str | bool
Name = Annotated[str, Meta(pattern=r"^[^\n/\\]{1,80}\Z")]
Seeds = Annotated[int, Meta(ge=1, le=10_000)]
Episodes = Annotated[int, Meta(ge=1, le=1_000_000)]


class StudyError(BipedError, ValueError):
    """A study that cannot be carried out; the message says where and why."""


class SeedRange(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Seeds, one after the other."""

    first: Annotated[int, Meta(ge=0, le=2**62)]
    count: Seeds


class Axis(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One setting that is varied."""

    setting: str
    values: Annotated[list[Value], Meta(min_length=1)]


class ArmChanges(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What is particular to an arm."""

    settings: dict[str, Any] = {}
    factors: dict[str, Value] = {}
    contestant: str | None = None
    options: dict[str, Any] | None = None
    seeds: Seeds | None = None
    preset: str | None = None


class Reduction(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The smaller study: what the larger one has in its place is left out."""

    seeds: Seeds
    most_episodes: Episodes | None = None
    arms: list[Name] | None = None


class StudyFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A study as it is written."""

    title: str
    most_episodes: Episodes
    seeds: SeedRange
    paper: str = ""
    claim: str = ""
    figure: Leading = "episodes"
    preset: str = "paper"
    settings: dict[str, Any] = {}
    goal: Goal = "schedule"
    contestant: str = BY_SETTINGS
    options: dict[str, Any] = {}
    axes: dict[Name, Axis] = {}
    arms: dict[Name, ArmChanges | None] = {}
    baseline: Name | None = None
    reduced: Reduction | None = None


class RunSpec(msgspec.Struct, frozen=True):
    """All that decides how a run goes; its address is a hash of it."""

    contestant: str
    options: dict[str, Any]
    settings: dict[str, Any]
    seed: int
    goal: Goal
    most_episodes: int
    code: str
    packages: dict[str, str]

    @property
    def address(self) -> str:
        """16 hexadecimal digits."""
        text = json.dumps(msgspec.to_builtins(self), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def run_settings(self) -> RunSettings:
        """Return the settings of the run."""
        return from_mapping(RunSettings, self.settings)


@dataclass(frozen=True)
class Arm:
    """Runs that differ in their seeds only."""

    name: str
    contestant: str
    options: dict[str, Any]
    settings: RunSettings
    seeds: tuple[int, ...]
    factors: dict[str, Value]
    """What it has of each factor of the study."""


@dataclass(frozen=True)
class Study:
    """A study, ready to be carried out."""

    name: str
    file: StudyFile
    arms: tuple[Arm, ...]
    reduced: bool
    source: str
    """What `load_study` finds it by: its name, or a file."""

    def specs(self) -> Iterator[tuple[str, RunSpec]]:
        """Yield each run with its arm, seed by seed: what is cut off stays balanced.

        Raises:
            StudyError: an arm's contestant is not known, or not under these options.
        """
        seeds = sorted({seed for arm in self.arms for seed in arm.seeds})
        for seed in seeds:
            for arm in self.arms:
                if seed in arm.seeds:
                    yield arm.name, self._spec(arm, seed)

    def _spec(self, arm: Arm, seed: int) -> RunSpec:
        try:
            who = entry(arm.contestant)
            options = to_mapping(from_mapping(who.options, arm.options))
        except (UnknownContestantError, SettingsError) as error:
            raise StudyError(f"{self.name}: arm {arm.name!r}: {error}") from None
        return RunSpec(
            arm.contestant,
            options,
            to_mapping(arm.settings),
            seed,
            self.file.goal,
            self.file.most_episodes,
            *run_code(arm.contestant, arm.settings),
        )


def run_code(contestant: str, settings: RunSettings) -> CodeIdentity:
    """Return the identity of the code that carries out a run."""
    engine = ENGINES[settings.sim.engine].module
    return code_identity("biped_bringup.training", engine, entry(contestant).module)


def study_names() -> list[str]:
    """Return the names of the studies that come with the laboratory."""
    files = resources.files(__package__).joinpath("studies").iterdir()
    return sorted(f.name.removesuffix(".yaml") for f in files if f.name[-5:] == ".yaml")


def load_study(name_or_file: str, *, reduced: bool = False) -> Study:
    """Return a study that comes with the laboratory, or one of a YAML file.

    Raises:
        StudyError: there is none, or it says what cannot be.
    """
    name, values = _read(name_or_file)
    study = study_of(name, values, reduced=reduced)
    return replace(study, source=name_or_file)


def study_of(name: str, values: Mapping[str, Any], *, reduced: bool = False) -> Study:
    """Return the study that a YAML file's content describes.

    Args:
        name: of the study.
        values: the content.
        reduced: the smaller study that it describes.

    Raises:
        StudyError: it says what cannot be.
    """
    try:
        file = msgspec.convert(dict(values), StudyFile)
    except msgspec.ValidationError as error:
        raise StudyError(f"study {name}: {error}") from None
    arms, source = _arms(name, file), name
    if reduced:
        file, arms = _reduced(name, file, arms)
        name = f"{name}-reduced"
    if name in _OTHER_FOLDERS:
        raise StudyError(
            f"study {name}: must have another name; the laboratory has a folder of "
            "this one"
        )
    if file.baseline is not None and file.baseline not in {arm.name for arm in arms}:
        raise StudyError(f"study {name}: baseline {file.baseline!r}: no such arm")
    return Study(name, file, arms, reduced, source)


def _read(name_or_file: str, after: tuple[str, ...] = ()) -> tuple[str, dict[str, Any]]:
    """Return the name and the content of a study that the ones before are like."""
    if name_or_file in after:
        chain = " is like ".join((*after, name_or_file))
        raise StudyError(f"study {name_or_file}: is like itself: {chain}")
    if name_or_file in study_names():
        file = resources.files(__package__) / "studies" / f"{name_or_file}.yaml"
        text, name = file.read_text(), name_or_file
    else:
        path = Path(name_or_file)
        if path.suffix not in (".yaml", ".yml"):
            raise StudyError(
                f"study {name_or_file!r}: must be a YAML file, or one of "
                f"{', '.join(study_names())}"
            )
        try:
            text, name = path.read_text(), path.stem
        except (OSError, UnicodeDecodeError) as error:
            raise StudyError(f"study {path}: cannot be read: {error}") from None
    try:
        values = read_yaml(text)
    except YamlError as error:
        raise StudyError(f"study {name_or_file}: is not YAML: {error}") from None
    if not isinstance(values, dict):
        raise StudyError(f"study {name_or_file}: must hold keys")
    if "like" in values:
        like = str(values.pop("like"))
        if like not in study_names():  # a file, beside the one that names it
            like = str(Path(name_or_file).parent / like)
        _, other = _read(like, (*after, name_or_file))
        values = {**other, **values}
    return name, values


def _arms(name: str, file: StudyFile) -> tuple[Arm, ...]:
    written: dict[str, ArmChanges] = {}
    if file.axes:
        for values in itertools.product(*(axis.values for axis in file.axes.values())):
            factors = dict(zip(file.axes, values, strict=True))
            label = ", ".join(f"{axis} = {value}" for axis, value in factors.items())
            settings = {file.axes[axis].setting: factors[axis] for axis in factors}
            written[label] = ArmChanges(settings=settings, factors=factors)
    for label, given in file.arms.items():
        changes = given or ArmChanges()
        made = written.get(label, ArmChanges())
        written[label] = msgspec.structs.replace(
            changes,
            settings=made.settings | changes.settings,
            factors=made.factors | changes.factors,
        )
    if not written:
        raise StudyError(f"study {name}: neither axes nor arms")
    return tuple(_arm(name, file, label, given) for label, given in written.items())


def _arm(study: str, file: StudyFile, label: str, changes: ArmChanges) -> Arm:
    try:
        values: Mapping[str, Any] = to_mapping(
            load_settings(changes.preset or file.preset)
        )
        for key, value in {**file.settings, **changes.settings}.items():
            values = overlay(values, nested(key, value))
        settings = from_mapping(RunSettings, values)
    except SettingsError as error:
        raise StudyError(f"study {study}: arm {label!r}: {error}") from None
    count = changes.seeds or file.seeds.count
    return Arm(
        name=label,
        contestant=changes.contestant or file.contestant,
        options=file.options if changes.options is None else changes.options,
        settings=settings,
        seeds=tuple(range(file.seeds.first, file.seeds.first + count)),
        factors=changes.factors,
    )


def _reduced(
    name: str, file: StudyFile, arms: tuple[Arm, ...]
) -> tuple[StudyFile, tuple[Arm, ...]]:
    less = file.reduced
    if less is None:
        raise StudyError(f"study {name}: has no reduced form")
    names = [arm.name for arm in arms] if less.arms is None else less.arms
    unknown = set(names) - {arm.name for arm in arms}
    if unknown:
        raise StudyError(f"study {name}: reduced: no arm {sorted(unknown)[0]!r}")
    kept = tuple(
        replace(arm, seeds=arm.seeds[: less.seeds]) for arm in arms if arm.name in names
    )
    episodes = less.most_episodes or file.most_episodes
    return msgspec.structs.replace(file, most_episodes=episodes), kept


def changed(arm: Arm, preset: str) -> dict[str, Any]:
    """Return an arm's settings that differ from a preset's, by dotted key."""
    own, plain = (
        dotted(to_mapping(arm.settings)),
        dotted(to_mapping(load_settings(preset))),
    )
    return {key: value for key, value in own.items() if plain[key] != value}
