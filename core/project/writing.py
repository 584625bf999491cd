"""A design as the tables of its file, keys in the order of the contract."""

from __future__ import annotations

from typing import Any

from core.design import FOLLOWER_KINDS, Design, kind_of
from core.design.paths import SECTIONS, section
from core.project.hooks import converter

FORMAT = 1


def to_table(design: Design) -> dict[str, Any]:
    """The tables of the file."""
    kind = kind_of(design.drive.follower)
    made = converter(FOLLOWER_KINDS[kind].motion_unit)
    table: dict[str, Any] = {"format": FORMAT, "name": design.name}
    if design.assumed:
        table["assumed"] = list(design.assumed)
    for name in SECTIONS:
        table[name] = made.unstructure(section(design, name))
    table["follower"] = {"kind": kind, **table["follower"]}
    return table
