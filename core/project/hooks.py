"""How the tables of a file become parts of a design and back: cattrs, told by the metadata of the fields."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING as NO_DEFAULT
from dataclasses import fields, is_dataclass, replace
from functools import cache, lru_cache
from numbers import Real
from types import MappingProxyType
from typing import Any, get_type_hints

from cattrs import Converter, override
from cattrs.gen import make_dict_structure_fn, make_dict_unstructure_fn

from core.design import (
    CURVES,
    Curve,
    Elastic,
    End,
    Info,
    Loads,
    Motion,
    Named,
    Point,
    Segment,
    Shaft,
    info_of,
    split_unit,
)
from core.laws import LAWS, find_law

Hook = Callable[[Any, Any], Any]


class _NoWord(str):
    """Text apart from all other."""


# What stands where nothing could be read, so that the rules can be asked of the rest: no rule fires on nan,
# and what is told of these very objects is left out.
NO_NUMBER = float("nan")
NO_WORD = _NoWord()

_ELASTIC_KEYS = tuple(f.name for f in fields(Elastic))
_ELASTIC = "stiffness_nm_per_rad"  # under this one of them the others are gathered
_IN_MOTION_UNIT = ((Motion, "start"), (Segment, "rise"))
_LOADS_LAST = (
    "friction",
    "external_force_n",
    "spring_rate_n_per_mm",
    "preload_n",
    "gravity_m_s2",
    "gravity_angle_deg",
)


class Wrong(ValueError):
    """A value of the wrong type; where it stands is known further out: ``{path}`` in what is allowed."""

    def __init__(self, value: Any, problem: str, allowed: str = "") -> None:
        super().__init__(problem)
        self.value, self.problem, self.allowed = value, problem, allowed


@cache
def keys_of(part: type, unit: str) -> Mapping[str, str]:
    """Field -> key of the file, for a motion in ``unit``."""
    keys = {f.name: f"{f.name}_{unit}" if (part, f.name) in _IN_MOTION_UNIT else f.name for f in fields(part)}
    if part is Motion:
        del keys["unit"]
    if part is Segment:
        keys["curve"] = "law"
    if part is Shaft:
        keys["elastic"] = _ELASTIC
    return MappingProxyType(keys)


@cache
def required_keys(part: type, unit: str) -> tuple[str, ...]:
    keys = keys_of(part, unit)
    bare = {f.name for f in fields(part) if f.default is NO_DEFAULT and f.default_factory is NO_DEFAULT}
    return tuple(key for name, key in keys.items() if name in bare)


def allowed_in(part: type, name: str, key: str) -> str:
    """The range of a field as text."""
    info = info_of(next(f for f in fields(part) if f.name == name))
    if info is not None:
        return info.allowed(split_unit(key)[1])
    return " | ".join(LAWS) if (part, name) == (Named, "law") else ""


def curve_type(law: Any) -> type:
    return CURVES.get(law, Named) if isinstance(law, str) else Named


@cache
def converter(unit: str, strict: bool = True) -> Converter:
    """For a motion in ``unit``.

    Strict: raises cattrs' errors for unknown keys, missing keys and wrong types, all of them at once. Else:
    reads what can be read, and the rest is NO_NUMBER or NO_WORD.
    """
    made = Converter(forbid_extra_keys=strict)
    made.register_structure_hook_factory(is_dataclass, lambda part: _reader(part, made, unit, strict))
    made.register_unstructure_hook_factory(is_dataclass, lambda part: _writer(part, made, unit))
    made.register_unstructure_hook(float, float)
    return made


# -- reading ----------------------------------------------------------------------------------------------


def _reader(part: type, made: Converter, unit: str, strict: bool) -> Hook:
    types = get_type_hints(part)
    keys = keys_of(part, unit)
    overrides: dict[str, Any] = {name: override(omit=True) for name in types if name not in keys}
    for field in fields(part):
        if key := keys.get(field.name):
            hook = _entry(info_of(field), types[field.name], key, made, strict)
            overrides[field.name] = override(rename=key, struct_hook=hook)
    build: Hook = make_dict_structure_fn(part, made, **overrides)
    holes: dict[str, Any] = {} if strict else dict.fromkeys(required_keys(part, unit))

    def read(value: Any, _: Any) -> Any:
        table = _table(value, strict)
        if part is Segment:
            table = _with_curve(table, keys["rise"], strict)
        if part is Shaft:
            table = _with_elastic(table)
        read_part = build({**holes, **table}, part)
        return replace(read_part, unit=unit) if isinstance(read_part, Motion) else read_part

    return read


def _table(value: Any, strict: bool) -> Mapping[str, Any]:
    if isinstance(value, Mapping):
        return value
    if strict:
        raise Wrong(value, "must be a table")
    return {}


def _with_curve(table: Mapping[str, Any], rise: str, strict: bool) -> dict[str, Any]:
    """A segment's table with the keys of its curve gathered under ``law``; a dwell need not say its rise."""
    curve_part = curve_type(table.get("law"))
    own = _names_of(curve_part)
    gathered = {key: value for key, value in table.items() if key not in own}
    gathered["law"] = (curve_part, {key: value for key, value in table.items() if key in own})
    law = find_law(table["law"]) if isinstance(table.get("law"), str) else None
    if rise not in table and (law.is_dwell if law else strict):
        gathered[rise] = 0.0
    return gathered


@lru_cache(maxsize=64)
def _names_of(part: Any) -> frozenset[str]:
    return frozenset(f.name for f in fields(part))


def _with_elastic(table: Mapping[str, Any]) -> dict[str, Any]:
    """A shaft's table with the keys of its elasticity gathered; there is none where none of them is said."""
    gathered = {key: value for key, value in table.items() if key not in _ELASTIC_KEYS}
    own = {key: value for key, value in table.items() if key in _ELASTIC_KEYS}
    return {**gathered, _ELASTIC: own} if own else gathered


def _entry(info: Info | None, expected: Any, key: str, made: Converter, strict: bool) -> Hook:
    """The hook of one field."""
    if info is not None and not info.choices:
        return _number(info.allowed(split_unit(key)[1]), strict)
    if expected is str:
        return _text(info.allowed(split_unit(key)[1]) if info else " | ".join(LAWS), strict)
    if getattr(expected, "__origin__", None) is tuple:
        return _list(made.get_structure_hook(expected), strict)
    if expected == Curve:
        return lambda value, _: made.structure(value[1], value[0])
    if expected == Elastic | None:
        return lambda value, _: made.structure(value, Elastic)
    return lambda value, _: made.structure(value, expected)  # a table within the table


def _is_truth(value: object) -> bool:
    return isinstance(value, bool)  # which Python counts among the integers


def _number(allowed: str, strict: bool) -> Hook:
    def read(value: Any, _: Any) -> float:
        problem = "must be a number"
        if isinstance(value, Real) and not _is_truth(value):
            try:
                return float(value)
            except OverflowError:
                problem = "too large for a number"
        if strict:
            raise Wrong(value, problem, allowed)
        return NO_NUMBER

    return read


def _text(allowed: str, strict: bool) -> Hook:
    def read(value: Any, _: Any) -> str:
        if isinstance(value, str):
            return value
        if strict:
            raise Wrong(value, "must be text", allowed)
        return NO_WORD

    return read


def _list(structure: Hook, strict: bool) -> Hook:
    def read(value: Any, expected: Any) -> Any:
        if isinstance(value, list | tuple):
            return structure(value, expected)
        if strict:
            raise Wrong(value, "must be a list of tables", "[[{path}]]")
        return ()

    return read


# -- writing ----------------------------------------------------------------------------------------------


def _writer(part: type, made: Converter, unit: str) -> Callable[[Any], dict[str, Any]]:
    keys = keys_of(part, unit)
    overrides: dict[str, Any] = {
        f.name: override(rename=keys.get(f.name), omit=f.name not in keys) for f in fields(part)
    }
    if part is Segment:
        overrides["curve"] = override(rename="law", unstruct_hook=made.unstructure)
    if part is Shaft:
        overrides["elastic"] = override(rename=_ELASTIC, unstruct_hook=lambda e: e and made.unstructure(e))
    unstructure: Callable[[Any], dict[str, Any]] = make_dict_unstructure_fn(part, made, **overrides)
    if part is Segment:
        return lambda segment: _without_curve(segment, unstructure(segment), keys["rise"])
    if part is Shaft:
        return lambda shaft: _without_elastic(unstructure(shaft))
    if part in (End, Point):
        return lambda value: {k: v for k, v in unstructure(value).items() if v is not None}
    if issubclass(part, Loads):
        return lambda loads: _loads_in_order(unstructure(loads))
    return unstructure


def _without_curve(segment: Segment, table: dict[str, Any], rise: str) -> dict[str, Any]:
    curve = table.pop("law")
    slug = next((slug for slug, part in CURVES.items() if part is type(segment.curve)), None)
    law = find_law(segment.curve.law) if slug is None else None
    if law is not None and law.is_dwell and str(segment.rise) == "0.0":
        del table[rise]
    return {"law": slug or curve.pop("law"), **table, **_said(curve, segment.curve)}


def _without_elastic(table: dict[str, Any]) -> dict[str, Any]:
    own = table.pop(_ELASTIC)
    return {**table, **(own or {})}


def _said(table: dict[str, Any], curve: Any) -> dict[str, Any]:
    """What a curve says beside its law: nothing that is as it would be without a word."""
    bare = {f.name: f.default for f in fields(curve) if f.default is not NO_DEFAULT}
    return {k: v for k, v in table.items() if k not in bare or getattr(curve, k) != bare[k]}


def _loads_in_order(table: dict[str, Any]) -> dict[str, Any]:
    """What a kind adds stands first, as in the contract."""
    own = [key for key in table if key not in _LOADS_LAST]
    return {key: table[key] for key in (*own, *_LOADS_LAST) if key in table}
