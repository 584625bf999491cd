"""Tables and text of a design file: keys in the order of the format, points, driver and branch of a linkage on one line each."""

from __future__ import annotations

import os
import re
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

from core.design import (
    NO_LIMITS,
    Design,
    Drive,
    LinkageLoads,
    Motion,
    Outline,
    Segment,
    SlideLoads,
    TurnLoads,
    all_paths,
)
from core.design.design import MOTIONS
from core.design.edits import is_dwell
from core.design.fields import FileEntry, Info, slots
from core.design.paths import in_order
from core.project.reading_faults import FORMAT

_SILENT = (
    repr(LinkageLoads()),
    repr(NO_LIMITS),
    repr(SlideLoads()),
    repr(TurnLoads()),
)  # tables with nothing but defaults; as text, since 0.0 == -0.0
_NUMBERS = r"\[\n\s*((?:[-+\w.]+,\s*)+)\]"
_WIDE = 100  # an indent beyond tomli_w's longest line, so that every segment becomes a table [[motion.segments]]


def to_table(design: Design, folder: str | None = None) -> dict[str, Any]:
    """Tables of a design's file; [limits], and [loads] of a linkage, only where they differ from the defaults.

    folder: that of the file, to which linked paths are relative; without it they are absolute.
    """
    table: dict[str, Any] = {"format": FORMAT, "name": design.name}
    if design.assumed:
        table["assumed"] = list(design.assumed)
    if not design.listed:
        return table | _tables(design.drive_tables, design.drive, folder) | _lists_of_design(design, folder)
    table["shaft"] = _table(design.shaft, "")
    if design.engine is not None:
        table["engine"] = _table(design.engine, "")
    table["drives"] = [_table(drive, "") | _tables(drive.tables, drive, folder) for drive in design.drives]
    if design.timing:
        table["timing"] = [_table(row, "") for row in design.timing]
    if design.balancer is not None:
        table["balancer"] = _table(design.balancer, "")
    return table | _lists_of_design(design, folder)


def _lists_of_design(design: Design, folder: str | None) -> dict[str, Any]:
    """Outlines, with the paths of their drawings from the folder of the file; clearances, tolerances and waviness."""
    outlines = [_table(_outline(row, folder), "") for row in design.outlines]
    clearances = [_table(row, "") for row in design.clearances]
    lists = {"outlines": outlines, "clearances": clearances}
    return {name: rows for name, rows in lists.items() if rows} | _tolerance_tables(design)


def _outline(outline: Outline, folder: str | None) -> Outline:
    return replace(outline, file=_relative(outline.file, outline.folder, folder)) if outline.file else outline


def _relative(name: str, old: str, folder: str | None) -> str:
    """Path of a linked file from the new folder of a design (None: absolute), as typed where the folder stays the same."""
    if os.path.isabs(name) or (folder is not None and os.path.realpath(folder) == os.path.realpath(old)):
        return name
    path = os.path.join(old, name)
    return os.path.normpath(path) if folder is None else os.path.relpath(path, folder)


def _tolerance_tables(design: Design) -> dict[str, Any]:
    """Tolerances of fields that exist, and waviness."""
    paths = set(all_paths(design)) if design.tolerances else set()
    rows = [_table(row, "") for row in design.tolerances if row.field in paths]
    waves = {} if design.waviness is None else {"waviness": _table(design.waviness, "")}
    return ({"tolerances": rows} if rows else {}) | waves


def _tables(tables: Mapping[str, Any], drive: Drive, folder: str | None) -> dict[str, Any]:
    tables_of_file = {
        name: _linked_motion(part, folder)
        if name == "motion" and part.follows
        else _table(part, getattr(part, "unit", drive.motion_unit))
        for name, part in tables.items()
        if repr(part) not in _SILENT
    }
    if "follower" in tables_of_file:
        tables_of_file["follower"] = {"kind": drive.kind, **tables_of_file["follower"]}
    if drive.is_alone and "cam" in tables_of_file:
        tables_of_file["cam"] = {"kind": drive.kind, **tables_of_file["cam"]}
    if drive.motions:
        motions = {motion.name: tables_of_file.pop(f"{MOTIONS}{motion.name}") for motion in drive.motions}
        tables_of_file["motions"] = motions
    return tables_of_file


def _linked_motion(motion: Motion, folder: str | None) -> dict[str, Any]:
    """Table of a linked motion, with the paths as typed where the design stays in its folder, else relative to the new one.

    The required motion of an inverse's output is included.
    """
    assert motion.follows is not None
    follows, requested = motion.follows, motion.follows.asked
    table = _table(follows.origin, "") | ({} if requested is None else _table(requested, requested.unit))

    def relative(name: str) -> str:
        return _relative(name, follows.folder, folder)

    for key, name in (("from", "table"), ("inverse", "linkage")):
        if key in table:
            table[key] |= {name: relative(table[key][name])}
    return table | ({"sum": [relative(name) for name in follows.origin.sum]} if follows.origin.sum else {})


def _table(part: Any, unit: str) -> dict[str, Any]:
    """Entries of a part and of the parts inside its table; without values that are None, and empty lists."""
    table: dict[str, Any] = {}
    for slot in in_order(part, unit):
        holder = getattr(part, slot.within) if slot.within else part
        if not _is_omitted(part, holder, slot):
            entry = _entry(holder, slot, unit)
            table |= entry if slot.placing.spread else {slot.key: entry}
    return table


def _is_omitted(part: Any, holder: Any, slot: FileEntry) -> bool:
    values = [getattr(holder, name) for name in slot.names or (slot.key,)]
    if isinstance(part, Segment) and slot.names == ("rise",):
        return is_dwell(part) and str(part.rise) == "0.0"
    value = values[0] if len(values) == 1 else values
    is_empty = all(v is None for v in values) or (isinstance(value, tuple) and not value and slot.missing is None)
    return is_empty or (slot.brief and value == slot.default)


def _entry(part: Any, slot: FileEntry, unit: str) -> Any:
    """Value of one entry as in the file."""
    if not slot.names:
        return getattr(part, slot.key)
    if len(slot.names) > 1:
        return [_number(getattr(part, name), info) for name, info in zip(slot.names, slot.infos, strict=True)]
    value, placing = getattr(part, slot.names[0]), slot.placing
    if placing.key:
        name, content = slots(placing.kind)
        return {getattr(row, name.key): _entry(row, content, unit) for row in value}
    if placing.rows:
        return [_row(row) for row in value]
    if placing.each is not None:
        return list(value)
    if isinstance(value, tuple):
        return [_table(row, unit) for row in value]
    if placing.kind is not None:
        return _table(value, unit)
    is_real = slot.info is not None and not slot.info.choices and not slot.info.flag
    return _number(value, slot.info) if is_real and slot.info is not None else value


def _number(value: Any, info: Info) -> Any:
    return value if info.whole else float(value)


def _row(part: Any) -> list[float]:
    """Numbers of a part in their order, up to the last known one."""
    values = [getattr(part, slot.names[0]) for slot in slots(cast(Hashable, type(part)))]
    while values and values[-1] is None:
        values.pop()
    return [float(value) for value in values]


# -- text -------------------------------------------------------------------------------------------------------


def dumps(design: Design, folder: str | None = None) -> str:
    """Text of a design's file, with all digits of every number; folder: as in `to_table`."""
    import tomli_w

    table = to_table(design, folder)
    header = {
        name: value
        for name, value in table.items()
        if name in ("motion", "motions") or not (isinstance(value, Mapping) or _is_rows(value))
    }
    text = re.sub(
        rf"(?m)^(?: {{{_WIDE}}})+",
        lambda indent: " " * (4 * len(indent[0]) // _WIDE),
        tomli_w.dumps(header, indent=_WIDE),
    )
    text = re.sub(_NUMBERS, lambda row: f"[{', '.join(row[1].replace(',', ' ').split())}]", text)  # a row of a table
    return text + "".join(_sections(name, part) for name, part in table.items() if name not in header)


def dumps_table(part: Any) -> str:
    """Text of a file that is one part: its entries, then its lists of tables as `[[name]]`."""
    table = _table(part, "")
    header = [line for key, value in table.items() if not _is_rows(value) for line in _lines({key: value})]
    return "\n".join(header) + "\n" + "".join(_sections(key, rows) for key, rows in table.items() if _is_rows(rows))


def _sections(name: str, part: Any) -> str:
    """A table of the file, or a list of tables `[[name]]`, with their inner tables as `[name.key]`."""
    if not _is_rows(part):
        return _section(f"[{name}]", name, part)
    text = ""
    for row in part:
        inner = {key: value for key, value in row.items() if isinstance(value, Mapping)}
        text += _section(f"[[{name}]]", name, {key: value for key, value in row.items() if key not in inner})
        text += "".join(_section(f"[{name}.{key}]", f"{name}.{key}", table) for key, table in inner.items())
    return text


def _section(heading: str, name: str, table: Mapping[str, Any]) -> str:
    """The heading with its entries, one a line, then its lists of tables as `[[name.key]]`."""
    lines = ["", heading, *_lines({key: value for key, value in table.items() if not _is_rows(value)})]
    for key, rows in table.items():
        if _is_rows(rows):
            for row in rows:
                lines += ["", f"[[{name}.{key}]]", *_lines(row)]
    return "\n".join(lines) + "\n"


def _is_rows(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], dict)


def _lines(table: Mapping[str, Any]) -> list[str]:
    return [f"{_toml({key: 0}).removesuffix(' = 0')} = {_inline(value)}" for key, value in table.items()]


def _inline(value: Any) -> str:
    if isinstance(value, Mapping):
        inside = ", ".join(_lines(value))
        return f"{{ {inside} }}" if inside else "{}"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"[{', '.join(map(_inline, value))}]"
    return _toml({"v": value}).removeprefix("v = ")


def _toml(table: Mapping[str, Any]) -> str:
    import tomli_w

    return tomli_w.dumps(table).rstrip("\n")
