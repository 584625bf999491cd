"""A linkage as the tables and the text of its file, in the spelling of the contract: points, driver and branch on one
line each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

import tomli_w

from core.design import Design, LinkageLoads
from core.design.paths import PAIRS
from core.project.hooks import converter


def linkage_tables(design: Design) -> dict[str, Any]:
    """The tables [linkage], [cam] and [loads], each only where there is something to say."""
    linkage = design.drive.linkage
    table: dict[str, Any] = {"driver": _flat(linkage.driver)}
    if linkage.branch:
        table["branch"] = {s.joint: s.side for s in linkage.branch}
    table["links"] = [
        {"number": link.number, "points": {p.name: [float(p.x_mm), float(p.y_mm)] for p in link.points}}
        for link in linkage.links
    ]
    if linkage.sliders:
        table["sliders"] = [_flat(slider) for slider in linkage.sliders]
    told = {"linkage": table}
    if design.drive.cam is not None:
        told["cam"] = _flat(design.drive.cam)
    if design.shaft is not None:
        told["shaft"] = converter("mm").unstructure(design.shaft)
    if repr(design.drive.loads) != repr(LinkageLoads()):  # which tells 0.0 from -0.0
        told["loads"] = _flat(design.drive.loads)
    return told


def _flat(part: Any) -> dict[str, Any]:
    """A part's fields as keys; pairs of coordinates as [x, y]; rows of a list behind them."""
    firsts = {x: (key, y) for key, (x, y) in PAIRS.items()}
    seconds = {y for _, y in PAIRS.values()}
    table: dict[str, Any] = {}
    for field in fields(part):
        value = getattr(part, field.name)
        if field.name in firsts:
            key, other = firsts[field.name]
            table[key] = [float(value), float(getattr(part, other))]
        elif isinstance(value, tuple):
            if value:
                table[field.name] = [_flat(row) for row in value]
        elif field.name not in seconds:
            table[field.name] = float(value) if field.type == "float" else value
    return table


def section_text(name: str, table: Mapping[str, Any]) -> str:
    """``[name]`` with its entries on one line each, then its lists of tables as ``[[name.key]]``."""
    lines = ["", f"[{name}]", *_lines({k: v for k, v in table.items() if not _is_rows(v)})]
    for key, rows in table.items():
        if _is_rows(rows):
            for row in rows:
                lines += ["", f"[[{name}.{key}]]", *_lines(row)]
    return "\n".join(lines) + "\n"


def _is_rows(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], dict)


def _lines(table: Mapping[str, Any]) -> list[str]:
    return [f"{_key(key)} = {_inline(value)}" for key, value in table.items()]


def _inline(value: Any) -> str:
    if isinstance(value, Mapping):
        inside = ", ".join(_lines(value))
        return f"{{ {inside} }}" if inside else "{}"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"[{', '.join(_inline(v) for v in value)}]"
    return tomli_w.dumps({"v": value}).removeprefix("v = ").rstrip("\n")


def _key(key: str) -> str:
    return tomli_w.dumps({key: 0}).removesuffix(" = 0\n")
