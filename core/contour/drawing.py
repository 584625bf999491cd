"""Curves of lines and arcs from a DXF drawing."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from core.bounds import ROWS, bounded_float
from core.contour.elements import (
    ContourElement,
    arc,
    arc_of_bulge,
    area,
    intersections,
    line,
    near_pairs,
    sampled,
    winding,
)
from core.design.fields import LONGEST_MM
from core.errors import KindynaError
from core.frozen import frozen
from core.number_text import result_text
from core.units import conversion_factor

# -- DXF file in text form, tag by tag --------------------------------------------------------------------------


COMMENT, UNIT_CODE, PAPER_SPACE = 999, "$INSUNITS", 67
_PARTS = ("VERTEX", "SEQEND")  # of the POLYLINE before them


class NoDrawing(ValueError):
    """The text is not a DXF file; the message states the reason."""


@frozen(eq=False)
class Entity:
    """An entity with its tags in order, group codes and texts; parts: the vertices of a POLYLINE."""

    kind: str
    codes: Sequence[int]
    texts: Sequence[str]
    parts: list[Entity]

    @property
    def layer(self) -> str:
        """Name of the layer; ``0`` where the file states none."""
        return self.text(8, "0")

    def text(self, code: int, default: str) -> str:
        """Text of the first tag of a group code, or the default."""
        return self.texts[self.codes.index(code)].strip() if code in self.codes else default

    def number(self, code: int, default: float = 0.0) -> float:
        """Number of the first tag of a group code, or the default. Raises NoDrawing."""
        return as_number(self.text(code, str(default)))

    def point(self, code: int) -> complex:
        """Point x + iy; the group code of y is larger by 10."""
        return complex(self.number(code), self.number(code + 10))

    @property
    def upwards(self) -> tuple[float, float, float]:
        """Extrusion direction, from which the entity is seen."""
        return self.number(210), self.number(220), self.number(230, 1.0)

    def numbers(self, code: int) -> list[float]:
        """Numbers of all tags of a group code. Raises NoDrawing."""
        return [as_number(text) for key, text in zip(self.codes, self.texts, strict=True) if key == code]


@frozen(eq=False)
class Drawing:
    """Contents of a DXF file.

    Attributes
    ----------
    unit : $INSUNITS, 0 where it is not stated
    entities : of the model space
    blocks : name in capitals -> entities, the first of which is the block itself
    hidden : names in capitals of layers that are off or frozen
    """

    unit: int
    entities: list[Entity]
    blocks: Mapping[str, list[Entity]]
    hidden: frozenset[str]


def as_number(text: str) -> float:
    """Number of a tag. Raises NoDrawing where it is none, or out of range."""
    try:
        value = bounded_float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= LONGEST_MM:
        raise NoDrawing(f"{text.strip()[:40]} is no number of a drawing; allowed: {-LONGEST_MM:g} ... {LONGEST_MM:g}")
    return value


def read_dxf(text: str) -> tuple[int, list[Entity]]:
    """$INSUNITS, 0 where it is not stated, and the entities of the model space. Raises NoDrawing."""
    drawing = read_drawing(text)
    return drawing.unit, [entity for entity in drawing.entities if entity.number(PAPER_SPACE) == 0.0]


def read_drawing(text: str) -> Drawing:
    """The drawing in a text, with the entities of the paper space. Raises NoDrawing."""
    if max(text.count("\n"), text.count("\r")) > 2 * ROWS:
        raise NoDrawing(f"more than {ROWS} group codes; save only the needed part of it")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n").split("\n")
    try:
        codes = [int(line) for line in lines[::2]]
    except ValueError as error:
        raise NoDrawing(f"not a group code: {str(error)[:80]}") from None
    texts = lines[1::2]
    unit, entities, section = 0, list[Entity](), ""
    blocks, hidden = dict[str, list[Entity]](), set[str]()
    block: list[Entity] = []
    for kind, first, last in _blocks(codes, texts):
        if kind == "SECTION":
            section = texts[first].strip() if first < last else ""
            if section == "HEADER":
                unit = _header_unit(texts[first:last])
        elif kind == "ENDSEC":
            section = ""
        elif section in ("ENTITIES", "BLOCKS", "TABLES"):
            entity = Entity(kind, codes[first:last], texts[first:last], [])
            if section == "TABLES":
                if kind == "LAYER" and _is_hidden(entity):
                    hidden.add(entity.text(2, "").upper())
                continue
            if kind == "BLOCK":
                block = blocks[entity.text(2, "").upper()] = []
            target = entities if section == "ENTITIES" else block
            if kind not in _PARTS:
                target.append(entity)
            elif kind == "VERTEX" and target:
                target[-1].parts.append(entity)
    if section or not codes or codes[0] not in (0, COMMENT):
        raise NoDrawing(f"section {section} has no end" if section else "it begins with no section")
    return Drawing(unit, entities, blocks, frozenset(hidden))


def _is_hidden(layer: Entity) -> bool:
    """Whether a layer is off (negative colour), or frozen."""
    try:
        return layer.number(62) < 0.0 or bool(int(layer.number(70)) & 1)
    except NoDrawing:
        return False


def _blocks(codes: Sequence[int], texts: Sequence[str]) -> Iterator[tuple[str, int, int]]:
    """Names after group code 0, with the range of the tags that follow."""
    begins = [i for i, code in enumerate(codes[: len(texts)]) if code == 0]
    for begin, end in pairwise([*begins, len(texts)]):
        yield texts[begin].strip().upper(), begin + 1, end


def _header_unit(header: Sequence[str]) -> int:
    for name, value in pairwise(header):
        if name.strip() == UNIT_CODE:
            return int(as_number(value))
    return 0


# -- closed curve -----------------------------------------------------------------------------------------------


JOIN_MM = 1e-4
"""Largest distance [mm] of ends of lines and arcs that are one point."""
GAP_MM, MOST_GAP_MM = 0.002, 1.0
"""Gap [mm] over which free ends join, default and largest: CAD writes three decimals."""
BREAK, MOST_BREAK = math.radians(0.01), math.radians(0.05)
"""Turn of the tangent [rad] below which a joint is smooth, for rounded numbers; at most, over a gap."""
LAYERS = ("PROFILE", "PROFILE_INNER")
"""Preferred layers: of a cam, and of the inner wall of a groove."""
UNITS = ("mm", "cm", "in")
"""Units of a drawing without a stated unit."""
_HEADER: Mapping[int, str] = MappingProxyType({1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"})
"""$INSUNITS of the header -> unit."""
_REFUSED = ("SPLINE", "ELLIPSE")
_SAME = 1e-10  # relative tolerance of centres and radii of one circle
_ROUNDING_MM = 1e-7  # largest distance of coincident ends
MOST_ELEMENTS = 20_000
MOST_NEAR = 50  # ends within the gap of an end, on average


class DrawingError(KindynaError):
    """The drawing contains no curve on which a follower can roll."""


@frozen(eq=False)
class Contour:
    """A closed curve about the cam centre, which is the origin [mm], counter-clockwise.

    Attributes
    ----------
    name, layer : of the file and of the curve in it
    unit : of the drawing
    centre : of the cam, in the drawing [mm]
    smooth : smaller turns of the tangent [rad] count as smooth
    """

    elements: tuple[ContourElement, ...]
    name: str
    layer: str
    unit: str
    centre: complex
    smooth: float


def read_contour(
    data: bytes, name: str, unit: str = "", centre: complex | None = None, gap_mm: float = GAP_MM
) -> Contour:
    """The closed curve of a DXF file.

    unit: key of ``UNITS``, empty for that of the header; centre: of the cam in the drawing's units, None for its
    origin; gap_mm: largest gap over which ends join. Raises DrawingError where there is no such curve, or more than
    one, where it crosses itself, where the unit is unknown, and where the centre is not inside it.
    """
    curve = _read_curve(data, name, unit, centre, gap_mm)
    if winding(curve.elements, 0j) == 0:
        raise DrawingError(
            f"{name}: the cam centre {at_text(curve.centre)} lies outside the curve; give the centre about which the cam rotates"
        )
    return curve


def read_outline(data: bytes, name: str) -> tuple[ContourElement, ...]:
    """Lines and arcs [mm] of the closed curve of a DXF file, in millimetres where its header states no unit.

    Raises DrawingError where there is no such curve, or more than one, and where it crosses itself.
    """
    return _read_curve(data, name, _millimetres_if_unknown(data, name), None, GAP_MM).elements


def read_curve(data: bytes, name: str) -> tuple[tuple[ContourElement, ...], bool]:
    """Lines and arcs [mm] of the curve of a DXF file, and whether it is closed; an open one, and one that crosses itself, too.

    In millimetres where the header states no unit. Raises DrawingError where there is no curve, or more than one.
    """
    drawn = _read_pieces(data, name, _millimetres_if_unknown(data, name), None)
    curves, parts, partners = _curves(drawn.pieces, name, 0j, GAP_MM)
    closed = len(curves)
    curves += _open_chains(parts, partners)
    if not curves:
        raise DrawingError(f"{name}: no curve: its lines, arcs, circles and polylines have no length")
    if len(curves) > 1:
        raise DrawingError(f"{name}: {len(curves)} curves on layer {drawn.layer}, which do not join; leave one")
    return tuple(curves[0]), bool(closed)


def _millimetres_if_unknown(data: bytes, name: str) -> str:
    """Unit of a drawing whose header states none: mm; else empty."""
    return "" if _read_entities(data, name)[0] in _HEADER else UNITS[0]


class _Drawn(NamedTuple):
    """Lines and arcs of a drawing [mm] about an origin [mm]."""

    pieces: list[ContourElement]
    layer: str
    unit: str
    origin: complex


def _read_pieces(data: bytes, name: str, unit: str, centre: complex | None) -> _Drawn:
    unit_code, model_space = _read_entities(data, name)
    label, scale = _unit(unit_code, name, unit)
    layer, entities = _entities(model_space, name)
    origin = (centre or 0j) * scale
    pieces = [piece.transformed(-origin, scale) for entity in entities for piece in _pieces(entity, name)]
    if len(pieces) > MOST_ELEMENTS:
        raise DrawingError(f"{name}: {len(pieces)} lines and arcs are too many; allowed: {MOST_ELEMENTS}")
    return _Drawn(pieces, layer, label, origin)


def _read_curve(data: bytes, name: str, unit: str, centre: complex | None, gap_mm: float) -> Contour:
    """The closed curve of a DXF file, wherever it is; parameters and errors as for `read_contour`."""
    if not 0.0 <= gap_mm <= MOST_GAP_MM:
        raise DrawingError(f"{name}: gap {gap_mm:g} mm between ends; allowed: 0 ... {MOST_GAP_MM:g} mm")
    pieces, layer, label, origin = _read_pieces(data, name, unit, centre)
    chain = _closed_chain(pieces, name, layer, origin, gap_mm)
    elements = _with_common_ends(chain)
    _require_simple(elements, name, origin)
    return Contour(tuple(elements), name, layer, label, origin, _smooth(chain, elements))


def at_text(z: complex) -> str:
    """A point as text, without a negative zero."""
    x, y = (round(value, 6) + 0.0 for value in (z.real, z.imag))
    return f"({result_text(x)}, {result_text(y)}) mm"


# -- file -------------------------------------------------------------------------------------------------


def _read_entities(data: bytes, name: str) -> tuple[int, list[Entity]]:
    """Code of the unit, and entities of the model space."""
    try:
        return read_dxf(text_of(data))
    except NoDrawing as error:
        reason = " ".join(str(error).split())[:120]
        raise DrawingError(f"{name}: not a DXF drawing in text form ({reason}); save it as ASCII DXF") from error


def text_of(data: bytes) -> str:
    """Text of a drawing's bytes in any encoding."""
    for encoding in ("utf-8", "cp1252"):
        try:
            return data.decode(encoding)
        except UnicodeDecodeError:
            continue
    return data.decode("latin-1")


def _unit(code: int, name: str, unit: str) -> tuple[str, float]:
    """Unit of the drawing, and its length in millimetres."""
    if not unit and code not in _HEADER:
        stated = "states no unit" if code == 0 else f"states the unit {code} in $INSUNITS, which is unknown"
        raise DrawingError(f"{name}: its header {stated}; state the unit: {' | '.join(UNITS)}")
    name_of_unit = unit or _HEADER[code]
    return name_of_unit, conversion_factor(name_of_unit, "mm")


def _entities(entities: Sequence[Entity], name: str) -> tuple[str, list[Entity]]:
    """The layers and curves of the model space: of the first of ``LAYERS`` with a curve, otherwise of all layers."""
    curves = [entity for entity in entities if entity.kind in (*_READERS, *_REFUSED)]
    preferred = ([entity for entity in curves if entity.layer.upper() == layer] for layer in LAYERS)
    chosen = next(filter(None, preferred), curves)
    for entity in chosen:
        if entity.kind in _REFUSED:
            raise DrawingError(
                f"{name}: {entity.kind} on layer {entity.layer!r}: only lines, arcs, circles and polylines are read; save the curve "
                "as arcs or as a polyline (a profile from here: as tangent arcs)"
            )
    if not chosen:
        raise DrawingError(
            f"{name}: no closed curve: no line, arc, circle or polyline in the model space; explode blocks"
        )
    return ", ".join(sorted({entity.layer for entity in chosen})), chosen


def _pieces(entity: Entity, name: str) -> list[ContourElement]:
    """Lines and arcs of an entity, in the plane of the drawing."""
    label = f"{name}: {entity.kind} on layer {entity.layer!r}"
    try:
        x, y, z = entity.upwards
        if abs(x) > 1e-9 or abs(y) > 1e-9:
            raise DrawingError(f"{label} does not lie in the xy plane; draw it there")
        pieces = [piece for piece in _READERS[entity.kind](entity) if piece.length > 0.0]
    except NoDrawing as error:
        raise DrawingError(f"{label}: {error}") from error
    if z <= 0.0 and entity.kind != "LINE":
        pieces = [
            ContourElement(-p.start.conjugate(), -p.end.conjugate(), -p.sweep, -p.centre.conjugate()) for p in pieces
        ]
    return pieces


def _line(entity: Entity) -> Iterator[ContourElement]:
    yield line(entity.point(10), entity.point(11))


def _arc(entity: Entity) -> Iterator[ContourElement]:
    begin, end = entity.number(50), entity.number(51)
    sweep = math.radians((end - begin) % 360.0) or 2.0 * math.pi
    yield arc(entity.point(10), entity.number(40), math.radians(begin), sweep)


def _circle(entity: Entity) -> Iterator[ContourElement]:
    yield arc(entity.point(10), entity.number(40), 0.0, 2.0 * math.pi)


def _light_polyline(entity: Entity) -> Iterator[ContourElement]:
    rows = list[tuple[complex, float]]()
    for code, text in zip(entity.codes, entity.texts, strict=True):
        if code == 10:
            rows.append((complex(as_number(text)), 0.0))
        elif code == 20 and rows:
            rows[-1] = (rows[-1][0] + 1j * as_number(text), 0.0)
        elif code == 42 and rows:
            rows[-1] = (rows[-1][0], as_number(text))
    return _vertices(rows, _is_closed(entity))


def _polyline(entity: Entity) -> Iterator[ContourElement]:
    return _vertices([(vertex.point(10), vertex.number(42)) for vertex in entity.parts], _is_closed(entity))


def _is_closed(entity: Entity) -> bool:
    return bool(int(entity.number(70)) & 1)


def _vertices(rows: Sequence[tuple[complex, float]], closed: bool) -> Iterator[ContourElement]:
    for (start, bulge), (end, _) in zip(rows, [*rows[1:], *rows[:1]] if closed else rows[1:], strict=False):
        if start != end:
            yield arc_of_bulge(start, end, bulge)


_READERS: Mapping[str, Callable[[Entity], Iterator[ContourElement]]] = MappingProxyType(
    {"LINE": _line, "ARC": _arc, "CIRCLE": _circle, "LWPOLYLINE": _light_polyline, "POLYLINE": _polyline}
)
"""Readers of the entities."""


# -- chain of lines and arcs ------------------------------------------------------------------------------


def _closed_chain(
    pieces: Sequence[ContourElement], name: str, layer: str, origin: complex, gap: float
) -> list[ContourElement]:
    """The closed chain of the pieces as drawn, counter-clockwise; neighbours on one line or circle are merged."""
    loops, parts, partners = _curves(pieces, name, origin, gap)
    if not loops:
        raise DrawingError(f"{name}: no closed curve: {_least_gap(parts, partners, origin, gap)}")
    if len(loops) > 1:
        raise DrawingError(
            f"{name}: {len(loops)} closed curves on layer {layer}; leave one, or put the cam's profile on a layer {LAYERS[0]}"
        )
    (chain,) = loops
    if area(chain) < 0.0:
        chain = [piece.reversed() for piece in reversed(chain)]
    return _merge(chain)


def _curves(
    pieces: Sequence[ContourElement], name: str, origin: complex, gap: float
) -> tuple[list[list[ContourElement]], list[ContourElement], dict[int, int]]:
    """Closed curves of the pieces; the pieces that are no circles, and the ends of these that join."""
    circles = [[piece] for piece in pieces if _is_circle(piece)]
    parts = [piece for piece in pieces if not _is_circle(piece)]
    partners = _partners(parts, name, origin, gap)
    return circles + _chains(parts, partners), parts, partners


def _is_circle(element: ContourElement) -> bool:
    return abs(element.sweep) >= 2.0 * math.pi - 1e-12


def _ends(pieces: Sequence[ContourElement]) -> np.ndarray:
    """Start and end of each piece (2k,): the opposite end of end i has the number i ^ 1."""
    return np.array([z for piece in pieces for z in (piece.start, piece.end)])


def _partners(pieces: Sequence[ContourElement], name: str, origin: complex, gap: float) -> dict[int, int]:
    """End -> end that it joins: nearest first, within the gap. Raises DrawingError where more than two ends meet."""
    if not pieces:
        return {}
    from scipy.spatial import cKDTree

    ends = _ends(pieces)
    points = np.column_stack((ends.real, ends.imag))
    tree, tolerance = cKDTree(points), min(JOIN_MM, gap)
    third = tree.query(points, k=3)[0][:, 2]  # the end itself, its partner, a third one
    if third.min() <= tolerance:
        i = int(np.argmin(third))
        count = tree.query_ball_point(points[i], tolerance, return_length=True)
        raise DrawingError(
            f"{name}: {count} ends of lines and arcs meet at {at_text(ends[i] + origin)}; leave two of them"
        )
    if tree.count_neighbors(tree, gap) > MOST_NEAR * len(points):
        raise DrawingError(f"{name}: too many ends within the gap of {gap:g} mm; join over a narrower one")
    i, j = tree.query_pairs(gap, output_type="ndarray").T
    is_short = (i // 2 == j // 2) & (
        np.array([piece.length for piece in pieces])[i // 2] <= 2.0 * gap
    )  # both ends of a short piece
    i, j = i[~is_short], j[~is_short]
    partners: dict[int, int] = {}
    for k in np.lexsort((j, i, np.abs(ends[i] - ends[j]))).tolist():
        first, second = int(i[k]), int(j[k])
        if first not in partners and second not in partners:
            partners |= {first: second, second: first}
    return partners


def _chains(pieces: Sequence[ContourElement], partners: Mapping[int, int]) -> list[list[ContourElement]]:
    """Closed chains of pieces whose ends join; other pieces are omitted."""
    loops, used = [], set[int]()
    for first in range(len(pieces)):
        chain: list[ContourElement] = []
        end = 2 * first
        while end // 2 not in used:
            used.add(end // 2)
            piece = pieces[end // 2]
            chain.append(piece if end % 2 == 0 else piece.reversed())
            far_end = end ^ 1
            if far_end not in partners:
                chain = []
                break
            end = partners[far_end]
        if chain and end == 2 * first:
            loops.append(chain)
    return loops


def _open_chains(pieces: Sequence[ContourElement], partners: Mapping[int, int]) -> list[list[ContourElement]]:
    """Chains of pieces from a free end to another one."""
    chains, used = [], set[int]()
    for first in range(2 * len(pieces)):
        chain: list[ContourElement] = []
        end: int | None = first if first not in partners and first // 2 not in used else None
        while end is not None:
            used.add(end // 2)
            piece = pieces[end // 2]
            chain.append(piece if end % 2 == 0 else piece.reversed())
            end = partners.get(end ^ 1)
        if chain:
            chains.append(chain)
    return chains


def _least_gap(pieces: Sequence[ContourElement], partners: Mapping[int, int], origin: complex, gap: float) -> str:
    """Sentence on the two nearest free ends and their distance."""
    ends = np.delete(_ends(pieces), list(partners)) if pieces else np.zeros(0)
    if ends.size < 2:
        return (
            "the lines and arcs do not form one" if pieces else "its lines, arcs, circles and polylines have no length"
        )
    from scipy.spatial import cKDTree

    points = np.column_stack((ends.real, ends.imag))
    distance, nearest = cKDTree(points).query(points, k=2)
    i = int(np.argmin(distance[:, 1]))
    first, second = at_text(ends[i] + origin), at_text(ends[nearest[i, 1]] + origin)
    return (
        f"the ends {first} and {second} are {result_text(distance[i, 1])} mm apart, more than {gap:g} mm; close it, "
        "or join over a wider gap"
    )


def _with_common_ends(chain: Sequence[ContourElement]) -> list[ContourElement]:
    """The chain with neighbouring ends moved to one point."""
    if len(chain) == 1 and _is_circle(chain[0]):
        return list(chain)
    joints = [_joint(a, b) for a, b in zip(chain, [*chain[1:], chain[0]], strict=True)]
    return [_with_end_points(element, joints[i - 1], joints[i]) for i, element in enumerate(chain)]


def _joint(a: ContourElement, b: ContourElement) -> complex:
    """Common point of two neighbours.

    Over a gap it is the end of a circle about the cam centre, which stays a dwell, or of the longer arc; otherwise the
    middle.
    """
    if abs(a.end - b.start) <= _ROUNDING_MM or (a.is_line and b.is_line):
        return a.end if a.end == b.start else 0.5 * (a.end + b.start)
    return a.end if _weight(a) >= _weight(b) else b.start


def _weight(element: ContourElement) -> tuple[bool, float]:
    return not element.is_line and abs(element.centre) <= _ROUNDING_MM, abs(element.sweep) * element.radius


def _with_end_points(element: ContourElement, start: complex, end: complex) -> ContourElement:
    """An element between slightly shifted ends; an arc keeps its circle where the shift is rounding."""
    if element.is_line or max(abs(start - element.start), abs(end - element.end)) <= _ROUNDING_MM:
        return element.with_ends(start, end)
    return arc_of_bulge(start, end, math.tan(0.25 * element.sweep))


def _smooth(drawn: Sequence[ContourElement], chain: Sequence[ContourElement]) -> float:
    """Turn of the tangent [rad] below which a joint is smooth: shifted ends rotate an element."""
    turns = (
        2.0 * max(abs(b.start - a.start), abs(b.end - a.end)) / b.length for a, b in zip(drawn, chain, strict=True)
    )
    return max(BREAK, min(2.0 * max(turns), MOST_BREAK))


def _merge(chain: list[ContourElement]) -> list[ContourElement]:
    """Neighbours on one circle or line merged into one element; an arc may become a full circle."""
    size = max(float(np.abs(sampled(chain)).max()), 1e-300)
    merged: list[ContourElement] = []
    for element in chain:
        if merged and (single := _merged(merged[-1], element, size)) is not None:
            merged[-1] = single
        else:
            merged.append(element)
    while len(merged) > 1 and (single := _merged(merged[-1], merged[0], size)) is not None:
        merged = [single, *merged[1:-1]]
    return merged


def _merged(a: ContourElement, b: ContourElement, size: float) -> ContourElement | None:
    tolerance = _SAME * size + 2.0 * abs(a.end - b.start)  # precision of the drawing
    if a.is_line and b.is_line:
        is_straight = abs(complex(a.tangent(0.0)) - complex(b.tangent(0.0))) <= _SAME
        return (
            ContourElement(a.start, b.end)
            if is_straight and abs(b.end - a.start) > 0.5 * (a.length + b.length)
            else None
        )
    if a.is_line or b.is_line or (a.sweep > 0.0) != (b.sweep > 0.0):
        return None
    if abs(a.centre - b.centre) > tolerance or abs(a.radius - b.radius) > tolerance:
        return None
    sweep = a.sweep + b.sweep
    is_circle = abs(abs(sweep) - 2.0 * math.pi) < 1e-9
    longer = a if abs(a.sweep) >= abs(b.sweep) else b
    return ContourElement(
        a.start,
        a.start if is_circle else b.end,
        math.copysign(2.0 * math.pi, sweep) if is_circle else sweep,
        longer.centre,
    )


def _require_simple(chain: Sequence[ContourElement], name: str, origin: complex) -> None:
    """Raise DrawingError where the curve crosses itself."""
    count = len(chain)
    for i, j in near_pairs(chain):
        a, b = chain[i], chain[j]
        shared = [
            z
            for z in (a.start, a.end)
            if min(abs(z - b.start), abs(z - b.end)) <= JOIN_MM and (j - i == 1 or j - i == count - 1)
        ]
        tolerance = max(JOIN_MM, 1e-6 * min(a.length, b.length))
        for z in intersections(a, b):
            if all(abs(z - end) > tolerance for end in shared):
                raise DrawingError(
                    f"{name}: the curve crosses itself at {at_text(z + origin)}; draw it without the crossing"
                )
