"""Image or DXF drawing under the drawing of a linkage: its position, its file next to the design's, and its points."""

from __future__ import annotations

import cmath
import json
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice, pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from core.bounds import LINES, NESTING
from core.contour.drawing import PAPER_SPACE, Drawing, DrawingError, Entity, NoDrawing, as_number, read_drawing, text_of
from core.errors import DesignError, FileError
from core.frozen import frozen
from core.project import parsed
from core.project.files import read_bytes, read_text, remove, write_into

# -- lines of a DXF with its blocks -----------------------------------------------------------------------------


_PER_ROOT = 14.0  # lines of an arc of 1 rad; proportional to the root of the angle, with a sagitta of 1/500 of the size
_PER_SPAN = 8  # lines between two knots of a spline
_UP = (0.0, 0.0, 1.0)
_INSERTS = ("INSERT", "DIMENSION")
_DEGREES = range(1, 12)  # of a spline


@frozen(eq=False)
class Polylines:
    """Polylines in the units of the drawing.

    Attributes
    ----------
    points : ndarray (n, 3) [drawing units]
    starts : ndarray (m,), dimensionless
        Index of the first point of each line.
    corners : ndarray (k, 3) [drawing units]
    centres : ndarray (c, 3) [drawing units]
    """

    points: np.ndarray
    starts: np.ndarray
    corners: np.ndarray
    centres: np.ndarray

    @property
    def count(self) -> int:
        """Number of straight lines between the points."""
        return len(self.points) - len(self.starts)

    @property
    def size(self) -> int:
        """Number of lines, or half the number of corners where it is larger."""
        return max(self.count, -(-len(self.corners) // 2), len(self.centres))


_NO_POINTS = np.zeros((0, 3))
EMPTY = Polylines(_NO_POINTS, np.zeros(0, int), _NO_POINTS, _NO_POINTS)


Placement = tuple[float, ...]
"""A matrix (3, 3) by its rows, and the position (3,) of a block's base."""


@dataclass
class Layout:
    """Inserts the blocks of a drawing; notes: its omitted parts, each once."""

    drawing: Drawing
    notes: dict[str, None] = field(default_factory=dict)
    _cache: dict[str, Polylines] = field(default_factory=dict)
    _open: list[str] = field(default_factory=list)
    _work: int = 10 * LINES  # limit on the lines of all blocks
    _unreadable: int = 0

    def model(self) -> Polylines:
        """Lines of the model space."""
        with np.errstate(all="ignore"):
            lines = self._lines_of(self.drawing.entities)
        if self._unreadable:
            self.notes[f"{self._unreadable} unreadable entities are omitted"] = None
        return lines

    def _lines_of(self, entities: list[Entity]) -> Polylines:
        """Lines of entities and of the blocks that they insert, as far as the limit allows."""
        curves, count, inserts = _Curves(), 0, dict[str, list[Placement]]()
        blocks: dict[str, Polylines] = {}
        for entity in entities:
            try:
                if entity.number(PAPER_SPACE) != 0.0:
                    continue
                if entity.kind in _INSERTS:
                    name = entity.text(2, "").upper()
                    if name not in blocks:
                        blocks[name] = self._block(name)
                    size = blocks[name].size
                    placements = list(islice(_placements(entity), LINES // size + 1)) if size else []
                    inserts.setdefault(name, []).extend(placements)
                    added = size * len(placements)
                elif entity.kind in _CURVES and entity.layer.upper() not in self.drawing.hidden:
                    added = curves.add(_CURVES[entity.kind](entity), LINES)
                else:
                    continue
            except (ArithmeticError, NoDrawing, ValueError):  # an invalid number
                self._unreadable += 1
                continue
            self._work -= added
            count += added
            if self._work < 0 or count > LINES:
                self._note_limit()
                break
        parts = [
            _repeated(blocks[name], self._base(name), placements) for name, placements in inserts.items() if placements
        ]
        return self._limited(_concatenated([curves.joined(), *parts]))

    def _block(self, name: str) -> Polylines:
        if name in self._cache:
            return self._cache[name]
        if name in self._open:
            self.notes[f"block {name[:40]!r} inserts itself: it is omitted there"] = None
        elif len(self._open) >= NESTING:
            self.notes[f"blocks nested more than {NESTING} deep are omitted"] = None
        elif self._work < 0:
            self._note_limit()
        elif len(self.drawing.blocks.get(name, ())) > 1:
            self._open.append(name)
            lines = self._lines_of(self.drawing.blocks[name][1:])
            self._open.pop()
            while self._cache and sum(lines.size for lines in self._cache.values()) > 4 * LINES:
                del self._cache[next(iter(self._cache))]  # computed again on demand
            self._cache[name] = lines
            return lines
        return EMPTY

    def _base(self, name: str) -> np.ndarray:
        try:
            return np.array(_coordinates(self.drawing.blocks[name][0], 10))
        except NoDrawing:
            return np.zeros(3)

    def _limited(self, lines: Polylines) -> Polylines:
        if lines.size <= LINES:
            return lines
        self._note_limit()
        ends = np.append(lines.starts[1:], len(lines.points))
        count = int(np.searchsorted(ends - np.arange(1, ends.size + 1), LINES, side="right"))
        last = int(ends[count - 1]) if count else 0
        return Polylines(lines.points[:last], lines.starts[:count], lines.corners[: 2 * LINES], lines.centres[:LINES])

    def _note_limit(self) -> None:
        self.notes[f"more than {LINES} lines: the rest is omitted"] = None


def _placements(entity: Entity) -> Iterator[Placement]:
    """Placements of the block of an insert: one, or rows and columns."""
    if entity.kind == "DIMENSION":  # its block is in its final position
        yield (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
        return
    turn = math.radians(entity.number(50))
    c, s = math.cos(turn), math.sin(turn)
    u, v, w = (entity.number(code, 1.0) or 1.0 for code in (41, 42, 43))
    matrix: Placement = (c * u, -s * v, 0.0, s * u, c * v, 0.0, 0.0, 0.0, w)
    x, y, z = _coordinates(entity, 10)
    axes = _axes(entity)
    if axes is not None:
        matrix = tuple((axes @ np.reshape(matrix, (3, 3))).ravel().tolist())
    columns, rows, right, up = (entity.number(code, float(code > 60)) for code in (70, 71, 44, 45))
    for i in range(max(1, int(rows))):
        for j in range(max(1, int(columns))):
            dx, dy = j * right, i * up
            position: Point = (x + c * dx - s * dy, y + s * dx + c * dy, z)
            yield matrix + (position if axes is None else tuple((axes @ position).tolist()))


def _concatenated(parts: list[Polylines]) -> Polylines:
    firsts = np.cumsum([0, *(len(part.points) for part in parts[:-1])])
    return Polylines(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.starts + first for part, first in zip(parts, firsts.tolist(), strict=True)]),
        np.concatenate([part.corners for part in parts]),
        np.concatenate([part.centres for part in parts]),
    )


def _repeated(block: Polylines, base: np.ndarray, placements: Sequence[Placement]) -> Polylines:
    """A block, rotated and scaled about its base (3,), at each of its placements."""
    rows = np.array(placements)
    matrices, positions = rows[:, :9].reshape(-1, 3, 3), rows[:, 9:]
    points, corners, centres = (
        (np.einsum("pij,nj->pni", matrices, z - base) + positions[:, None]).reshape(-1, 3)
        for z in (block.points, block.corners, block.centres)
    )
    starts = (block.starts[None] + len(block.points) * np.arange(len(rows))[:, None]).ravel()
    return Polylines(points, starts, corners, centres)


# -- one entity -------------------------------------------------------------------------------------------

Point = tuple[float, ...]
Curve = tuple[Sequence[Point], Point | None]
"""Points x, y, z along a curve, and its centre."""


class _Curves:
    """A list of curves: their points, the ends of the open ones, and their centres; a single point is a corner."""

    def __init__(self) -> None:
        self._points, self._starts = list[Point](), list[int]()
        self._corners, self._centres = list[Point](), list[Point]()

    def add(self, curves: Iterable[Curve], limit: int) -> int:
        """Add the curves of an entity up to a limit on its straight lines; returns their number."""
        count = 0
        for points, centre in curves:
            if count > limit:
                break
            first, last = points[0], points[-1]
            if len(points) == 1:
                self._corners.append(first)
            elif any(point != first for point in points):
                self._starts.append(len(self._points))
                self._points += points
                self._corners += [] if math.dist(first, last) <= 1e-9 * math.dist(first, points[1]) else [first, last]
                self._centres += [] if centre is None else [centre]
                count += len(points) - 1
        return count

    def joined(self) -> Polylines:
        """All curves as polylines."""
        points, corners, centres = (
            np.array(rows, dtype=float).reshape(-1, 3) for rows in (self._points, self._corners, self._centres)
        )
        return Polylines(points, np.array(self._starts, dtype=int), corners, centres)


def _tuples(points: np.ndarray) -> list[Point]:
    return list(map(tuple, points.tolist()))


def _axes(entity: Entity) -> np.ndarray | None:
    """Axes of an entity's plane as columns (3, 3), by the arbitrary axis algorithm; None for those of the drawing."""
    if entity.upwards == _UP:
        return None
    upwards = np.array(entity.upwards)
    z = upwards / np.linalg.norm(upwards)
    x = np.cross([0.0, 1.0, 0.0] if abs(z[0]) < 1 / 64 and abs(z[1]) < 1 / 64 else [0.0, 0.0, 1.0], z)
    x /= np.linalg.norm(x)
    return np.column_stack((x, np.cross(z, x), z))


def _coordinates(entity: Entity, code: int) -> Point:
    return entity.number(code), entity.number(code + 10), entity.number(code + 20)


def _steps(begin: float, sweep: float) -> list[float]:
    """Angles [rad] along an arc."""
    count = max(4, math.ceil(_PER_ROOT * math.sqrt(abs(sweep))))
    return [begin + sweep * i / count for i in range(count + 1)]


def _in_space(axes: np.ndarray | None, points: Sequence[complex], height: float) -> list[Point]:
    """Points of a plane with these axes (None: those of the drawing) at a height above it."""
    if axes is None:
        return [(z.real, z.imag, height) for z in points]
    return [tuple((axes @ (z.real, z.imag, height)).tolist()) for z in points]


def _line(entity: Entity) -> Iterator[Curve]:
    yield (_coordinates(entity, 10), _coordinates(entity, 11)), None


def _point(entity: Entity) -> Iterator[Curve]:
    yield (_coordinates(entity, 10),), None


def _arc(entity: Entity) -> Iterator[Curve]:
    begin, sweep = 0.0, 2.0 * math.pi
    if entity.kind == "ARC":
        begin = math.radians(entity.number(50))
        sweep = math.radians((entity.number(51) - entity.number(50)) % 360.0) or sweep
    x, y, height = _coordinates(entity, 10)
    ring = [complex(x, y) + cmath.rect(entity.number(40), angle) for angle in _steps(begin, sweep)]
    *points, centre = _in_space(_axes(entity), [*ring, complex(x, y)], height)
    yield points, centre


def _ellipse(entity: Entity) -> Iterator[Curve]:
    centre, major = np.array(_coordinates(entity, 10)), np.array(_coordinates(entity, 11))
    upwards = np.array(entity.upwards)
    minor = entity.number(40, 1.0) * np.cross(upwards / np.linalg.norm(upwards), major)
    begin, end = entity.number(41), entity.number(42, 2.0 * math.pi)
    sweep = (end - begin) % (2.0 * math.pi) or 2.0 * math.pi
    angles = np.array(_steps(begin, sweep))[:, None]
    yield _tuples(centre + np.cos(angles) * major + np.sin(angles) * minor), tuple(centre.tolist())


def _light_polyline(entity: Entity) -> Iterator[Curve]:
    rows: list[list[float]] = []
    for code, text in zip(entity.codes, entity.texts, strict=True):
        if code == 10:
            rows.append([as_number(text), 0.0, 0.0])
        elif code in (20, 42) and rows:
            rows[-1][1 if code == 20 else 2] = as_number(text)
    return _vertices(rows, entity, entity.number(38))


def _polyline(entity: Entity) -> Iterator[Curve]:
    flags = int(entity.number(70))
    if flags & (16 | 64):  # a mesh
        return iter(())
    if flags & 8:
        points = [_coordinates(vertex, 10) for vertex in entity.parts]
        return ((pair, None) for pair in pairwise([*points, *(points[:1] if flags & 1 else [])]))
    rows = [[v.number(10), v.number(20), v.number(42)] for v in entity.parts if not int(v.number(70)) & 16]
    return _vertices(rows, entity, entity.number(30))


def _vertices(rows: list[list[float]], entity: Entity, height: float) -> Iterator[Curve]:
    """Lines and arcs between vertices x, y, bulge in the entity's plane."""
    closed, axes = int(entity.number(70)) & 1, _axes(entity)
    for (x0, y0, bulge), (x1, y1, _) in zip(rows, [*rows[1:], *rows[:1]] if closed else rows[1:], strict=False):
        start, end = complex(x0, y0), complex(x1, y1)
        if abs(bulge) > 1e-12 and start != end:
            middle = 0.5 * (start + end) + 0.25j * (end - start) * (1.0 - bulge * bulge) / bulge
            arc = [middle + (start - middle) * cmath.rect(1.0, a) for a in _steps(0.0, 4.0 * math.atan(bulge))]
            *points, centre = _in_space(axes, [*arc, middle], height)
            yield points, centre
        else:
            yield _in_space(axes, (start, end), height), None


def _spline(entity: Entity) -> Iterator[Curve]:
    from scipy.interpolate import BSpline, make_interp_spline

    knots, degree = np.array(entity.numbers(40)), int(entity.number(71, 3.0))
    poles, through = (np.column_stack([entity.numbers(first + 10 * i) for i in range(3)]) for first in (10, 11))
    if len(poles) < 2 <= len(through):
        parameter = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(through, axis=0), axis=1)))
        curve, low, high, spans = (
            make_interp_spline(parameter, through, min(3, len(through) - 1)),
            0.0,
            parameter[-1],
            len(through),
        )
    else:
        weights = np.array(entity.numbers(41) or [1.0] * len(poles))
        if degree not in _DEGREES or len(knots) != len(poles) + degree + 1 or len(weights) != len(poles):
            raise NoDrawing("a spline whose knots do not fit its poles")
        curve = BSpline(knots, np.column_stack((poles * weights[:, None], weights)), degree)
        low, high, spans = knots[degree], knots[-degree - 1], len(poles) - degree
    if not high > low:
        raise NoDrawing("a spline without length")
    points = curve(np.linspace(low, high, min(_PER_SPAN * max(spans, 3), LINES // 4) + 1))
    yield _tuples(points[:, :3] / points[:, 3:] if points.shape[1] == 4 else points), None


_CURVES: Mapping[str, Callable[[Entity], Iterator[Curve]]] = MappingProxyType(
    {
        "LINE": _line, "POINT": _point, "ARC": _arc, "CIRCLE": _arc, "ELLIPSE": _ellipse, "LWPOLYLINE": _light_polyline,
        "POLYLINE": _polyline, "SPLINE": _spline,
    }
)  # fmt: skip
"""Readers of the entities."""


# -- underlay ---------------------------------------------------------------------------------------------------


IMAGES = (".png", ".jpg", ".jpeg", ".svg")
DXF = ".dxf"
ENDINGS = (*IMAGES, DXF)
_UNITS_MM = {1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0}  # $INSUNITS -> mm
_RANGES = {
    "x_mm": (-1e6, 1e6), "y_mm": (-1e6, 1e6), "scale_mm_per_unit": (1e-9, 1e6), "angle_deg": (-360.0, 360.0), "opacity": (0.0, 1.0),
}  # fmt: skip


@frozen
class Underlay:
    """Position of an image or DXF drawing in the plane of the linkage.

    x_mm, y_mm: its origin (the lower left corner of an image, the origin of a DXF); scale_mm_per_unit: length of its
    unit (a pixel of an image); angle_deg: its rotation.
    """

    file: Path
    x_mm: float = 0.0
    y_mm: float = 0.0
    scale_mm_per_unit: float = 1.0
    angle_deg: float = 0.0
    opacity: float = 0.5
    locked: bool = False

    @property
    def _unit(self) -> complex:
        return cmath.rect(self.scale_mm_per_unit, math.radians(self.angle_deg))

    def to_plane(self, z: Any) -> Any:
        """Points (n,) complex of the underlay [its units] in the plane of the linkage [mm]."""
        return complex(self.x_mm, self.y_mm) + self._unit * z

    def shifted(self, shift: complex) -> Underlay:
        """The underlay shifted [mm]."""
        return replace(self, x_mm=self.x_mm + shift.real, y_mm=self.y_mm + shift.imag)

    def scaled(self, first: complex, second: complex, distance_mm: float) -> Underlay:
        """The underlay scaled about a first point [mm] to a distance from a second point. Raises DrawingError."""
        if first == second or not distance_mm > 0.0:
            raise DrawingError(
                f"distance {distance_mm:g} mm between two points of the underlay; allowed: above 0, between different points"
            )
        factor = distance_mm / abs(second - first)
        return replace(self._with_fixed(first, factor), scale_mm_per_unit=self.scale_mm_per_unit * factor)

    def rotated(self, first: complex, second: complex, angle_deg: float) -> Underlay:
        """The underlay rotated about a first point [mm] so that the line to a second point has an angle."""
        rotation = angle_deg - math.degrees(cmath.phase(second - first))
        angle = math.remainder(self.angle_deg + rotation, 360.0)
        return replace(self._with_fixed(first, cmath.rect(1.0, math.radians(rotation))), angle_deg=angle)

    def _with_fixed(self, point: complex, factor: complex) -> Underlay:
        origin = point + (complex(self.x_mm, self.y_mm) - point) * factor
        return replace(self, x_mm=origin.real, y_mm=origin.imag)


# -- file next to the design ------------------------------------------------------------------------------


def sidecar(design: Path) -> Path:
    """File that stores the underlay of a design's file."""
    return design.with_suffix(".underlay.toml")


def read_underlay(design: Path) -> Underlay | None:
    """The underlay of a design's file; None without one. Raises FileError."""
    path = sidecar(design)
    if not path.is_file():
        return None
    try:
        table = parsed(read_text(path), str(path))
    except DesignError as error:
        raise FileError(f"{error}; correct it, or delete it") from None
    file, locked = table.pop("file", None), table.pop("locked", False)
    if not isinstance(file, str) or not file:
        raise FileError(f"{path}: file: enter the name of an image or drawing: {' | '.join(ENDINGS)}")
    if not isinstance(locked, bool):
        raise FileError(f"{path}: locked: {locked!r}; allowed: true | false")
    for name, value in table.items():
        if name not in _RANGES:
            raise FileError(f"{path}: {name}: unknown; allowed: file, {', '.join(_RANGES)}, locked")
        low, high = _RANGES[name]
        if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
            raise FileError(f"{path}: {name}: {value!r}; allowed: {low:g} ... {high:g}")
    return Underlay(path.parent / file, **{name: float(value) for name, value in table.items()}, locked=locked)


def save_underlay(design: Path, underlay: Underlay | None) -> None:
    """Write the underlay next to the design's file; None removes it.

    Raises FileError, also where the present file is no underlay, or is to be removed and was edited by hand.
    """
    path = sidecar(design)
    before = read_underlay(design)
    if underlay is not None:
        write_into(path.parent, {path.name: _text(path.parent, underlay)})
    elif before is not None:
        if read_text(path) != _text(path.parent, before):
            raise FileError(f"{path}: was not written by this program; delete it")
        remove(path)


def _text(folder: Path, underlay: Underlay) -> str:
    try:
        file = Path(os.path.relpath(underlay.file, folder)).as_posix()
    except ValueError:  # on another drive
        file = underlay.file.as_posix()
    rows = [f"file = {json.dumps(file, ensure_ascii=False)}"]
    rows += [f"{name} = {getattr(underlay, name)!r}" for name in _RANGES]
    return "\n".join([*rows, f"locked = {str(underlay.locked).lower()}"]) + "\n"


# -- DXF --------------------------------------------------------------------------------------------------


@frozen(eq=False)
class DxfLines:
    """Lines of a DXF.

    Attributes
    ----------
    lines : tuple of ndarray (n,) complex [drawing units]
    corners, centres : ndarray (k,) complex [drawing units]
    unit_mm : length of a unit [mm], 1 where the header states none
    notes : omitted parts, a line each
    """

    lines: tuple[np.ndarray, ...]
    corners: np.ndarray
    centres: np.ndarray
    unit_mm: float
    notes: tuple[str, ...] = ()


def read_lines(path: Path) -> DxfLines:
    """Lines of the model space of a DXF with its blocks, without layers that are off or frozen.

    Raises FileError, DrawingError.
    """
    data = read_bytes(path)
    try:
        drawing = read_drawing(text_of(data))
    except NoDrawing as error:
        raise DrawingError(
            f"{path.name}: not a DXF drawing in text form ({' '.join(str(error).split())[:120]})"
        ) from None
    layout = Layout(drawing)
    polylines = layout.model()
    lines = np.split(_flat(polylines.points), polylines.starts[1:]) if polylines.starts.size else []
    corners, centres = (np.unique(_flat(points)) for points in (polylines.corners, polylines.centres))
    return DxfLines(tuple(lines), corners, centres, _UNITS_MM.get(drawing.unit, 1.0), tuple(layout.notes))


def _flat(points: np.ndarray) -> np.ndarray:
    """Points (n, 3) in the plane, complex; rounded below a drawing's precision, so that common ends are one corner."""
    known = points[np.isfinite(points).all(axis=1)] if len(points) else points
    return np.round(known[:, 0], 9) + 1j * np.round(known[:, 1], 9) + 0.0


def snap_points(underlay: Underlay) -> tuple[np.ndarray, np.ndarray]:
    """Corners and centres of a DXF in the plane of the linkage. Raises FileError, DrawingError.

    Parameters
    ----------
    underlay : Underlay

    Returns
    -------
    corners, centres : ndarray (n,) complex [mm], ndarray (k,) complex [mm]
    """
    lines = read_lines(underlay.file)
    return underlay.to_plane(lines.corners), underlay.to_plane(lines.centres)
