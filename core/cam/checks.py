"""Checks of a cam: self-intersection, limits of the user, hub, bore, keyway and cutter, and tangency of the profile."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterable, Mapping
from math import degrees, hypot, pi, radians, sqrt
from typing import Any, NamedTuple

import numpy as np

from core.cam.faces import row_of
from core.cam.forms import ROUNDING, Radius, form_row, smallest_concave
from core.cam.shape import ENTRIES, INNER, OUTER, SECOND, CamShape, Flank, SecondEntry
from core.design import Limits
from core.findings import ERROR, LEAST_BOUND, WARNING, Finding, Residual
from core.frozen import frozen
from core.motion.extremes import Extreme
from core.numerics.derivatives import cross

# -- where a flank of a cam crosses itself ----------------------------------------------------------------------


TURN = 2.0 * pi
PANEL = 8  # points
MOST_POINTS = 1440
MOST_PAIRS = 64  # of points: a profile with more is undercut all over
NEAR = 1.25  # largest distance of two points near a crossing, relative to the sum of their steps
FAR = 1.5  # least distance along the curve of two points near a crossing, relative to their distance
LEAST_STEP = 1e-5  # [rad] between two points
REFINEMENT = 8  # times as many points around such pairs
NEWTON_STEPS = 24
CLOSED = 1e-12  # relative to the cam's size: two points coincide
DISTINCT = 1e-7  # [rad]

FlankAt = Callable[[np.ndarray], Flank]


@frozen
class Crossing:
    """Point of the profile [m], in the cam's frame, that two cam angles [rad] share, the smaller angle first."""

    first: float
    second: float
    point: complex


def crossings(flank_at: FlankAt, theta: np.ndarray, profile: np.ndarray) -> tuple[Crossing, ...]:
    """All crossings of a closed profile with itself, P(θ₁) = P(θ₂), in the order of their cam angles.

    A profile whose polar angle makes one turn in one direction cannot cross itself. Otherwise the pairs of points where
    two steps of the polyline cross, or come nearest, are sampled more densely; Newton's method refines the angles from
    there. Of more than ``MOST_PAIRS`` pairs those with the largest difference of cam angle are used: the others belong
    to loops of an undercut.

    Parameters
    ----------
    flank_at : function
        The flank at any cam angles (m,) [rad].
    theta : ndarray (n,) [rad]
        Rising cam angles, so dense that the profile curves little between two of them.
    profile : ndarray (n,) complex [m]
        Points of the profile at these angles.

    Returns
    -------
    tuple of Crossing
    """
    separate = np.diff(theta, append=TURN) > LEAST_STEP
    every = slice(None, None, max(1, -(-int(separate.sum()) // MOST_POINTS)))
    theta, profile = theta[separate][every], profile[separate][every]
    polar_steps = np.angle(np.roll(profile, -1) * profile.conj())
    if ((polar_steps > 0.0).all() or (polar_steps < 0.0).all()) and abs(polar_steps.sum()) < 1.5 * TURN:
        return ()
    i, j = _near_pairs(profile)
    if not i.size:
        return ()
    if i.size > MOST_PAIRS:
        difference = np.abs(theta[i] - theta[j])
        farthest = np.argsort(-np.minimum(difference, TURN - difference), kind="stable")[:MOST_PAIRS]
        i, j = i[farthest], j[farthest]
    largest_step = float(np.diff(theta).max())
    first, second = _newton_starts(flank_at, theta[i], theta[j], largest_step)
    if not first.size:
        return ()
    return _solve_crossings(flank_at, first, second, float(np.abs(profile).max()), largest_step)


def _near_pairs(profile: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices (m,), (m,) of pairs of points near which the polyline may cross itself."""
    step = np.abs(np.roll(profile, -1) - profile)
    reach = np.maximum(step, np.roll(step, 1))
    starts = np.arange(0, profile.size, PANEL)
    middle = np.add.reduceat(profile, starts) / np.diff(np.append(starts, profile.size))
    radius = np.maximum.reduceat(np.abs(profile - np.repeat(middle, PANEL)[: profile.size]) + NEAR * reach, starts)
    panel_i, panel_j = np.nonzero(np.triu(np.abs(middle[:, None] - middle) <= radius[:, None] + radius))
    inside = np.arange(PANEL)
    i = (starts[panel_i][:, None, None] + inside[:, None]) + 0 * inside
    j = (starts[panel_j][:, None, None] + inside) + 0 * inside[:, None]
    valid = (i < j) & (j < profile.size)
    i, j = i[valid], j[valid]
    distance = np.abs(profile[i] - profile[j])
    along = np.append(0.0, np.cumsum(step))
    along_curve = np.abs(along[i] - along[j])
    along_curve = np.minimum(along_curve, along[-1] - along_curve)
    near = (distance <= NEAR * (reach[i] + reach[j])) & (along_curve > FAR * distance)
    i, j = i[near], j[near]
    chosen = _is_nearest(i, j, distance[near], profile.size) | _steps_cross(profile, i, j)
    return i[chosen], j[chosen]


def _steps_cross(profile: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Whether the steps from points i and j (m,) of the polyline to the next ones cross each other (m,)."""
    step_i, step_j = (profile[(k + 1) % profile.size] - profile[k] for k in (i, j))
    gap, area = profile[j] - profile[i], cross(step_i, step_j)
    with np.errstate(divide="ignore", invalid="ignore"):
        along, across = cross(gap, step_j) / area, cross(gap, step_i) / area
    return np.asarray((along >= 0.0) & (along <= 1.0) & (across >= 0.0) & (across <= 1.0))


def _is_nearest(i: np.ndarray, j: np.ndarray, distance: np.ndarray, size: int) -> np.ndarray:
    """Whether no neighbour of a pair (m,) of points is nearer (m,)."""
    distances = dict(zip(zip(i.tolist(), j.tolist(), strict=True), distance.tolist(), strict=True))
    neighbours = [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b]
    nearest = [
        all(distances.get(((a + da) % size, (b + db) % size), np.inf) >= d for da, db in neighbours)
        for (a, b), d in distances.items()
    ]
    return np.array(nearest, dtype=bool)


def _newton_starts(
    flank_at: FlankAt, first: np.ndarray, second: np.ndarray, largest_step: float
) -> tuple[np.ndarray, np.ndarray]:
    """Cam angles (m,), (m,) from which Newton's method starts.

    The curve is sampled ``REFINEMENT`` times as densely around a pair, since one step may contain two crossings: the
    angles are those where two fine steps cross, or the nearest points if they all but touch.
    """
    offsets = largest_step * np.linspace(-1.5, 1.5, 3 * REFINEMENT + 1)
    near = np.concatenate((first, second))[:, None] + offsets
    profile = flank_at(near.ravel() % TURN).profile.reshape(near.shape)
    part_i, part_j = np.split(profile, 2)
    step_i, step_j = np.diff(part_i)[:, :, None], np.diff(part_j)[:, None, :]
    gap, area = part_j[:, None, :-1] - part_i[:, :-1, None], cross(step_i, step_j)
    with np.errstate(divide="ignore", invalid="ignore"):
        along, across = cross(gap, step_j) / area, cross(gap, step_i) / area
    k, a, b = np.nonzero((along >= 0.0) & (along <= 1.0) & (across >= 0.0) & (across <= 1.0))
    distance = np.abs(part_j[:, None, :] - part_i[:, :, None]).reshape(first.size, -1)
    near_only = distance.min(axis=1) <= np.abs(step_i).max(axis=(1, 2)) + np.abs(step_j).max(axis=(1, 2))
    near_only[k] = False
    p, q = np.unravel_index(distance.argmin(axis=1), (offsets.size, offsets.size))
    return (
        np.concatenate(((first + offsets[p])[near_only], first[k] + offsets[a])),
        np.concatenate(((second + offsets[q])[near_only], second[k] + offsets[b])),
    )


def _solve_crossings(
    flank_at: FlankAt, first: np.ndarray, second: np.ndarray, size: float, largest_step: float
) -> tuple[Crossing, ...]:
    """Newton's method on both angles of all pairs at once; drops pairs of equal angles and pairs that do not close."""
    count = first.size
    for _ in range(NEWTON_STEPS):
        flank = flank_at(np.concatenate((first, second)) % TURN)
        profile, velocity = flank.profile, flank.profile_velocity
        gap = profile[count:] - profile[:count]
        if (np.abs(gap) <= CLOSED * size).all():
            break
        velocity_i, velocity_j = velocity[:count], velocity[count:]
        area = cross(velocity_i, velocity_j)
        with np.errstate(divide="ignore", invalid="ignore"):  # parallel: no crossing there
            steps = np.array([cross(gap, velocity_j) / area, cross(gap, velocity_i) / area])
        steps = np.clip(np.nan_to_num(steps), -largest_step, largest_step)
        first, second = first + steps[0], second + steps[1]
    first, second = first % TURN, second % TURN
    difference = np.abs(first - second)
    solved = (np.abs(gap) <= 16.0 * CLOSED * size) & (np.minimum(difference, TURN - difference) > DISTINCT)
    rows = zip(
        np.minimum(first, second)[solved].tolist(),
        np.maximum(first, second)[solved].tolist(),
        profile[:count][solved].tolist(),
        strict=True,
    )
    result: list[Crossing] = []
    for low, high, point in sorted(rows, key=lambda row: row[:2]):
        if not any(abs(low - known.first) < DISTINCT and abs(high - known.second) < DISTINCT for known in result):
            result.append(Crossing(low, high, point))
    return tuple(result)


# -- findings besides the typical limits ------------------------------------------------------------------------


STRETCHES: Mapping[str, float] = {"rise": 1.0, "return": -1.0}
"""Stretches of the motion by the sign of its velocity."""


# -- limits of the user ------------------------------------------------------------------------------------


def pressure_findings(
    worst: Mapping[str, Extreme], limits: Limits, face: Any, cam: Any, second: SecondEntry | None = None
) -> list[Finding]:
    """Findings where the pressure angle of a flank exceeds a limit of the user.

    Parameters
    ----------
    worst : mapping
        Stretch of the motion -> the greatest pressure angle [rad] in it.
    limits : Limits
    face, cam : the design's tables
    second : SecondEntry, optional
        Entry of the second roller, where the flank is that of its cam.
    """
    findings = []
    for stretch, extreme in worst.items():
        limit, angle = getattr(limits, f"pressure_angle_{stretch}_deg"), degrees(extreme.value)
        if limit is not None and angle > limit * (1.0 + ROUNDING):
            row, (what, field) = ENTRIES[type(cam)], row_of(face).steep
            remedy = f"reduce the {what} of the face" if what else row.gentler.format(stretch=stretch)
            values: dict[str, float | str] = {"value": angle, "limit": limit, "remedy": remedy}
            if second is not None:
                field = second.field
                values |= {"remedy": f"{second.remedy}, or lengthen the {stretch}", "flank": SECOND}
            findings.append(
                Finding(f"pressure-angle-{stretch}", WARNING, field or row.size, degrees(extreme.theta), values)
            )
    return findings


class LeastRadius(NamedTuple):
    """A least radius [mm], whose limit it is, and why, for the sentence of a finding."""

    limit: float
    whose: str
    why: str = ""


def radius_findings(radii: Iterable[Radius], limits: Mapping[str, LeastRadius], cam: Any) -> list[Finding]:
    """Findings where the smallest radius of a profile, of each sort ("convex", "concave"), is below its limit."""
    findings = []
    for sort, limit in limits.items():
        extremes = [r.smallest for r in radii if r.is_on_profile and r.is_concave == (sort == "concave")]
        least = min(extremes, key=lambda extreme: extreme.value, default=None)
        findings += [] if least is None else least_findings(f"{sort}-radius", least, limit, cam)
    return findings


def least_findings(code: str, least: Extreme, limit: LeastRadius, cam: Any) -> list[Finding]:
    """Finding where a radius [m] is below its limit."""
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
    """A circle inside the cam: "hub" or "bore", the field that states it, and its radius [mm]."""

    what: str
    field: str
    radius_mm: float


def inner_circles(cam: Any) -> list[InnerCircle]:
    """Hub and bore, where the design states their diameters."""
    rows = (("hub", cam.hub_mm), ("bore", cam.bore_mm))
    return [InnerCircle(what, f"cam.{what}_mm", 0.5 * diameter) for what, diameter in rows if diameter is not None]


def hub_findings(nearest: Extreme, cam: Any) -> list[Finding]:
    """Finding where the smallest radius [m] of the profile does not exceed the radius of the hub, or of the bore."""
    for what, field, radius in inner_circles(cam):
        if 1e3 * nearest.value <= radius:
            values: dict[str, float | str] = {"radius_mm": 1e3 * nearest.value, "limit_mm": radius, "what": what}
            return [Finding("profile-meets-hub", ERROR, field, degrees(nearest.theta), values)]
    return []


KEYWAY = ("keyway_width_mm", "keyway_depth_mm", "keyway_angle_deg")


def keyway_unknown(cam: Any) -> tuple[str, ...]:
    """Names of the entries that an incompletely stated keyway lacks; without them it cannot be drawn."""
    names = ("bore_mm", *KEYWAY) if any(getattr(cam, name) is not None for name in KEYWAY) else ()
    return tuple(name for name in names if getattr(cam, name) is None)


def keyway_corners(cam: Any) -> tuple[complex, ...]:
    """Corners of a keyway [mm]: from the bore along one side, its floor and the other side back to the bore.

    Empty without a keyway, or where one of its entries is missing.
    """
    if cam.keyway_width_mm is None or keyway_unknown(cam):
        return ()
    radius, half, turn = 0.5 * cam.bore_mm, 0.5 * cam.keyway_width_mm, cmath.rect(1.0, radians(cam.keyway_angle_deg))
    inner, outer = sqrt(radius * radius - half * half), radius + cam.keyway_depth_mm
    return tuple(turn * complex(x, y) for x, y in ((inner, -half), (outer, -half), (outer, half), (inner, half)))


def keyway_reach(cam: Any) -> float:
    """Largest distance of a point of the keyway from the cam centre [m]; 0 without a keyway."""
    if cam.bore_mm is None or cam.keyway_depth_mm is None:
        return 0.0
    return 1e-3 * hypot(0.5 * cam.bore_mm + cam.keyway_depth_mm, 0.5 * (cam.keyway_width_mm or 0.0))


def keyway_clearance(profile: np.ndarray, cam: Any) -> np.ndarray:
    """Clearance between profile and keyway, negative inside the keyway.

    It is the larger one of the distances beyond its floor along x and beyond its side along y. A keyway without angle
    or width may be anywhere in the circle through its floor.

    Parameters
    ----------
    profile : ndarray (n,) complex [m]
        Points of the profile in the cam's frame.
    cam : the design's table

    Returns
    -------
    ndarray (n,) [m]
    """
    floor = 1e-3 * (0.5 * cam.bore_mm + cam.keyway_depth_mm)
    if cam.keyway_angle_deg is None or cam.keyway_width_mm is None:
        return np.asarray(np.abs(profile) - floor)
    local = profile * cmath.rect(1.0, -radians(cam.keyway_angle_deg))
    clearance = np.maximum(local.real - floor, np.abs(local.imag) - 0.5e-3 * cam.keyway_width_mm)
    return np.where(local.real > 0.0, clearance, np.abs(local))


def keyway_findings(wall: Extreme, cam: Any) -> list[Finding]:
    """Finding where a profile cuts into the keyway; ``wall`` is the least of `keyway_clearance` [m]."""
    if wall.value > 0.0:
        return []
    values: dict[str, float | str] = {"overlap_mm": -1e3 * wall.value}
    return [Finding("profile-meets-keyway", ERROR, "cam.keyway_depth_mm", degrees(wall.theta), values)]


# -- cutter ------------------------------------------------------------------------------------------------


def cutter_findings(radii: tuple[Radius, ...], face: Any, cam: Any) -> list[Finding]:
    """Findings where the cutter does not fit into the smallest concave radius of the profile, or into a groove."""
    cutter = cam.cutter_radius_mm
    if cutter is None:
        return []
    findings = []
    concave = smallest_concave(radii)
    if concave is not None and cutter > 1e3 * concave.smallest.value * (1.0 + ROUNDING):
        smallest = concave.smallest
        values: dict[str, float | str] = {"cutter_mm": cutter, "radius_mm": 1e3 * smallest.value}
        findings.append(Finding("cutter-too-large", ERROR, "cam.cutter_radius_mm", degrees(smallest.theta), values))
    if OUTER in form_row(cam.form).flanks:
        half = face.radius_mm + 0.5 * cam.form.play_mm
        if cutter > half * (1.0 + ROUNDING):
            values = {"cutter_mm": cutter, "radius_mm": half}
            findings.append(Finding("cutter-wider-than-groove", ERROR, "cam.cutter_radius_mm", None, values))
    return findings


# -- self-intersection of the profile ----------------------------------------------------------------------


def crossing_findings(flank: str, crossings: tuple[Crossing, ...], cam: Any) -> list[Finding]:
    """Finding where two distant parts of a profile cross: the first crossing by cam angle, and their number."""
    if not crossings:
        return []
    first = crossings[0]
    values: dict[str, float | str] = {
        "first_deg": degrees(first.first), "other_deg": degrees(first.second), "crossings": float(len(crossings)),
        "flank": flank, "which": "profile" if flank == INNER else f"{flank} profile",
        "x_mm": 1e3 * first.point.real, "y_mm": 1e3 * first.point.imag,
    }  # fmt: skip
    return [Finding("self-intersection", ERROR, ENTRIES[type(cam)].size, degrees(first.first), values)]


def is_reversed(flank: Flank) -> np.ndarray:
    """Mask of the cam angles where a flank runs backwards, as between the two cusps of an undercut.

    Parameters
    ----------
    flank : Flank

    Returns
    -------
    ndarray (n,) bool, dimensionless
    """
    margin = flank.profile_radius if flank.straight else 1.0 - flank.offset * flank.pitch_curvature
    return np.asarray(margin <= 0.0)


def without_undercut(
    crossings: tuple[Crossing, ...], is_reversed_between: Callable[[float, float], bool]
) -> tuple[Crossing, ...]:
    """The crossings without those of an undercut, between whose angles the profile runs backwards."""
    return tuple(c for c in crossings if not is_reversed_between(c.first, c.second))


# -- independent checks of the cam -----------------------------------------------------------------------------


POSITIONS = 120  # of the cam at which the gap between face and profile is searched


def centre_residual(shape: CamShape) -> np.ndarray:
    """Difference of the relative velocity t and i(φ' - d)(R - Q), relative to the terms of the latter.

    The instant centre Q has the weight φ' - d, so that the second expression exists for a centre at infinity too.

    Parameters
    ----------
    shape : CamShape

    Returns
    -------
    ndarray (n,), dimensionless
    """
    weighted, centre = shape.centre.weight * shape.reference, shape.centre.point
    return np.abs(shape.relative_velocity - 1j * (weighted - centre)) / (np.abs(weighted) + np.abs(centre))


def gaps(shape: CamShape, face: Any, positions: int = POSITIONS) -> np.ndarray:
    """Least distance of any profile point from the face, by brute force; negative where the profile enters it.

    Parameters
    ----------
    shape : CamShape
    face : the design's face
    positions : int
        Number m of cam positions.

    Returns
    -------
    ndarray (m,) [m]
    """
    return row_of(face).gaps(shape, face, positions)


def tangency_residual(shape: CamShape, face: Any, reach: float, positions: int = POSITIONS) -> float:
    """Largest of the gaps, relative to ``reach`` [m], the distance of the face's reference point on the base circle."""
    return float(np.abs(gaps(shape, face, positions)).max()) / reach


def tangency(shape: CamShape, face: Any, reach: float, derived: float, undercut: Callable[[], bool]) -> Residual:
    """Residual of the tangency: the profile touches the face at every angle, and enters it nowhere.

    An undercut profile crosses itself: the part that enters the face is cut away in machining, and nothing touches it.
    Such positions are left out; a finding names the undercut.

    Parameters
    ----------
    shape : CamShape
    face : the design's face
    reach : float
        Distance of the face's reference point on the base circle [m].
    derived : float
        Bound of the residual that follows from the accuracy of the results, dimensionless.
    undercut : function
        Whether the curvature says that the cam is undercut.
    """
    contact_distance = float(row_of(face).contact_distance(shape, face).max())
    distances = gaps(shape, face)
    entered = -distances > max(derived, LEAST_BOUND) * reach
    left_out = int(np.count_nonzero(entered)) if entered.any() and undercut() else 0
    checked = distances[~entered] if left_out else distances
    worst = max(contact_distance, float(np.abs(checked).max(initial=0.0)))
    return Residual(worst / reach, derived, left_out, f"{distances.size} positions (undercut)")
