"""Graphs that are ready to be shown: paths of points and of what several drives carry, and how a point moves with its height."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot

import numpy as np

from core.design import FRAME_LINK
from core.design.topology import pins
from core.frozen import frozen
from core.output.channels import channels
from core.output.graph.model import ANGLES, WHOLE, Graph, GraphAxis, GraphCurve, add_curve
from core.output.graph.sources import MACHINE, DesignSource, Source
from core.output.shaft_outputs import ACCELERATION, SPEED, travel_column
from core.study.transfer_path import leads


@frozen
class ReadyGraph:
    """name: as the command calls it; text and tip: as a menu does; graph: of the design at hand."""

    name: str
    text: str
    tip: str
    graph: Graph


def ready(source: DesignSource) -> tuple[ReadyGraph, ...]:
    """Those that this design has."""
    return (*_of_shaft(source), *_of_points(source))


def _graph(title: str, *curves: GraphCurve, across: str = "", left: str = "") -> Graph:
    made = Graph(title=title, x=GraphAxis(across), left=GraphAxis(left))
    for curve in curves:
        made = add_curve(made, curve)
    return made


def _of_shaft(source: DesignSource) -> Iterator[ReadyGraph]:
    """The first drive across, those behind it upwards."""
    names = leads(source.shaft) if source.drives else ()
    if not names:
        return
    first, *others = (travel_column(source.shaft, name) for name in names)
    paths = [
        GraphCurve(drive=WHOLE, x=first, y=other, name=f"{name} over {names[0]}", mark=ANGLES, dash=dash)
        for name, other, dash in zip(names[1:], others, ("dashed", "solid"), strict=False)
    ]
    led = f"what {', '.join(names[:-1])} and {names[-1]} carry together"
    path = _graph("Path of the transfer", *paths, across=names[0], left=", ".join(names[1:]))
    yield ReadyGraph("path", "Path of the transfer", f"The path of {led}, marked by machine angle", path)
    along = (
        GraphCurve(drive=WHOLE, x=MACHINE, y=column, name=name)
        for column, name in ((SPEED, "Speed"), (ACCELERATION, "Acceleration"))
    )
    speed = _graph("Speed along the path", *along, left="Speed")
    yield ReadyGraph("speed", "Speed along the path", f"Speed and acceleration of {led}", speed)


def _of_points(source: DesignSource) -> Iterator[ReadyGraph]:
    """Of every point that is no joint, of a link that moves."""
    drive = source.design.drive if not source.drives else None
    if drive is None or not drive.links:
        return
    joints = {pin.name for pin in pins(drive.linkage)}
    rows = {row.name: row.slug for row in channels(source.design, ("linkage",))}
    for link in drive.linkage.links:
        for point in link.points if link.number != FRAME_LINK else ():
            if point.name in joints:
                continue
            name, along, height = point.name, rows[f"point.{point.name}_x"], rows[f"point.{point.name}_y"]
            turned = rows.get(f"link.{link.number}")
            path = _graph(f"Path of {name}", GraphCurve(x=along, y=height, name=f"Path of {name}", mark=ANGLES))
            yield ReadyGraph(
                f"path:{name}",
                f"Path of {name}",
                f"Where {name} of link {link.number} is over the turn, marked by angle",
                path,
            )
            moved = [GraphCurve(x=height, y=along, name=f"{name}, along", mark=ANGLES)]
            moved += [GraphCurve(x=height, y=turned, name=f"Link {link.number}, angle")] if turned else []
            tip = f"How far {name} moves along, and link {link.number} turns, with the height of {name}: of a wheel its bump plot"
            over = f"{name} over its height"
            yield ReadyGraph(f"height:{name}", over, tip, _graph(over, *moved, across=f"Height of {name}"))


@frozen
class PointValue:
    """What is read at a point of a path: its name, value and unit."""

    name: str
    value: float
    unit: str


def on_path(source: Source, curve: GraphCurve, angle: float) -> tuple[PointValue, ...]:
    """Speed along a path and size of the acceleration on it where the angle of the turn is so [deg]; nothing where the curve is no path:
    neither x and y of one point of a linkage, nor two outputs that lead what several drives carry."""
    if not isinstance(source, DesignSource):
        return ()
    part = source.parts(curve.drive)[0]
    point = curve.x.removesuffix("_x_mm")
    if part == WHOLE and {curve.x, curve.y} <= {travel_column(source.shaft, name) for name in leads(source.shaft)}:
        columns: tuple[str, ...] = (SPEED, ACCELERATION)
    elif part != WHOLE and (curve.x, curve.y) == (f"{point}_x_mm", f"{point}_y_mm") and point:
        columns = tuple(f"{point}_{what}" for what in ("speed_mm_s", "ax_mm_s2", "ay_mm_s2"))
    else:
        return ()
    headings = source.headings(part)
    if not {each.name for each in headings}.issuperset(columns):
        return ()
    at, *values = source.values(part, (headings[0].name, *columns))
    speed, *acceleration = (float(np.interp(angle, at, each, period=360.0)) for each in values)
    return PointValue("speed", speed, "mm/s"), PointValue("acceleration", hypot(*acceleration), "mm/s²")


__all__ = ["PointValue", "ReadyGraph", "on_path", "ready"]
