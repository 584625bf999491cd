"""Rows of a graph: curves, axes and titles without numbers, their changes and their files."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, field, fields, replace
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from core.bounds import bounded_json
from core.errors import KindynaError
from core.frozen import frozen
from core.measured.units import LONGEST, unit_in
from core.project.files import read_text, write
from core.units import split_unit, unit_symbol

# -- rows -------------------------------------------------------------------------------------------------------


AUTO, LEFT, RIGHT = "auto", "left", "right"
SIDES = (AUTO, LEFT, RIGHT)
DASHES: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {"solid": (), "dashed": (7.0, 4.0), "dotted": (1.5, 3.0), "dash-dot": (10.0, 3.0, 1.5, 3.0)}
)
"""Name of a stroke -> dashes and gaps [pixels]."""
ANGLES = "every 30°"
MARKS = ("none", "circle", "square", "triangle", "cross", "plus", ANGLES)
"""Marks on the points of a curve; with ``ANGLES``, labelled marks at every 30° of a design's turn."""
ALL, SHAFT = "(all)", "(shaft)"
"""Instead of a drive's name: a curve for every drive; quantities of the shaft."""
LEAST_WIDTH, MOST_WIDTH = 0.5, 6.0
MOST_ROWS = 200  # of a file; further rows are omitted


@frozen
class GraphCurve:
    """One curve.

    Attributes
    ----------
    key : name by which other rows refer to this one
    source : file of a table or a design; empty: the current design
    drive : name of a drive, ``ALL``, ``SHAFT``; empty: the selected drive
    x, y : columns by name, or by number from 1; empty: the angle or the first column, and the first one after it
    x_unit, y_unit : units on display; empty: those of the columns
    minus : key of a curve to subtract
    side : one of ``SIDES``; auto: curves of one kind share an axis, the first kind on the left
    name : name in the legend; empty: from source and column
    colour : #rrggbb; empty: by quantity
    width : [pixels]
    dash : key of ``DASHES``
    mark : one of ``MARKS``
    """

    key: str = ""
    source: str = ""
    drive: str = ""
    x: str = ""
    y: str = ""
    x_unit: str = ""
    y_unit: str = ""
    minus: str = ""
    side: str = AUTO
    name: str = ""
    colour: str = ""
    width: float = 1.0
    dash: str = "solid"
    mark: str = "none"
    shown: bool = True


@frozen
class GraphAxis:
    """An axis.

    Attributes
    ----------
    title : empty: from the curves
    low, high : range; None: from the curves
    """

    title: str = ""
    log: bool = False
    low: float | None = None
    high: float | None = None


@frozen
class Graph:
    """Curves in the order of drawing, with the axes at the bottom, on the left and on the right."""

    title: str = ""
    curves: tuple[GraphCurve, ...] = ()
    x: GraphAxis = field(default_factory=GraphAxis)
    left: GraphAxis = field(default_factory=GraphAxis)
    right: GraphAxis = field(default_factory=GraphAxis)

    def curve(self, key: str) -> GraphCurve | None:
        """The row of a key; None where it is removed."""
        return next((curve for curve in self.curves if curve.key == key), None)

    def number(self, key: str) -> int:
        """Index of the row of a key. Raises StopIteration."""
        return next(i for i, curve in enumerate(self.curves) if curve.key == key)


# -- changes of rows ----------------------------------------------------------------------------------------


def _free_key(graph: Graph) -> str:
    used = {curve.key for curve in graph.curves} | {curve.minus for curve in graph.curves}
    return next(f"c{i}" for i in range(1, len(graph.curves) + len(used) + 2) if f"c{i}" not in used)


def add_curve(graph: Graph, curve: GraphCurve, at: int | None = None) -> Graph:
    """The graph with one more row, which gets a new key; ``at``: its index, None: the last."""
    rows = list(graph.curves)
    rows.insert(len(rows) if at is None else at, replace(curve, key=_free_key(graph)))
    return replace(graph, curves=tuple(rows))


def copy_curve(graph: Graph, index: int) -> Graph:
    """The graph with a copy of a row behind it."""
    return add_curve(graph, graph.curves[index], index + 1)


def remove_curve(graph: Graph, index: int) -> Graph:
    """The graph without a row; rows that refer to it remain, and report it."""
    return replace(graph, curves=(*graph.curves[:index], *graph.curves[index + 1 :]))


def move_curve(graph: Graph, index: int, to: int) -> Graph:
    """The graph with a row at another index; later rows are drawn on top."""
    rows = list(graph.curves)
    rows.insert(to, rows.pop(index))
    return replace(graph, curves=tuple(rows))


def with_curve(graph: Graph, index: int, curve: GraphCurve) -> Graph:
    """The graph with a changed row. Raises KindynaError where a curve would be subtracted from itself."""
    rows = list(graph.curves)
    rows[index] = replace(curve, key=rows[index].key)
    result = replace(graph, curves=tuple(rows))
    require_no_cycle(result, rows[index].key)
    return result


def require_no_cycle(graph: Graph, key: str) -> None:
    """Raises KindynaError where a curve is subtracted from itself, directly or through others."""
    seen, curve = [key], graph.curve(key)
    while curve is not None and curve.minus:
        if curve.minus in seen:
            numbers = " - ".join(str(graph.number(name) + 1) for name in (*seen, curve.minus))
            raise KindynaError(f"minus leads back to itself (curves {numbers}); choose another curve")
        seen.append(curve.minus)
        curve = graph.curve(curve.minus)


# -- plain data -----------------------------------------------------------------------------------------------


def to_data(graph: Graph) -> dict[str, Any]:
    """Plain data for JSON, without values at their defaults."""
    axes: dict[str, Any] = {name: _shortened(getattr(graph, name)) for name in ("x", "left", "right")}
    return {"title": graph.title, **axes, "curves": [_shortened(curve) for curve in graph.curves]}


def _shortened(part: Any) -> dict[str, Any]:
    default = asdict(type(part)())
    return {name: value for name, value in asdict(part).items() if value != default[name]}


def from_data(data: Any) -> Graph:
    """The graph of plain data. Values of a wrong type are ignored: settings may be from an older or newer version."""
    if not isinstance(data, Mapping):
        return Graph()
    axes = {name: _part(GraphAxis, data.get(name)) for name in ("x", "left", "right")}
    rows = data.get("curves")
    curves: dict[str, GraphCurve] = {}
    for row in rows[:MOST_ROWS] if isinstance(rows, list | tuple) else ():
        curve = _part(GraphCurve, row)
        if curve.key:
            curves.setdefault(curve.key, curve)
    title = data.get("title", "")
    return Graph(title=title if isinstance(title, str) else "", curves=tuple(curves.values()), **axes)


def _is_finite(value: float) -> bool:
    return abs(value) < 1e300


_ALLOWED: Mapping[str, Callable[[Any], bool]] = MappingProxyType(
    {
        "side": SIDES.__contains__, "dash": DASHES.__contains__, "mark": MARKS.__contains__, "low": _is_finite, "high": _is_finite,
        "colour": lambda text: not text or is_colour(text), "width": lambda value: LEAST_WIDTH <= value <= MOST_WIDTH,
    }
)  # fmt: skip
"""Field of a row or an axis -> whether a value is allowed."""


def is_colour(text: str) -> bool:
    """Whether the text is ``#rrggbb``."""
    return re.fullmatch("#[0-9A-Fa-f]{6}", text) is not None


def _part(kind: Any, data: Any) -> Any:
    part = kind()
    for name in [entry.name for entry in fields(kind)] if isinstance(data, Mapping) else ():
        if name not in data:
            continue
        value, default = data[name], getattr(part, name)
        type_: Any = (int, float) if default is None or isinstance(default, float) else type(default)
        is_valid = isinstance(value, type_) and (type_ is bool or not isinstance(value, bool))
        if is_valid and (name not in _ALLOWED or value is None or _ALLOWED[name](value)):
            part = replace(part, **{name: value})
    return part


# -- files ------------------------------------------------------------------------------------------------------


ENDING = ".graph.json"


def with_absolute_paths(graph: Graph, folder: Path) -> Graph:
    """The graph with absolute paths instead of paths relative to a folder."""
    return replace(
        graph,
        curves=tuple(replace(c, source=str((folder / c.source).absolute()) if c.source else "") for c in graph.curves),
    )


def with_relative_paths(graph: Graph, folder: Path | None) -> Graph:
    """The graph with paths relative to a folder, for files inside it or next to it; others stay absolute."""

    def shorten(source: str) -> str:
        if not source or folder is None:
            return source
        try:
            text = os.path.relpath(source, folder)
        except ValueError:  # on another disk
            return source
        return source if text.startswith(os.path.join("..", "..")) else text

    return replace(graph, curves=tuple(replace(curve, source=shorten(curve.source)) for curve in graph.curves))


def save_setup(graph: Graph, path: Path) -> None:
    """Write the rows of a graph, without numbers. Raises FileError."""
    data = to_data(with_relative_paths(graph, path.absolute().parent))
    write(path, json.dumps(data, indent=1, ensure_ascii=False) + "\n")


def load_setup(path: Path) -> Graph:
    """Read the rows of a graph. Raises FileError, KindynaError where the file is none of a graph."""
    try:
        data = bounded_json(read_text(path))
    except ValueError:
        data = None
    if not isinstance(data, dict) or "curves" not in data:
        raise KindynaError(f"{path.name}: not a graph; allowed: a file saved by the graph page (*{ENDING})")
    return with_absolute_paths(from_data(data), path.absolute().parent)


# -- units from names of columns --------------------------------------------------------------------------------


_AT_END = re.compile(r"[\[(]([^\[(\])]*)[\])]$")


@lru_cache(maxsize=64)
def unit_of_column(name: str) -> str:
    """Unit at the end of a column's name; empty where there is none.

    As in tables of KINDYNA (``force_n``), in brackets, behind a comma, or as in measured tables. An unknown unit in brackets
    is returned unchanged.
    """
    name = name.strip()[-LONGEST:]
    inside = _AT_END.search(name)
    if inside:
        return unit_symbol(inside[1]) or inside[1].strip()
    if symbol := split_unit(name)[1].symbol:
        return symbol
    tail = re.split(r",\s*|_", name)
    return unit_symbol(unit_in(name)) or (unit_symbol(tail[-1]) if len(tail) > 1 else "")


def without_unit(name: str) -> str:
    """A column's name in words: ``contact_force_n`` -> ``contact force``."""
    text = _AT_END.sub("", name.strip()).rstrip()
    short, unit = split_unit(text)
    if not unit.symbol and unit_of_column(text):
        short = re.sub(r"(_|,\s*+)[^_,]*+$", "", text)
        words = short.rsplit(None, 1)  # "Hub mm", "Hub in mm"
        if short == text and len(words) == 2 and unit_symbol(words[1]):
            short = re.sub(r"\s+in$", "", words[0][-LONGEST:])
    return short.replace("_", " ").strip()
