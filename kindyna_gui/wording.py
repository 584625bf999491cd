"""Words and numbers as the window shows them: names of fields, names of steps, the shortest text of a number."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from decimal import Decimal
from types import MappingProxyType
from typing import Any

from core.design import Design, Unit, entries
from core.design.paths import SECTIONS
from core.laws import find_law
from core.linkage.base import LAYOUT_TABLE

SECTION_NAMES: Mapping[str, str] = MappingProxyType(
    {"motion": "Motion", "follower": "Follower", "cam": "Cam", "shaft": "Shaft", "loads": "Loads"}
)

_CHOICES: Mapping[str, str] = MappingProxyType(
    {"ccw": "counter-clockwise", "cw": "clockwise", "roller": "roller", "open": "open (disk)"}
)
"""Words of the file that read better otherwise."""

_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*)", re.ASCII)
_PLAIN_FROM, _PLAIN_TO = 1e-7, 1e15


def shortest(value: float) -> str:
    """The shortest text that reads back to the same number, without an exponent where that is no longer."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value + 0.0:g}"
    text = repr(float(value))
    if _PLAIN_FROM <= abs(value) < _PLAIN_TO:
        text = f"{Decimal(text):f}"
    return text.removesuffix(".0")


def parsed(text: str, unit: Unit) -> float | None:
    """The number in a text, with or without its unit; None where it is none."""
    match = _NUMBER.fullmatch(text.strip().replace("\u2212", "-"))
    if match is None or match[2] not in ("", unit.symbol):
        return None
    value = float(match[1])
    return value + 0.0 if math.isfinite(value) else None


def sentence(text: str) -> str:
    """A text that begins with a capital letter, with the printer's signs for what has them."""
    return (text[:1].upper() + text[1:]).replace(">=", "≥").replace("<=", "≤")


def choice_text(word: str) -> str:
    """A word of a choice, as shown."""
    return _CHOICES.get(word, word)


def choice_tip(word: str) -> str:
    """What a word of a choice stands for; empty where it says so itself."""
    row = LAYOUT_TABLE.get(word)
    if row is None:
        return ""
    cam, roller, slider = (
        "left" if row.cam_left else "right",
        "above" if row.roller_above else "below",
        "right" if row.slider_right else "left",
    )
    return f"cam {cam}, roller {roller}, slider {slider}"


def law_label(slug: str) -> str:
    law = find_law(slug)
    return law.label if law is not None else slug


def value_text(value: Any, unit: Unit) -> str:
    """A value with its unit: ``850 mm``, ``35°``, ``clockwise``."""
    if not isinstance(value, float):
        return choice_text(str(value))
    gap = "" if unit.symbol in ("", "°") else " "
    return f"{shortest(value)}{gap}{unit.symbol}"


def step_text(name: str, value: Any, unit: Unit) -> str:
    """The name of a step of the undo stack: ``Change rod L2 to 850 mm``."""
    return f"Change {name[:1].lower()}{name[1:]} to {value_text(value, unit)}"


def segment_of(path: str) -> int | None:
    """The number of the segment, from 0, that a path leads into."""
    match = re.match(r"motion\.segments\[(\d+)\]", path)
    return int(match[1]) if match else None


def name_of(design: Design, path: str) -> str:
    """A field's name for the reader: ``Rod L2``, ``Segment 3, span``; the path itself where it has none."""
    number = segment_of(path)
    prefix = "" if number is None else f"Segment {number + 1}"
    top = path.partition(".")[0]
    if path in SECTION_NAMES:
        return SECTION_NAMES[path]
    if prefix and path.endswith("]"):
        return prefix
    if path.endswith(".law"):
        return f"{prefix}, law"
    for entry in entries(design, top) if top in SECTIONS else ():
        if entry.path == path:
            label = entry.info.label
            return f"{prefix}, {label[:1].lower()}{label[1:]}" if prefix else label
    return {"motion.segments": "Motion", "name": "Name"}.get(path, path)
