"""A closed curve of lines and arcs read from a DXF drawing, by ezdxf."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from core.contour.elements import Element, arc, arc_of_bulge, area, line, meetings, near_pairs, sampled, winding
from core.errors import KindynaError
from core.frozen import frozen

JOIN_MM = 1e-4
"""Ends of lines and arcs that are no farther apart are one point."""
LAYER = "PROFILE"
"""The layer that counts where it has a curve."""
UNITS: Mapping[str, float] = MappingProxyType({"mm": 1.0, "cm": 10.0, "in": 25.4})
"""Unit that may be chosen -> millimetres."""
_HEADER: Mapping[int, tuple[str, float]] = MappingProxyType(
    {1: ("in", 25.4), 2: ("ft", 304.8), 4: ("mm", 1.0), 5: ("cm", 10.0), 6: ("m", 1000.0)}
)
"""$INSUNITS of the header -> unit, millimetres."""
_REFUSED = ("SPLINE", "ELLIPSE")
_SAME = 1e-10  # relative: centres and radii of one circle
MOST_ELEMENTS = 20_000


class DrawingError(KindynaError):
    """A drawing holds no curve that a follower can be rolled over."""


@frozen(eq=False)
class Contour:
    """A closed curve about the cam centre, which is the origin [mm], counter-clockwise.

    name, layer  of the file and where it stood
    unit         of the drawing
    centre       of the cam, in the drawing [mm]
    """

    elements: tuple[Element, ...]
    name: str
    layer: str
    unit: str
    centre: complex


def read_contour(data: bytes, name: str, unit: str = "", centre: complex | None = None) -> Contour:
    """The closed curve of a DXF file; unit: key of ``UNITS``, empty as the header says; centre of the cam in the drawing's
    units, None for its origin.

    Raises DrawingError where there is no such curve, or more than one, where it crosses itself, in units that are not known,
    and where the centre does not lie inside of it.
    """
    drawing = _opened(data, name)
    label, size = _unit(drawing, name, unit)
    layer, entities = _entities(drawing, name)
    origin = (centre or 0j) * size
    pieces = [piece.moved(-origin, size) for entity in entities for piece in _pieces(entity, name)]
    if len(pieces) > MOST_ELEMENTS:
        raise DrawingError(f"{name}: {len(pieces)} lines and arcs are too many; allowed: {MOST_ELEMENTS}")
    elements = _closed(pieces, name, layer, origin)
    _require_simple(elements, name, origin)
    if winding(elements, 0j) == 0:
        raise DrawingError(
            f"{name}: the cam centre {at_text(origin)} lies outside the curve; give the centre where the cam turns about"
        )
    return Contour(tuple(elements), name, layer, label, origin)


def at_text(z: complex) -> str:
    """A point as text, without the minus of a zero."""
    x, y = (round(value, 6) + 0.0 for value in (z.real, z.imag))
    return f"({x:.6g}, {y:.6g}) mm"


# -- the file ---------------------------------------------------------------------------------------------


def _opened(data: bytes, name: str) -> Any:
    import ezdxf
    from ezdxf.lldxf.const import DXFError

    for encoding in ("utf-8", "cp1252", "latin-1"):
        try:
            text = data.decode(encoding)
            break
        except UnicodeDecodeError:
            continue
    try:
        return ezdxf.read(io.StringIO(text.replace("\r\n", "\n")))
    except (DXFError, ValueError, LookupError, TypeError, AttributeError) as error:
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise DrawingError(f"{name}: not a DXF drawing in text form ({reason}); save it as ASCII DXF") from error


def _unit(drawing: Any, name: str, unit: str) -> tuple[str, float]:
    if unit:
        return unit, UNITS[unit]
    code = drawing.header.get("$INSUNITS", 0)
    if code not in _HEADER:
        stated = "states no unit" if code == 0 else f"states the unit {code} in $INSUNITS, which is not known here"
        raise DrawingError(f"{name}: its header {stated}; state the unit: {' | '.join(UNITS)}")
    return _HEADER[code]


def _entities(drawing: Any, name: str) -> tuple[str, list[Any]]:
    """The curves of the model space: of the layer PROFILE where it has any, else of all layers, and of which."""
    curves = [each for each in drawing.modelspace() if each.dxftype() in (*_READERS, *_REFUSED)]
    preferred = [each for each in curves if each.dxf.layer.upper() == LAYER]
    chosen = preferred or curves
    for each in chosen:
        if each.dxftype() in _REFUSED:
            raise DrawingError(
                f"{name}: {each.dxftype()} on layer {each.dxf.layer!r}: only lines, arcs, circles and polylines are read; save the curve "
                "as arcs or as a polyline (a profile from here: as tangent arcs)"
            )
    if not chosen:
        raise DrawingError(f"{name}: no closed curve: no line, arc, circle or polyline in the model space; explode blocks")
    return ", ".join(sorted({each.dxf.layer for each in chosen})), chosen


def _pieces(entity: Any, name: str) -> Iterator[Element]:
    """Lines and arcs of an entity, in the plane of the drawing."""
    extrusion = tuple(entity.dxf.get("extrusion", (0.0, 0.0, 1.0)))
    if abs(extrusion[0]) > 1e-9 or abs(extrusion[1]) > 1e-9:
        raise DrawingError(f"{name}: {entity.dxftype()} on layer {entity.dxf.layer!r} does not lie in the xy plane; draw it there")
    pieces = (each for each in _READERS[entity.dxftype()](entity) if each.length > 0.0)
    if extrusion[2] > 0.0 or entity.dxftype() == "LINE":
        return pieces
    return (Element(-p.start.conjugate(), -p.end.conjugate(), -p.sweep, -p.centre.conjugate()) for p in pieces)


def _point(at: Any) -> complex:
    return complex(at[0], at[1])


def _line(entity: Any) -> Iterator[Element]:
    yield line(_point(entity.dxf.start), _point(entity.dxf.end))


def _arc(entity: Any) -> Iterator[Element]:
    begin, end = entity.dxf.start_angle, entity.dxf.end_angle
    sweep = math.radians((end - begin) % 360.0) or 2.0 * math.pi
    yield arc(_point(entity.dxf.center), entity.dxf.radius, math.radians(begin), sweep)


def _circle(entity: Any) -> Iterator[Element]:
    yield arc(_point(entity.dxf.center), entity.dxf.radius, 0.0, 2.0 * math.pi)


def _light_polyline(entity: Any) -> Iterator[Element]:
    return _vertices([(complex(x, y), b) for x, y, b in entity.get_points("xyb")], entity.closed)


def _polyline(entity: Any) -> Iterator[Element]:
    rows = [(_point(v.dxf.location), v.dxf.get("bulge", 0.0)) for v in entity.vertices]
    return _vertices(rows, entity.is_closed)


def _vertices(rows: Sequence[tuple[complex, float]], closed: bool) -> Iterator[Element]:
    for (start, bulge), (end, _) in zip(rows, [*rows[1:], *rows[:1]] if closed else rows[1:], strict=False):
        if start != end:
            yield arc_of_bulge(start, end, bulge)


_READERS: Mapping[str, Callable[[Any], Iterator[Element]]] = MappingProxyType(
    {"LINE": _line, "ARC": _arc, "CIRCLE": _circle, "LWPOLYLINE": _light_polyline, "POLYLINE": _polyline}
)
"""One row for each entity that is read."""


# -- the curve --------------------------------------------------------------------------------------------


def _closed(pieces: Sequence[Element], name: str, layer: str, origin: complex) -> list[Element]:
    """The one closed chain of the pieces, counter-clockwise, neighbours of one line or circle made one."""
    loops = [[each] for each in pieces if _is_whole(each)]
    loops += _chains([each for each in pieces if not _is_whole(each)], name, origin)
    if not loops:
        raise DrawingError(f"{name}: no closed curve: {_widest_gap(pieces, origin)}")
    if len(loops) > 1:
        raise DrawingError(
            f"{name}: {len(loops)} closed curves on layer {layer}; leave one, or put the cam's profile on a layer {LAYER}"
        )
    (chain,) = loops
    if area(chain) < 0.0:
        chain = [each.reversed() for each in reversed(chain)]
    return _made_one(_meeting(chain))


def _is_whole(each: Element) -> bool:
    return abs(each.sweep) >= 2.0 * math.pi - 1e-12


def _chains(pieces: Sequence[Element], name: str, origin: complex) -> list[list[Element]]:
    """Closed chains of pieces whose ends meet; pieces that belong to none are left out."""
    if not pieces:
        return []
    from scipy.spatial import cKDTree

    ends = np.array([z for each in pieces for z in (each.start, each.end)])
    near: list[list[int]] = cKDTree(np.column_stack((ends.real, ends.imag))).query_ball_point(
        np.column_stack((ends.real, ends.imag)), JOIN_MM
    ).tolist()
    partner: dict[int, int] = {}
    for i, others in enumerate(near):
        rest = [j for j in others if j != i]
        if len(rest) > 1:
            raise DrawingError(f"{name}: {len(others)} ends of lines and arcs meet at {at_text(ends[i] + origin)}; leave two of them")
        if rest:
            partner[i] = rest[0]
    loops, used = [], set[int]()
    for first in range(len(pieces)):
        chain: list[Element] = []
        end = 2 * first
        while end // 2 not in used:
            used.add(end // 2)
            piece = pieces[end // 2]
            chain.append(piece if end % 2 == 0 else piece.reversed())
            other = end ^ 1
            if other not in partner:
                chain = []
                break
            end = partner[other]
        if chain and end == 2 * first:
            loops.append(chain)
    return loops


def _widest_gap(pieces: Sequence[Element], origin: complex) -> str:
    """The two free ends that are next to each other, and how far they are apart."""
    ends = np.array([z for each in pieces for z in (each.start, each.end)])
    apart = np.abs(ends[:, None] - ends[None, :])
    np.fill_diagonal(apart, np.inf)
    free = np.flatnonzero(apart.min(axis=1) > JOIN_MM)
    if free.size < 2:
        return "the lines and arcs do not form one"
    inside = apart[np.ix_(free, free)]
    i, j = np.unravel_index(int(np.argmin(inside)), inside.shape)
    one, other = ends[free[i]] + origin, ends[free[j]] + origin
    return f"the ends {at_text(one)} and {at_text(other)} are {inside[i, j]:.4g} mm apart, more than {JOIN_MM:g} mm; close it"


def _meeting(chain: Sequence[Element]) -> list[Element]:
    """Ends that are next to each other put on one point between them."""
    if len(chain) == 1 and _is_whole(chain[0]):
        return list(chain)
    joints = [
        a.end if a.end == b.start else 0.5 * (a.end + b.start) for a, b in zip(chain, [*chain[1:], chain[0]], strict=True)
    ]
    return [each.with_ends(joints[i - 1], joints[i]) for i, each in enumerate(chain)]


def _made_one(chain: list[Element]) -> list[Element]:
    """Neighbours on one circle, or one line, as one element; an arc may take the whole turn."""
    size = max(float(np.abs(sampled(chain)).max()), 1e-300)
    done: list[Element] = []
    for each in chain:
        if done and (one := _one(done[-1], each, size)) is not None:
            done[-1] = one
        else:
            done.append(each)
    while len(done) > 1 and (one := _one(done[-1], done[0], size)) is not None:
        done = [one, *done[1:-1]]
    return done


def _one(a: Element, b: Element, size: float) -> Element | None:
    room = _SAME * size
    if a.is_line and b.is_line:
        straight = abs(complex(a.tangent(0.0)) - complex(b.tangent(0.0))) <= _SAME
        return Element(a.start, b.end) if straight and abs(b.end - a.start) > 0.5 * (a.length + b.length) else None
    if a.is_line or b.is_line or (a.sweep > 0.0) != (b.sweep > 0.0):
        return None
    if abs(a.centre - b.centre) > room or abs(a.radius - b.radius) > room:
        return None
    sweep = a.sweep + b.sweep
    whole = abs(abs(sweep) - 2.0 * math.pi) < 1e-9
    longer = a if abs(a.sweep) >= abs(b.sweep) else b
    return Element(a.start, a.start if whole else b.end, math.copysign(2.0 * math.pi, sweep) if whole else sweep, longer.centre)


def _require_simple(chain: Sequence[Element], name: str, origin: complex) -> None:
    """Raises DrawingError where the curve crosses itself."""
    count = len(chain)
    for i, j in near_pairs(chain):
        a, b = chain[i], chain[j]
        shared = [z for z in (a.start, a.end) if min(abs(z - b.start), abs(z - b.end)) <= JOIN_MM and (j - i == 1 or j - i == count - 1)]
        room = max(JOIN_MM, 1e-6 * min(a.length, b.length))
        for z in meetings(a, b):
            if all(abs(z - end) > room for end in shared):
                raise DrawingError(f"{name}: the curve crosses itself at {at_text(z + origin)}; draw it without the crossing")
