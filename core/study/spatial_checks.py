"""Checks of a cam in space over the turn: pressure angle, undercut, rib, rollers in the blank, and the limits of the user."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import degrees

import numpy as np

from core.cam import PRESSURE_LIMITS
from core.cam.checks import STRETCHES
from core.cam.forms import NO_DRIVE, ROUNDING
from core.findings import ERROR, WARNING, Finding
from core.mechanism.kinematics import REVOLUTE, SLIDING
from core.motion import TURN
from core.motion.extremes import Extreme, Extremes, piecewise_angles
from core.spatial import KINDS, rib_thickness
from core.study.extremes import extremes_of
from core.study.quantities import names_of
from core.study.study import Study

SAMPLES, FAR = 181, 0.25
"""Cam angles at which flanks and ribs are first judged, and the margin of a flank above which it is not judged further."""

CHECKED = ("pressure_angle", "surface_curvature", "flank_margin", "rib_wall")
"""Quantities of the cam from which the findings follow."""


def checked_quantities(study: Study) -> tuple[str, ...]:
    """Those of ``CHECKED`` that the design has."""
    names = names_of(study.design)
    return tuple(name for name in CHECKED if name in names)


def surface_extremes(study: Study) -> Mapping[str, Extremes]:
    """Refined extremes of the quantities from which the findings follow, in SI units."""
    return extremes_of(study, "cam", checked_quantities(study))


def typical_pressure_limit(study: Study) -> float:
    """Typical limit of the pressure angle [deg], by whether the output slides or turns."""
    return PRESSURE_LIMITS[SLIDING if study.machine.slides else REVOLUTE]


def has_edge(study: Study) -> bool:
    """Whether a flank of the cam is undercut."""
    return surface_extremes(study)["flank_margin"].low.value <= 0.0


def shape_errors(study: Study) -> list[str]:
    """Codes of findings because of which a cam in space cannot be made: an edge, a rib without thickness, a turret that is free."""
    first = study.at(study.program.angles(np.linspace(0.0, TURN, SAMPLES)))
    margin = float(first.surface.margin_at(np.linspace(study.machine.inner, study.machine.outer, 5)).min())
    distance = np.array([np.inf])
    if "rib_wall" in checked_quantities(study):
        distance = rib_thickness(study.machine, first.surface.motion, study.motion_rows, study.sense, refined=False)
    far = margin > FAR and not np.any(distance <= 0.0)
    return [finding.code for finding in (*(() if far else _edge_findings(study)), *_free_findings(study))]


def spatial_findings(study: Study) -> Iterator[Finding]:
    """Findings of the stage ``cam`` of a cam in space, except the limits of the user.

    Parameters
    ----------
    study : Study

    Yields
    ------
    Finding

    Raises
    ------
    NoCam
        As the stage does.
    """
    worst, limit = surface_extremes(study)["pressure_angle"].high, typical_pressure_limit(study)
    angle = degrees(worst.value)
    if angle > limit * (1.0 + ROUNDING):
        severity = ERROR if angle > NO_DRIVE else WARNING
        values: dict[str, float | str] = {"value": angle, "limit": limit, "face": study.machine.kind}
        yield Finding("pressure-angle", severity, KINDS[study.machine.kind].size, degrees(worst.theta), values)
    yield from _edge_findings(study)
    yield from _free_findings(study)
    yield from _open_groove_findings(study)


def _edge_findings(study: Study) -> Iterator[Finding]:
    """Flanks that are undercut, and a rib whose flanks cross."""
    extremes, cam, row = surface_extremes(study), study.design.drive.cam, KINDS[study.machine.kind]
    if has_edge(study):
        margin = extremes["flank_margin"].low
        values: dict[str, float | str] = {
            "face": study.machine.kind,
            "roller_radius_mm": cam.roller_radius_mm,
            "remedy": row.gentler,
        }
        yield Finding("undercut", ERROR, "cam.roller_radius_mm", degrees(margin.theta), values)
    if "rib_wall" in extremes and (thinnest := extremes["rib_wall"].low).value <= 0.0:
        values = {"thickness_mm": 1e3 * thinnest.value}
        yield Finding("rib-vanishes", ERROR, "cam.roller_radius_mm", degrees(thinnest.theta), values)


def _free_findings(study: Study) -> Iterator[Finding]:
    """Cam angles at which fewer than two rollers are on a rib between neighbours of a turret."""
    machine = study.machine
    if not (machine.is_turret and machine.is_rib):
        return
    angles = piecewise_angles(study.program)
    touching = study.at(angles).surface.touching
    if touching.min() < 2:
        at = float(angles.theta[int(np.argmin(touching))])
        yield Finding("turret-free", ERROR, "cam.length_mm", degrees(at), {"count": float(touching.min())})


def axis_heights(study: Study) -> tuple[Extreme, Extreme]:
    """Heights of the roller's axis along the axis of the cam [m] at the least and the greatest motion, with their angles."""
    y, machine = extremes_of(study, "motion", ("displacement",))["displacement"], study.machine
    ends = y.low, y.high
    heights = KINDS[machine.kind].axes[machine.unit](machine, np.array([end.value for end in ends])).c[2]
    low, high = (Extreme(float(height), end.theta) for height, end in zip(heights, ends, strict=True))
    return low, high


def _open_groove_findings(study: Study) -> Iterator[Finding]:
    """Groove of one roller on a cylinder that leaves the blank through an end; the flank ahead is above the roller."""
    machine = study.machine
    if machine.length is None or machine.is_turret or machine.is_rib or not machine.is_cylindrical:
        return
    ends = axis_heights(study)
    heights = np.array([end.value for end in ends])
    middle = float(heights.mean()) if machine.slides else 0.0
    radius = max(float(machine.roller_radius(u)) for u in (machine.inner, machine.outer))
    reach = np.abs(heights - middle) + radius + np.where(heights > middle, 0.0, machine.play)
    farthest = int(np.argmax(reach))
    if reach[farthest] > 0.5 * machine.length:
        values: dict[str, float | str] = {"reach_mm": 1e3 * float(reach[farthest]), "half_mm": 500.0 * machine.length}
        yield Finding("groove-leaves-blank", WARNING, "cam.length_mm", degrees(ends[farthest].theta), values)


def pressure_limit_findings(study: Study, worst: Mapping[str, Extreme]) -> Iterator[Finding]:
    """Pressure angles beyond the limits of the user.

    Parameters
    ----------
    study : Study
    worst : mapping of str -> Extreme
        ``rise`` or ``return`` -> the greatest pressure angle [rad] there.

    Yields
    ------
    Finding
    """
    row = KINDS[study.machine.kind]
    for stretch in (stretch for stretch in STRETCHES if stretch in worst):
        limit, angle = (
            getattr(study.design.drive.limits, f"pressure_angle_{stretch}_deg"),
            degrees(worst[stretch].value),
        )
        if limit is not None and angle > limit * (1.0 + ROUNDING):
            values: dict[str, float | str] = {"value": angle, "limit": limit}
            values["remedy"] = f"{row.gentler}, or lengthen the {stretch}"
            yield Finding(f"pressure-angle-{stretch}", WARNING, row.size, degrees(worst[stretch].theta), values)


def convex_radius_findings(study: Study) -> Iterator[Finding]:
    """Convex radius of a flank below the limit of the user."""
    limit, sharpest = study.design.drive.limits.convex_radius_mm, surface_extremes(study)["surface_curvature"].high
    if limit is not None and sharpest.value > 0.0 and 1e3 / sharpest.value < limit * (1.0 - ROUNDING):
        values: dict[str, float | str] = {
            "value": 1e3 / sharpest.value,
            "limit": limit,
            "whose": "your limit",
            "why": "",
        }
        yield Finding("convex-radius", WARNING, KINDS[study.machine.kind].size, degrees(sharpest.theta), values)
