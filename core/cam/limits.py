"""Limits of a cam: pressure angle and undercut."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from types import MappingProxyType

from core.design import RollerCam, si
from core.extremes import Range
from core.findings import ERROR, WARNING, Finding
from core.train import REVOLUTE, SLIDING

# usual limits for cams in machine shops: VDI 2142, Norton ch. 7; by the pair that holds the follower
PRESSURE_LIMITS: Mapping[str, float] = MappingProxyType({SLIDING: 30.0, REVOLUTE: 45.0})


def findings(extremes: Mapping[str, Range], ground: str, cam: RollerCam) -> list[Finding]:
    """What the refined extremes of pressure angle [rad] and pitch curvature [1/m] exceed; ground: kind of the pair
    that holds the follower."""
    found = []
    worst, limit = extremes["pressure_angle"].high, PRESSURE_LIMITS[ground]
    degrees = worst.value * 180.0 / pi
    if degrees > limit:
        values = {"value": degrees, "limit": limit}
        found.append(Finding("pressure-angle", WARNING, "cam.base_radius_mm", worst.theta * 180.0 / pi, values))
    sharpest, radius = extremes["pitch_curvature"].high, si(cam).roller_radius
    if radius * sharpest.value >= 1.0:
        values = {"pitch_radius_mm": 1e3 / sharpest.value, "roller_radius_mm": cam.roller_radius_mm}
        found.append(Finding("undercut", ERROR, "cam.roller_radius_mm", sharpest.theta * 180.0 / pi, values))
    return found
