"""Quantity and unit of a column from the words above it."""

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
"""What a column may hold; the place in the row is the order of the derivative by cam angle."""
QUANTITIES = DERIVATIVES[:3]
"""What a motion can be made of."""


def _sizes(of: str, *names: str) -> Mapping[str, float]:
    """Spelling in a table -> how many of a unit it is; these are the units that tables are looked through for."""
    return MappingProxyType({name: conversion_factor(unit_symbol(name), of) for name in names})


ANGLE_UNITS = _sizes("°", "deg", "rad", "turns")
"""Degrees of cam angle in one."""
TIME_UNITS = _sizes("s", "s", "ms")
"""Seconds in one; a cam angle by the shaft's speed."""
BASES: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "mm": {
            **_sizes("mm", "mm", "cm", "m", "um", "in", "thou", "ft"),
            "1e-4in": conversion_factor("in", "mm") / 1e4,
        },
        "deg": _sizes("°", "deg", "rad"),
    }
)
"""Unit of a motion -> the units that it can be measured in, and how many of it they are."""
PER = ("deg", "rad", "s")
GRAVITY = conversion_factor("g", "mm/s²")


@frozen
class ValueUnit:
    """The unit of a measured value: mm, mm/s, mm/deg², g.

    motion  unit of the motion it belongs to, ``mm`` or ``deg``
    size    how many of that it is
    per     key of ``PER``; empty for a displacement
    order   of the derivative
    """

    name: str
    motion: str
    size: float
    per: str = ""
    order: int = 0

    def by_degree(self, speed_rpm: float | None) -> float:
        """How many of the motion's unit per degree^order of cam angle it is; a speed is needed where ``per`` is s."""
        each = {"": 1.0, "deg": 1.0, "rad": ANGLE_UNITS["rad"], "s": 6.0 * (speed_rpm or 1.0)}[self.per]
        return self.size / each**self.order


@lru_cache(maxsize=4096)
def value_unit(name: str, motion: str) -> ValueUnit | None:
    """A unit by its name, ``mm/s2``, for a motion in mm or deg; None where it is none."""
    if name == "g" and motion == "mm":
        return ValueUnit("g", "mm", GRAVITY, "s", 2)
    match = re.fullmatch(r"([a-z]+|1e-4in)(?:/(deg|rad|s)([23]?))?", name)
    if match is None or match[1] not in BASES[motion]:
        return None
    order = 0 if match[2] is None else int(match[3] or 1)
    return ValueUnit(name, motion, BASES[motion][match[1]], match[2] or "", order)


def value_units(quantity: str, motion: str) -> tuple[str, ...]:
    """The units that a quantity can be measured in."""
    order = DERIVATIVES.index(quantity)
    if order == 0:
        return tuple(BASES[motion])
    power = "" if order == 1 else str(order)
    units = tuple(f"{base}/{per}{power}" for per in ("s", "deg", "rad") for base in BASES[motion])
    return (*units, "g") if (order, motion) == (2, "mm") else units


_NUMBERED = re.compile(r"\s*\d[\d.,/^*·eE+\- ]*\s*[a-zA-Zµμ]")  # a number before a unit: 1/100 mm


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
    """The unit that a text spells, by its name here: ``mm``, ``deg``, ``mm/s2``, ``turns``; empty where it spells none."""
    if len(text := text.strip()) > _LONGEST_UNIT:
        return ""
    for sign, plain in (("º", "°"), ("˚", "°"), ("″", "in"), ('"', "in")):
        text = text.replace(sign, plain)
    parts = text.strip().lower().split("_")
    if len(parts) > 1:  # mm_s2, as in our own tables
        text = parts[0] + "/" + "".join(p for p in parts[1:] if p != "per")
    plain = unicodedata.normalize("NFKC", text).lower().replace("\u2044", "/").replace("\u2215", "/").replace("−", "-")
    for spelled, meant in _SPELLINGS:
        plain = spelled.sub(meant, plain)
    known = plain in ANGLE_UNITS or plain in TIME_UNITS or any(value_unit(plain, motion) for motion in BASES)
    return plain if known else ""


def unknown_unit(name: str) -> str:
    """What stands in square brackets in a column's name, as a unit does, and is none that is known; empty where nothing does."""
    name = name[-LONGEST:]
    inside = re.findall(r"\[([^\[\]]*)\]", name) or [
        text for text in re.findall(r"\(([^()]*)\)", name) if _NUMBERED.match(text)
    ]
    return "" if not inside or unit_of(inside[-1]) else inside[-1].strip()


def unit_in(text: str) -> str:
    """The unit that a column's name ends in: in brackets, behind a comma, slash or ``in``, after an underscore or
    space; empty where there is none."""
    text = text[-LONGEST:]
    for inside in re.findall(r"[\[({<]([^\[({<\])}>]*)[\])}>]", text):
        if unit_of(inside):
            return unit_of(inside)
    if any(_NUMBERED.match(inside) for inside in re.findall(r"\(([^()]*)\)", text)):
        return ""  # a multiple of a unit that is not known: not that unit
    tried = [part.strip() for part in re.split(r",|\s/\s|\s/(?=\S+$)|\bin\b(?=\s*\S)", text)[1:][-_MOST_PARTS:]]
    words = re.split(r"\s+", text.strip())
    if len(words) > 1:
        tried.append(words[-1])
    pieces = words[-1].split("_")
    tried += ["_".join(pieces[i:]) for i in range(max(1, len(pieces) - _MOST_PARTS), len(pieces))]
    if len(text.strip()) > 1:  # a letter alone is a name: s, m, g
        tried.append(text)
    return next((unit_of(part) for part in tried if unit_of(part)), "")


# -- reading quantities -----------------------------------------------------------------------------------

_WORDS: tuple[tuple[str, str], ...] = (
    # the first row that fits counts; Korean words stand without spaces around them
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
    """Quantity and unit that a column's name states; empty where it does not."""

    quantity: str
    unit: str


@lru_cache(maxsize=4096)
def meaning(name: str) -> ColumnMeaning:
    """Quantity and unit that a column's name states; a unit such as mm/s² implies the quantity."""
    name = name[-LONGEST:]
    unit = unit_in(name)
    order = max((result.order for motion in BASES if (result := value_unit(unit, motion))), default=0)
    plain = unicodedata.normalize("NFKC", re.sub(r"[\[({<][^\[({<\])}>]*[\])}>]", " ", name)).lower()
    tokens = [t for t in re.split(r"[^\w]+|_|\d+", plain) if t]
    named = next((q for q, words in _WORDS if any(re.fullmatch(words, token) for token in tokens)), "")
    return ColumnMeaning(DERIVATIVES[order] if order and named != "other" else named, unit)
