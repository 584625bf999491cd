"""A design as the tables and the text of its file: keys in the order of the contract, a linkage's points, driver and branch
on one line each."""

from __future__ import annotations

import os
import re
from collections.abc import Hashable, Mapping, Sequence
from typing import Any, cast

from core.design import (
    NO_LIMITS,
    Design,
    Drive,
    LinkageLoads,
    Motion,
    Segment,
    SlideLoads,
    TurnLoads,
    all_paths,
)
from core.design.design import MOTIONS
from core.design.edits import is_dwell
from core.design.fields import FileEntry, Info, slots
from core.design.paths import in_order
from core.project.reading import FORMAT

_SILENT = (
    repr(LinkageLoads()),
    repr(NO_LIMITS),
    repr(SlideLoads()),
    repr(TurnLoads()),
)  # tables that say nothing; as text, which tells 0.0 from -0.0
_NUMBERS = r"\[\n\s*((?:[-+\w.]+,\s*)+)\]"
_WIDE = 100  # an indent beyond tomli_w's longest line: then it gives every segment its own [[motion.segments]]


def to_table(design: Design, folder: str | None = None) -> dict[str, Any]:
    """The tables of the file; [limits], and of a linkage [loads], only where there is something to say. folder: in which it shall be;
    without one the names of other files are whole."""
    table: dict[str, Any] = {"format": FORMAT, "name": design.name}
    if design.assumed:
        table["assumed"] = list(design.assumed)
    if not design.listed:
        return table | _tables(design.tables, design.drive, folder) | _as_made(design)
    table["shaft"] = _table(design.shaft, "")
    table["drives"] = [_table(drive, "") | _tables(drive.tables, drive, folder) for drive in design.drives]
    if design.timing:
        table["timing"] = [_table(row, "") for row in design.timing]
    if design.balancer is not None:
        table["balancer"] = _table(design.balancer, "")
    return table | _as_made(design)


def _as_made(design: Design) -> dict[str, Any]:
    """Tolerances, of fields that are still there, and waviness."""
    paths = set(all_paths(design)) if design.tolerances else set()
    rows = [_table(row, "") for row in design.tolerances if row.field in paths]
    waves = {} if design.waviness is None else {"waviness": _table(design.waviness, "")}
    return ({"tolerances": rows} if rows else {}) | waves


def _tables(tables: Mapping[str, Any], drive: Drive, folder: str | None) -> dict[str, Any]:
    made = {
        name: _following(part, folder)
        if name == "motion" and part.follows
        else _table(part, getattr(part, "unit", drive.motion_unit))
        for name, part in tables.items()
        if repr(part) not in _SILENT
    }
    if "follower" in made:
        made["follower"] = {"kind": drive.kind, **made["follower"]}
    if drive.motions:
        made["motions"] = {each.name: made.pop(f"{MOTIONS}{each.name}") for each in drive.motions}
    return made


def _following(motion: Motion, folder: str | None) -> dict[str, Any]:
    """A motion that follows from files: their names as typed where the design stays in its folder, else as seen from there; and what is
    asked of an inverse's output."""
    assert motion.follows is not None
    follows, asked = motion.follows, motion.follows.asked
    table = _table(follows.origin, "") | ({} if asked is None else _table(asked, asked.unit))
    stays = folder is not None and os.path.realpath(folder) == os.path.realpath(follows.folder)

    def seen(name: str) -> str:
        if stays or os.path.isabs(name):
            return name
        whole = os.path.join(follows.folder, name)
        return os.path.normpath(whole) if folder is None else os.path.relpath(whole, folder)

    for key, name in (("from", "table"), ("inverse", "linkage")):
        if key in table:
            table[key] |= {name: seen(table[key][name])}
    return table | ({"sum": [seen(name) for name in follows.origin.sum]} if follows.origin.sum else {})


def _table(part: Any, unit: str) -> dict[str, Any]:
    """A part's entries as keys, those of parts that stand in its table among them; what is None, and lists without rows, are
    left out."""
    table: dict[str, Any] = {}
    for slot in in_order(part, unit):
        holder = getattr(part, slot.within) if slot.within else part
        if not _left_out(part, holder, slot):
            entry = _entry(holder, slot, unit)
            table |= entry if slot.placing.spread else {slot.key: entry}
    return table


def _left_out(part: Any, holder: Any, slot: FileEntry) -> bool:
    values = [getattr(holder, name) for name in slot.names or (slot.key,)]
    if isinstance(part, Segment) and holder is part:
        return slot.names == ("rise",) and is_dwell(part) and str(part.rise) == "0.0"
    value = values[0] if len(values) == 1 else values
    empty = all(each is None for each in values) or (
        isinstance(value, tuple) and not value and slot.missing is None
    )  # of numpy a number is like no tuple; the frame of a drawing may hold nothing yet
    return empty or (slot.brief and value == slot.default)


def _entry(part: Any, slot: FileEntry, unit: str) -> Any:
    """The value of one entry as the file has it."""
    if not slot.names:
        return getattr(part, slot.key)
    if len(slot.names) > 1:
        return [_number(getattr(part, name), info) for name, info in zip(slot.names, slot.infos, strict=True)]
    value, placing = getattr(part, slot.names[0]), slot.placing
    if placing.key:
        name, only = slots(placing.kind)
        return {getattr(row, name.key): _entry(row, only, unit) for row in value}
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
    """The numbers of a part in their order, up to the last one that is known."""
    values = [getattr(part, slot.names[0]) for slot in slots(cast(Hashable, type(part)))]
    while values and values[-1] is None:
        values.pop()
    return [float(value) for value in values]


# -- as text ----------------------------------------------------------------------------------------------


def dumps(design: Design, folder: str | None = None) -> str:
    """The file's text, every number with all its digits; folder: as ``to_table`` has it."""
    import tomli_w

    table = to_table(design, folder)
    head = {
        name: value
        for name, value in table.items()
        if name in ("motion", "motions") or not (isinstance(value, Mapping) or _is_rows(value))
    }
    text = re.sub(
        rf"(?m)^(?: {{{_WIDE}}})+",
        lambda indent: " " * (4 * len(indent[0]) // _WIDE),
        tomli_w.dumps(head, indent=_WIDE),
    )
    text = re.sub(_NUMBERS, lambda row: f"[{', '.join(row[1].replace(',', ' ').split())}]", text)  # a row of a table
    return text + "".join(_sections(name, part) for name, part in table.items() if name not in head)


def dumps_table(part: Any) -> str:
    """The text of a file that is one part: its own entries, then its lists of tables as ``[[name]]``."""
    table = _table(part, "")
    head = [line for key, each in table.items() if not _is_rows(each) for line in _lines({key: each})]
    return "\n".join(head) + "\n" + "".join(_sections(key, each) for key, each in table.items() if _is_rows(each))


def _sections(name: str, part: Any) -> str:
    """A table of the file, or a list of them: ``[[name]]``, each with its own as ``[name.key]``."""
    if not _is_rows(part):
        return _section(f"[{name}]", name, part)
    text = ""
    for row in part:
        inner = {key: each for key, each in row.items() if isinstance(each, Mapping)}
        text += _section(f"[[{name}]]", name, {key: each for key, each in row.items() if key not in inner})
        text += "".join(_section(f"[{name}.{key}]", f"{name}.{key}", each) for key, each in inner.items())
    return text


def _section(heading: str, name: str, table: Mapping[str, Any]) -> str:
    """The heading with its entries on one line each, then its lists of tables as ``[[name.key]]``."""
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
        return f"[{', '.join(_inline(each) for each in value)}]"
    return _toml({"v": value}).removeprefix("v = ")


def _toml(table: Mapping[str, Any]) -> str:
    import tomli_w

    return tomli_w.dumps(table).rstrip("\n")
