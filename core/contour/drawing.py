"""A closed curve of lines and arcs read from a DXF drawing."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from core.bounds import ROWS, bounded_float
from core.contour.elements import ContourElement, arc, arc_of_bulge, area, line, meetings, near_pairs, sampled, winding
from core.design.fields import LONGEST_MM
from core.errors import KindynaError
from core.frozen import frozen
from core.units import conversion_factor

# -- A DXF file in text form, tag by tag ------------------------------------------------------------------------


COMMENT, UNIT_CODE, PAPER_SPACE = 999, "$INSUNITS", 67
_PARTS = ("VERTEX", "SEQEND")  # of the POLYLINE before them


class NoDrawing(ValueError):
    """The text is no DXF file; the message says why."""


@frozen(eq=False)
class Entity:
    """An entity: its tags in order, group code and text; parts: the vertices of a POLYLINE."""

    kind: str
    codes: Sequence[int]
    texts: Sequence[str]
    parts: list[Entity]

    @property
    def layer(self) -> str:
        """Name of the layer; ``0`` where the file states none."""
        return self.text(8, "0")

    def text(self, code: int, otherwise: str) -> str:
        """Of the first tag of a group code."""
        return self.texts[self.codes.index(code)].strip() if code in self.codes else otherwise

    def number(self, code: int, otherwise: float = 0.0) -> float:
        """The same as a number. Raises NoDrawing."""
        return as_number(self.text(code, str(otherwise)))

    def point(self, code: int) -> complex:
        """x and y: y's group code is 10 more."""
        return complex(self.number(code), self.number(code + 10))

    @property
    def upwards(self) -> tuple[float, float, float]:
        """The direction in which it is seen as it is drawn."""
        return self.number(210), self.number(220), self.number(230, 1.0)

    def numbers(self, code: int) -> list[float]:
        """The numbers of all tags of a group code. Raises NoDrawing."""
        return [as_number(text) for each, text in zip(self.codes, self.texts, strict=True) if each == code]


@frozen(eq=False)
class Drawing:
    """What is read of a file: $INSUNITS, 0 where it is not stated; entities of the model space; name of a block in capitals -> its
    entities, the first of which is the block itself; names in capitals of layers that are off or frozen."""

    unit: int
    entities: list[Entity]
    blocks: Mapping[str, list[Entity]]
    hidden: frozenset[str]


def as_number(text: str) -> float:
    """The number of a tag. Raises NoDrawing where it is none, or larger than any drawing's."""
    try:
        value = bounded_float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= LONGEST_MM:
        raise NoDrawing(f"{text.strip()[:40]} is no number of a drawing; allowed: {-LONGEST_MM:g} ... {LONGEST_MM:g}")
    return value


def read_dxf(text: str) -> tuple[int, list[Entity]]:
    """$INSUNITS, 0 where it is not stated, and the entities. Raises NoDrawing."""
    drawing = read_drawing(text)
    return drawing.unit, [each for each in drawing.entities if each.number(PAPER_SPACE) == 0.0]


def read_drawing(text: str) -> Drawing:
    """The drawing in a text, entities of the paper space among the others. Raises NoDrawing."""
    if max(text.count("\n"), text.count("\r")) > 2 * ROWS:
        raise NoDrawing(f"more than {ROWS} group codes; save what is needed of it alone")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n").split("\n")
    try:
        codes = [int(line) for line in lines[::2]]
    except ValueError as error:
        raise NoDrawing(f"a group code is wanted: {str(error)[:80]}") from None
    texts = lines[1::2]
    unit, entities, inside = 0, list[Entity](), ""
    blocks, hidden = dict[str, list[Entity]](), set[str]()
    block: list[Entity] = []
    for kind, first, last in _blocks(codes, texts):
        if kind == "SECTION":
            inside = texts[first].strip() if first < last else ""
            if inside == "HEADER":
                unit = _header_unit(texts[first:last])
        elif kind == "ENDSEC":
            inside = ""
        elif inside in ("ENTITIES", "BLOCKS", "TABLES"):
            entity = Entity(kind, codes[first:last], texts[first:last], [])
            if inside == "TABLES":
                if kind == "LAYER" and _is_hidden(entity):
                    hidden.add(entity.text(2, "").upper())
                continue
            if kind == "BLOCK":
                block = blocks[entity.text(2, "").upper()] = []
            into = entities if inside == "ENTITIES" else block
            if kind not in _PARTS:
                into.append(entity)
            elif kind == "VERTEX" and into:
                into[-1].parts.append(entity)
    if inside or not codes or codes[0] not in (0, COMMENT):
        raise NoDrawing(f"section {inside} has no end" if inside else "it begins with no section")
    return Drawing(unit, entities, blocks, frozenset(hidden))


def _is_hidden(layer: Entity) -> bool:
    """Whether a layer is off, which its negative colour says, or frozen."""
    try:
        return layer.number(62) < 0.0 or bool(int(layer.number(70)) & 1)
    except NoDrawing:
        return False


def _blocks(codes: Sequence[int], texts: Sequence[str]) -> Iterator[tuple[str, int, int]]:
    """What group code 0 names, and from where to where its tags go."""
    begins = [i for i, code in enumerate(codes[: len(texts)]) if code == 0]
    for begin, end in pairwise([*begins, len(texts)]):
        yield texts[begin].strip().upper(), begin + 1, end


def _header_unit(header: Sequence[str]) -> int:
    for name, value in pairwise(header):
        if name.strip() == UNIT_CODE:
            return int(as_number(value))
    return 0


# -- A closed curve of lines and arcs read from a DXF drawing ---------------------------------------------------


JOIN_MM = 1e-4
"""Ends of lines and arcs that are no farther apart are one point."""
GAP_MM, MOST_GAP_MM = 0.002, 1.0
"""Ends that belong to no other join over so much, usually and at most: CAD writes three decimals."""
BREAK, MOST_BREAK = math.radians(0.01), math.radians(0.05)
"""Tangents that break by less [rad] count as going on: drawings round their numbers; and at most, where ends join over a gap."""
LAYERS = ("PROFILE", "PROFILE_INNER")
"""The layers that count where they have a curve: of a cam, and of a groove the wall within."""
UNITS = ("mm", "cm", "in")
"""That may be chosen."""
_HEADER: Mapping[int, str] = MappingProxyType({1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"})
"""$INSUNITS of the header -> unit."""
_REFUSED = ("SPLINE", "ELLIPSE")
_SAME = 1e-10  # relative: centres and radii of one circle
_ROUNDING_MM = 1e-7  # of ends that meet
MOST_ELEMENTS = 20_000
MOST_NEAR = 50  # ends within the gap of an end, on average


class DrawingError(KindynaError):
    """A drawing holds no curve that a follower can be rolled over."""


@frozen(eq=False)
class Contour:
    """A closed curve about the cam centre, which is the origin [mm], counter-clockwise.

    name, layer  of the file and where it stood
    unit         of the drawing
    centre       of the cam, in the drawing [mm]
    smooth       tangents that break by less [rad] count as going on
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
    """The closed curve of a DXF file; unit: key of ``UNITS``, empty as the header says; centre of the cam in the drawing's
    units, None for its origin; gap_mm: over which ends join.

    Raises DrawingError where there is no such curve, or more than one, where it crosses itself, in units that are not known,
    and where the centre does not lie inside of it.
    """
    if not 0.0 <= gap_mm <= MOST_GAP_MM:
        raise DrawingError(f"{name}: gap {gap_mm:g} mm between ends; allowed: 0 ... {MOST_GAP_MM:g} mm")
    code, drawn = _opened(data, name)
    label, size = _unit(code, name, unit)
    layer, entities = _entities(drawn, name)
    origin = (centre or 0j) * size
    pieces = [piece.moved(-origin, size) for entity in entities for piece in _pieces(entity, name)]
    if len(pieces) > MOST_ELEMENTS:
        raise DrawingError(f"{name}: {len(pieces)} lines and arcs are too many; allowed: {MOST_ELEMENTS}")
    chain = _closed(pieces, name, layer, origin, gap_mm)
    elements = _meeting(chain)
    _require_simple(elements, name, origin)
    if winding(elements, 0j) == 0:
        raise DrawingError(
            f"{name}: the cam centre {at_text(origin)} lies outside the curve; give the centre where the cam turns about"
        )
    return Contour(tuple(elements), name, layer, label, origin, _smooth(chain, elements))


def at_text(z: complex) -> str:
    """A point as text, without the minus of a zero."""
    x, y = (round(value, 6) + 0.0 for value in (z.real, z.imag))
    return f"({x:.6g}, {y:.6g}) mm"


# -- the file ---------------------------------------------------------------------------------------------


def _opened(data: bytes, name: str) -> tuple[int, list[Entity]]:
    """Code of the unit, and the entities of the model space."""
    try:
        return read_dxf(text_of(data))
    except NoDrawing as error:
        reason = " ".join(str(error).split())[:120]
        raise DrawingError(f"{name}: not a DXF drawing in text form ({reason}); save it as ASCII DXF") from error


def text_of(data: bytes) -> str:
    """The text of a drawing's bytes, in whichever encoding."""
    for encoding in ("utf-8", "cp1252"):
        try:
            return data.decode(encoding)
        except UnicodeDecodeError:
            continue
    return data.decode("latin-1")


def _unit(code: int, name: str, unit: str) -> tuple[str, float]:
    """The unit of the drawing, and how many millimetres one is."""
    if not unit and code not in _HEADER:
        stated = "states no unit" if code == 0 else f"states the unit {code} in $INSUNITS, which is not known here"
        raise DrawingError(f"{name}: its header {stated}; state the unit: {' | '.join(UNITS)}")
    name_of_unit = unit or _HEADER[code]
    return name_of_unit, conversion_factor(name_of_unit, "mm")


def _entities(drawn: Sequence[Entity], name: str) -> tuple[str, list[Entity]]:
    """The curves of the model space: of the first of ``LAYERS`` that has any, else of all layers, and of which."""
    curves = [each for each in drawn if each.kind in (*_READERS, *_REFUSED)]
    preferred = ([each for each in curves if each.layer.upper() == layer] for layer in LAYERS)
    chosen = next(filter(None, preferred), curves)
    for each in chosen:
        if each.kind in _REFUSED:
            raise DrawingError(
                f"{name}: {each.kind} on layer {each.layer!r}: only lines, arcs, circles and polylines are read; save the curve "
                "as arcs or as a polyline (a profile from here: as tangent arcs)"
            )
    if not chosen:
        raise DrawingError(
            f"{name}: no closed curve: no line, arc, circle or polyline in the model space; explode blocks"
        )
    return ", ".join(sorted({each.layer for each in chosen})), chosen


def _pieces(entity: Entity, name: str) -> list[ContourElement]:
    """Lines and arcs of an entity, in the plane of the drawing."""
    what = f"{name}: {entity.kind} on layer {entity.layer!r}"
    try:
        x, y, z = entity.upwards
        if abs(x) > 1e-9 or abs(y) > 1e-9:
            raise DrawingError(f"{what} does not lie in the xy plane; draw it there")
        pieces = [each for each in _READERS[entity.kind](entity) if each.length > 0.0]
    except NoDrawing as error:
        raise DrawingError(f"{what}: {error}") from error
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
    return _vertices([(each.point(10), each.number(42)) for each in entity.parts], _is_closed(entity))


def _is_closed(entity: Entity) -> bool:
    return bool(int(entity.number(70)) & 1)


def _vertices(rows: Sequence[tuple[complex, float]], closed: bool) -> Iterator[ContourElement]:
    for (start, bulge), (end, _) in zip(rows, [*rows[1:], *rows[:1]] if closed else rows[1:], strict=False):
        if start != end:
            yield arc_of_bulge(start, end, bulge)


_READERS: Mapping[str, Callable[[Entity], Iterator[ContourElement]]] = MappingProxyType(
    {"LINE": _line, "ARC": _arc, "CIRCLE": _circle, "LWPOLYLINE": _light_polyline, "POLYLINE": _polyline}
)
"""One row for each entity that is read."""


# -- the curve --------------------------------------------------------------------------------------------


def _closed(
    pieces: Sequence[ContourElement], name: str, layer: str, origin: complex, gap: float
) -> list[ContourElement]:
    """The one closed chain of the pieces, counter-clockwise, neighbours of one line or circle made one; their ends as drawn."""
    loops, parts = [[each] for each in pieces if _is_whole(each)], [each for each in pieces if not _is_whole(each)]
    partners = _partners(parts, name, origin, gap)
    loops += _chains(parts, partners)
    if not loops:
        raise DrawingError(f"{name}: no closed curve: {_least_gap(parts, partners, origin, gap)}")
    if len(loops) > 1:
        raise DrawingError(
            f"{name}: {len(loops)} closed curves on layer {layer}; leave one, or put the cam's profile on a layer {LAYERS[0]}"
        )
    (chain,) = loops
    if area(chain) < 0.0:
        chain = [each.reversed() for each in reversed(chain)]
    return _made_one(chain)


def _is_whole(each: ContourElement) -> bool:
    return abs(each.sweep) >= 2.0 * math.pi - 1e-12


def _ends(pieces: Sequence[ContourElement]) -> np.ndarray:
    """Start and end of each (2k,): the other end of end i is that of number i ^ 1."""
    return np.array([z for each in pieces for z in (each.start, each.end)])


def _partners(pieces: Sequence[ContourElement], name: str, origin: complex, gap: float) -> dict[int, int]:
    """End -> the end that it joins: the nearest first, none farther than the gap. Raises DrawingError where more than two meet."""
    if not pieces:
        return {}
    from scipy.spatial import cKDTree

    ends = _ends(pieces)
    places = np.column_stack((ends.real, ends.imag))
    tree, same = cKDTree(places), min(JOIN_MM, gap)
    third = tree.query(places, k=3)[0][:, 2]  # itself, another, one more
    if third.min() <= same:
        i = int(np.argmin(third))
        meet = tree.query_ball_point(places[i], same, return_length=True)
        raise DrawingError(
            f"{name}: {meet} ends of lines and arcs meet at {at_text(ends[i] + origin)}; leave two of them"
        )
    if tree.count_neighbors(tree, gap) > MOST_NEAR * len(places):
        raise DrawingError(f"{name}: too many ends within the gap of {gap:g} mm; join over a narrower one")
    i, j = tree.query_pairs(gap, output_type="ndarray").T
    alone = (i // 2 == j // 2) & (
        np.array([each.length for each in pieces])[i // 2] <= 2.0 * gap
    )  # both ends of a short piece
    i, j = i[~alone], j[~alone]
    partners: dict[int, int] = {}
    for k in np.lexsort((j, i, np.abs(ends[i] - ends[j]))).tolist():
        one, other = int(i[k]), int(j[k])
        if one not in partners and other not in partners:
            partners |= {one: other, other: one}
    return partners


def _chains(pieces: Sequence[ContourElement], partners: Mapping[int, int]) -> list[list[ContourElement]]:
    """Closed chains of pieces whose ends join; pieces that belong to none are left out."""
    loops, used = [], set[int]()
    for first in range(len(pieces)):
        chain: list[ContourElement] = []
        end = 2 * first
        while end // 2 not in used:
            used.add(end // 2)
            piece = pieces[end // 2]
            chain.append(piece if end % 2 == 0 else piece.reversed())
            other = end ^ 1
            if other not in partners:
                chain = []
                break
            end = partners[other]
        if chain and end == 2 * first:
            loops.append(chain)
    return loops


def _least_gap(pieces: Sequence[ContourElement], partners: Mapping[int, int], origin: complex, gap: float) -> str:
    """The two free ends that are next to each other, and how far they are apart."""
    ends = np.delete(_ends(pieces), list(partners)) if pieces else np.zeros(0)
    if ends.size < 2:
        return (
            "the lines and arcs do not form one" if pieces else "its lines, arcs, circles and polylines have no length"
        )
    from scipy.spatial import cKDTree

    places = np.column_stack((ends.real, ends.imag))
    apart, nearest = cKDTree(places).query(places, k=2)
    i = int(np.argmin(apart[:, 1]))
    one, other = at_text(ends[i] + origin), at_text(ends[nearest[i, 1]] + origin)
    return f"the ends {one} and {other} are {apart[i, 1]:.4g} mm apart, more than {gap:g} mm; close it, or join over a wider gap"


def _meeting(chain: Sequence[ContourElement]) -> list[ContourElement]:
    """Ends that are next to each other put on one point."""
    if len(chain) == 1 and _is_whole(chain[0]):
        return list(chain)
    joints = [_joint(a, b) for a, b in zip(chain, [*chain[1:], chain[0]], strict=True)]
    return [_between(each, joints[i - 1], joints[i]) for i, each in enumerate(chain)]


def _joint(a: ContourElement, b: ContourElement) -> complex:
    """Where one goes over into the next: over a gap at the end of a circle about the cam centre, which stays a dwell, else of the longer
    arc; else between them."""
    if abs(a.end - b.start) <= _ROUNDING_MM or (a.is_line and b.is_line):
        return a.end if a.end == b.start else 0.5 * (a.end + b.start)
    return a.end if _weight(a) >= _weight(b) else b.start


def _weight(each: ContourElement) -> tuple[bool, float]:
    return not each.is_line and abs(each.centre) <= _ROUNDING_MM, abs(each.sweep) * each.radius


def _between(each: ContourElement, start: complex, end: complex) -> ContourElement:
    """An element between ends that have been moved a little: an arc goes through them, but keeps its circle where that is rounding."""
    if each.is_line or max(abs(start - each.start), abs(end - each.end)) <= _ROUNDING_MM:
        return each.with_ends(start, end)
    return arc_of_bulge(start, end, math.tan(0.25 * each.sweep))


def _smooth(drawn: Sequence[ContourElement], chain: Sequence[ContourElement]) -> float:
    """Tangents that break by less count as going on [rad]: two elements turn by as much as their ends were moved for their length."""
    turned = (
        2.0 * max(abs(b.start - a.start), abs(b.end - a.end)) / b.length for a, b in zip(drawn, chain, strict=True)
    )
    return max(BREAK, min(2.0 * max(turned), MOST_BREAK))


def _made_one(chain: list[ContourElement]) -> list[ContourElement]:
    """Neighbours on one circle, or one line, as one element; an arc may take the whole turn."""
    size = max(float(np.abs(sampled(chain)).max()), 1e-300)
    done: list[ContourElement] = []
    for each in chain:
        if done and (one := _one(done[-1], each, size)) is not None:
            done[-1] = one
        else:
            done.append(each)
    while len(done) > 1 and (one := _one(done[-1], done[0], size)) is not None:
        done = [one, *done[1:-1]]
    return done


def _one(a: ContourElement, b: ContourElement, size: float) -> ContourElement | None:
    room = _SAME * size + 2.0 * abs(a.end - b.start)  # as good as they were drawn
    if a.is_line and b.is_line:
        straight = abs(complex(a.tangent(0.0)) - complex(b.tangent(0.0))) <= _SAME
        return (
            ContourElement(a.start, b.end) if straight and abs(b.end - a.start) > 0.5 * (a.length + b.length) else None
        )
    if a.is_line or b.is_line or (a.sweep > 0.0) != (b.sweep > 0.0):
        return None
    if abs(a.centre - b.centre) > room or abs(a.radius - b.radius) > room:
        return None
    sweep = a.sweep + b.sweep
    whole = abs(abs(sweep) - 2.0 * math.pi) < 1e-9
    longer = a if abs(a.sweep) >= abs(b.sweep) else b
    return ContourElement(
        a.start, a.start if whole else b.end, math.copysign(2.0 * math.pi, sweep) if whole else sweep, longer.centre
    )


def _require_simple(chain: Sequence[ContourElement], name: str, origin: complex) -> None:
    """Raises DrawingError where the curve crosses itself."""
    count = len(chain)
    for i, j in near_pairs(chain):
        a, b = chain[i], chain[j]
        shared = [
            z
            for z in (a.start, a.end)
            if min(abs(z - b.start), abs(z - b.end)) <= JOIN_MM and (j - i == 1 or j - i == count - 1)
        ]
        room = max(JOIN_MM, 1e-6 * min(a.length, b.length))
        for z in meetings(a, b):
            if all(abs(z - end) > room for end in shared):
                raise DrawingError(
                    f"{name}: the curve crosses itself at {at_text(z + origin)}; draw it without the crossing"
                )
