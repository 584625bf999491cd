"""Points of a path: of a stroke, or of a file with a table or a drawing."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from core.contour import ContourElement, read_curve
from core.errors import FileError
from core.measured.sheet import dialect, number, split_cells
from core.project.files import read_bytes, read_text
from core.synthesis.curves import evenly_spaced
from core.synthesis.task import PathPoint, TracedPath

CSV, DXF = ENDINGS = (".csv", ".dxf")
STROKE_POINTS, CURVE_POINTS = 36, 96
"""Points, evenly spaced by length, of a stroke, and of the curve of a drawing."""
DETECTED = 500
"""Lines of a table from which its delimiter and its decimal mark are detected."""
CLOSES = 0.12
"""Distance of the ends of a stroke, of its size, below which it is closed."""
X, Y = "x_mm", "y_mm"
"""Columns of a table, or their endings behind the name of a point, as in ``B_x_mm``."""


def traced_path(points: np.ndarray, closed: bool) -> TracedPath:
    """Path of points.

    Parameters
    ----------
    points : ndarray (n,) complex [mm]
    closed : bool
    """
    return TracedPath(points=tuple(PathPoint(z.real, z.imag) for z in points.tolist()), closed=closed)


def stroke_path(stroke: np.ndarray) -> TracedPath | None:
    """Path along a stroke of the mouse, or along many points, closed where it returns to its start; None where it has no length.

    Parameters
    ----------
    stroke : ndarray (n,) complex [mm]
    """
    z = stroke[np.append(True, np.abs(np.diff(stroke)) > 0.0)]
    if z.size < 4:
        return None
    size = float(np.hypot(np.ptp(z.real), np.ptp(z.imag)))
    closed = bool(abs(z[-1] - z[0]) < CLOSES * size)
    return traced_path(np.round(_even(np.append(z, z[0]) if closed else z, STROKE_POINTS, closed), 3), closed)


def _even(points: np.ndarray, count: int, closed: bool) -> np.ndarray:
    """Points (count,) [mm] evenly spaced by length along a polyline; the last point of a closed one repeats the first."""
    even, _ = evenly_spaced(points[None], np.zeros((1, points.size)), count, closed=closed)
    return even[0]


def read_path(path: Path, *, closed: bool = False, point: str = "") -> TracedPath:
    """Path in a file.

    Parameters
    ----------
    path : Path
        A ``.csv`` with x and y in mm, where rows without two numbers are skipped: in the columns ``x_mm`` and ``y_mm``, or ``P_x_mm`` and
        ``P_y_mm`` of a point P as ``linkage.csv`` has them, in a table without such columns in the first two; its delimiter and decimal
        mark are detected. Or a ``.dxf`` with one curve of lines and arcs, whose points are evenly spaced by length.
    closed : bool
        The last point is joined to the first, also where a drawn curve is open.
    point : str
        Name of the point, where a table has the columns of several.

    Raises
    ------
    FileError
        The file cannot be read, has another ending, has no points, or those of several.
    DrawingError
        The drawing has no curve, or more than one.
    """
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise FileError(f"{path}: no points of a path; allowed: {' | '.join(ENDINGS)}")
    if ending == DXF:
        elements, is_closed = read_curve(read_bytes(path), path.name)
        return traced_path(_along(elements, is_closed), is_closed or closed)
    lines = [line for line in read_text(path).splitlines() if line.strip()]
    delimiter, decimal = dialect(lines[:DETECTED])
    rows = [split_cells(line, delimiter) for line in lines]
    x, y = _columns(rows[0] if rows else [], point, path)
    points = [complex(*numbers) for row in rows if (numbers := _numbers(row, x, y, decimal)) is not None]
    if not points:
        raise FileError(f"{path}: has no points; columns with x and y in mm are needed")
    return traced_path(np.array(points), closed)


def _columns(header: Sequence[str], point: str, path: Path) -> tuple[int, int]:
    """Numbers of the columns of x and y."""
    names = [name.strip() for name in header]
    points = [name.removesuffix(X).removesuffix("_") for name in names if name.endswith(X)]
    points = [name for name in points if (f"{name}_{Y}" if name else Y) in names]
    if point and point not in points:
        listed = ", ".join(filter(None, points)) or "none"
        raise FileError(f"{path}: has no columns {point}_{X} and {point}_{Y}; points in this table: {listed}")
    if not points:
        return 0, 1
    if len(points) > 1 and not point and "" not in points:
        raise FileError(f"{path}: has the points {', '.join(points)}; state one of them as path.point")
    prefix = f"{point}_" if point else "" if "" in points else f"{points[0]}_"
    return names.index(f"{prefix}{X}"), names.index(f"{prefix}{Y}")


def _numbers(row: Sequence[str], x: int, y: int, decimal: str) -> tuple[float, float] | None:
    if len(row) <= max(x, y):
        return None
    first, second = number(row[x], decimal), number(row[y], decimal)
    return None if first is None or second is None else (first, second)


def _along(elements: Sequence[ContourElement], closed: bool) -> np.ndarray:
    """Points (CURVE_POINTS,) [mm] of a curve, evenly spaced by length."""
    ends = np.append(0.0, np.cumsum([element.length for element in elements]))
    at = np.linspace(0.0, ends[-1], CURVE_POINTS, endpoint=not closed)
    index = np.clip(np.searchsorted(ends, at, side="right") - 1, 0, len(elements) - 1)
    parts = (at - ends[index]) / np.diff(ends)[index]
    return np.array([complex(elements[i].at(part)) for i, part in zip(index.tolist(), parts.tolist(), strict=True)])
