"""The points as CSV: cam angle, place and polar coordinates; and what the table is, beside it."""

from __future__ import annotations

import numpy as np

from core.output.export import csv
from core.output.profile.drawing import ProfileDrawing

COLUMNS = ("cam_angle_deg", "x_mm", "y_mm", "radius_mm", "polar_angle_deg")


def written(job: ProfileDrawing) -> bytes:
    """The table, to be read as a closed polyline."""
    at = job.main.points
    z = at.ends.z
    polar = np.mod(np.rad2deg(np.angle(z)), 360.0)
    columns = [at.degrees, z.real, z.imag, np.abs(z), np.where(polar >= 360.0, 0.0, polar)]
    return csv(COLUMNS, [column + 0.0 for column in columns]).encode()  # no minus zero


__all__ = ["written"]
