"""The command ``graph``: curves of tables and designs as a picture or as numbers, and their values."""

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
from core.number_text import result_text
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
MOST_CURVES = 200  # without --curve: more cannot be distinguished
_CURVE = (
    "a curve: Y, or KEY=VALUE,KEY=VALUE of y x (columns, by name or by number from 1), file (number from 1), drive ((all): a curve for "
    "every drive), y-unit x-unit, minus (number of a curve, from 1), axis (auto left right), name, colour (#rrggbb), width, dash "
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
"""Key of a curve on the command line -> field of its row, and reader of the value."""


def curve(text: str) -> GraphCurve:
    """Read a curve, as ``y=force_n,x=angle_deg,file=2,axis=right``; ``minus`` and ``file`` are numbers."""
    row = GraphCurve()
    for i, part in enumerate(text.split(",")):
        key, mark, value = part.partition("=")
        key, value = ("y", part) if not mark and i == 0 else (key.strip(), value)
        if key not in _KEYS or not (mark or i == 0) or not value:
            raise _fail(text, f"{part!r} is not KEY=VALUE; keys of a curve: {' '.join(_KEYS)}")
        name, read = _KEYS[key]
        row = replace(row, **{name: read(value.strip())})
    return row


Ends = tuple[float | None, float | None]


def span(text: str) -> Ends:
    """Read a range ``LOW:HIGH``; either end may be empty."""
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
    return text_option(f"title of the {axis}", default=None, metavar="TEXT")


def _axis_range(axis: str) -> Any:
    return text_option(f"range of the {axis}", default=None, type=span, metavar="LOW:HIGH")


def _axis_log(axis: str) -> Any:
    return flag("Logarithmic", help=f"logarithmic scale of the {axis}")


@frozen(kw_only=True)
class GraphArguments:
    """Arguments of ``graph``: files, curves, axes, and points at which values are printed."""

    files: tuple[Path, ...] = text_option(
        "tables (.csv, text) and designs (.toml)", "FILE", default=(), type=Path, nargs="*"
    )
    setup: Path | None = text_option(
        "a graph that the window saved, with its files", default=None, type=Path, metavar="JSON"
    )
    curve: tuple[GraphCurve, ...] = text_option(_CURVE, default=(), action="append", type=curve, metavar="SPEC")
    ready: str | None = text_option(
        "a ready graph: path, speed (of a part that several drives move); path:POINT, height:POINT (of a point of a linkage)",
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
    title: str | None = text_option("title of the graph", default=None, metavar="TEXT")
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
        "size of the picture",
        default=DEFAULT_SIZE,
        default_text=f"{DEFAULT_SIZE[0]}x{DEFAULT_SIZE[1]}",
        type=picture_size(LEAST_SIDE, MOST_SIDE),
        metavar="WxH",
    )
    at: float | None = option(
        number("X of a point", default=None, help="print the value of every curve there"), metavar="X"
    )
    to: float | None = option(
        number(
            "X of a second point", default=None, help="print also the values there, with Δx, Δy and slope from --at"
        ),
        metavar="X",
    )
    json: bool = as_json()


def run_graph(arguments: GraphArguments, painter: Painter | None) -> int:
    """Write the files and print values; exit code 1 where some curves have no values."""
    if not arguments.files and arguments.setup is None:
        raise KindynaError("graph: no file; give a table, a design, or a saved graph with --setup")
    if arguments.to is not None and arguments.at is None:
        raise KindynaError("--to: a second point needs a first one; give it with --at")
    sources: dict[str, Source] = {}

    def source_of(name: str) -> Source:
        if name not in sources:
            sources[name] = read_source(Path(name) if name else arguments.files[0])
        return sources[name]

    graph = _graph(arguments, source_of)
    data_set = graph_data(graph, source_of)
    for line in _fault_lines(graph, data_set):
        print(printable(line), file=sys.stderr)
    if not data_set.series:
        if not data_set.faults:
            raise KindynaError(
                f"{arguments.setup.name if arguments.setup else arguments.files[0].name}: has no curve that is shown"
            )
        return NOTHING_DONE
    contents = {path: _content(path, graph, data_set, arguments.size, painter) for path in arguments.out}
    for path, content in contents.items():
        write(path, content)
        if not arguments.json:
            print(path)
    data = _data(data_set, arguments.at, arguments.to)
    print(
        to_json(data) if arguments.json else "\n".join(_readings(data)),
        end="" if arguments.json or arguments.at is None else "\n",
    )
    return DONE_WITH_ERRORS if data_set.faults else DONE


def _graph(arguments: GraphArguments, source_of: Callable[[str], Source]) -> Graph:
    """Curves of the setup, then those of the command line; without both all columns."""
    graph = load_setup(arguments.setup) if arguments.setup is not None else Graph()
    if arguments.ready is not None:
        graph = _ready(arguments, source_of)
    begin, names = len(graph.curves), [str(path) for path in arguments.files]
    if arguments.setup is not None and any(not row.source for row in graph.curves) and not names:
        raise KindynaError(f"{arguments.setup.name}: has curves of the current design; give the file of a design")
    rows = arguments.curve or (
        [] if begin else [row for name in names for row in _default_curves(name, source_of(name))]
    )
    if len(rows) > MOST_CURVES and not arguments.curve:
        raise KindynaError(
            f"{len(rows)} curves are too many for one graph; allowed: {MOST_CURVES}; choose some with --curve"
        )
    for row in rows:
        graph = add_curve(graph, replace(row, source=_file(row.source, names), minus=""))
    for i, row in enumerate(rows):
        if row.minus:
            if not (number := number_from_one(row.minus, len(graph.curves))):
                raise KindynaError(f"minus={row.minus}: number of a curve; allowed: 1 ... {len(graph.curves)}")
            at = begin + i
            changed = replace(graph.curves[at], minus=graph.curves[number - 1].key)
            graph = replace(graph, curves=(*graph.curves[:at], changed, *graph.curves[at + 1 :]))
    x, left, right = (_scale(getattr(graph, side), arguments, side) for side in ("x", "left", "right"))
    return replace(
        graph, title=graph.title if arguments.title is None else arguments.title, x=x, left=left, right=right
    )


def _ready(arguments: GraphArguments, source_of: Callable[[str], Source]) -> Graph:
    """The ready graph of this name, of the first file."""
    if arguments.setup is not None:
        raise KindynaError("--ready: cannot be combined with --setup")
    source = source_of("")
    available = ready_graphs(source) if isinstance(source, DesignSource) else ()
    for row in available:
        if row.name == arguments.ready:
            return row.graph
    names = (
        ", ".join(row.name for row in available)
        or "none; designs with several drives, and linkages with points besides their joints, have some"
    )
    raise KindynaError(f"--ready {arguments.ready}: {source.name} has no such graph; allowed: {names}")


def _default_curves(name: str, source: Source) -> list[GraphCurve]:
    """All columns of a table but the first; the first quantity of a design, for every drive."""
    part = source.parts("")[0]
    if not name.lower().endswith(".toml"):
        return [GraphCurve(source=name, y=heading.name) for heading in source.headings(part)[1:]]
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
    title, ends, log = (getattr(arguments, f"{side}_{field}") for field in ("title", "range", "log"))
    low, high = ends if ends is not None else (scale.low, scale.high)
    return replace(scale, title=scale.title if title is None else title, low=low, high=high, log=scale.log or log)


def _fault_lines(graph: Graph, data_set: GraphData) -> list[str]:
    faults = [f"curve {graph.number(key) + 1}: {text}" for key, text in data_set.faults.items()]
    return [*dict.fromkeys(note for notes in data_set.notes.values() for note in notes), *faults]


def _content(
    path: Path, graph: Graph, data_set: GraphData, size: tuple[int, int], painter: Painter | None
) -> bytes | str:
    ending = path.suffix.lower()
    if ending == ".csv":
        return numbers_csv(data_set)
    if painter is None:
        raise KindynaError(f"{path.name}: pictures need kindyna --headless; a table (.csv) does not")
    (data,) = painter(GraphImage(graph, data_set, ending, *size, name=graph.title or path.stem)).values()
    return data


def _data(data_set: GraphData, at: float | None, to: float | None) -> dict[str, Any]:
    rows = []
    for i, series in enumerate(data_set.series):
        row: dict[str, Any] = {"name": series.name, "unit": series.y_unit, "points": series.x.size}
        if at is not None:
            first = point_at(data_set, i, at)
            row |= {"x": first.x, "y": first.y}
            if to is not None:
                second = point_at(data_set, i, to)
                difference = point_distance(data_set, first, second)
                row |= {
                    "to_x": second.x,
                    "to_y": second.y,
                    "delta_x": difference.x,
                    "delta_y": difference.y,
                    "slope": difference.slope,
                }
        rows.append(row)
    return {"x_unit": data_set.x_unit, "curves": rows}


def _readings(data: Mapping[str, Any]) -> list[str]:
    lines, across = [], data["x_unit"]
    for row in data["curves"]:
        if "x" in row:
            unit = row["unit"]
            line = f"{printable(row['name'])}: {_value_text(row['y'], unit)} at {_value_text(row['x'], across)}"
            if "to_x" in row:
                line += f", {_value_text(row['to_y'], unit)} at {_value_text(row['to_x'], across)}"
                line += f"; Δx {result_text(row['delta_x'], 6)}, Δy {_value_text(row['delta_y'])}"
                line += f", slope {_value_text(row['slope'])}"
            lines.append(line)
    return lines


def _value_text(value: float, unit: str = "") -> str:
    return f"{result_text(value, 6)} {unit}".strip() if math.isfinite(value) else "no value"
