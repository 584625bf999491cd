"""The command ``graph``: curves of tables and designs in one picture, or as numbers, and what is read off them."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from core.bounds import number_from_one
from core.commands import DONE, DONE_WITH_ERRORS, NOTHING_DONE, Painter
from core.commands.common import as_json, ending_with, picture_size
from core.design.fields import Info, flag, number
from core.errors import KindynaError
from core.frozen import frozen
from core.output.graph import (
    DASHES,
    LEAST_WIDTH,
    MARKS,
    MOST_WIDTH,
    SIDES,
    DesignSource,
    Graph,
    GraphAxis,
    GraphCurve,
    GraphData,
    Source,
    add_curve,
    graph_data,
    is_colour,
    numbers_csv,
    point_at,
    point_distance,
    read_source,
    ready_graphs,
)
from core.output.graph.curves import DEFAULT_SIZE, ENDINGS, LEAST_SIDE, MOST_SIDE, GraphImage
from core.output.graph.model import load_setup
from core.output.lines import printable
from core.output.summary import to_json
from core.project.files import write
from core.requests import number_reader, option, text_option
from core.units import NO_UNIT, unit_symbol

FILES = (*ENDINGS, ".csv")
MOST_CURVES = 200  # that nobody named: no picture tells more of them apart
_CURVE = (
    "a curve: Y, or KEY=VALUE,KEY=VALUE of y x (columns, by name or by number from 1), file (number from 1), drive ((all): a curve for "
    "each), y-unit x-unit, minus (number of a curve, from 1), axis (auto left right), name, colour (#rrggbb), width, dash "
    f"({' '.join(DASHES)}), mark ({' '.join(MARKS)}); repeat it (without: of tables all columns, {MOST_CURVES} at most, of designs "
    "the first channel)"
)


def _fail(text: str, what: str) -> argparse.ArgumentTypeError:
    return argparse.ArgumentTypeError(f"{text!r}: {what}")


def _one_of(allowed: Sequence[str]) -> Callable[[str], str]:
    def read(text: str) -> str:
        if text not in allowed:
            raise _fail(text, f"allowed: {' '.join(allowed)}")
        return text

    return read


def _unit(text: str) -> str:
    return unit_symbol(text) or text


def _colour(text: str) -> str:
    if not is_colour(text):
        raise _fail(text, "colour; allowed: #rrggbb, such as #D55E00")
    return text


_KEYS: Mapping[str, tuple[str, Callable[[str], Any]]] = MappingProxyType(
    {
        "y": ("y", str), "x": ("x", str), "file": ("source", str), "drive": ("drive", str), "y-unit": ("y_unit", _unit),
        "unit": ("y_unit", _unit), "x-unit": ("x_unit", _unit), "minus": ("minus", str), "axis": ("side", _one_of(SIDES)),
        "name": ("name", str), "colour": ("colour", _colour), "dash": ("dash", _one_of(tuple(DASHES))), "mark": ("mark", _one_of(MARKS)),
        "width": ("width", number_reader(Info("Width of a line", low=LEAST_WIDTH, high=MOST_WIDTH), NO_UNIT)),
    }
)  # fmt: skip
"""Key of a curve on the command line -> field of its row, and what reads it."""


def curve(text: str) -> GraphCurve:
    """``y=force_n,x=angle_deg,file=2,axis=right``; ``minus`` and ``file`` still by number."""
    made = GraphCurve()
    for i, part in enumerate(text.split(",")):
        key, mark, value = part.partition("=")
        key, value = ("y", part) if not mark and i == 0 else (key.strip(), value)
        if key not in _KEYS or not (mark or i == 0) or not value:
            raise _fail(text, f"{part!r} is no KEY=VALUE of a curve; keys: {' '.join(_KEYS)}")
        name, read = _KEYS[key]
        made = replace(made, **{name: read(value.strip())})
    return made


Ends = tuple[float | None, float | None]


def span(text: str) -> Ends:
    """``LOW:HIGH``, either empty."""
    low, mark, high = text.partition(":")
    try:
        ends = tuple(float(end) if end.strip() else None for end in (low, high))
    except ValueError:
        ends = (math.nan, math.nan)
    finite = all(end is None or math.isfinite(end) for end in ends)
    if not mark or not finite or (ends[0] is not None and ends[1] is not None and ends[0] >= ends[1]):
        raise _fail(
            text, "range of an axis; allowed: LOW:HIGH, such as 0:90 or :5 (with = before a minus: --x-range=-1:1)"
        )
    return ends[0], ends[1]


def _axis_title(axis: str) -> Any:
    return text_option(f"of the {axis}", default=None, metavar="TEXT")


def _axis_range(axis: str) -> Any:
    return text_option(f"of the {axis}", default=None, type=span, metavar="LOW:HIGH")


def _axis_log(axis: str) -> Any:
    return flag("In powers of ten", help=f"{axis} in powers of ten")


@frozen(kw_only=True)
class GraphArguments:
    """Which curves of which files, on which axes, and what is read off them."""

    files: tuple[Path, ...] = text_option(
        "tables (.csv, text) and designs (.toml)", "FILE", default=(), type=Path, nargs="*"
    )
    setup: Path | None = text_option(
        "a graph that the window saved, with its files", default=None, type=Path, metavar="JSON"
    )
    curve: tuple[GraphCurve, ...] = text_option(_CURVE, default=(), action="append", type=curve, metavar="SPEC")
    ready: str | None = text_option(
        "a graph that is ready: path, speed (of what several drives carry); path:POINT, height:POINT (of a point of a linkage)",
        default=None,
        metavar="NAME",
    )
    out: tuple[Path, ...] = text_option(
        f"file to write: {', '.join(FILES)}; repeat it",
        default=(),
        action="append",
        type=ending_with("a graph", *FILES),
        metavar="NAME",
    )
    title: str | None = text_option("of the graph", default=None, metavar="TEXT")
    x_title: str | None = _axis_title("axis along the bottom")
    x_range: Ends | None = _axis_range("axis along the bottom")
    x_log: bool = _axis_log("axis along the bottom")
    left_title: str | None = _axis_title("left axis")
    left_range: Ends | None = _axis_range("left axis")
    left_log: bool = _axis_log("left axis")
    right_title: str | None = _axis_title("right axis")
    right_range: Ends | None = _axis_range("right axis")
    right_log: bool = _axis_log("right axis")
    size: tuple[int, int] = text_option(
        "of the picture",
        default=DEFAULT_SIZE,
        default_text=f"{DEFAULT_SIZE[0]}x{DEFAULT_SIZE[1]}",
        type=picture_size(LEAST_SIDE, MOST_SIDE),
        metavar="WxH",
    )
    at: float | None = option(number("X of a point", default=None, help="print every curve's value there"), metavar="X")
    to: float | None = option(
        number("X of a second point", default=None, help="and there, with Δx, Δy and slope"), metavar="X"
    )
    json: bool = as_json()


def run_graph(arguments: GraphArguments, painter: Painter | None) -> int:
    """Write the files, print what is read off; 1 where a curve could not be drawn and others could."""
    if not arguments.files and arguments.setup is None:
        raise KindynaError("graph: no file; name a table, a design, or a graph that was saved with --setup")
    if arguments.to is not None and arguments.at is None:
        raise KindynaError("--to: a second point wants a first one; give it with --at")
    sources: dict[str, Source] = {}

    def source_of(name: str) -> Source:
        if name not in sources:
            sources[name] = read_source(Path(name) if name else arguments.files[0])
        return sources[name]

    graph = _graph(arguments, source_of)
    found = graph_data(graph, source_of)
    for line in _lines_wrong(graph, found):
        print(printable(line), file=sys.stderr)
    if not found.series:
        if not found.faults:
            raise KindynaError(
                f"{arguments.setup.name if arguments.setup else arguments.files[0].name}: has no curve that is shown"
            )
        return NOTHING_DONE
    made = {path: _content(path, graph, found, arguments.size, painter) for path in arguments.out}
    for path, content in made.items():
        write(path, content)
        if not arguments.json:
            print(path)
    data = _data(found, arguments.at, arguments.to)
    print(
        to_json(data) if arguments.json else "\n".join(_readings(data)),
        end="" if arguments.json or arguments.at is None else "\n",
    )
    return DONE_WITH_ERRORS if found.faults else DONE


def _graph(arguments: GraphArguments, source_of: Callable[[str], Source]) -> Graph:
    """The rows of the setup, then those of the command line; without any of them all columns."""
    graph = load_setup(arguments.setup) if arguments.setup is not None else Graph()
    if arguments.ready is not None:
        graph = _ready(arguments, source_of)
    begin, names = len(graph.curves), [str(path) for path in arguments.files]
    if arguments.setup is not None and any(not each.source for each in graph.curves) and not names:
        raise KindynaError(f"{arguments.setup.name}: has curves of a design at hand; name the design's file")
    rows = arguments.curve or ([] if begin else [row for name in names for row in _usual(name, source_of(name))])
    if len(rows) > MOST_CURVES and not arguments.curve:
        raise KindynaError(
            f"{len(rows)} curves are too many for one graph; allowed: {MOST_CURVES}; choose some with --curve"
        )
    for each in rows:
        graph = add_curve(graph, replace(each, source=_file(each.source, names), minus=""))
    for i, each in enumerate(rows):
        if each.minus:
            if not (row := number_from_one(each.minus, len(graph.curves))):
                raise KindynaError(f"minus={each.minus}: number of a curve; allowed: 1 ... {len(graph.curves)}")
            at = begin + i
            changed = replace(graph.curves[at], minus=graph.curves[row - 1].key)
            graph = replace(graph, curves=(*graph.curves[:at], changed, *graph.curves[at + 1 :]))
    x, left, right = (_scale(getattr(graph, side), arguments, side) for side in ("x", "left", "right"))
    return replace(
        graph, title=graph.title if arguments.title is None else arguments.title, x=x, left=left, right=right
    )


def _ready(arguments: GraphArguments, source_of: Callable[[str], Source]) -> Graph:
    """The graph of that name, of the first file."""
    if arguments.setup is not None:
        raise KindynaError("--ready: not together with --setup")
    source = source_of("")
    there = ready_graphs(source) if isinstance(source, DesignSource) else ()
    for each in there:
        if each.name == arguments.ready:
            return each.graph
    names = (
        ", ".join(each.name for each in there)
        or "none; several drives, and linkages with points beside their joints, have some"
    )
    raise KindynaError(f"--ready {arguments.ready}: {source.name} has no such graph; allowed: {names}")


def _usual(name: str, source: Source) -> list[GraphCurve]:
    """Of a table every column but the first; of a design the first channel, of each drive."""
    part = source.parts("")[0]
    if not name.lower().endswith(".toml"):
        return [GraphCurve(source=name, y=each.name) for each in source.headings(part)[1:]]
    return [GraphCurve(source=name, drive=part)]


def _file(source: str, names: Sequence[str]) -> str:
    if not source and names:
        return names[0]
    if file := number_from_one(source, len(names)):
        return names[file - 1]
    if source in names:
        return source
    raise KindynaError(f"file={source}: number of a file; allowed: 1 ... {len(names)}")


def _scale(scale: GraphAxis, arguments: GraphArguments, side: str) -> GraphAxis:
    title, ends, log = (getattr(arguments, f"{side}_{what}") for what in ("title", "range", "log"))
    low, high = ends if ends is not None else (scale.low, scale.high)
    return replace(scale, title=scale.title if title is None else title, low=low, high=high, log=scale.log or log)


def _lines_wrong(graph: Graph, found: GraphData) -> list[str]:
    faults = [f"curve {graph.number(key) + 1}: {text}" for key, text in found.faults.items()]
    return [*dict.fromkeys(note for notes in found.notes.values() for note in notes), *faults]


def _content(path: Path, graph: Graph, found: GraphData, size: tuple[int, int], painter: Painter | None) -> bytes | str:
    ending = path.suffix.lower()
    if ending == ".csv":
        return numbers_csv(found)
    if painter is None:
        raise KindynaError(f"{path.name}: pictures need kindyna --headless; a table (.csv) does not")
    (data,) = painter(GraphImage(graph, found, ending, *size, name=graph.title or path.stem)).values()
    return data


def _data(found: GraphData, at: float | None, to: float | None) -> dict[str, Any]:
    rows = []
    for i, each in enumerate(found.series):
        row: dict[str, Any] = {"name": each.name, "unit": each.y_unit, "points": each.x.size}
        if at is not None:
            first = point_at(found, i, at)
            row |= {"x": first.x, "y": first.y}
            if to is not None:
                second = point_at(found, i, to)
                apart = point_distance(found, first, second)
                row |= {
                    "to_x": second.x,
                    "to_y": second.y,
                    "delta_x": apart.x,
                    "delta_y": apart.y,
                    "slope": apart.slope,
                }
        rows.append(row)
    return {"x_unit": found.x_unit, "curves": rows}


def _readings(data: Mapping[str, Any]) -> list[str]:
    lines, across = [], data["x_unit"]
    for row in data["curves"]:
        if "x" in row:
            unit = row["unit"]
            line = f"{printable(row['name'])}: {_value_text(row['y'], unit)} at {_value_text(row['x'], across)}"
            if "to_x" in row:
                line += f", {_value_text(row['to_y'], unit)} at {_value_text(row['to_x'], across)}"
                line += f"; Δx {row['delta_x']:.9g}, Δy {_value_text(row['delta_y'])}"
                line += f", slope {_value_text(row['slope'])}"
            lines.append(line)
    return lines


def _value_text(value: float, unit: str = "") -> str:
    return f"{value:.9g} {unit}".strip() if math.isfinite(value) else "no value"
