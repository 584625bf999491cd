"""Lines of one level over a grid of values."""

from __future__ import annotations

import numpy as np


def level_line(x: np.ndarray, y: np.ndarray, z: np.ndarray, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Where values z (m, n) at x (n,) and y (m,), linear on the two triangles of each cell, reach a level: x and y of pieces of two
    points, parted by NaN. A triangle with a corner that has no value has no line."""
    corners = np.stack([*np.meshgrid(x, y), z], axis=-1)
    a, b, c, d = corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]
    every = np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3)
    above = every[..., 2] > level
    through = np.isfinite(every[..., 2]).all(axis=1) & above.any(axis=1) & ~above.all(axis=1)
    cut, above = every[through], above[through]
    alone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), above.argmin(axis=1))  # on its side of the level
    row = np.arange(alone.size)
    ends = np.full((alone.size, 3, 2), np.nan)
    first = cut[row, alone]
    for i in (1, 2):
        other = cut[row, (alone + i) % 3]
        part = (level - first[:, 2]) / (other[:, 2] - first[:, 2])
        ends[:, i - 1] = first[:, :2] + part[:, None] * (other - first)[:, :2]
    return ends[..., 0].ravel(), ends[..., 1].ravel()
