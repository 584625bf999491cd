"""The checks of a cam that go through the whole turn: pressure angle on rise and return, smallest radii, hub, bore and cutter,
and the profile against itself; and all its limits side by side."""

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
from core.study.extremes import cam_extremes, undercut_on
from core.study.limits import OWN, OWN_BOUNDS, POLAR, UsualValue, by_torque, limit_of, worst_of
from core.study.quantities import quantities_of
from core.study.stages import memory
from core.study.study import Study
from core.units import split_unit

_UNDER = "pressure_angle"
CLEAR = 1.05  # times a limit: what samples leave needs no refining
_SAMPLES = 181  # between two cam angles, to see whether the profile runs backwards there


def pressure_angles(study: Study) -> Mapping[str, Mapping[str, Extremes]]:
    """Refined extremes of the pressure angle [rad] of each flank that has one of its own (name of the quantity), by stretch of the
    motion: ``rise`` and ``return``, as far as there is one."""

    def compute() -> Mapping[str, Mapping[str, Extremes]]:
        rows = {name: row for name, row in quantities_of(study, "cam").items() if name.endswith(_UNDER)}

        def values(angles: Angles) -> Mapping[str, np.ndarray]:
            there = study.at(angles)
            sign = there.motion.velocity_sign
            each = {name: row.value(there) for name, row in rows.items()}
            return {
                f"{name} {stretch}": np.where(sign == way, value, nan)
                for name, value in each.items()
                for stretch, way in checks.STRETCHES.items()
            }

        found = find_extremes(values, study.program)
        there = {name: {stretch: found[f"{name} {stretch}"] for stretch in checks.STRETCHES} for name in rows}
        return {
            name: {key: each for key, each in by.items() if isfinite(each.high.value)} for name, by in there.items()
        }

    found: Mapping[str, Mapping[str, Extremes]] = memory.get("pressure angles", study.depends_on("cam"), compute)
    return found


def radii(study: Study) -> tuple[cam.Radius, ...]:
    """The smallest radii of curvature of profile and pitch curve [m], convex and concave."""
    drive = study.design.drive
    return cam.smallest_radii(cam_extremes(study), drive.face, drive.cam)


def crossings(study: Study, flank: str) -> tuple[cam.Crossing, ...]:
    """Where a flank crosses itself, that of an undercut aside. None where the motion jumps, so that no profile is closed."""
    if any(join.jumps[0] for join in study.program.joins):
        return ()

    def flank_at(theta: np.ndarray) -> cam.Flank:
        return study.at_theta(theta).cam.only(flank).flank

    corners = [join.theta for join in study.program.joins if join.jumps[1]]

    def is_reversed_between(first: float, second: float) -> bool:
        """On the shorter way; a corner of the pitch curve counts as an undercut."""
        ends = (first, second) if second - first <= 0.5 * TURN else (second, first + TURN)
        if any(ends[0] <= corner + turns <= ends[1] for corner in corners for turns in (0.0, TURN)):
            return True
        return bool(checks.is_reversed(flank_at(np.linspace(*ends, _SAMPLES) % TURN)).any())

    def compute() -> tuple[cam.Crossing, ...]:
        angles = piecewise_angles(study.program)
        profile = study.at(angles).cam.only(flank).flank.profile
        return checks.without_undercut(cam.crossings(flank_at, angles.theta, profile), is_reversed_between)

    found: tuple[cam.Crossing, ...] = memory.get(("crossings", flank), study.depends_on("cam"), compute)
    return found


def findings(study: Study) -> list[Finding]:
    """What the cam exceeds besides the usual limits."""
    drive = study.design.drive
    limits, blank, face = drive.limits, drive.cam, drive.face
    found: list[Finding] = []
    if any(getattr(limits, f"pressure_angle_{stretch}_deg") is not None for stretch in checks.STRETCHES):
        second = cam.second_entry(drive.mechanism, blank)
        for name, by in pressure_angles(study).items():
            worst = {stretch: each.high for stretch, each in by.items()}
            found += checks.pressure_findings(worst, limits, face, blank, second if name != _UNDER else None)
    found += checks.radius_findings(radii(study), _least_radii(study), blank)
    found += checks.cutter_findings(radii(study), face, blank)
    found += _core_findings(study)
    for flank in cam.form_row(blank.form).flanks:
        if not blank.form.holds or flank == cam.SECOND:
            found += checks.crossing_findings(flank, crossings(study, flank), blank)
    return found


def _least_radii(study: Study) -> Mapping[str, checks.LeastRadius]:
    """Sort of a radius of curvature -> its limit; where the profile is undercut its least convex radius is 0, which is said already."""
    undercut = any(undercut_on(study, flank) for flank in cam.form_row(study.design.drive.cam.form).flanks)
    found = {sort: limit_of(study, f"{sort}_radius_mm") for sort in ("convex", "concave")}
    return {
        sort: _least(usual)
        for sort, usual in found.items()
        if usual is not None and not (undercut and usual.source != OWN)
    }


def _least(usual: UsualValue) -> checks.LeastRadius:
    return (
        checks.LeastRadius(usual.value, "your own limit")
        if usual.source == OWN
        else checks.LeastRadius(usual.value, "limit", f" ({usual.reason})")
    )


def nearest(study: Study) -> Extreme:
    """Where the profiles come nearest to the cam centre [m], refined."""

    def compute() -> Extreme:
        found = find_extremes(lambda angles: _distances(study.at(angles)), study.program)
        return min((each.low for each in found.values()), key=lambda extreme: extreme.value)

    found: Extreme = memory.get("nearest", study.depends_on("cam"), compute)
    return found


def _distances(study: Study) -> Mapping[str, np.ndarray]:
    """Flank -> distance of its profile from the cam centre (n,) [m]; the outer one of a groove lies outside of the other."""
    return {flank.name: np.abs(flank.profile) for flank in study.cam.flanks if flank.name != cam.OUTER}


def _core_findings(study: Study) -> list[Finding]:
    """Of hub, bore and keyway."""
    blank = study.design.drive.cam
    if checks.inner_circles(blank):
        first = cam_extremes(study)["radius"].low
        found = checks.hub_findings(first, blank)
        if not found and first.value <= checks.keyway_reach(blank):

            def wall(angles: Angles) -> Mapping[str, np.ndarray]:
                return {"wall": checks.keyway_clearance(study.at(angles).cam.flank.profile, blank)}

            found = checks.keyway_findings(find_extremes(wall, study.program)["wall"].low, blank)
        if found:
            return found
    return [] if by_torque(study) else _room_findings(study)


def _room_findings(study: Study) -> list[Finding]:
    """A profile that leaves no room for hub or shaft; refined where samples come near to that."""
    drive = study.design.drive

    def compute() -> list[Finding]:
        there = study.at(piecewise_angles(study.program))
        rough = limit_of(there, POLAR)
        if rough is None or 1e3 * min(each.min() for each in _distances(there).values()) > CLEAR * rough.value:
            return []
        usual = limit_of(study, POLAR)
        return [] if usual is None else checks.least_findings("polar-radius", nearest(study), _least(usual), drive.cam)

    stage = "dynamics" if by_torque(study) else "cam"
    found: list[Finding] = memory.get(
        "room", (study.depends_on(stage), drive.cam, drive.limits.polar_radius_mm), compute
    )
    return found


def force_findings(study: Study) -> list[Finding]:
    """A cam without room for a shaft that carries the torque."""
    return _room_findings(study) if by_torque(study) else []


# -- side by side ------------------------------------------------------------------------------------------


class LimitRow(NamedTuple):
    """A figure of a cam beside its limit, both in the unit of ``unit``.

    name    slug, ending with its unit
    label   what it is
    value, cam_angle_deg   its worst, refined
    limit   None where there is none
    source  whose limit it is: ``own``, or where the usual one stands
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
    """The figures of a cam that have limits, beside the user's own, else the usual ones; of the named stages."""
    if "cam" in stages and "cam" in study.stages:
        yield from _shape_rows(study, stages)
    for stage in (stage for stage in stages if stage in study.stages):
        for key, own, worst in worst_of(study, stage):
            unit = key.removeprefix(f"{split_unit(key)[0]}_")
            yield LimitRow(key, OWN_BOUNDS[key][0].label, unit, worst.value, degrees(worst.theta), own, OWN)
    if "dynamics" in stages and (pressed := quantity_requests.peak_pressures(study)):
        most = max(pressed.values(), key=lambda extreme: extreme.value)
        yield _row(study, "contact_pressure_mpa", "Contact pressure", 1e-6 * most.value, most)


def _shape_rows(study: Study, stages: Sequence[str]) -> Iterator[LimitRow]:
    for name, by in pressure_angles(study).items():
        whose = "" if name == _UNDER else " of the second roller"
        body = None if name == _UNDER else study.cam.only(cam.SECOND).flank.body
        for stretch, each in by.items():
            key = f"pressure_angle_{stretch}_deg"
            row = _row(
                study,
                key,
                f"Pressure angle{whose}, {stretch}",
                degrees(each.high.value),
                each.high,
                f"{name}_{stretch}_deg",
            )
            if body is not None and row.source != OWN:
                row = row._replace(limit=cam.PRESSURE_LIMITS[study.frame_pair_kind(body)])
            yield row
    for radius in radii(study):
        sort = "concave" if radius.is_concave else "convex"
        label = f"Smallest {sort} radius {_CURVES[radius.curve]}"
        key = f"{sort}_radius_mm" if radius.is_on_profile else ""
        yield _row(study, key, label, 1e3 * radius.smallest.value, radius.smallest, f"{radius.name}_mm")
    if "dynamics" in stages or not by_torque(study):
        least = nearest(study)
        yield _row(study, POLAR, "Least distance of the profile from the cam centre", 1e3 * least.value, least)


def _row(study: Study, key: str, label: str, value: float, at: Extreme, name: str = "") -> LimitRow:
    """A figure in the unit of its name, beside the limit of that key; name: where it is another than the key."""
    usual, name = limit_of(study, key) if key else None, name or key
    found = (None, "") if usual is None else (usual.value, usual.source)
    return LimitRow(name, label, name.rpartition("_")[2], value, degrees(at.theta), *found)
