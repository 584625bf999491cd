"""What a cam exceeds besides the usual limits: the user's own, hub and bore, the cutter, its own profile."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterable, Mapping
from math import degrees, hypot, radians, sqrt
from typing import Any, NamedTuple

import numpy as np

from core.cam.crossings import Crossing
from core.cam.faces import row_of
from core.cam.forms import form_row
from core.cam.limits import ROUNDING
from core.cam.radii import Radius, hollowest
from core.cam.shape import INNER, OUTER, SECOND, Flank
from core.cam.sizes import ENTRIES, SecondEntry
from core.design import Limits
from core.findings import ERROR, WARNING, Finding
from core.motion.extremes import Extreme

STRETCHES: Mapping[str, float] = {"rise": 1.0, "return": -1.0}
"""Stretches of the motion by the sign of its velocity."""


# -- the user's own limits ---------------------------------------------------------------------------------


def pressure_findings(
    worst: Mapping[str, Extreme], limits: Limits, face: Any, cam: Any, second: SecondEntry | None = None
) -> list[Finding]:
    """Pressure angles of a flank beyond the user's own limits; worst: stretch -> the greatest pressure angle [rad] there; second: the
    entry of the second roller, where the flank is that of its cam."""
    found = []
    for stretch, extreme in worst.items():
        limit, angle = getattr(limits, f"pressure_angle_{stretch}_deg"), degrees(extreme.value)
        if limit is not None and angle > limit * (1.0 + ROUNDING):
            row, (what, field) = ENTRIES[type(cam)], row_of(face).steep
            remedy = f"lessen the {what} of the face" if what else row.gentler.format(stretch=stretch)
            values: dict[str, float | str] = {"value": angle, "limit": limit, "remedy": remedy}
            if second is not None:
                field = second.field
                values |= {"remedy": f"{second.remedy}, or lengthen the {stretch}", "flank": SECOND}
            found.append(
                Finding(f"pressure-angle-{stretch}", WARNING, field or row.size, degrees(extreme.theta), values)
            )
    return found


class LeastRadius(NamedTuple):
    """A least radius [mm], whose limit it is, and why; for the sentence of a finding."""

    limit: float
    whose: str
    why: str = ""


def radius_findings(radii: Iterable[Radius], limits: Mapping[str, LeastRadius], cam: Any) -> list[Finding]:
    """Radii of the profiles below their limits, the smallest of each sort: ``convex`` and ``concave``."""
    found = []
    for sort, limit in limits.items():
        of_sort = [each.smallest for each in radii if each.of_profile and each.hollow == (sort == "concave")]
        least = min(of_sort, key=lambda extreme: extreme.value, default=None)
        found += [] if least is None else least_findings(f"{sort}-radius", least, limit, cam)
    return found


def least_findings(code: str, least: Extreme, limit: LeastRadius, cam: Any) -> list[Finding]:
    """A radius [m] below its limit."""
    if 1e3 * least.value >= limit.limit * (1.0 - ROUNDING):
        return []
    values: dict[str, float | str] = {
        "value": 1e3 * least.value,
        "limit": limit.limit,
        "whose": limit.whose,
        "why": limit.why,
    }
    return [Finding(code, WARNING, ENTRIES[type(cam)].size, degrees(least.theta), values)]


# -- shaft, hub, bore and keyway ---------------------------------------------------------------------------


class InnerCircle(NamedTuple):
    """What lies inside a cam, with the field that states it and its radius [mm]."""

    what: str
    field: str
    radius_mm: float


def cores(cam: Any) -> list[InnerCircle]:
    """Hub and bore, as far as they are known."""
    rows = (("hub", cam.hub_mm), ("bore", cam.bore_mm))
    return [InnerCircle(what, f"cam.{what}_mm", 0.5 * diameter) for what, diameter in rows if diameter is not None]


def core_findings(nearest: Extreme, cam: Any) -> list[Finding]:
    """A profile whose smallest radius [m] does not exceed that of the hub, else of the bore."""
    for what, field, radius in cores(cam):
        if 1e3 * nearest.value <= radius:
            values: dict[str, float | str] = {"radius_mm": 1e3 * nearest.value, "limit_mm": radius, "what": what}
            return [Finding("profile-meets-hub", ERROR, field, degrees(nearest.theta), values)]
    return []


KEYWAY = ("keyway_width_mm", "keyway_depth_mm", "keyway_angle_deg")


def keyway_unknown(cam: Any) -> tuple[str, ...]:
    """What is not known of a keyway of which something is: names of the entries, without which it cannot be drawn."""
    names = ("bore_mm", *KEYWAY) if any(getattr(cam, name) is not None for name in KEYWAY) else ()
    return tuple(name for name in names if getattr(cam, name) is None)


def keyway_corners(cam: Any) -> tuple[complex, ...]:
    """A keyway's corners [mm], from the bore along one side, its bottom and the other side back to the bore; none where there is
    none, or not all of it is known."""
    if cam.keyway_width_mm is None or keyway_unknown(cam):
        return ()
    radius, half, turn = 0.5 * cam.bore_mm, 0.5 * cam.keyway_width_mm, cmath.rect(1.0, radians(cam.keyway_angle_deg))
    inner, outer = sqrt(radius * radius - half * half), radius + cam.keyway_depth_mm
    return tuple(turn * complex(x, y) for x, y in ((inner, -half), (outer, -half), (outer, half), (inner, half)))


def keyway_reach(cam: Any) -> float:
    """Farthest from the cam centre that a keyway comes [m]; 0 where there is none."""
    if cam.bore_mm is None or cam.keyway_depth_mm is None:
        return 0.0
    return 1e-3 * hypot(0.5 * cam.bore_mm + cam.keyway_depth_mm, 0.5 * (cam.keyway_width_mm or 0.0))


def over_keyway(profile: np.ndarray, cam: Any) -> np.ndarray:
    """How far the profile (n,) [m] is from the keyway (n,) [m]: in x along it beyond its floor, or in y beside it, whichever is
    more; less than 0 within. Where its angle or its width is not known it may lie anywhere."""
    floor = 1e-3 * (0.5 * cam.bore_mm + cam.keyway_depth_mm)
    if cam.keyway_angle_deg is None or cam.keyway_width_mm is None:
        return np.asarray(np.abs(profile) - floor)
    local = profile * cmath.rect(1.0, -radians(cam.keyway_angle_deg))
    within = np.maximum(local.real - floor, np.abs(local.imag) - 0.5e-3 * cam.keyway_width_mm)
    return np.where(local.real > 0.0, within, np.abs(local))


def keyway_findings(wall: Extreme, cam: Any) -> list[Finding]:
    """A profile that cuts into the keyway; wall: the least of ``over_keyway``."""
    if wall.value > 0.0:
        return []
    values: dict[str, float | str] = {"overlap_mm": -1e3 * wall.value}
    return [Finding("profile-meets-keyway", ERROR, "cam.keyway_depth_mm", degrees(wall.theta), values)]


# -- cutter ------------------------------------------------------------------------------------------------


def cutter_findings(radii: tuple[Radius, ...], face: Any, cam: Any) -> list[Finding]:
    """A cutter that does not go into the smallest hollow of the profile, or not into a groove."""
    cutter = cam.cutter_radius_mm
    if cutter is None:
        return []
    found = []
    hollow = hollowest(radii)
    if hollow is not None and cutter > 1e3 * hollow.smallest.value * (1.0 + ROUNDING):
        values: dict[str, float | str] = {"cutter_mm": cutter, "radius_mm": 1e3 * hollow.smallest.value}
        found.append(Finding("cutter-too-large", ERROR, "cam.cutter_radius_mm", degrees(hollow.smallest.theta), values))
    if OUTER in form_row(cam.form).flanks:
        half = face.radius_mm + 0.5 * cam.form.play_mm
        if cutter > half * (1.0 + ROUNDING):
            values = {"cutter_mm": cutter, "radius_mm": half}
            found.append(Finding("cutter-wider-than-groove", ERROR, "cam.cutter_radius_mm", None, values))
    return found


# -- the profile and itself --------------------------------------------------------------------------------


def crossing_findings(flank: str, found: tuple[Crossing, ...], cam: Any) -> list[Finding]:
    """Two far parts of a profile that cross: the first crossing by cam angle, and how many there are."""
    if not found:
        return []
    first = found[0]
    values: dict[str, float | str] = {
        "first_deg": degrees(first.first), "other_deg": degrees(first.second), "crossings": float(len(found)),
        "flank": flank, "which": "profile" if flank == INNER else f"{flank} profile",
        "x_mm": 1e3 * first.place.real, "y_mm": 1e3 * first.place.imag,
    }  # fmt: skip
    return [Finding("self-intersection", ERROR, ENTRIES[type(cam)].size, degrees(first.first), values)]


def reversed_at(flank: Flank) -> np.ndarray:
    """Where a flank runs backwards (n,), as between the two cusps of an undercut."""
    left = flank.profile_radius if flank.straight else 1.0 - flank.offset * flank.pitch_curvature
    return np.asarray(left <= 0.0)


def without_undercut(
    found: tuple[Crossing, ...], reversed_between: Callable[[float, float], bool]
) -> tuple[Crossing, ...]:
    """The crossings that are not those of an undercut, between whose angles the profile runs backwards."""
    return tuple(each for each in found if not reversed_between(each.first, each.second))
