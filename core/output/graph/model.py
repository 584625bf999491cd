"""What a graph is: curves as rows, axes, titles; and what can be done with the rows. It holds no numbers."""

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

# -- what a graph is --------------------------------------------------------------------------------------------


AUTO, LEFT, RIGHT = "auto", "left", "right"
SIDES = (AUTO, LEFT, RIGHT)
DASHES: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {"solid": (), "dashed": (7.0, 4.0), "dotted": (1.5, 3.0), "dash-dot": (10.0, 3.0, 1.5, 3.0)}
)
"""Name of a stroke -> dashes and gaps, pixels."""
ANGLES = "every 30°"
MARKS = ("none", "circle", "square", "triangle", "cross", "plus", ANGLES)
"""On the points of a curve, or, with their number beside them, where the angle of a design's turn is a multiple of 30°."""
ALL, WHOLE = "(all)", "(shaft)"
"""In place of a drive's name: each of them, a curve for each; and what the shaft has as a whole."""
LEAST_WIDTH, MOST_WIDTH = 0.5, 6.0
MOST_ROWS = 200  # of a file, before the rest is left out


@frozen
class GraphCurve:
    """One row.

    key      by which other rows name this one
    source   a table's or a design's file; empty: the design at hand
    drive    of a design of several: its name, ``ALL``, ``WHOLE``; empty: the one that is chosen
    x, y     columns by name, or by number from 1; empty: the angle, or the first column; and the first after it
    x_unit, y_unit   to be shown in; empty: that of the column
    minus    key of a curve that is subtracted
    side     one of ``SIDES``; auto: curves of one kind share an axis, the first on the left
    name     in the legend; empty: of source and column
    colour   #rrggbb; empty: by quantity
    width    pixels; dash: key of ``DASHES``; mark: one of ``MARKS``
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
    """An axis. title: empty: of what is drawn; low, high: its range, None: to the curves."""

    title: str = ""
    log: bool = False
    low: float | None = None
    high: float | None = None


@frozen
class Graph:
    """Curves in the order of drawing, with the axes along the bottom, on the left and on the right."""

    title: str = ""
    curves: tuple[GraphCurve, ...] = ()
    x: GraphAxis = field(default_factory=GraphAxis)
    left: GraphAxis = field(default_factory=GraphAxis)
    right: GraphAxis = field(default_factory=GraphAxis)

    def curve(self, key: str) -> GraphCurve | None:
        """The row of a key; None where it is gone."""
        return next((curve for curve in self.curves if curve.key == key), None)

    def number(self, key: str) -> int:
        """Its place in the list, from 0. Raises StopIteration."""
        return next(i for i, curve in enumerate(self.curves) if curve.key == key)


# -- rows ---------------------------------------------------------------------------------------------------


def _free_key(graph: Graph) -> str:
    taken = {curve.key for curve in graph.curves} | {curve.minus for curve in graph.curves}
    return next(f"c{i}" for i in range(1, len(graph.curves) + len(taken) + 2) if f"c{i}" not in taken)


def add_curve(graph: Graph, curve: GraphCurve, at: int | None = None) -> Graph:
    """One row more, with a key of its own; at: its place, None: the last."""
    rows = list(graph.curves)
    rows.insert(len(rows) if at is None else at, replace(curve, key=_free_key(graph)))
    return replace(graph, curves=tuple(rows))


def copy_curve(graph: Graph, index: int) -> Graph:
    """A row again, behind itself."""
    return add_curve(graph, graph.curves[index], index + 1)


def remove_curve(graph: Graph, index: int) -> Graph:
    """A row less; those that name it stay, and say so."""
    return replace(graph, curves=(*graph.curves[:index], *graph.curves[index + 1 :]))


def move_curve(graph: Graph, index: int, to: int) -> Graph:
    """A row to another place; what is drawn later lies above."""
    rows = list(graph.curves)
    rows.insert(to, rows.pop(index))
    return replace(graph, curves=tuple(rows))


def with_curve(graph: Graph, index: int, curve: GraphCurve) -> Graph:
    """A row changed. Raises KindynaError where it would be subtracted from itself, directly or by way of others."""
    rows = list(graph.curves)
    rows[index] = replace(curve, key=rows[index].key)
    made = replace(graph, curves=tuple(rows))
    require_no_ring(made, rows[index].key)
    return made


def require_no_ring(graph: Graph, key: str) -> None:
    """Raises KindynaError where a curve is subtracted from itself, directly or by way of others."""
    seen, at = [key], graph.curve(key)
    while at is not None and at.minus:
        if at.minus in seen:
            numbers = " - ".join(str(graph.number(each) + 1) for each in (*seen, at.minus))
            raise KindynaError(f"minus leads back to itself (curves {numbers}); choose another curve")
        seen.append(at.minus)
        at = graph.curve(at.minus)


# -- as text ------------------------------------------------------------------------------------------------


def to_data(graph: Graph) -> dict[str, Any]:
    """Plain data, for JSON; what is at its default is left out."""
    made: dict[str, Any] = {name: _shortened(getattr(graph, name)) for name in ("x", "left", "right")}
    return {"title": graph.title, **made, "curves": [_shortened(curve) for curve in graph.curves]}


def _shortened(part: Any) -> dict[str, Any]:
    usual = asdict(type(part)())
    return {name: value for name, value in asdict(part).items() if value != usual[name]}


def from_data(data: Any) -> Graph:
    """The graph of such data. What is of another kind than it should be is left out: a file of settings may be older, or newer."""
    if not isinstance(data, Mapping):
        return Graph()
    axes = {name: _part(GraphAxis, data.get(name)) for name in ("x", "left", "right")}
    rows = data.get("curves")
    curves: dict[str, GraphCurve] = {}
    for row in rows[:MOST_ROWS] if isinstance(rows, list | tuple) else ():
        curve = _part(GraphCurve, row)
        if curve.key:
            curves.setdefault(curve.key, curve)
    return Graph(title=_title(data), curves=tuple(curves.values()), **axes)


def _title(data: Mapping[str, Any]) -> str:
    title = data.get("title", "")
    return title if isinstance(title, str) else ""


def _is_finite(value: float) -> bool:
    return abs(value) < 1e300


_ALLOWED: Mapping[str, Callable[[Any], bool]] = MappingProxyType(
    {
        "side": SIDES.__contains__, "dash": DASHES.__contains__, "mark": MARKS.__contains__, "low": _is_finite, "high": _is_finite,
        "colour": lambda text: not text or is_colour(text), "width": lambda value: LEAST_WIDTH <= value <= MOST_WIDTH,
    }
)  # fmt: skip
"""Field of a row or an axis -> what it may be."""


def is_colour(text: str) -> bool:
    """Whether it is ``#rrggbb``."""
    return re.fullmatch("#[0-9A-Fa-f]{6}", text) is not None


def _part(kind: Any, data: Any) -> Any:
    made = kind()
    for each in fields(kind):
        if not isinstance(data, Mapping) or each.name not in data:
            continue
        value, usual = data[each.name], getattr(made, each.name)
        wanted: Any = (int, float) if usual is None or isinstance(usual, float) else type(usual)
        fits = isinstance(value, wanted) and (wanted is bool or not isinstance(value, bool))
        if fits and (each.name not in _ALLOWED or value is None or _ALLOWED[each.name](value)):
            made = replace(made, **{each.name: value})
    return made


# -- A graph as a file ------------------------------------------------------------------------------------------


ENDING = ".graph.json"


def rooted(graph: Graph, folder: Path) -> Graph:
    """The same with paths from the root, of paths from a folder."""
    return replace(
        graph,
        curves=tuple(replace(c, source=str((folder / c.source).absolute()) if c.source else "") for c in graph.curves),
    )


def relative(graph: Graph, folder: Path | None) -> Graph:
    """The same with paths from a folder, where the files are inside it or beside it; those farther off stay whole."""

    def short(source: str) -> str:
        if not source or folder is None:
            return source
        try:
            text = os.path.relpath(source, folder)
        except ValueError:  # on another disk
            return source
        return source if text.startswith(os.path.join("..", "..")) else text

    return replace(graph, curves=tuple(replace(curve, source=short(curve.source)) for curve in graph.curves))


def save_setup(graph: Graph, path: Path) -> None:
    """Write the rows of a graph, not their numbers. Raises FileError."""
    data = to_data(relative(graph, path.absolute().parent))
    write(path, json.dumps(data, indent=1, ensure_ascii=False) + "\n")


def load_setup(path: Path) -> Graph:
    """Read them. Raises FileError, KindynaError where it is no such file."""
    try:
        data = bounded_json(read_text(path))
    except ValueError:
        data = None
    if not isinstance(data, dict) or "curves" not in data:
        raise KindynaError(f"{path.name}: no graph; wanted: a file that the graph page saved (*{ENDING})")
    return rooted(from_data(data), path.absolute().parent)


# -- units of the columns of a graph by the columns' names ------------------------------------------------------


_AT_END = re.compile(r"[\[(]([^\[(\])]*)[\])]$")


@lru_cache(maxsize=64)
def unit_of_column(name: str) -> str:
    """The unit that a column's name ends in: as in our own tables (``force_n``), in brackets, behind a comma, or as measured
    tables have it; what stands in brackets and is no known unit is taken as it is; empty where there is none."""
    name = name.strip()[-LONGEST:]
    inside = _AT_END.search(name)
    if inside:
        return unit_symbol(inside[1]) or inside[1].strip()
    own = split_unit(name)[1].symbol
    if own:
        return own
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
