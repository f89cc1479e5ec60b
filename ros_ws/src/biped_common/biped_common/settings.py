"""Settings: plain mappings (YAML) turned into frozen, checked dataclasses.

Every number that a user may change is a field declared with `setting`, which carries
its unit, its range and one line of meaning. The same declaration serves the YAML
files, `biped check`, `--set key=value`, and ROS parameter descriptors.
"""

from __future__ import annotations

import dataclasses
import re
import sys
from collections.abc import Iterator, Mapping
from typing import (
    Annotated,
    Any,
    Literal,
    NamedTuple,
    TypeVar,
    final,
    get_args,
    get_origin,
    get_type_hints,
)

import msgspec
from msgspec import Meta

from biped_common.errors import BipedError

AnySettings = TypeVar("AnySettings", bound="Settings")
Content = TypeVar("Content")
_SECTION = "must be a section of keys"
_NOUNS = {int: "a whole number", bool: "true or false", str: "text"}
_WITHOUT_DOT = re.compile(r"[-+]?\d+[eE][-+]?\d+")


class SettingsError(BipedError, ValueError):
    """A setting is unknown, of the wrong type or out of range.

    The message is one line: the dotted key, the value, and what is allowed.
    """

    def __init__(self, key: str, value: object, allowed: str) -> None:
        """Say which key has which unusable value, and what would be allowed."""
        super().__init__(f"{key} = {_shown(value)}: {allowed}")
        self.key = key
        self.value = value
        self.allowed = allowed

    def under(self, section: str) -> SettingsError:
        """Return the same error with its key prefixed by the enclosing section."""
        return SettingsError(f"{section}.{self.key}", self.value, self.allowed)


def _shown(value: object) -> str:
    try:
        return repr(value)
    except ValueError:
        return "a whole number of thousands of digits"  # which Python does not write


# -- declaring -------------------------------------------------------------------------


class Settings:
    """Base of every frozen dataclass of settings: no unsound object can be made."""

    @final
    def __post_init__(self) -> None:
        """Refuse values of the wrong type, out of range or at odds with one another."""
        _check_fields(self)
        self.check_together()

    def check_together(self) -> None:
        """Refuse values that are at odds with one another; classes override it.

        Raises:
            SettingsError: naming one of the keys, its value and what is allowed.
        """


def setting(
    default: Any,
    unit: str,
    doc: str,
    *,
    lower: float | None = None,
    upper: float | None = None,
    above: float | None = None,
    choices: tuple[str, ...] | None = None,
    live: bool = False,
) -> Any:
    """Declare one field of a settings dataclass.

    Args:
        default: value where the YAML is silent.
        unit: SI unit, or "" for a pure number.
        doc: what the number means, in one line.
        lower: smallest allowed value; for a tuple, of each element.
        upper: largest allowed value.
        above: exclusive lower bound.
        choices: the allowed words, for text.
        live: may be changed while a node runs; no walk may depend on it.
    """
    metadata = {
        "unit": unit,
        "doc": doc,
        "lower": lower,
        "upper": upper,
        "above": above,
        "choices": choices,
        "live": live,
    }
    return dataclasses.field(default=default, metadata=metadata)


def section(cls: type[AnySettings]) -> AnySettings:
    """Declare a nested settings dataclass with its own defaults."""
    return dataclasses.field(default_factory=cls)


class Declaration(NamedTuple):
    """What is declared of one field."""

    kind: Any
    """Its type; that of a section is a settings dataclass."""
    rules: Mapping[str, Any]
    """The arguments of `setting`; empty for a section."""

    @property
    def is_section(self) -> bool:
        """Whether it holds settings itself."""
        return dataclasses.is_dataclass(self.kind)


def declarations(cls: type[Any]) -> dict[str, Declaration]:
    """Return what a settings dataclass declares, by name of the field."""
    hints = get_type_hints(cls)
    return {
        f.name: Declaration(hints[f.name], f.metadata) for f in dataclasses.fields(cls)
    }


def _forms(kind: Any, rules: Mapping[str, Any]) -> Iterator[tuple[Any, str]]:
    """Yield the types that a value must fit, one narrower than the other, and words.

    The types are msgspec's; the words say what is allowed.
    """
    if get_origin(kind) is tuple:
        several: Any = tuple
        element = get_args(kind)[0]
        yield several[Any, ...], f"must be a list of {element.__name__}"
        for form, allowed in _forms(element, rules):
            yield several[form, ...], allowed
        return
    if kind is float:
        largest = sys.float_info.max
        yield int | float, "must be a number"
        yield Annotated[float, Meta(ge=-largest, le=largest)], "must be a finite number"
    else:
        yield kind, f"must be {_NOUNS[kind]}"
    unit = f" {rules['unit']}" if rules["unit"] else ""
    lower, upper, above = rules["lower"], rules["upper"], rules["above"]
    if rules["choices"] is not None:
        words = ", ".join(rules["choices"])
        yield Literal[rules["choices"]], f"must be one of {words}"
    if above is not None:
        yield Annotated[kind, Meta(gt=above)], f"must be above {above}{unit}"
    if lower is not None and upper is not None:
        allowed = f"must be between {lower} and {upper}{unit}"
        yield Annotated[kind, Meta(ge=lower, le=upper)], allowed
    elif lower is not None:
        yield Annotated[kind, Meta(ge=lower)], f"must be at least {lower}{unit}"
    elif upper is not None:
        yield Annotated[kind, Meta(le=upper)], f"must be at most {upper}{unit}"


# -- checking --------------------------------------------------------------------------


def _check_fields(settings: Any) -> None:
    """Check every field of a settings object against its declaration.

    A whole number becomes a float, and a list a tuple, where such is declared.

    Raises:
        SettingsError: naming the key, the value and what is allowed.
    """
    for name, declared in declarations(type(settings)).items():
        if declared.is_section:
            continue
        value = getattr(settings, name)
        for form, allowed in _forms(declared.kind, declared.rules):
            try:
                value = msgspec.convert(value, form)
            except msgspec.ValidationError:
                raise SettingsError(name, value, allowed + _hint(value)) from None
        object.__setattr__(settings, name, value)


def _hint(value: object) -> str:
    # YAML 1.1 reads 1e-3 as text: the commonest surprise deserves its own word.
    if isinstance(value, str) and _WITHOUT_DOT.fullmatch(value):
        return " (YAML wants a dot in the mantissa, as in 1.0e-3)"
    return ""


# -- mappings --------------------------------------------------------------------------


def from_mapping(
    cls: type[AnySettings], values: Mapping[str, Any], base: AnySettings | None = None
) -> AnySettings:
    """Build the settings dataclass `cls` from a mapping, strictly.

    Args:
        cls: frozen dataclass whose fields are made by `setting` or `section`.
        values: what the user wrote; may be partial.
        base: settings that supply what `values` leaves out (default: the defaults).

    Raises:
        SettingsError: unknown key, wrong type, non-finite or out-of-range value.
    """
    if not isinstance(values, Mapping):
        raise SettingsError("settings", values, _SECTION)
    if base is not None:
        values = overlay(to_mapping(base), values)
    known = declarations(cls)
    arguments = dict(values)
    for key, value in values.items():
        if key not in known:
            names = ", ".join(sorted(known))
            raise SettingsError(str(key), value, f"unknown key; known here: {names}")
        if known[key].is_section:
            if not isinstance(value, Mapping):
                raise SettingsError(key, value, _SECTION)
            try:
                arguments[key] = from_mapping(known[key].kind, value)
            except SettingsError as error:
                raise error.under(key) from None
    return cls(**arguments)


def from_json(key: str, text: str, kind: type[Content]) -> Content:
    """Return what a setting that is JSON text holds: a tree that no one here declares.

    Args:
        key: of the setting.
        text: its value.
        kind: what it must hold, such as dict[str, str].

    Raises:
        SettingsError: it holds something else.
    """
    try:
        return msgspec.json.decode(text, type=kind)
    except msgspec.DecodeError as error:
        raise SettingsError(key, text, f"is not the JSON it must be, {error}") from None


def to_mapping(settings: Any) -> dict[str, Any]:
    """Return nested plain values (lists, not tuples), the inverse of `from_mapping`."""
    return dataclasses.asdict(settings, dict_factory=_plain)


def _plain(fields: list[tuple[str, Any]]) -> dict[str, Any]:
    return {k: list(v) if isinstance(v, tuple) else v for k, v in fields}


def overlay(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return `base` with `changes` laid over it, section by section."""
    merged = dict(base)
    for key, value in changes.items():
        under = merged.get(key)
        if isinstance(under, Mapping) and isinstance(value, Mapping):
            merged[key] = overlay(under, value)
        else:
            merged[key] = value
    return merged


def nested(key: str, value: Any) -> dict[str, Any]:
    """Return the mapping in which the dotted key has this value, and nothing else."""
    first, dot, rest = key.partition(".")
    return {first: nested(rest, value) if dot else value}


def dotted(values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return nested settings by dotted key."""
    flat: dict[str, Any] = {}
    for key, value in values.items():
        if isinstance(value, Mapping):
            flat.update(dotted(value, f"{prefix}{key}."))
        else:
            flat[f"{prefix}{key}"] = value
    return flat
