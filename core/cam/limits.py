"""Limits of a cam: its pressure angle, and what its face adds."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees
from types import MappingProxyType
from typing import Any

import numpy as np

from core.cam.faces import LeastAt, row_of
from core.cam.flank_checks import further_flanks
from core.cam.forms import path_by_driver
from core.cam.shape import SECOND, CamShape
from core.cam.sizes import ENTRIES, SecondEntry
from core.errors import NoCam
from core.findings import ERROR, WARNING, Finding
from core.mechanism.kinematics import REVOLUTE, SLIDING, Kinematics
from core.motion import EPS
from core.motion.extremes import Range
from core.numerics.vectors import dot

# usual limits for cams in machine shops: VDI 2142, Norton ch. 7; by the pair that holds the follower
PRESSURE_SOURCE = "VDI 2142; Norton ch. 7"
PRESSURE_LIMITS: Mapping[str, float] = MappingProxyType({SLIDING: 30.0, REVOLUTE: 45.0})

ROUNDING = 1e-12  # relative accuracy of a channel: a radius found for the limit itself does not exceed it
NO_DRIVE = 89.0  # from here on the cam cannot move the follower, whatever the force


def findings(extremes: Mapping[str, Range], ground: str, face: Any, cam: Any, least_at: LeastAt) -> list[Finding]:
    """What the refined extremes of pressure angle [rad] and of the face's own quantities exceed; ground: kind of the pair
    that holds the follower; least_at: quantity, base radius [mm] -> its refined least value with that one."""
    found = []
    worst, limit = extremes["pressure_angle"].high, PRESSURE_LIMITS[ground]
    angle = degrees(worst.value)
    if angle > limit * (1.0 + ROUNDING):
        values: dict[str, float | str] = {"value": angle, "limit": limit}
        severity = ERROR if angle > NO_DRIVE else WARNING
        row, (what, field) = ENTRIES[type(cam)], row_of(face).steep
        if what:
            values |= {"face": face.face, "what": what}
        found.append(Finding(row.pressure, severity, field or row.size, degrees(worst.theta), values))
    return found + row_of(face).findings(extremes, face, cam, least_at)


def limits_of(face: Any, cam: Any) -> tuple[str, ...]:
    """The quantities whose refined extremes the findings of a cam are taken from; the radius where hub or bore are known."""
    further = [name for _, row, _ in further_flanks(face, cam) for name in row.limits]
    inside = [] if cam.hub_mm is cam.bore_mm is None else ["radius"]
    return tuple(dict.fromkeys((*row_of(face).limits, *further, *inside)))


def further_findings(
    extremes: Mapping[str, Range], grounds: Mapping[str, str], face: Any, cam: Any, second: SecondEntry | None
) -> list[Finding]:
    """What the flanks besides the first exceed; grounds: kind of the pair that holds what touches each; second: the entry of the second
    roller."""
    found = []
    for name, row, touching in further_flanks(face, cam):
        if row.pressure:
            worst, limit = extremes[row.pressure].high, PRESSURE_LIMITS[grounds[name]]
            angle = degrees(worst.value)
            if angle > limit * (1.0 + ROUNDING) and second is not None:
                severity = ERROR if angle > NO_DRIVE else WARNING
                values: dict[str, float | str] = {"value": angle, "limit": limit, "remedy": second.remedy}
                found.append(Finding(f"{name}-pressure-angle", severity, second.field, degrees(worst.theta), values))
        found += row.findings(extremes, touching, cam)
    return found


def undercut(extremes: Mapping[str, Range], flank: str, face: Any, cam: Any) -> bool:
    """Whether a flank has a cusp, or crosses itself where it is curved too much for what touches it."""
    further = {
        name: row.undercut(extremes, touching) for name, row, touching in further_flanks(face, cam) if name == flank
    }
    return further[flank] if further else row_of(face).undercut(extremes, face)


def require_hold(kinematics: Kinematics, noun: str, shape: CamShape) -> None:
    """The roller of a linkage, or another face of that ``noun``, must come nearer to the cam centre or go away from it somewhere
    in a turn; so must the second roller of a conjugate pair.

    Else the cam is a circle about its own centre, every contact normal goes through that, and no torque of the cam moves
    the linkage: NoCam.
    """
    held = [(noun, "cam.point", kinematics.follower.origin[0], kinematics.travel)]
    held += [
        ("second roller", "cam.second.point", flank.reference, path_by_driver(kinematics, flank))
        for flank in shape.flanks
        if flank.name == SECOND
    ]
    for name, field, reference, path in held:
        with np.errstate(invalid="ignore", divide="ignore"):  # no travel where the roller stands still
            hold = np.abs(dot(path / np.abs(path), reference)) / np.abs(reference)
        if not (hold > 16.0 * EPS * kinematics.condition).any():
            raise NoCam(
                f"the {name} keeps its distance from the cam centre, so no cam can move it",
                field,
                "choose another point",
            )
