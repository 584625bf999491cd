"""A small reader of binary STL files: triangles, their open sides, and the volume they enclose."""

import struct
from collections import Counter
from pathlib import Path

import numpy as np


def read_stl(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Normals (n, 3) and corners (n, 3, 3) of a binary STL file."""
    content = path.read_bytes()
    (count,) = struct.unpack_from("<I", content, 80)
    assert len(content) == 84 + 50 * count
    rows = np.frombuffer(content, dtype=[("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")], offset=84)
    return rows["n"].astype(float), rows["p"].astype(float)


def open_sides(corners: np.ndarray) -> int:
    """Number of sides of triangles that no other triangle has in the opposite direction."""
    indices: dict[tuple[float, ...], int] = {}
    rows = [[indices.setdefault(tuple(corner), len(indices)) for corner in triangle] for triangle in corners.tolist()]
    sides = Counter((row[i], row[(i + 1) % 3]) for row in rows for i in range(3))
    assert max(sides.values()) == 1
    return sum(1 for a, b in sides if (b, a) not in sides)


def enclosed_volume(corners: np.ndarray) -> float:
    """Volume in closed triangles (n, 3, 3) by the divergence theorem."""
    return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6.0
