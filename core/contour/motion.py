"""The motion of a follower that is rolled over a curve, as segments: dwells where it stands, else tables that hold the closed
form within a tolerance; and the cam angles where velocity or acceleration jumps."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from core.contour.drawing import Contour, DrawingError, at_text
from core.contour.elements import ContourElement
from core.contour.rolling import Rolled, RolledPart, roll
from core.design import Design, Motion, NamedCurve, Segment, SplinePoint, TableCurve, put, require_motion, with_motion
from core.design.motion_edits import without_marks
from core.errors import MISSING, DesignError, Fault
from core.followers import built
from core.followers.touching import touching
from core.frozen import frozen
from core.laws.polynomial import quintics
from core.measured import ColumnLayout, MeasuredTable, MotionFit, fit, with_measured_motion
from core.measured.table import SAME
from core.measured.units import ValueUnit
from core.numerics.derivatives import dot

# -- A digitised curve ------------------------------------------------------------------------------------------


LEAST_LINES = 36
LARGEST_TURN = math.radians(20.0)
"""A curve of at least so many lines, whose corners all turn by less, is one that was digitised."""
DECIMALS = 9  # that a drawing is taken to hold
INSIDE = 0.01  # of a round's radius: a point beside which it would enter the curve by more is not touched


@frozen(eq=False)
class MeasuredMotion:
    """The design with the fitted motion, and the fit."""

    design: Design
    fit: MotionFit


def is_digitised(elements: Sequence[ContourElement]) -> bool:
    """Whether a curve counts as points on a smooth one."""
    if len(elements) < LEAST_LINES or not all(each.is_line for each in elements):
        return False
    chords = np.array([each.end - each.start for each in elements])
    return bool(np.abs(np.angle(np.roll(chords, -1) / chords)).max() <= LARGEST_TURN)


def fitted(contour: Contour, design: Design) -> MeasuredMotion:
    """The motion through the lifts of all points. Raises DrawingError where the follower does not reach them."""
    drive, motion = design.drive, require_motion(design)
    follower: Any = drive.mechanism
    face, row, sense = drive.face, touching(follower), design.sense
    z, n = _points(contour.elements)
    if face.straight:
        support = _support(z, n)
        _require_convex(contour, support - dot(n, z), z)
        z, reach = z + (support - dot(n, z)) * n, float(support.min())
        turned = row.angle(z, n)
        place = row.driver(n * np.exp(1j * turned), z * np.exp(1j * turned))
    else:
        centres = z + face.radius_mm * n
        from scipy.spatial import cKDTree

        depth = cKDTree(np.column_stack((z.real, z.imag))).query(np.column_stack((centres.real, centres.imag)))[0]
        touched = depth >= (1.0 - INSIDE) * face.radius_mm
        centres = centres[touched]
        reach = float(np.abs(centres).min())
        turned = row.angle(centres)
        place = row.driver(centres * np.exp(1j * turned))
    if np.isnan(turned).any() or np.isnan(place).any():
        raise DrawingError(
            f"{contour.name}: the {face.noun} cannot reach all of the curve; change the follower's lengths"
        )
    changed = put(design, "cam.base_radius_mm", reach - face.radius_mm)
    changed = replace(changed, assumed=tuple(path for path in changed.assumed if path != "cam.base_radius_mm"))
    mechanism = built(follower, changed.drive.cam)
    turns = motion.unit == "deg"
    lift = place - (mechanism.start if turns else 1e3 * mechanism.start)
    if turns:
        lift = np.rad2deg(np.remainder(lift + math.pi, 2.0 * math.pi) - math.pi)
    angles = np.remainder(np.rad2deg(sense * turned), 360.0)
    angles = np.where((angles > 360.0 - SAME) | (angles < SAME), 0.0, angles)
    order = np.argsort(angles, kind="stable")
    table = MeasuredTable(
        contour.name,
        ColumnLayout(0, 1, "deg", ValueUnit(motion.unit, motion.unit, 1.0), "displacement"),
        motion.unit,
        np.arange(1, order.size + 1),
        angles[order],
        mechanism.driver_sign * lift[order],
        1.0,
        DECIMALS,
        None,
        (),
    )
    result = fit(table)
    return MeasuredMotion(with_measured_motion(changed, result), result)


def _points(elements: Sequence[ContourElement]) -> tuple[np.ndarray, np.ndarray]:
    """The corners (n,) and unit normals there, away from the body: square to the tangent d₁/|d₁|² + d₂/|d₂|² of the circle through
    a corner and its neighbours, d₁ and d₂ being the chords before and behind it."""
    z = np.array([each.start for each in elements])
    after = np.roll(z, -1) - z
    before = np.roll(after, 1)
    tangent = before / np.abs(before) ** 2 + after / np.abs(after) ** 2
    return z, -1j * tangent / np.abs(tangent)


def _support(z: np.ndarray, n: np.ndarray) -> np.ndarray:
    """How far points z (k,) reach along unit vectors n (m,), both about the origin (m,): a flat face lies on a corner of their hull."""
    from scipy.spatial import ConvexHull

    hull = z[ConvexHull(np.column_stack((z.real, z.imag))).vertices]  # counter-clockwise
    sides = np.unwrap(np.angle(-1j * (np.roll(hull, -1) - hull)))  # outward normals, rising
    corner = np.searchsorted(sides, sides[0] + np.mod(np.angle(n) - sides[0], 2.0 * math.pi), side="right")
    near = hull[(corner[:, None] + np.arange(-1, 2)) % hull.size]  # and those beside it, for rounding
    return np.asarray(dot(n[:, None], near).max(axis=1))


def _require_convex(contour: Contour, depth: np.ndarray, z: np.ndarray) -> None:
    """Raises DrawingError where a flat face bridges a hollow."""
    worst = int(np.argmax(depth))
    if depth[worst] > INSIDE * float(np.abs(z).max()):
        raise DrawingError(
            f"{contour.name}: the curve is hollow at {at_text(z[worst])} from the cam centre, {depth[worst]:.4g} mm below "
            " a flat face; choose a roller, or a convex curve"
        )


# -- the motion of a follower that is rolled over a curve, as segments ------------------------------------------


TOLERANCE_MM = 2e-10
"""How far the tables may be from the closed form."""
ALIKE = 1e-8  # relative: accelerations that differ by less go on
_NO_ACCELERATION = 1e-10  # of the stroke, per deg²
SHORTEST = 2e-6  # degrees: a shorter stretch belongs to its neighbours
_CLOSE = 1e-9  # degrees: a join this close to 0 is there
_MOST_HALVINGS = 12
_AT_CORNERS = 0.02
DROP = 1e-4
"""More than the joints of a drawing, rounded as they are, let the motion differ on their two sides [mm or deg]."""
_INSIDE = np.array([0.2, 0.5, 0.8])  # of a table's interval, where it is compared with the closed form


@frozen
class Jump:
    """Where the velocity (order 1) or the acceleration (2) jumps: cam angle [deg], values before and after, in the motion's unit
    per deg^order; place: of the round's centre, or on the curve under a flat face, as drawn at cam angle 0 [mm]."""

    angle: float
    order: int
    before: float
    after: float
    place: complex


@frozen(eq=False)
class TracedMotion:
    """The design with the motion and the base radius of a curve.

    jumps  by cam angle; those of the acceleration only where the velocity goes on
    path   of a round's centre at cam angle 0 [mm], or the curve itself under a flat face
    fit    of the lifts that a digitised curve was turned into; None where the motion is exact
    """

    design: Design
    contour: Contour
    jumps: tuple[Jump, ...]
    path: tuple[ContourElement, ...]
    fit: MotionFit | None = None

    @property
    def base_radius_mm(self) -> float:
        """The base radius of the cam [mm]."""
        radius: float = self.design.drive.cam.base_radius_mm
        return radius


def trace(design: Design, contour: Contour) -> TracedMotion:
    """The motion that a curve gives to the follower of a design, with the base radius that belongs to it.

    Lines and arcs are followed exactly; a curve of many short lines with small corners counts as points that were measured on a
    smooth one. Raises DrawingError where the follower cannot follow the curve, DesignError where the design has no follower on a
    cam with a motion.
    """
    motion = require_motion(design)
    if design.drive.cam is None or not hasattr(design.drive.cam, "base_radius_mm"):
        raise DesignError(
            [Fault("cam", MISSING, "a curve gives its motion to a follower on a disk cam", "a design with [follower]")]
        )
    if is_digitised(contour.elements):
        measured = fitted(contour, design)
        return TracedMotion(measured.design, contour, (), contour.elements, measured.fit)
    rolled = roll(contour, design)
    changed = _with_base(design, rolled.reach)
    position = _position(changed, motion.unit)
    lever = touching(changed.drive.mechanism).lever_mm
    tolerance = TOLERANCE_MM * min(1.0, lever) if motion.unit == "mm" else math.degrees(TOLERANCE_MM / lever)
    segments, start, jumps = _segments(rolled, position, tolerance)
    made = without_marks(with_motion(changed, Motion(start, segments, motion.unit)))
    return TracedMotion(made, contour, jumps, rolled.path)


def _with_base(design: Design, reach: float) -> Design:
    """The base radius from the nearest place of the face's reference."""
    radius = reach - design.drive.face.radius_mm
    if radius <= 0.0:
        raise DrawingError(
            f"the cam centre lies {-radius:.6g} mm outside the curve as the follower sees it; give another centre"
        )
    changed = put(design, "cam.base_radius_mm", radius)
    return replace(changed, assumed=tuple(path for path in changed.assumed if path != "cam.base_radius_mm"))


def _position(design: Design, unit: str) -> Callable[[RolledPart, np.ndarray], np.ndarray]:
    """Part, cam angles (n,) [deg] -> the motion with two derivatives by degrees (3, n), in its unit."""
    drive = design.drive
    mechanism, turns = built(drive.mechanism, drive.cam), unit == "deg"
    scale = 180.0 / math.pi if turns else 1.0
    base = mechanism.start if turns else 1e3 * mechanism.start

    def states(part: RolledPart, angles: np.ndarray) -> np.ndarray:
        with np.errstate(invalid="ignore", divide="ignore"):
            rows = part.driver(np.deg2rad(angles)).derivatives.real.copy()
        rows[0] -= base
        if turns:
            rows[0] = np.remainder(rows[0] + math.pi, 2.0 * math.pi) - math.pi
        return np.asarray(mechanism.driver_sign * scale * rows * np.deg2rad(1.0) ** np.arange(3)[:, None])

    return states


# -- segments ---------------------------------------------------------------------------------------------


@frozen(eq=False)
class _Stretch:
    """A part between two cam angles [deg], low < high; breaks: the velocity may jump where it begins."""

    part: RolledPart
    low: float
    high: float
    breaks: bool


def _stretches(parts: Sequence[RolledPart]) -> list[_Stretch]:
    """The parts cut at cam angle 0, from there on; those too short are left to their neighbours."""
    whole = [_Stretch(p, math.degrees(p.low), math.degrees(p.high), p.breaks) for p in parts]
    kept: list[_Stretch] = []
    for each in whole:
        if each.high - each.low >= SHORTEST:
            low = kept[-1].high if kept else each.low
            kept.append(_Stretch(each.part, low, each.high, each.breaks))
        elif kept:
            kept[-1] = _Stretch(kept[-1].part, kept[-1].low, each.high, kept[-1].breaks)
    shift = 360.0 * math.floor((kept[0].low + _CLOSE) / 360.0)
    laid = [_Stretch(s.part, s.low - shift, s.high - shift, s.breaks) for s in kept]
    before, after = [], []
    for s in laid:  # from low in 0 ... 360 on
        if s.low >= 360.0 - _CLOSE:
            before.append(_Stretch(s.part, s.low - 360.0, s.high - 360.0, s.breaks))
        elif s.high > 360.0 + _CLOSE:
            after.append(_Stretch(s.part, s.low, 360.0, s.breaks))
            before.append(_Stretch(s.part, 0.0, s.high - 360.0, False))  # the curve goes on there
        else:
            after.append(s)
    rows = [*before, *after]
    joints = [0.0, *(s.low for s in rows[1:]), 360.0]
    return [_Stretch(s.part, low, high, s.breaks) for s, (low, high) in zip(rows, pairwise(joints), strict=True)]


States = Callable[[RolledPart, np.ndarray], np.ndarray]


def _segments(
    rolled: Rolled, position: States, tolerance: float
) -> tuple[tuple[Segment, ...], float, tuple[Jump, ...]]:
    stretches = _stretches(rolled.parts)
    rows = [_rows(s, position, tolerance) for s in stretches]
    for (angles, states), s in zip(rows, stretches, strict=True):
        if not np.isfinite(states).all():
            place = float(angles[np.flatnonzero(~np.isfinite(states).all(axis=0))[0]])
            raise DrawingError(
                f"the follower cannot follow the curve at cam angle {place:.6g} deg ({s.low:.6g} ... {s.high:.6g} deg)"
            )
    still = [float(np.ptp(states[0])) <= tolerance for _, states in rows]
    for (_, states), dwells in zip(rows, still, strict=True):
        if dwells:
            level = float(np.mean(states[0]))
            states[0], states[1:] = (0.0 if abs(level) < tolerance else level), 0.0
    jumps = _settle(rows, stretches, still)
    segments: list[Segment] = []
    for (angles, states), s, dwells in zip(rows, stretches, still, strict=True):
        span, rise = s.high - s.low, float(states[0, -1] - states[0, 0])
        if dwells and rise == 0.0:
            if segments and segments[-1].curve == NamedCurve("dwell"):
                segments[-1] = Segment(segments[-1].span_deg + span, 0.0)
            else:
                segments.append(Segment(span, 0.0))
            continue
        at = np.append(angles[:-1] - s.low, span)
        points = (
            SplinePoint(*map(float, row))
            for row in zip(at, states[0] - states[0, 0], states[1], states[2], strict=True)
        )
        segments.append(Segment(span, rise, TableCurve(tuple(points))))
    return tuple(segments), float(rows[0][1][0, 0]), jumps


def _rows(s: _Stretch, position: States, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Angles (m,) [deg] and states (3, m) between which quintics keep to the closed form."""
    # a profile that is a corner shows the slope's error too
    tolerance *= _AT_CORNERS if s.part.corner else 1.0
    angles = np.linspace(s.low, s.high, 2 + int((s.high - s.low) / 30.0))
    for _ in range(_MOST_HALVINGS):
        h, states = np.diff(angles), position(s.part, angles)
        x = _INSIDE[:, None] * h
        c = quintics(h, states.T[:-1, :, None], states.T[1:, :, None])[:, :, 0]
        curve = sum(c[:, k] * x**k for k in range(6))
        exact = position(s.part, (angles[:-1] + x).ravel())[0].reshape(x.shape)
        off = np.flatnonzero(np.abs(curve - exact).max(axis=0) > tolerance)
        if not off.size or not np.isfinite(states).all():
            break
        angles = np.insert(angles, off + 1, 0.5 * (angles[off] + angles[off + 1]))
    return angles, position(s.part, angles)


def _settle(
    rows: Sequence[tuple[np.ndarray, np.ndarray]], stretches: Sequence[_Stretch], still: Sequence[bool]
) -> tuple[Jump, ...]:
    """Both sides of every join given the same values, as far as nothing jumps there; what does."""
    jumps = []
    heights = np.concatenate([states[0] for _, states in rows])
    rounding = _NO_ACCELERATION * float(np.ptp(heights))
    for i, s in enumerate(stretches):
        left, right = rows[i - 1][1], rows[i][1]
        if abs(left[0, -1] - right[0, 0]) > DROP:
            raise DrawingError(
                f"the follower cannot follow the curve at cam angle {s.low:.6g} deg: the pressure angle passes 90 deg there; choose "
                "another follower or centre"
            )
        level = left[0, -1] if still[i - 1] else right[0, 0] if still[i] else 0.5 * (left[0, -1] + right[0, 0])
        left[0, -1] = right[0, 0] = level
        if s.breaks:
            jumps.append(Jump(s.low, 1, float(left[1, -1]), float(right[1, 0]), s.part.place))
            continue
        left[1, -1] = right[1, 0] = 0.0 if still[i - 1] or still[i] else 0.5 * (left[1, -1] + right[1, 0])
        if abs(left[2, -1] - right[2, 0]) > ALIKE * max(abs(left[2, -1]), abs(right[2, 0])) + rounding:
            jumps.append(Jump(s.low, 2, float(left[2, -1]), float(right[2, 0]), s.part.place))
        else:
            left[2, -1] = right[2, 0] = 0.0 if still[i - 1] or still[i] else 0.5 * (left[2, -1] + right[2, 0])
    return tuple(jumps)
