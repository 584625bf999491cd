"""Limits of the flanks that a cam may have besides its first: one row each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import degrees
from types import MappingProxyType
from typing import Any, NamedTuple

from core.cam.forms import faces_of, form_row
from core.cam.shape import OUTER, SECOND
from core.cam.sizes import ENTRIES
from core.design import Face
from core.findings import ERROR, Finding
from core.motion.extremes import Range

Extremes = Mapping[str, Range]
_RADIUS = "cam.second.roller_radius_mm"


class FlankRow(NamedTuple):
    """limits    quantities whose refined extremes its findings are taken from
    undercut  extremes, what touches it -> whether it has a cusp, or crosses itself where it is curved too much
    findings  extremes, what touches it, cam -> what is exceeded, the pressure angle aside
    pressure  its pressure angle, where that is another than the first flank's
    """

    limits: tuple[str, ...]
    undercut: Callable[[Extremes, Any], bool]
    findings: Callable[[Extremes, Any, Any], list[Finding]]
    pressure: str = ""


def _outer_undercut(extremes: Extremes, face: Any) -> bool:
    """Whether the pitch curve is somewhere so hollow that the roller with its play does not fit: κ_p (Rr + play) ≤ -1."""
    return 1e-3 * face.radius_mm * extremes["pitch_curvature"].low.value <= -1.0


def _outer(extremes: Extremes, face: Any, cam: Any) -> list[Finding]:
    if not _outer_undercut(extremes, face):
        return []
    hollow = extremes["pitch_curvature"].low
    values = {"pitch_radius_mm": -1e3 / hollow.value, "roller_radius_mm": face.radius_mm}
    return [Finding("outer-undercut", ERROR, ENTRIES[type(cam)].size, degrees(hollow.theta), values)]


def _second_undercut(extremes: Extremes, face: Any) -> bool:
    return 1e-3 * face.radius_mm * extremes["second_pitch_curvature"].high.value >= 1.0


def _second(extremes: Extremes, face: Any, cam: Any) -> list[Finding]:
    """Undercut, a second roller that meets the shaft or the first cam's hub, and one that does not push back."""
    found = []
    if _second_undercut(extremes, face):
        sharpest = extremes["second_pitch_curvature"].high
        values: dict[str, float | str] = {"pitch_radius_mm": 1e3 / sharpest.value, "roller_radius_mm": face.radius_mm}
        found.append(Finding("second-undercut", ERROR, _RADIUS, degrees(sharpest.theta), values))
    nearest = extremes["second_roller_distance"].low
    diameter, what = (cam.bore_mm, "bore") if cam.hub_mm is None else (cam.hub_mm, "hub")
    if diameter is not None and 2e3 * nearest.value <= diameter:
        values = {"distance_mm": 1e3 * nearest.value, "radius_mm": 0.5 * diameter, "what": what}
        found.append(Finding("second-roller-meets-hub", ERROR, f"cam.{what}_mm", degrees(nearest.theta), values))
    along = extremes["second_push"].high
    if along.value >= 0.0:
        found.append(Finding("second-roller-pushes-along", ERROR, "cam.form", degrees(along.theta), {}))
    return found


FLANK_ROWS: Mapping[str, FlankRow] = MappingProxyType(
    {
        OUTER: FlankRow(("pitch_curvature",), _outer_undercut, _outer),
        SECOND: FlankRow(
            ("second_pressure_angle", "second_pitch_curvature", "second_roller_distance", "second_push"),
            _second_undercut, _second, "second_pressure_angle",
        ),
    }
)  # fmt: skip


def further_flanks(face: Any, cam: Any) -> list[tuple[str, FlankRow, Face]]:
    """The flanks of a cam besides the first: name, row, and what touches it."""
    faces = faces_of(face, cam)
    return [(name, FLANK_ROWS[name], faces[name]) for name in form_row(cam.form).flanks[1:]]
