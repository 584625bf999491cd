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

from core.commands import DONE, DONE_WITH_ERRORS, NOTHING_DONE, Painter
from core.commands.common import number
from core.errors import KindynaError
from core.output.graph import (
    DASHES,
    LEAST_WIDTH,
    MARKS,
    MOST_WIDTH,
    SIDES,
    Curve,
    DesignSource,
    Graph,
    Plotted,
    Scale,
    Source,
    add_curve,
    gap,
    is_colour,
    numbers_csv,
    plotted,
    point_at,
    read_source,
    ready,
)
from core.output.graph.picture import ENDINGS, LEAST_SIDE, MOST_SIDE, USUAL_SIZE, Picture
from core.output.graph.setup_file import load_setup
from core.output.lines import printable
from core.output.summary import to_json
from core.project.files import write
from core.units import unit_called

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
    return unit_called(text) or text


def _colour(text: str) -> str:
    if not is_colour(text):
        raise _fail(text, "colour; allowed: #rrggbb, such as #D55E00")
    return text


_KEYS: Mapping[str, tuple[str, Callable[[str], Any]]] = MappingProxyType(
    {
        "y": ("y", str), "x": ("x", str), "file": ("source", str), "drive": ("drive", str), "y-unit": ("y_unit", _unit),
        "unit": ("y_unit", _unit), "x-unit": ("x_unit", _unit), "minus": ("minus", str), "axis": ("side", _one_of(SIDES)),
        "name": ("name", str), "colour": ("colour", _colour), "dash": ("dash", _one_of(tuple(DASHES))), "mark": ("mark", _one_of(MARKS)),
        "width": ("width", number("width of a line", f"{LEAST_WIDTH:g} ... {MOST_WIDTH:g}", lambda v: LEAST_WIDTH <= v <= MOST_WIDTH)),
    }
)  # fmt: skip
"""Key of a curve on the command line -> field of its row, and what reads it."""


def curve(text: str) -> Curve:
    """``y=force_n,x=angle_deg,file=2,axis=right``; ``minus`` and ``file`` still by number."""
    made = Curve()
    for i, part in enumerate(text.split(",")):
        key, mark, value = part.partition("=")
        key, value = ("y", part) if not mark and i == 0 else (key.strip(), value)
        if key not in _KEYS or not (mark or i == 0) or not value:
            raise _fail(text, f"{part!r} is no KEY=VALUE of a curve; keys: {' '.join(_KEYS)}")
        name, read = _KEYS[key]
        made = replace(made, **{name: read(value.strip())})
    return made


def span(text: str) -> tuple[float | None, float | None]:
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


def size(text: str) -> tuple[int, int]:
    """``960x600``."""
    sides = text.replace("×", "x").split("x")
    if len(sides) != 2 or not all(s.isdecimal() and LEAST_SIDE <= int(s) <= MOST_SIDE for s in sides):
        raise _fail(text, f"size of a picture; allowed: WIDTHxHEIGHT, each {LEAST_SIDE} ... {MOST_SIDE} pixels")
    return int(sides[0]), int(sides[1])


def out_file(text: str) -> Path:
    """A picture or a table."""
    if Path(text).suffix.lower() not in FILES:
        raise _fail(text, f"file of a graph; allowed endings: {', '.join(FILES)}")
    return Path(text)


def options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", metavar="FILE", type=Path, nargs="*", help="tables (.csv, text) and designs (.toml)")
    parser.add_argument("--setup", type=Path, metavar="JSON", help="a graph that the window saved, with its files")
    parser.add_argument("--curve", type=curve, action="append", default=[], metavar="SPEC", help=_CURVE)
    shown = "a graph that is ready: path, speed (of what several drives carry); path:POINT, height:POINT (of a point of a linkage)"
    parser.add_argument("--ready", metavar="NAME", help=shown)
    out = f"file to write: {', '.join(FILES)}; repeat it"
    parser.add_argument("--out", type=out_file, action="append", default=[], metavar="NAME", help=out)
    parser.add_argument("--title", metavar="TEXT")
    for side, words in (("x", "axis along the bottom"), ("left", "left axis"), ("right", "right axis")):
        parser.add_argument(f"--{side}-title", metavar="TEXT", help=f"of the {words}")
        parser.add_argument(f"--{side}-range", type=span, metavar="LOW:HIGH", help=f"of the {words}")
        parser.add_argument(f"--{side}-log", action="store_true", help=f"{words} in powers of ten")
    parser.add_argument(
        "--size", type=size, default=USUAL_SIZE, metavar="WxH", help=f"of the picture ({USUAL_SIZE[0]}x{USUAL_SIZE[1]})"
    )
    parser.add_argument(
        "--at", type=number("x of a point", "any number"), metavar="X", help="print every curve's value there"
    )
    parser.add_argument(
        "--to", type=number("x of a second point", "any number"), metavar="X", help="and there, with Δx, Δy and slope"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace, painter: Painter | None) -> int:
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
    found = plotted(graph, source_of)
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


def _graph(arguments: argparse.Namespace, source_of: Callable[[str], Source]) -> Graph:
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
            if not (each.minus.isdecimal() and 1 <= int(each.minus) <= len(graph.curves)):
                raise KindynaError(f"minus={each.minus}: number of a curve; allowed: 1 ... {len(graph.curves)}")
            at = begin + i
            changed = replace(graph.curves[at], minus=graph.curves[int(each.minus) - 1].key)
            graph = replace(graph, curves=(*graph.curves[:at], changed, *graph.curves[at + 1 :]))
    x, left, right = (_scale(getattr(graph, side), arguments, side) for side in ("x", "left", "right"))
    return replace(
        graph, title=graph.title if arguments.title is None else arguments.title, x=x, left=left, right=right
    )


def _ready(arguments: argparse.Namespace, source_of: Callable[[str], Source]) -> Graph:
    """The graph of that name, of the first file."""
    if arguments.setup is not None:
        raise KindynaError("--ready: not together with --setup")
    source = source_of("")
    there = ready(source) if isinstance(source, DesignSource) else ()
    for each in there:
        if each.name == arguments.ready:
            return each.graph
    names = (
        ", ".join(each.name for each in there)
        or "none; several drives, and linkages with points beside their joints, have some"
    )
    raise KindynaError(f"--ready {arguments.ready}: {source.name} has no such graph; allowed: {names}")


def _usual(name: str, source: Source) -> list[Curve]:
    """Of a table every column but the first; of a design the first channel, of each drive."""
    part = source.parts("")[0]
    if not name.lower().endswith(".toml"):
        return [Curve(source=name, y=each.name) for each in source.headings(part)[1:]]
    return [Curve(source=name, drive=part)]


def _file(source: str, names: Sequence[str]) -> str:
    if not source and names:
        return names[0]
    if source.isdecimal() and 1 <= int(source) <= len(names):
        return names[int(source) - 1]
    if source in names:
        return source
    raise KindynaError(f"file={source}: number of a file; allowed: 1 ... {len(names)}")


def _scale(scale: Scale, arguments: argparse.Namespace, side: str) -> Scale:
    title, ends, log = (getattr(arguments, f"{side}_{what}") for what in ("title", "range", "log"))
    low, high = ends if ends is not None else (scale.low, scale.high)
    return replace(scale, title=scale.title if title is None else title, low=low, high=high, log=scale.log or log)


def _lines_wrong(graph: Graph, found: Plotted) -> list[str]:
    faults = [f"curve {graph.number(key) + 1}: {text}" for key, text in found.faults.items()]
    return [*dict.fromkeys(note for notes in found.notes.values() for note in notes), *faults]


def _content(path: Path, graph: Graph, found: Plotted, size: tuple[int, int], painter: Painter | None) -> bytes | str:
    ending = path.suffix.lower()
    if ending == ".csv":
        return numbers_csv(found)
    if painter is None:
        raise KindynaError(f"{path.name}: pictures need kindyna --headless; a table (.csv) does not")
    (data,) = painter(Picture(graph, found, ending, *size, name=graph.title or path.stem)).values()
    return data


def _data(found: Plotted, at: float | None, to: float | None) -> dict[str, Any]:
    rows = []
    for i, each in enumerate(found.series):
        row: dict[str, Any] = {"name": each.name, "unit": each.y_unit, "points": each.x.size}
        if at is not None:
            first = point_at(found, i, at)
            row |= {"x": first.x, "y": first.y}
            if to is not None:
                second = point_at(found, i, to)
                apart = gap(found, first, second)
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
