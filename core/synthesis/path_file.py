"""Points of a path in a file: a table of two columns in mm, or the curve of a drawing."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from core.errors import FileError
from core.project.files import read_text

ENDINGS = (".csv",)


def read_path(path: Path) -> np.ndarray:
    """Points of a path.

    Parameters
    ----------
    path : Path
        A ``.csv`` with x and y in mm in its first two columns; rows without two numbers, such as a heading, are skipped.

    Returns
    -------
    ndarray (n,) complex [mm]

    Raises
    ------
    FileError
        The file cannot be read, has another ending, or has no points.
    """
    if path.suffix.lower() not in ENDINGS:
        raise FileError(f"{path}: no table of points; allowed: {' | '.join(ENDINGS)}")
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
