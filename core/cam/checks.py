"""What a cam exceeds besides the usual limits: the user's own, hub and bore, the cutter, its own profile."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Iterable, Mapping
from math import degrees, hypot, pi, radians, sqrt
from typing import Any, NamedTuple

import numpy as np

from core.cam.faces import row_of
from core.cam.forms import ROUNDING, Radius, form_row, hollowest
from core.cam.shape import ENTRIES, INNER, OUTER, SECOND, CamShape, Flank, SecondEntry
from core.design import Limits
from core.findings import ERROR, LEAST_BOUND, WARNING, Finding, Residual
from core.frozen import frozen
from core.motion.extremes import Extreme
from core.numerics.derivatives import cross

# -- where a flank of a cam crosses itself ----------------------------------------------------------------------


TURN = 2.0 * pi
PANEL = 8  # points
MOST = 1440  # points
PAIRS = 64  # of points: a profile of more is undercut all over
NEAR = 1.25  # two parts may cross where points of them are no farther apart than so many times their steps together
FAR = 1.5  # and part of a bend: along the curve they are apart by more than so many times that
CLOSEST = 1e-5  # [rad] between two points
FINER = 8  # times, around such pairs
STEPS = 24  # of Newton's method
CLOSED = 1e-12  # of the cam's size: two points coincide
DISTINCT = 1e-7  # [rad]

FlankAt = Callable[[np.ndarray], Flank]


@frozen
class Crossing:
    """A place [m] in the cam's own frame where the profile passes twice, at two cam angles [rad], the smaller first."""

    first: float
    second: float
    place: complex


def crossings(flank_at: FlankAt, theta: np.ndarray, place: np.ndarray) -> tuple[Crossing, ...]:
    """All crossings of a closed profile with itself, by cam angle.

    flank_at: the flank at any cam angles; theta: rising (n,) [rad], so dense that the profile bends little between two of them;
    place: its points there (n,) [m]. A profile whose polar angle goes round once, and never back, cannot cross
    itself. Else wherever two of the polyline's steps cross, their ends are no farther apart than the steps are long together: such
    pairs that are not neighbours along the curve are taken where the steps cross, and of those beside each other the nearest;
    there the curve is sampled more densely, and P(θ₁) = P(θ₂) is solved by Newton's method. Of more than ``PAIRS`` such pairs
    those farthest apart by cam angle are taken: the others belong to loops of an undercut.
    """
    alone = np.diff(theta, append=TURN) > CLOSEST
    every = slice(None, None, max(1, -(-int(alone.sum()) // MOST)))
    theta, place = theta[alone][every], place[alone][every]
    turned = np.angle(np.roll(place, -1) * place.conj())
    if ((turned > 0.0).all() or (turned < 0.0).all()) and abs(turned.sum()) < 1.5 * TURN:
        return ()
    i, j = _near(place)
    if not i.size:
        return ()
    if i.size > PAIRS:
        apart = np.abs(theta[i] - theta[j])
        farthest = np.argsort(-np.minimum(apart, TURN - apart), kind="stable")[:PAIRS]
        i, j = i[farthest], j[farthest]
    widest = float(np.diff(theta).max())
    first, second = _closer(flank_at, theta[i], theta[j], widest)
    if not first.size:
        return ()
    return _solved(flank_at, first, second, float(np.abs(place).max()), widest)


def _near(place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of points (m,), (m,) near which the polyline may cross itself."""
    step = np.abs(np.roll(place, -1) - place)
    reach = np.maximum(step, np.roll(step, 1))
    starts = np.arange(0, place.size, PANEL)
    middle = np.add.reduceat(place, starts) / np.diff(np.append(starts, place.size))
    radius = np.maximum.reduceat(np.abs(place - np.repeat(middle, PANEL)[: place.size]) + NEAR * reach, starts)
    one, other = np.nonzero(np.triu(np.abs(middle[:, None] - middle) <= radius[:, None] + radius))
    inside = np.arange(PANEL)
    i = (starts[one][:, None, None] + inside[:, None]) + 0 * inside
    j = (starts[other][:, None, None] + inside) + 0 * inside[:, None]
    valid = (i < j) & (j < place.size)
    i, j = i[valid], j[valid]
    distance = np.abs(place[i] - place[j])
    along = np.append(0.0, np.cumsum(step))
    apart = np.abs(along[i] - along[j])
    apart = np.minimum(apart, along[-1] - apart)
    wanted = (distance <= NEAR * (reach[i] + reach[j])) & (apart > FAR * distance)
    i, j = i[wanted], j[wanted]
    chosen = _nearest(i, j, distance[wanted], place.size) | _steps_cross(place, i, j)
    return i[chosen], j[chosen]


def _steps_cross(place: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Whether the steps from points i and j (m,) of the polyline to the next ones cross each other (m,)."""
    one, other = (place[(k + 1) % place.size] - place[k] for k in (i, j))
    gap, area = place[j] - place[i], cross(one, other)
    with np.errstate(divide="ignore", invalid="ignore"):
        along, across = cross(gap, other) / area, cross(gap, one) / area
    return np.asarray((along >= 0.0) & (along <= 1.0) & (across >= 0.0) & (across <= 1.0))


def _nearest(i: np.ndarray, j: np.ndarray, distance: np.ndarray, size: int) -> np.ndarray:
    """Whether no pair beside a pair (m,) is nearer (m,)."""
    held = dict(zip(zip(i.tolist(), j.tolist(), strict=True), distance.tolist(), strict=True))
    beside = [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b]
    least = [
        all(held.get(((a + da) % size, (b + db) % size), np.inf) >= d for da, db in beside)
        for (a, b), d in held.items()
    ]
    return np.array(least, dtype=bool)


def _closer(flank_at: FlankAt, first: np.ndarray, second: np.ndarray, widest: float) -> tuple[np.ndarray, np.ndarray]:
    """Cam angles (m,), (m,) to begin Newton's method from: around each pair the curve is sampled once more, ``FINER`` times as
    densely, where two crossings may lie within one step: every place where steps cross, else the nearest points if they all but
    touch."""
    offsets = widest * np.linspace(-1.5, 1.5, 3 * FINER + 1)
    near = np.concatenate((first, second))[:, None] + offsets
    place = flank_at(near.ravel() % TURN).profile.reshape(near.shape)
    one, other = np.split(place, 2)
    own, its = np.diff(one)[:, :, None], np.diff(other)[:, None, :]
    gap, area = other[:, None, :-1] - one[:, :-1, None], cross(own, its)
    with np.errstate(divide="ignore", invalid="ignore"):
        along, across = cross(gap, its) / area, cross(gap, own) / area
    k, a, b = np.nonzero((along >= 0.0) & (along <= 1.0) & (across >= 0.0) & (across <= 1.0))
    distance = np.abs(other[:, None, :] - one[:, :, None]).reshape(first.size, -1)
    touch = distance.min(axis=1) <= np.abs(own).max(axis=(1, 2)) + np.abs(its).max(axis=(1, 2))
    touch[k] = False
    p, q = np.unravel_index(distance.argmin(axis=1), (offsets.size, offsets.size))
    ours = np.concatenate(((first + offsets[p])[touch], first[k] + offsets[a]))
    return ours, np.concatenate(((second + offsets[q])[touch], second[k] + offsets[b]))


def _solved(
    flank_at: FlankAt, first: np.ndarray, second: np.ndarray, size: float, widest: float
) -> tuple[Crossing, ...]:
    """Newton's method on both angles of all pairs at once; what runs together, or does not close, is no crossing."""
    count = first.size
    for _ in range(STEPS):
        flank = flank_at(np.concatenate((first, second)) % TURN)
        place, speed = flank.profile, flank.profile_velocity
        gap = place[count:] - place[:count]
        if (np.abs(gap) <= CLOSED * size).all():
            break
        one, other = speed[:count], speed[count:]
        area = cross(one, other)
        with np.errstate(divide="ignore", invalid="ignore"):  # parallel: no crossing there
            steps = np.array([cross(gap, other) / area, cross(gap, one) / area])
        steps = np.clip(np.nan_to_num(steps), -widest, widest)
        first, second = first + steps[0], second + steps[1]
    first, second = first % TURN, second % TURN
    apart = np.abs(first - second)
    good = (np.abs(gap) <= 16.0 * CLOSED * size) & (np.minimum(apart, TURN - apart) > DISTINCT)
    rows = zip(
        np.minimum(first, second)[good].tolist(),
        np.maximum(first, second)[good].tolist(),
        place[:count][good].tolist(),
        strict=True,
    )
    found: list[Crossing] = []
    for low, high, at in sorted(rows, key=lambda row: row[:2]):
        if not any(abs(low - known.first) < DISTINCT and abs(high - known.second) < DISTINCT for known in found):
            found.append(Crossing(low, high, at))
    return tuple(found)


# -- what a cam exceeds besides the usual limits ----------------------------------------------------------------


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


# -- checks of a cam by other ways than the one it was computed -------------------------------------------------


POSITIONS = 120  # of the cam at which its profile is searched


def centre_residual(shape: CamShape) -> np.ndarray:
    """t against i(φ'-d)(R-Q) (n,), relative to the terms of the latter: relative velocity and instant centre Q must
    say the same. The centre's weight is φ'-d, so that i(weight R - point) stands at infinity too."""
    by_place, by_centre = shape.centre.weight * shape.reference, shape.centre.point
    return np.abs(shape.relative_velocity - 1j * (by_place - by_centre)) / (np.abs(by_place) + np.abs(by_centre))


def gaps(shape: CamShape, face: Any, positions: int = POSITIONS) -> np.ndarray:
    """Least distance of any profile point from the face [m], by brute force at ``positions`` cam positions (m,): negative where
    the profile enters it, positive where it stays away from it."""
    return row_of(face).gaps(shape, face, positions)


def tangency_residual(shape: CamShape, face: Any, reach: float, positions: int = POSITIONS) -> float:
    """The largest of the gaps, relative to ``reach``, the distance of the face's reference on the base circle."""
    return float(np.abs(gaps(shape, face, positions)).max()) / reach


def tangency(shape: CamShape, face: Any, reach: float, derived: float, undercut: Callable[[], bool]) -> Residual:
    """The proof that the profile touches the face and enters it nowhere, against ``derived`` or the promised accuracy.

    At every angle the profile's own point must lie on the face, and no other point beyond it. Where the cam is undercut, which
    its curvature says, the profile crosses itself: what enters the face there is cut away as the cam is made, and nothing
    touches it. Such positions are left out; the finding names the undercut.
    """
    own = float(row_of(face).own_distance(shape, face).max())
    by_search = gaps(shape, face)
    entered = -by_search > max(derived, LEAST_BOUND) * reach
    left_out = int(np.count_nonzero(entered)) if entered.any() and undercut() else 0
    held = by_search[~entered] if left_out else by_search
    worst = max(own, float(np.abs(held).max(initial=0.0)))
    return Residual(worst / reach, derived, left_out, f"{by_search.size} positions (undercut)")
