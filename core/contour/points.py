"""A digitised curve: its corners are points measured on a smooth cam. The follower is put on each of them along the normal of the
circle through it and its neighbours, and the lifts are fitted as a measured table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from core.contour.drawing import Contour, DrawingError, at_text
from core.contour.elements import ContourElement
from core.design import Design, put, require_motion
from core.followers import built
from core.followers.touching import touching
from core.frozen import frozen
from core.measured import ColumnLayout, MeasuredTable, MotionFit, fit, into_design
from core.measured.table import SAME
from core.measured.units import ValueUnit
from core.numerics.vectors import dot

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
        place = row.place(n * np.exp(1j * turned), z * np.exp(1j * turned))
    else:
        centres = z + face.radius_mm * n
        from scipy.spatial import cKDTree

        depth = cKDTree(np.column_stack((z.real, z.imag))).query(np.column_stack((centres.real, centres.imag)))[0]
        touched = depth >= (1.0 - INSIDE) * face.radius_mm
        centres = centres[touched]
        reach = float(np.abs(centres).min())
        turned = row.angle(centres)
        place = row.place(centres * np.exp(1j * turned))
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
        mechanism.sense * lift[order],
        1.0,
        DECIMALS,
        None,
        (),
    )
    result = fit(table)
    return MeasuredMotion(into_design(changed, result), result)


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


__all__ = ["MeasuredMotion", "fitted", "is_digitised"]
