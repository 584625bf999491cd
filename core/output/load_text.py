"""Rows of the loads in words: their names, and their attachments to the mechanism."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from core.design import HOLDS, Design, PairTarget, Target, get, holds_of, link_names, pairs_of
from core.design.paths import entry_at
from core.number_text import shortest

ROW = re.compile(r"loads\.(\w+)\[(\d+)\]")
"""Path of a row: the list and the index."""
_NAMES: Mapping[str, str] = MappingProxyType(
    {
        "springs": "Spring",
        "torsion_springs": "Torsion spring",
        "process": "Process force",
        "valve_springs": "Valve spring",
    }
)


def row_name(design: Design, path: str) -> str:
    """Name of a row of the loads: ``Spring 2``, ``Friction at A``, ``Mass of link 3``."""
    match = ROW.match(path)
    if match is None:
        return ""
    row = get(design, match[0])
    templates = {
        "pair_friction": "Friction at {0.pair}",
        "masses": "Mass of link {0.link}",
        "forces": "Force at {0.point} of link {0.link}",
    }
    return templates[match[1]].format(row) if match[1] in templates else f"{_NAMES[match[1]]} {int(match[2]) + 1}"


def row_attachments(design: Design, path: str) -> str:
    """Attachments of a row: ``frame at (60, 120) – roller of arm``."""
    match = ROW.match(path)
    if match is None or match[1] not in HOLDS:
        return ""
    row = get(design, match[0])
    return " – ".join(attachment_text(design, hold.read(row)) for hold in holds_of(design.drive, match[1]))


def row_title(design: Design, path: str) -> str:
    """Name of a row with its attachments, where the name does not contain them; empty where the path leads to no row."""
    name, attachments = row_name(design, path), row_attachments(design, path)
    return name if attachments in name else f"{name}: {attachments}"


def part_names(design: Design, paths: Sequence[str]) -> list[str]:
    """Names of parts of a design, given by their paths: loads, rows of loads, tables."""
    names = []
    for path in paths:
        entry = None if ROW.match(path) else entry_at(design, path)
        names.append(row_name(design, path) or (path if entry is None else entry.info.label))
    return [name[:1].lower() + name[1:] for name in names]


def link_text(design: Design, number: int) -> str:
    """A link in a sentence: ``frame``, ``arm``, ``link 3``."""
    name = link_names(design.drive).get(number, str(number))
    return f"link {number}" if name == str(number) else name.partition("(")[2].rstrip(")")


def attachment_text(design: Design, attachment: Target | None) -> str:
    """An attachment in words: ``A of link 2``, ``frame at (-50, 20)``, ``pin A``, ``slide of link 4``."""
    if attachment is None:
        return "output, along its motion"
    if isinstance(attachment, PairTarget):
        pin = pairs_of(design.drive).get(attachment.pair, (True, ()))[0]
        links = "" if attachment.link is None else f", links {attachment.link} and {attachment.other}"
        return (
            f"{attachment.pair}{links}"
            if pin or not attachment.pair.isdecimal()
            else f"slide of link {attachment.pair}"
        )
    link = link_text(design, attachment.link)
    if attachment.point is not None:
        return f"{attachment.point} of {link}"
    return (
        link
        if attachment.x_mm is None or attachment.y_mm is None
        else f"{link} at ({shortest(attachment.x_mm)}, {shortest(attachment.y_mm)})"
    )
