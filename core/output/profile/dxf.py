"""A drawing as DXF, written by ezdxf: the same drawing, the same bytes."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import datetime
from types import MappingProxyType
from typing import Any

import numpy as np

from core.output.profile.drawing import LAYERS, CircleShape, LineShape, Shape, reach
from core.output.profile.fits import Arcs, Cubics

VERSION = "R2010"
COMMENT = 999  # group code
MILLIMETRES, METRIC = 4, 1  # of $INSUNITS, $MEASUREMENT
PLANAR = 8  # flag of a spline; ends that meet close it: the flag for that makes some programs move its control points
VIEW = 2.2  # height of what is seen first, times the drawing's reach
LINES: Mapping[str, tuple[str, list[float]]] = MappingProxyType(
    {"CENTER": ("Center ____ _ ____", [12.0, 8.0, -1.5, 1.0, -1.5]), "DASHED": ("Dashed __ __", [4.0, 2.5, -1.5])}
)
"""Line types: description, then length of the pattern and its dashes and gaps [mm]."""


@contextmanager
def without_clock() -> Iterator[None]:
    """Files name neither a time nor a random number."""
    import ezdxf

    before = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before


def written(comment: Sequence[str], layers: Mapping[str, Sequence[Shape]]) -> bytes:
    """The file: comments, then a header with units and origin, then the shapes on their layers."""
    import ezdxf
    from ezdxf.tools.juliandate import juliandate

    with without_clock():
        drawing = ezdxf.new(VERSION)
        drawing.header["$INSUNITS"] = MILLIMETRES
        drawing.header["$MEASUREMENT"] = METRIC
        drawing.header["$INSBASE"] = (0.0, 0.0, 0.0)
        for name in ("$TDCREATE", "$TDUCREATE"):
            drawing.header[name] = juliandate(datetime(2000, 1, 1))
        for name, (text, pattern) in LINES.items():
            drawing.linetypes.add(name, pattern, description=text)
        half = reach(layers)
        drawing.set_modelspace_vport(VIEW * half)
        space = drawing.modelspace()
        space.reset_extents((-half, -half, 0.0), (half, half, 0.0))
        for name, shapes in layers.items():
            drawing.layers.add(name, color=LAYERS[name].colour, linetype=LAYERS[name].line)
            for shape in shapes:
                SHAPES[type(shape)](space, shape, {"layer": name})
        for kind in sorted(drawing.entitydb.dxf_types_in_use()):  # else in the order of a set, which changes
            drawing.classes.add_class(kind)
        stream = io.StringIO()
        drawing.write(stream)
    head = "".join(f"{COMMENT}\n{line}\n" for line in comment)
    return (head + stream.getvalue()).encode("utf-8", "replace")


def _polyline(space: Any, shape: Arcs, attributes: dict[str, Any]) -> None:
    rows = np.column_stack((shape.vertices.real, shape.vertices.imag, shape.b.ravel()))
    space.add_lwpolyline(rows.tolist(), format="xyb", close=True, dxfattribs=attributes)


def _spline(space: Any, shape: Cubics, attributes: dict[str, Any]) -> None:
    """One cubic B-spline with double knots, whose control points are those of the Bézier pieces without the common ones."""
    inner = shape.points[:, 1:3].ravel()
    points = np.concatenate((shape.points[:1, 0], inner, shape.points[:1, 0]))
    ends = np.append(0.0, np.cumsum(shape.lengths))
    knots = np.concatenate(([0.0, 0.0], np.repeat(ends, 2), [ends[-1]] * 2))
    made = space.add_spline(dxfattribs={**attributes, "degree": 3, "flags": PLANAR, "extrusion": (0.0, 0.0, 1.0)})
    made.knots = knots.tolist()
    made.control_points = [(z.real, z.imag, 0.0) for z in points.tolist()]


def _circle(space: Any, shape: CircleShape, attributes: dict[str, Any]) -> None:
    space.add_circle((0.0, 0.0), shape.radius, dxfattribs=attributes)


def _line(space: Any, shape: LineShape, attributes: dict[str, Any]) -> None:
    space.add_line((shape.start.real, shape.start.imag), (shape.end.real, shape.end.imag), dxfattribs=attributes)


SHAPES: Mapping[type, Callable[[Any, Any, dict[str, Any]], None]] = MappingProxyType(
    {Arcs: _polyline, Cubics: _spline, CircleShape: _circle, LineShape: _line}
)


__all__ = ["without_clock", "written"]
