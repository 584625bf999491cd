"""Limits of a cam: pressure angle and undercut."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees
from types import MappingProxyType

import numpy as np

from core.design import LinkageCam, RollerCam, si
from core.errors import NoCam
from core.findings import ERROR, WARNING, Finding
from core.mechanism.kinematics import REVOLUTE, SLIDING, Kinematics
from core.motion import EPS
from core.motion.extremes import Range
from core.numerics.vectors import dot

# usual limits for cams in machine shops: VDI 2142, Norton ch. 7; by the pair that holds the follower
PRESSURE_LIMITS: Mapping[str, float] = MappingProxyType({SLIDING: 30.0, REVOLUTE: 45.0})

# a cam under a linkage has the size that the linkage gives it
PRESSURE_FIELDS: Mapping[type, tuple[str, str]] = MappingProxyType(
    {RollerCam: ("pressure-angle", "cam.base_radius_mm"), LinkageCam: ("roller-pressure-angle", "cam.point")}
)

ROUNDING = 1e-12  # relative accuracy of a channel: a radius found for the limit itself does not exceed it
NO_DRIVE = 89.0  # from here on the cam cannot move the follower, whatever the force


def findings(extremes: Mapping[str, Range], ground: str, cam: RollerCam | LinkageCam) -> list[Finding]:
    """What the refined extremes of pressure angle [rad] and pitch curvature [1/m] exceed; ground: kind of the pair
    that holds the follower."""
    found = []
    worst, limit = extremes["pressure_angle"].high, PRESSURE_LIMITS[ground]
    angle = degrees(worst.value)
    if angle > limit * (1.0 + ROUNDING):
        values = {"value": angle, "limit": limit}
        severity = ERROR if angle > NO_DRIVE else WARNING
        code, field = PRESSURE_FIELDS[type(cam)]
        found.append(Finding(code, severity, field, degrees(worst.theta), values))
    if undercut(extremes, cam):
        sharpest = extremes["pitch_curvature"].high
        values = {"pitch_radius_mm": 1e3 / sharpest.value, "roller_radius_mm": cam.roller_radius_mm}
        found.append(Finding("undercut", ERROR, "cam.roller_radius_mm", degrees(sharpest.theta), values))
    return found


def undercut(extremes: Mapping[str, Range], cam: RollerCam | LinkageCam) -> bool:
    """Whether the pitch curve is somewhere no blunter than the roller: there the profile has a cusp, or crosses itself."""
    return bool(si(cam).roller_radius * extremes["pitch_curvature"].high.value >= 1.0)


def require_hold(kinematics: Kinematics) -> None:
    """The roller of a linkage must come nearer to the cam centre or go away from it somewhere in a turn.

    Else the cam is a circle about its own centre, every contact normal goes through that, and no torque of the cam moves
    the linkage: NoCam.
    """
    reference = kinematics.follower.origin[0]
    with np.errstate(invalid="ignore"):  # no travel where the roller stands still
        hold = np.abs(dot(kinematics.travel, reference)) / np.abs(reference)
    if not (hold > 16.0 * EPS * kinematics.condition).any():
        raise NoCam(
            "the roller keeps its distance from the cam centre, so no cam can move it", "cam.point",
            "choose another point",
        )  # fmt: skip
