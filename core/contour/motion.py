"""Motion of a follower that rolls on a curve, as segments, and the cam angles where velocity or acceleration jumps.

A segment is a dwell, or a table that represents the closed form within a tolerance.
"""

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
from core.number_text import result_text
from core.numerics.derivatives import dot

# -- digitised curve --------------------------------------------------------------------------------------------


LEAST_LINES = 36
LARGEST_TURN = math.radians(20.0)
"""A curve of at least so many lines, whose corners all turn by less, counts as digitised."""
DECIMALS = 9  # assumed precision of a drawing
INSIDE = 0.01  # of a round's radius: largest penetration of the neighbours of a contact point


@frozen(eq=False)
class MeasuredMotion:
    """The design with the fitted motion, and the fit."""

    design: Design
    fit: MotionFit


def is_digitised(elements: Sequence[ContourElement]) -> bool:
    """Whether a curve counts as points on a smooth one."""
    if len(elements) < LEAST_LINES or not all(element.is_line for element in elements):
        return False
    chords = np.array([element.end - element.start for element in elements])
    return bool(np.abs(np.angle(np.roll(chords, -1) / chords)).max() <= LARGEST_TURN)


def fit_motion(contour: Contour, design: Design) -> MeasuredMotion:
    """Motion through the lifts of all points. Raises DrawingError where the follower does not reach them."""
    drive, motion = design.drive, require_motion(design)
    follower: Any = drive.mechanism
    face, row, sign = drive.face, touching(follower), design.sense
    z, n = _points(contour.elements)
    if face.straight:
        support = _support(z, n)
        _require_convex(contour, support - dot(n, z), z)
        z, reach = z + (support - dot(n, z)) * n, float(support.min())
        rotation = row.angle(z, n)
        position = row.driver(n * np.exp(1j * rotation), z * np.exp(1j * rotation))
    else:
        centres = z + face.radius_mm * n
        from scipy.spatial import cKDTree

        depth = cKDTree(np.column_stack((z.real, z.imag))).query(np.column_stack((centres.real, centres.imag)))[0]
        is_contact = depth >= (1.0 - INSIDE) * face.radius_mm
        centres = centres[is_contact]
        reach = float(np.abs(centres).min())
        rotation = row.angle(centres)
        position = row.driver(centres * np.exp(1j * rotation))
    if np.isnan(rotation).any() or np.isnan(position).any():
        raise DrawingError(
            f"{contour.name}: the {face.noun} cannot reach all of the curve; change the follower's lengths"
        )
    changed = put(design, "cam.base_radius_mm", reach - face.radius_mm)
    changed = replace(changed, assumed=tuple(path for path in changed.assumed if path != "cam.base_radius_mm"))
    mechanism = built(follower, changed.drive.cam)
    is_rotary = motion.unit == "deg"
    lift = position - (mechanism.start if is_rotary else 1e3 * mechanism.start)
    if is_rotary:
        lift = np.rad2deg(np.remainder(lift + math.pi, 2.0 * math.pi) - math.pi)
    angles = np.remainder(np.rad2deg(sign * rotation), 360.0)
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
    """Corners (n,) and the unit normals at them, away from the body.

    The tangent d₁/|d₁|² + d₂/|d₂|², d₁ and d₂ the chords before and after the corner, is that of the circle through the
    corner and its neighbours.
    """
    z = np.array([element.start for element in elements])
    after = np.roll(z, -1) - z
    before = np.roll(after, 1)
    tangent = before / np.abs(before) ** 2 + after / np.abs(after) ** 2
    return z, -1j * tangent / np.abs(tangent)


def _support(z: np.ndarray, n: np.ndarray) -> np.ndarray:
    """Support (m,) of points z (k,) along unit vectors n (m,): a flat face touches a corner of their hull."""
    from scipy.spatial import ConvexHull

    hull = z[ConvexHull(np.column_stack((z.real, z.imag))).vertices]  # counter-clockwise
    sides = np.unwrap(np.angle(-1j * (np.roll(hull, -1) - hull)))  # outward normals, rising
    corner = np.searchsorted(sides, sides[0] + np.mod(np.angle(n) - sides[0], 2.0 * math.pi), side="right")
    corners = hull[(corner[:, None] + np.arange(-1, 2)) % hull.size]  # and its neighbours, for rounding
    return np.asarray(dot(n[:, None], corners).max(axis=1))


def _require_convex(contour: Contour, depth: np.ndarray, z: np.ndarray) -> None:
    """Raise DrawingError where a flat face bridges a concave part."""
    worst = int(np.argmax(depth))
    if depth[worst] > INSIDE * float(np.abs(z).max()):
        raise DrawingError(
            f"{contour.name}: the curve is hollow at {at_text(z[worst])} from the cam centre, {result_text(depth[worst])} mm below "
            " a flat face; choose a roller, or a convex curve"
        )


# -- motion as segments -----------------------------------------------------------------------------------------


TOLERANCE_MM = 2e-10
"""Tolerance of the tables against the closed form."""
ALIKE = 1e-8  # relative: a smaller difference of accelerations is no jump
_NO_ACCELERATION = 1e-10  # of the stroke, per deg²
SHORTEST = 2e-6  # [deg] a shorter stretch belongs to its neighbours
_CLOSE = 1e-9  # [deg] a join so near to 0 is at 0
_MOST_HALVINGS = 12
_AT_CORNERS = 0.02
DROP = 1e-4
"""Least jump of the motion [mm or deg], larger than that from rounded joints of a drawing."""
_INSIDE = np.array([0.2, 0.5, 0.8])  # of a table's interval, at which it is compared with the closed form


@frozen
class Jump:
    """Jump of the velocity (order 1) or the acceleration (order 2) at a cam angle [deg].

    before, after: values in the motion's unit per deg^order; place: of the round's centre, or on the curve under a flat
    face, as drawn at cam angle 0 [mm].
    """

    angle: float
    order: int
    before: float
    after: float
    place: complex


@frozen(eq=False)
class TracedMotion:
    """The design with the motion and the base radius of a curve.

    Attributes
    ----------
    jumps : by cam angle; a jump of the acceleration only where the velocity is continuous
    path : of a round's centre at cam angle 0 [mm], or the curve itself under a flat face
    fit : of the lifts of a digitised curve; None where the motion is exact
    """

    design: Design
    contour: Contour
    jumps: tuple[Jump, ...]
    path: tuple[ContourElement, ...]
    fit: MotionFit | None = None

    @property
    def base_radius_mm(self) -> float:
        """Base radius of the cam [mm]."""
        radius: float = self.design.drive.cam.base_radius_mm
        return radius


def trace(design: Design, contour: Contour) -> TracedMotion:
    """Motion that a curve gives to the follower of a design, with its base radius.

    Lines and arcs are followed exactly; a curve of many short lines with small corners counts as measured points of a
    smooth one. Raises DrawingError where the follower cannot follow the curve, DesignError where the design has no
    follower on a cam with a motion.
    """
    motion = require_motion(design)
    if not design.drive.has_disk or not hasattr(design.drive.cam, "base_radius_mm"):
        raise DesignError(
            [Fault("cam", MISSING, "a curve gives its motion to a follower on a disk cam", "a design with [follower]")]
        )
    if is_digitised(contour.elements):
        measured = fit_motion(contour, design)
        return TracedMotion(measured.design, contour, (), contour.elements, measured.fit)
    rolled = roll(contour, design)
    changed = _with_base(design, rolled.reach)
    position = _position(changed, motion.unit)
    lever = touching(changed.drive.mechanism).lever_mm
    tolerance = TOLERANCE_MM * min(1.0, lever) if motion.unit == "mm" else math.degrees(TOLERANCE_MM / lever)
    segments, start, jumps = _segments(rolled, position, tolerance)
    traced = without_marks(with_motion(changed, Motion(start, segments, motion.unit)))
    return TracedMotion(traced, contour, jumps, rolled.path)


def _with_base(design: Design, reach: float) -> Design:
    """The design with the base radius from the least distance of the face's reference."""
    radius = reach - design.drive.face.radius_mm
    if radius <= 0.0:
        raise DrawingError(
            f"the cam centre lies {result_text(-radius)} mm outside the curve as the follower sees it; give another centre"
        )
    changed = put(design, "cam.base_radius_mm", radius)
    return replace(changed, assumed=tuple(path for path in changed.assumed if path != "cam.base_radius_mm"))


def _position(design: Design, unit: str) -> Callable[[RolledPart, np.ndarray], np.ndarray]:
    """Part, cam angles (n,) [deg] -> motion with two derivatives by degrees (3, n), in its unit."""
    drive = design.drive
    mechanism, is_rotary = built(drive.mechanism, drive.cam), unit == "deg"
    scale = 180.0 / math.pi if is_rotary else 1.0
    base = mechanism.start if is_rotary else 1e3 * mechanism.start

    def states(part: RolledPart, angles: np.ndarray) -> np.ndarray:
        with np.errstate(invalid="ignore", divide="ignore"):
            rows = part.driver(np.deg2rad(angles)).derivatives.real.copy()
        rows[0] -= base
        if is_rotary:
            rows[0] = np.remainder(rows[0] + math.pi, 2.0 * math.pi) - math.pi
        return np.asarray(mechanism.driver_sign * scale * rows * np.deg2rad(1.0) ** np.arange(3)[:, None])

    return states


# -- segments ---------------------------------------------------------------------------------------------


@frozen(eq=False)
class _Stretch:
    """A part between two cam angles [deg], low < high; breaks: the velocity may jump at its begin."""

    part: RolledPart
    low: float
    high: float
    breaks: bool


def _stretches(parts: Sequence[RolledPart]) -> list[_Stretch]:
    """The parts from cam angle 0 on; short ones are added to their neighbours."""
    stretches = [_Stretch(p, math.degrees(p.low), math.degrees(p.high), p.breaks) for p in parts]
    merged: list[_Stretch] = []
    for stretch in stretches:
        if stretch.high - stretch.low >= SHORTEST:
            low = merged[-1].high if merged else stretch.low
            merged.append(_Stretch(stretch.part, low, stretch.high, stretch.breaks))
        elif merged:
            merged[-1] = _Stretch(merged[-1].part, merged[-1].low, stretch.high, merged[-1].breaks)
    shift = 360.0 * math.floor((merged[0].low + _CLOSE) / 360.0)
    shifted = [_Stretch(s.part, s.low - shift, s.high - shift, s.breaks) for s in merged]
    before, after = [], []
    for s in shifted:  # begin in 0 ... 360
        if s.low >= 360.0 - _CLOSE:
            before.append(_Stretch(s.part, s.low - 360.0, s.high - 360.0, s.breaks))
        elif s.high > 360.0 + _CLOSE:
            after.append(_Stretch(s.part, s.low, 360.0, s.breaks))
            before.append(_Stretch(s.part, 0.0, s.high - 360.0, False))  # smooth there
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
            angle = float(angles[np.flatnonzero(~np.isfinite(states).all(axis=0))[0]])
            raise DrawingError(
                f"the follower cannot follow the curve at cam angle {result_text(angle)} deg "
                f"({result_text(s.low)} ... {result_text(s.high)} deg)"
            )
    is_dwell = [float(np.ptp(states[0])) <= tolerance for _, states in rows]
    for (_, states), dwell in zip(rows, is_dwell, strict=True):
        if dwell:
            level = float(np.mean(states[0]))
            states[0], states[1:] = (0.0 if abs(level) < tolerance else level), 0.0
    jumps = _settle(rows, stretches, is_dwell)
    segments: list[Segment] = []
    for (angles, states), s, dwell in zip(rows, stretches, is_dwell, strict=True):
        span, rise = s.high - s.low, float(states[0, -1] - states[0, 0])
        if dwell and rise == 0.0:
            if segments and segments[-1].curve == NamedCurve("dwell"):
                segments[-1] = Segment(segments[-1].span_deg + span, 0.0)
            else:
                segments.append(Segment(span, 0.0))
            continue
        local = np.append(angles[:-1] - s.low, span)
        points = (
            SplinePoint(*map(float, row))
            for row in zip(local, states[0] - states[0, 0], states[1], states[2], strict=True)
        )
        segments.append(Segment(span, rise, TableCurve(tuple(points))))
    return tuple(segments), float(rows[0][1][0, 0]), jumps


def _rows(s: _Stretch, position: States, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Angles (m,) [deg] and states (3, m) between which quintics agree with the closed form."""
    # where the profile is a corner the error of the slope matters too
    tolerance *= _AT_CORNERS if s.part.corner else 1.0
    angles = np.linspace(s.low, s.high, 2 + int((s.high - s.low) / 30.0))
    for _ in range(_MOST_HALVINGS):
        h, states = np.diff(angles), position(s.part, angles)
        x = _INSIDE[:, None] * h
        c = quintics(h, states.T[:-1, :, None], states.T[1:, :, None])[:, :, 0]
        curve = sum(c[:, k] * x**k for k in range(6))
        exact = position(s.part, (angles[:-1] + x).ravel())[0].reshape(x.shape)
        coarse = np.flatnonzero(np.abs(curve - exact).max(axis=0) > tolerance)
        if not coarse.size or not np.isfinite(states).all():
            break
        angles = np.insert(angles, coarse + 1, 0.5 * (angles[coarse] + angles[coarse + 1]))
    return angles, position(s.part, angles)


def _settle(
    rows: Sequence[tuple[np.ndarray, np.ndarray]], stretches: Sequence[_Stretch], is_dwell: Sequence[bool]
) -> tuple[Jump, ...]:
    """Give both sides of every join equal values, except at jumps, and return the jumps."""
    jumps = []
    heights = np.concatenate([states[0] for _, states in rows])
    rounding = _NO_ACCELERATION * float(np.ptp(heights))
    for i, s in enumerate(stretches):
        left, right = rows[i - 1][1], rows[i][1]
        if abs(left[0, -1] - right[0, 0]) > DROP:
            raise DrawingError(
                f"the follower cannot follow the curve at cam angle {result_text(s.low)} deg: the pressure "
                "angle passes 90 deg there; choose "
                "another follower or centre"
            )
        level = left[0, -1] if is_dwell[i - 1] else right[0, 0] if is_dwell[i] else 0.5 * (left[0, -1] + right[0, 0])
        left[0, -1] = right[0, 0] = level
        if s.breaks:
            jumps.append(Jump(s.low, 1, float(left[1, -1]), float(right[1, 0]), s.part.place))
            continue
        left[1, -1] = right[1, 0] = 0.0 if is_dwell[i - 1] or is_dwell[i] else 0.5 * (left[1, -1] + right[1, 0])
        if abs(left[2, -1] - right[2, 0]) > ALIKE * max(abs(left[2, -1]), abs(right[2, 0])) + rounding:
            jumps.append(Jump(s.low, 2, float(left[2, -1]), float(right[2, 0]), s.part.place))
        else:
            left[2, -1] = right[2, 0] = 0.0 if is_dwell[i - 1] or is_dwell[i] else 0.5 * (left[2, -1] + right[2, 0])
    return tuple(jumps)
