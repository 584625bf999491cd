"""A design as the tables of its file, keys in the order of the contract."""

from __future__ import annotations

from typing import Any

from core.design import FOLLOWER_KINDS, Design, Motion, kind_of
from core.project.hooks import converter
from core.project.linkage_writing import linkage_tables

FORMAT = 1


def to_table(design: Design) -> dict[str, Any]:
    """The tables of the file."""
    if design.drive.is_linkage:
        return {**linkage_head(design), **linkage_tables(design)}
    kind = kind_of(design.drive.follower)
    made = converter(FOLLOWER_KINDS[kind].motion_unit)
    table = _head(design)
    for name, part in design.tables.items():
        table[name] = made.unstructure(part)
    table["follower"] = {"kind": kind, **table["follower"]}
    return table


def motion_to_table(motion: Motion) -> dict[str, Any]:
    """The table [motion] of the file."""
    table: dict[str, Any] = converter(motion.unit).unstructure(motion)
    return table


def linkage_head(design: Design) -> dict[str, Any]:
    """What stands before [linkage]: head and motion."""
    table = _head(design)
    if design.drive.motion is not None:
        table["motion"] = motion_to_table(design.drive.motion)
    return table


def _head(design: Design) -> dict[str, Any]:
    table: dict[str, Any] = {"format": FORMAT, "name": design.name}
    if design.assumed:
        table["assumed"] = list(design.assumed)
    return table
