"""Points of a path in a file: a table of two columns in mm, or the curve of a drawing."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from core.contour import ContourElement, read_outline
from core.errors import FileError
from core.project.files import read_bytes, read_text

CSV, DXF = ENDINGS = (".csv", ".dxf")
CURVE_POINTS = 96
"""Points, evenly spaced by length, of the curve of a drawing."""


def read_path(path: Path) -> np.ndarray:
    """Points of a path.

    Parameters
    ----------
    path : Path
        A ``.csv`` with x and y in mm in its first two columns, where rows without two numbers, such as a heading, are skipped; or a
        ``.dxf`` with one closed curve of lines and arcs, whose points are evenly spaced by length.

    Returns
    -------
    ndarray (n,) complex [mm]

    Raises
    ------
    FileError
        The file cannot be read, has another ending, or has no points.
    DrawingError
        The drawing has no closed curve, or more than one.
    """
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise FileError(f"{path}: no points of a path; allowed: {' | '.join(ENDINGS)}")
    if ending == DXF:
        return _along(read_outline(read_bytes(path), path.name))
    text = read_text(path)
    dialect = ";" if text.count(";") > text.count(",") else ","
    points = []
    for row in csv.reader(io.StringIO(text), delimiter=dialect):
        try:
            points.append(complex(float(row[0]), float(row[1])))
        except (ValueError, IndexError):
            continue
    if not points:
        raise FileError(f"{path}: has no points; two columns with x and y in mm are needed")
    return np.array(points)


def _along(elements: Sequence[ContourElement]) -> np.ndarray:
    """Points (CURVE_POINTS,) [mm] of a closed curve, evenly spaced by length."""
    ends = np.cumsum([element.length for element in elements])
    at = ends[-1] * np.arange(CURVE_POINTS) / CURVE_POINTS
    index = np.searchsorted(ends, at, side="right")
    starts = np.append(0.0, ends)
    parts = zip(index.tolist(), ((at - starts[index]) / np.diff(starts)[index]).tolist(), strict=True)
    return np.array([complex(elements[i].at(part)) for i, part in parts])
