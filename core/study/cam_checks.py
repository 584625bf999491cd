"""Checks of a cam over the full turn, and its figures with their limits.

They are the pressure angle on rise and return, the smallest radii, hub, bore and cutter, and crossings of the profile.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import degrees, isfinite, nan
from typing import NamedTuple

import numpy as np

from core import cam
from core.cam import checks
from core.findings import Finding
from core.motion import TURN, Angles
from core.motion.extremes import Extreme, Extremes, find_extremes, piecewise_angles
from core.study import quantity_requests
from core.study.extremes import cam_extremes, has_undercut
from core.study.limits import POLAR, USER, USER_BOUNDS, LimitValue, limit_of, needs_torque, worst_values
from core.study.quantities import quantities_of
from core.study.stages import memory
from core.study.study import Study
from core.units import split_unit

_PRESSURE_ANGLE = "pressure_angle"
CLEARANCE = 1.05  # times a limit: samples beyond it need no refining
_SAMPLES = 181  # between two cam angles, to see whether the profile runs backwards between them


def pressure_angles(study: Study) -> Mapping[str, Mapping[str, Extremes]]:
    """Refined extremes of the pressure angle [rad]: quantity of a flank -> ``rise`` or ``return`` -> extremes.

    Stretches that the motion lacks are left out.
    """

    def compute() -> Mapping[str, Mapping[str, Extremes]]:
        rows = {name: row for name, row in quantities_of(study, "cam").items() if name.endswith(_PRESSURE_ANGLE)}

        def values(angles: Angles) -> Mapping[str, np.ndarray]:
            at_angles = study.at(angles)
            velocity_sign = at_angles.motion.velocity_sign
            pressure_angle = {name: row.value(at_angles) for name, row in rows.items()}
            return {
                f"{name} {stretch}": np.where(velocity_sign == sign, value, nan)
                for name, value in pressure_angle.items()
                for stretch, sign in checks.STRETCHES.items()
            }

        extremes = find_extremes(values, study.program)
        result: dict[str, dict[str, Extremes]] = {name: {} for name in rows}
        for name in rows:
            for stretch in checks.STRETCHES:
                if isfinite(extremes[f"{name} {stretch}"].high.value):
                    result[name][stretch] = extremes[f"{name} {stretch}"]
        return result

    result: Mapping[str, Mapping[str, Extremes]] = memory.get("pressure angles", study.depends_on("cam"), compute)
    return result


def smallest_radii(study: Study) -> tuple[cam.Radius, ...]:
    """Smallest radii of curvature of profile and pitch curve [m], convex and concave."""
    drive = study.design.drive
    return cam.smallest_radii(cam_extremes(study), drive.face, drive.cam)


def profile_crossings(study: Study, flank: str) -> tuple[cam.Crossing, ...]:
    """Crossings of a flank with itself, except those of an undercut; empty where the motion jumps: the profile is not closed."""
    if any(join.jumps[0] for join in study.program.joins):
        return ()

    def flank_at(theta: np.ndarray) -> cam.Flank:
        return study.at_theta(theta).cam.only(flank).flank

    corners = [join.theta for join in study.program.joins if join.jumps[1]]

    def is_reversed_between(first: float, second: float) -> bool:
        """Whether the profile runs backwards on the shorter path between two cam angles; a corner counts as an undercut."""
        ends = (first, second) if second - first <= 0.5 * TURN else (second, first + TURN)
        if any(ends[0] <= corner + turns <= ends[1] for corner in corners for turns in (0.0, TURN)):
            return True
        return bool(checks.is_reversed(flank_at(np.linspace(*ends, _SAMPLES) % TURN)).any())

    def compute() -> tuple[cam.Crossing, ...]:
        angles = piecewise_angles(study.program)
        profile = study.at(angles).cam.only(flank).flank.profile
        return checks.without_undercut(cam.crossings(flank_at, angles.theta, profile), is_reversed_between)

    result: tuple[cam.Crossing, ...] = memory.get(("crossings", flank), study.depends_on("cam"), compute)
    return result


def cam_findings(study: Study) -> list[Finding]:
    """Findings of the checks in this module that need no forces."""
    drive = study.design.drive
    limits, blank, face = drive.limits, drive.cam, drive.face
    findings: list[Finding] = []
    if any(getattr(limits, f"pressure_angle_{stretch}_deg") is not None for stretch in checks.STRETCHES):
        second = cam.second_entry(drive.mechanism, blank)
        for name, stretches in pressure_angles(study).items():
            worst = {stretch: extremes.high for stretch, extremes in stretches.items()}
            entry = second if name != _PRESSURE_ANGLE else None
            findings += checks.pressure_findings(worst, limits, face, blank, entry)
    findings += checks.radius_findings(smallest_radii(study), _radius_limits(study), blank)
    findings += checks.cutter_findings(smallest_radii(study), face, blank)
    findings += _hub_findings(study)
    for flank in cam.form_row(blank.form).flanks:
        if not blank.form.holds or flank == cam.SECOND:
            findings += checks.crossing_findings(flank, profile_crossings(study, flank), blank)
    return findings


def surface_limit_findings(study: Study) -> list[Finding]:
    """Limits of the user that a cam in space exceeds, except those of quantities."""
    from core.study import spatial_checks  # few designs have a cam in space

    limits, findings = study.design.drive.limits, list(spatial_checks.convex_radius_findings(study))
    if any(getattr(limits, f"pressure_angle_{stretch}_deg") is not None for stretch in checks.STRETCHES):
        worst = {stretch: extremes.high for stretch, extremes in pressure_angles(study)[_PRESSURE_ANGLE].items()}
        findings += spatial_checks.pressure_limit_findings(study, worst)
    return findings


def _radius_limits(study: Study) -> Mapping[str, checks.LeastRadius]:
    """Limits of the convex and of the concave radius, by sort.

    A typical limit is left out where the profile is undercut, which has its own finding.
    """
    is_undercut = has_undercut(study)
    limits = {sort: limit_of(study, f"{sort}_radius_mm") for sort in ("convex", "concave")}
    return {
        sort: _least_radius(limit)
        for sort, limit in limits.items()
        if limit is not None and not (is_undercut and limit.source != USER)
    }


def _least_radius(limit: LimitValue) -> checks.LeastRadius:
    if limit.source == USER:
        return checks.LeastRadius(limit.value, "your limit")
    return checks.LeastRadius(limit.value, "limit", f" ({limit.reason})")


def least_distance(study: Study) -> Extreme:
    """Least distance of the profiles from the cam centre [m], refined."""

    def compute() -> Extreme:
        extremes = find_extremes(lambda angles: _distances(study.at(angles)), study.program)
        return min((e.low for e in extremes.values()), key=lambda extreme: extreme.value)

    result: Extreme = memory.get("nearest", study.depends_on("cam"), compute)
    return result


def _distances(study: Study) -> Mapping[str, np.ndarray]:
    """Flank -> distance of its profile from the cam centre (n,) [m]; without the outer flank of a groove, which is farther."""
    return {flank.name: np.abs(flank.profile) for flank in study.cam.flanks if flank.name != cam.OUTER}


def _hub_findings(study: Study) -> list[Finding]:
    """A profile that cuts hub, bore or keyway, or leaves no room for them."""
    blank = study.design.drive.cam
    if checks.inner_circles(blank):
        least = cam_extremes(study)["radius"].low
        findings = checks.hub_findings(least, blank)
        if not findings and least.value <= checks.keyway_reach(blank):

            def wall(angles: Angles) -> Mapping[str, np.ndarray]:
                return {"wall": checks.keyway_clearance(study.at(angles).cam.flank.profile, blank)}

            findings = checks.keyway_findings(find_extremes(wall, study.program)["wall"].low, blank)
        if findings:
            return findings
    return [] if needs_torque(study) else _room_findings(study)


def _room_findings(study: Study) -> list[Finding]:
    """A profile that leaves no room for hub or shaft; the least distance is refined where samples are near the limit."""
    drive = study.design.drive

    def compute() -> list[Finding]:
        sampled = study.at(piecewise_angles(study.program))
        rough = limit_of(sampled, POLAR)
        if rough is None or 1e3 * min(d.min() for d in _distances(sampled).values()) > CLEARANCE * rough.value:
            return []
        limit = limit_of(study, POLAR)
        if limit is None:
            return []
        return checks.least_findings("polar-radius", least_distance(study), _least_radius(limit), drive.cam)

    stage = "dynamics" if needs_torque(study) else "cam"
    key = study.depends_on(stage), drive.cam, drive.limits.polar_radius_mm
    findings: list[Finding] = memory.get("room", key, compute)
    return findings


def shaft_room_findings(study: Study) -> list[Finding]:
    """A cam without room for a shaft that transmits the torque, where the limit follows from the torque."""
    return _room_findings(study) if needs_torque(study) else []


# -- figures with their limits -----------------------------------------------------------------------------


class LimitRow(NamedTuple):
    """A figure of a cam with its limit.

    Attributes
    ----------
    name : str
        Slug, which ends with the unit.
    label, unit : str
    value, cam_angle_deg : float
        Worst value in the unit, refined, and its cam angle.
    limit : float or None
        Limit in the unit; None where there is none.
    source : str
        ``own`` for the user's limit, else the source of the typical one.
    """

    name: str
    label: str
    unit: str
    value: float
    cam_angle_deg: float
    limit: float | None
    source: str


_CURVES = {"profile": "of the profile", "pitch": "of the pitch curve", "outer": "of the outer flank",
           "second": "of the second profile", "second_pitch": "of the second pitch curve"}  # fmt: skip


def limit_rows(study: Study, stages: Sequence[str]) -> Iterator[LimitRow]:
    """Figures of a cam in the named stages, with the user's limits, or else typical ones."""
    if "cam" in stages and study.has_disk:
        yield from _shape_rows(study, stages)
    elif "cam" in stages and study.has_surface:
        yield from _surface_rows(study)
    for stage in (stage for stage in stages if stage in study.stages):
        for key, limit, worst in worst_values(study, stage):
            unit = key.removeprefix(f"{split_unit(key)[0]}_")
            yield LimitRow(key, USER_BOUNDS[key][0].label, unit, worst.value, degrees(worst.theta), limit, USER)
    if "dynamics" in stages and (pressures := quantity_requests.peak_pressures(study)):
        greatest = max(pressures.values(), key=lambda extreme: extreme.value)
        yield _row(study, "contact_pressure_mpa", "Contact pressure", 1e-6 * greatest.value, greatest)


def _shape_rows(study: Study, stages: Sequence[str]) -> Iterator[LimitRow]:
    for name, stretches in pressure_angles(study).items():
        roller = "" if name == _PRESSURE_ANGLE else " of the second roller"
        body = None if name == _PRESSURE_ANGLE else study.cam.only(cam.SECOND).flank.body
        for stretch, extremes in stretches.items():
            key, label = f"pressure_angle_{stretch}_deg", f"Pressure angle{roller}, {stretch}"
            worst = extremes.high
            row = _row(study, key, label, degrees(worst.value), worst, f"{name}_{stretch}_deg")
            if body is not None and row.source != USER:
                row = row._replace(limit=cam.PRESSURE_LIMITS[study.frame_pair_kind(body)])
            yield row
    for radius in smallest_radii(study):
        sort = "concave" if radius.is_concave else "convex"
        label = f"Smallest {sort} radius {_CURVES[radius.curve]}"
        key = f"{sort}_radius_mm" if radius.is_on_profile else ""
        yield _row(study, key, label, 1e3 * radius.smallest.value, radius.smallest, f"{radius.name}_mm")
    if "dynamics" in stages or not needs_torque(study):
        least = least_distance(study)
        yield _row(study, POLAR, "Least distance of the profile from the cam centre", 1e3 * least.value, least)


def _surface_rows(study: Study) -> Iterator[LimitRow]:
    from core.study import spatial_checks  # as above

    for stretch, extremes in pressure_angles(study)[_PRESSURE_ANGLE].items():
        key = f"pressure_angle_{stretch}_deg"
        yield _row(study, key, f"Pressure angle, {stretch}", degrees(extremes.high.value), extremes.high)
    surfaces = spatial_checks.surface_extremes(study)
    if (sharpest := surfaces["surface_curvature"].high).value > 0.0:
        yield _row(study, "convex_radius_mm", "Smallest convex radius of a flank", 1e3 / sharpest.value, sharpest)
    if "rib_wall" in surfaces:
        thinnest = surfaces["rib_wall"].low
        yield _row(study, "", "Least thickness of a rib", 1e3 * thinnest.value, thinnest, "rib_thickness_mm")


def _row(study: Study, key: str, label: str, value: float, at: Extreme, name: str = "") -> LimitRow:
    """A figure in the unit of its name (the key, where it is empty), with the limit of the key, where there is one."""
    limit, name = limit_of(study, key) if key else None, name or key
    value_and_source = (None, "") if limit is None else (limit.value, limit.source)
    return LimitRow(name, label, name.rpartition("_")[2], value, degrees(at.theta), *value_and_source)
