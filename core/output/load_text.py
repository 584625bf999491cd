"""The rows of the loads in words: what each is called, and where it holds on to the mechanism."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

from core.design import HOLDS, Design, Held, PairPlace, get, holds_of, link_names, pairs_of
from core.output.lines import shortest

ROW = re.compile(r"loads\.(\w+)\[(\d+)\]")
"""The path of a row, and what lies in it."""
_CALLED: Mapping[str, str] = MappingProxyType(
    {"springs": "Spring", "torsion_springs": "Torsion spring", "process": "Process force"}
)


def row_name(design: Design, path: str) -> str:
    """What a row of the loads is called: ``Spring 2``, ``Friction at A``, ``Mass of link 3``."""
    match = ROW.match(path)
    if match is None:
        return ""
    row = get(design, match[0])
    others = {
        "pair_friction": "Friction at {0.pair}",
        "masses": "Mass of link {0.link}",
        "forces": "Force at {0.point} of link {0.link}",
    }
    return others[match[1]].format(row) if match[1] in others else f"{_CALLED[match[1]]} {int(match[2]) + 1}"


def row_place(design: Design, path: str) -> str:
    """Where it holds on: ``frame at (60, 120) – roller of arm``."""
    match = ROW.match(path)
    if match is None or match[1] not in HOLDS:
        return ""
    row = get(design, match[0])
    return " – ".join(held_text(design, hold.read(row)) for hold in holds_of(design.drive, match[1]))


def row_title(design: Design, path: str) -> str:
    """What it is called with where it holds on, where the name does not say so; empty where the path leads to no row."""
    name, place = row_name(design, path), row_place(design, path)
    return name if place in name else f"{name}: {place}"


def link_text(design: Design, number: int) -> str:
    """What a link is called in a sentence: ``frame``, ``arm``, ``link 3``."""
    name = link_names(design.drive).get(number, str(number))
    return f"link {number}" if name == str(number) else name.partition("(")[2].rstrip(")")


def held_text(design: Design, held: Held | None) -> str:
    """Where something holds on: ``A of link 2``, ``frame at (-50, 20)``, ``pin A``, ``slide of link 4``."""
    if held is None:
        return "output, along its motion"
    if isinstance(held, PairPlace):
        pin = pairs_of(design.drive).get(held.pair, (True, ()))[0]
        of = "" if held.link is None else f", links {held.link} and {held.other}"
        return f"{held.pair}{of}" if pin or not held.pair.isdecimal() else f"slide of link {held.pair}"
    on = link_text(design, held.link)
    if held.point is not None:
        return f"{held.point} of {on}"
    return on if held.x_mm is None or held.y_mm is None else f"{on} at ({shortest(held.x_mm)}, {shortest(held.y_mm)})"
