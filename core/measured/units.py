"""Quantity and unit of a column from its header."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType

from core.frozen import frozen
from core.units import conversion_factor, unit_symbol

ANGLE, TIME = "angle", "time"
DERIVATIVES = ("displacement", "velocity", "acceleration", "jerk")
"""Quantities of a column; the index is the order of the derivative by cam angle."""
QUANTITIES = DERIVATIVES[:3]
"""Quantities from which a motion can be computed."""


def _sizes(base: str, *names: str) -> Mapping[str, float]:
    """Spelling in a table -> the unit in terms of ``base``."""
    return MappingProxyType({name: conversion_factor(unit_symbol(name), base) for name in names})


ANGLE_UNITS = _sizes("°", "deg", "rad", "turns")
"""Unit -> degrees of cam angle."""
TIME_UNITS = _sizes("s", "s", "ms")
"""Unit -> seconds; the speed of the shaft converts them into cam angles."""
BASES: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "mm": {
            **_sizes("mm", "mm", "cm", "m", "um", "in", "thou", "ft"),
            "1e-4in": conversion_factor("in", "mm") / 1e4,
        },
        "deg": _sizes("°", "deg", "rad"),
    }
)
"""Unit of a motion -> units of its tables, in terms of it."""
PER = ("deg", "rad", "s")
GRAVITY = conversion_factor("g", "mm/s²")


@frozen
class ValueUnit:
    """Unit of a measured value: mm, mm/s, mm/deg², g.

    Attributes
    ----------
    motion : unit of the motion, ``mm`` or ``deg``
    size : numerator in that unit
    per : denominator, element of ``PER``; empty for a displacement
    order : order of the derivative
    """

    name: str
    motion: str
    size: float
    per: str = ""
    order: int = 0

    def by_degree(self, speed_rpm: float | None) -> float:
        """Value of the unit in units of the motion per degree^order; a speed is required where ``per`` is s."""
        denominator = {"": 1.0, "deg": 1.0, "rad": ANGLE_UNITS["rad"], "s": 6.0 * (speed_rpm or 1.0)}[self.per]
        return self.size / denominator**self.order


@lru_cache(maxsize=4096)
def value_unit(name: str, motion: str) -> ValueUnit | None:
    """Unit with a name such as ``mm/s2`` for a motion in mm or deg; None where it is unknown."""
    if name == "g" and motion == "mm":
        return ValueUnit("g", "mm", GRAVITY, "s", 2)
    match = re.fullmatch(r"([a-z]+|1e-4in)(?:/(deg|rad|s)([23]?))?", name)
    if match is None or match[1] not in BASES[motion]:
        return None
    order = 0 if match[2] is None else int(match[3] or 1)
    return ValueUnit(name, motion, BASES[motion][match[1]], match[2] or "", order)


def value_units(quantity: str, motion: str) -> tuple[str, ...]:
    """Names of the units of a quantity."""
    order = DERIVATIVES.index(quantity)
    if order == 0:
        return tuple(BASES[motion])
    power = "" if order == 1 else str(order)
    units = tuple(f"{base}/{per}{power}" for per in ("s", "deg", "rad") for base in BASES[motion])
    return (*units, "g") if (order, motion) == (2, "mm") else units


_NUMBERED = re.compile(r"\s*\d[\d.,/^*·eE+\- ]*\s*[a-zA-Zµμ]")  # a number before a unit: 1/100 mm
_FRACTION = re.compile(
    r"(?:^|\s)((?:0?[.,]\d|1/\d|1e-\d|10\^?-\d)[\d.,]*\s+\S+)\s*$", re.IGNORECASE
)  # 0.01 mm at the end


# -- reading units ----------------------------------------------------------------------------------------

_SPELLINGS = tuple(
    (re.compile(spelled), meant)
    for spelled, meant in (
        (r"[\^*·⋅∙×_~ ]+", ""),
        (r"per", "/"),
        (r"micro?met(?:er|re)s?|microns?|mic\b|μm", "um"),
        (r"millimet(?:er|re)s?", "mm"),
        (r"centimet(?:er|re)s?", "cm"),
        (r"met(?:er|re)s?", "m"),
        (r"\.$", ""),
        (r"inch(?:es)?|zoll|''", "in"),
        (r"\b(?:thous?|mils?)\b", "thou"),
        (r"\b(?:feet|foot)\b", "ft"),
        (r"^(?:0?\.0001|1/10000|10-4|1e-0?4)(?=in)", "1e-4"),
        (r"degrees?|degs?|grad|°|도", "deg"),
        (r"radians?|rads", "rad"),
        (r"seconds?|secs?|sek|초", "s"),
        (r"revolutions?|revs?|turns?|cycles?|umdr?|회전", "turns"),
        (r"(?<=[a-z])s-1$", "/s"),
        (r"(?<=[a-z])s-2$", "/s2"),
        (r"(?<=[a-z])s-3$", "/s3"),
        (r"(?<=[a-z])(deg|rad)-([12])$", r"/\1\2"),
        (r"/(s|deg|rad)/\1$", r"/\g<1>2"),
        (r"/(s|deg|rad)1$", r"/\1"),
    )
)


LONGEST = 200
"""Characters of a column's name, from its end, in which quantity and unit are searched."""
_LONGEST_UNIT, _MOST_PARTS = 40, 6


@lru_cache(maxsize=4096)
def unit_of(text: str) -> str:
    """Name of the unit that a text spells: ``mm``, ``deg``, ``mm/s2``, ``turns``; empty where it is unknown."""
    if len(text := text.strip()) > _LONGEST_UNIT:
        return ""
    for sign, plain in (("º", "°"), ("˚", "°"), ("″", "in"), ('"', "in")):
        text = text.replace(sign, plain)
    parts = text.strip().lower().split("_")
    if len(parts) > 1:  # mm_s2, as in tables of KINDYNA
        text = parts[0] + "/" + "".join(p for p in parts[1:] if p != "per")
    plain = unicodedata.normalize("NFKC", text).lower().replace("\u2044", "/").replace("\u2215", "/").replace("−", "-")
    for spelled, meant in _SPELLINGS:
        plain = spelled.sub(meant, plain)
    known = plain in ANGLE_UNITS or plain in TIME_UNITS or any(value_unit(plain, motion) for motion in BASES)
    return plain if known else ""


def _multiples(name: str) -> list[str]:
    """Multiples of a unit in a column's name: in parentheses, or a fraction before the unit at its end."""
    bracketed = [text for text in re.findall(r"\(([^()]*)\)", name) if _NUMBERED.match(text)]
    return bracketed or _FRACTION.findall(name)


def unknown_unit(name: str) -> str:
    """Unknown unit of a column's name, in brackets or as a multiple; empty where there is none."""
    name = name[-LONGEST:]
    spelled = re.findall(r"\[([^\[\]]*)\]", name) or _multiples(name)
    return "" if not spelled or unit_of(spelled[-1]) else spelled[-1].strip()


def unit_in(text: str) -> str:
    """Unit at the end of a column's name: in brackets, after comma, slash, ``in``, underscore or space; else empty."""
    text = text[-LONGEST:]
    for bracketed in re.findall(r"[\[({<]([^\[({<\])}>]*)[\])}>]", text):
        if unit_of(bracketed):
            return unit_of(bracketed)
    if multiples := _multiples(text):
        return unit_of(multiples[-1])
    candidates = [part.strip() for part in re.split(r",|\s/\s|\s/(?=\S+$)|\bin\b(?=\s*\S)", text)[1:][-_MOST_PARTS:]]
    words = re.split(r"\s+", text.strip())
    if len(words) > 1:
        candidates.append(words[-1])
    pieces = words[-1].split("_")
    candidates += ["_".join(pieces[i:]) for i in range(max(1, len(pieces) - _MOST_PARTS), len(pieces))]
    if len(text.strip()) > 1:  # a single letter is a name: s, m, g
        candidates.append(text)
    return next((unit_of(part) for part in candidates if unit_of(part)), "")


# -- reading quantities -----------------------------------------------------------------------------------

_WORDS: tuple[tuple[str, str], ...] = (
    # the first matching row is used; Korean words have no spaces around them
    ("jerk", r"jerk|j|ruck"),
    ("other", r"snap|force|torque|pressure|curvature|temperature|rpm"),
    ("acceleration", r"accelerations?|accel|acc|a|d2s|beschleunigung|가속도"),
    ("velocity", r"velocity|velocities|vel|v|speed|ds|geschwindigkeit|속도"),
    (TIME, r"time|t|zeit|시간"),
    (ANGLE, r"angles?|theta|θ|ϑ|ang|winkel|\w*winkel|각도?|\w*각도?"),
    ("displacement", r"displacements?|disp|displ|lift|strokes?|rise|travel|positions?|pos|weg|hub|\w*hub|\w*weg|y|s|h|x|변위|\w*변위"
                     r"|양정|리프트|행정|follower|output"),
    (ANGLE, r"cam|phi|φ|deg|degrees?|rotation|crank|nocken"),
)  # fmt: skip


@frozen
class ColumnMeaning:
    """Quantity and unit in a column's name; empty where it states none."""

    quantity: str
    unit: str


@lru_cache(maxsize=4096)
def meaning(name: str) -> ColumnMeaning:
    """Quantity and unit in a column's name; a unit such as mm/s² implies the quantity."""
    name = name[-LONGEST:]
    unit = unit_in(name)
    order = max((result.order for motion in BASES if (result := value_unit(unit, motion))), default=0)
    plain = unicodedata.normalize("NFKC", re.sub(r"[\[({<][^\[({<\])}>]*[\])}>]", " ", name)).lower()
    tokens = [t for t in re.split(r"[^\w]+|_|\d+", plain) if t]
    named = next((q for q, words in _WORDS if any(re.fullmatch(words, token) for token in tokens)), "")
    return ColumnMeaning(DERIVATIVES[order] if order and named != "other" else named, unit)
