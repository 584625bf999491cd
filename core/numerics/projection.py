"""Points in space as they look on paper."""

from __future__ import annotations

import numpy as np

ISOMETRIC = (45.0, float(np.rad2deg(np.arctan(np.sqrt(0.5)))))
"""Turn about the upright axis and tilt [deg] under which all three axes look equally long."""


def seen_from(points: np.ndarray, turn_deg: float, tilt_deg: float) -> np.ndarray:
    """Points (n, 3) as they look (n,), complex, x to the right: turned about the upright axis z, then tilted towards the eye."""
    turn, tilt = np.deg2rad((turn_deg, tilt_deg))
    x, y, z = np.asarray(points, dtype=float).T
    right = x * np.cos(turn) + y * np.sin(turn)
    away = -x * np.sin(turn) + y * np.cos(turn)
    return np.asarray(right + 1j * (z * np.cos(tilt) + away * np.sin(tilt)))
