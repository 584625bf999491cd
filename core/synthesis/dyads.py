"""Dyads that guide a body through given poses: a link between frame and body, pinned or sliding at its ends.

A dyad is a point q = (q₁, A, G, W, q₈) with

    q₁|d|² + 2Re(Ā e^{-iθ}d) + 2Re(Ḡd) + 2Re(W e^{iθ}) + q₈ = 0 for every pose (d, θ), and q₁W = ḠA.

With q₁ = 1 the moving pivot is A in the body's frame, the fixed pivot -G. With q₁ = A = 0 the moving pivot is on a line of the frame
(a guide), with q₁ = G = 0 the fixed pivot on a line of the body (a turning guide). A pose, and a line for a pivot, are one linear
condition. Five conditions leave a pencil of three dimensions, in which q₁W = ḠA is two conics.

Source: B. Ravani, B. Roth, *Motion Synthesis Using Kinematic Mappings*, J. Mech. Transm. Autom. Des. 105 (1983) 460-467; the
equation is that of a circle, or of a line, in the frame.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import pi, radians

import numpy as np

from core.frozen import frozen
from core.synthesis.task import FIXED, MOVING, Area, BodyPose, Pivot

PIN, GUIDE, TURNING_GUIDE = "pin", "guide", "turning-guide"
FARTHEST = 1e6  # of the task's size: a pivot farther off is at infinity, its circle a line
CONVERGED = 1e-11
SAME_DYAD = 1e-7  # of two dyads as unit vectors
ROTATIONS = 2
"""Rotations of the pencil in which the conics are intersected: no intersection is at infinity of both."""


@frozen
class Dyad:
    """A dyad that fits a body at all poses.

    Attributes
    ----------
    kind : str
        ``pin``, ``guide`` or ``turning-guide``.
    fixed : complex
        Fixed pivot [mm]; of a guide a point of its line, the moving pivot at the first pose.
    moving : complex
        Moving pivot in the body's frame [mm]; of a turning guide a point of its line, the fixed pivot at the first pose.
    line : float
        Direction of the line [rad]: of a guide in the frame, of a turning guide in the body's frame; 0 of a pin.
    """

    kind: str
    fixed: complex
    moving: complex
    line: float = 0.0

    def moving_at(self, pose: BodyPose) -> complex:
        """The moving pivot [mm] at a pose; of a turning guide the point of its line."""
        return pose.z + self.moving * cmath.rect(1.0, radians(pose.angle_deg))

    def line_at(self, pose: BodyPose) -> tuple[complex, float] | None:
        """A point [mm] and the direction [rad] of the line of a guide or a turning guide at a pose; None for a pin."""
        if self.kind == PIN:
            return None
        if self.kind == GUIDE:
            return self.fixed, self.line
        return self.moving_at(pose), self.line + radians(pose.angle_deg)


@frozen(eq=False)
class ScaledPoses:
    """Poses moved to their mean and divided by their size.

    Attributes
    ----------
    d : ndarray (n,) complex, dimensionless
        Origins of the body.
    turn : ndarray (n,) complex, dimensionless
        Unit vectors of its x axis.
    mean : complex
        Origin of the scaled frame [mm].
    size : float
        Unit of length [mm].
    """

    d: np.ndarray
    turn: np.ndarray
    mean: complex
    size: float

    @classmethod
    def of(cls, poses: Sequence[BodyPose], reach: float = 0.0) -> ScaledPoses:
        """Scale poses; ``reach`` is the length [mm] of a task whose poses only turn."""
        z = np.array([pose.z for pose in poses])
        mean = complex(z.mean())
        size = float(np.abs(z - mean).max()) or reach or 1.0
        turn = np.array([cmath.rect(1.0, np.deg2rad(pose.angle_deg)) for pose in poses])
        return cls((z - mean) / size, turn, mean, size)

    def rows(self) -> np.ndarray:
        """Conditions of the poses on a dyad.

        Returns
        -------
        ndarray (n, 8), dimensionless
            Factors of q₁, Re A, Im A, Re G, Im G, Re W, Im W, q₈.
        """
        a = 2.0 * np.conj(self.turn) * self.d  # Re(Ā a)
        g, w = 2.0 * self.d, 2.0 * self.turn
        columns = (np.abs(self.d) ** 2, a.real, a.imag, g.real, g.imag, w.real, -w.imag, np.ones(self.d.size))
        return np.column_stack(columns)

    def line_row(self, pivot: Pivot) -> np.ndarray:
        """Condition of a line for a pivot, Re(n̄ G) = -c q₁ or Re(n̄ A) = c q₁.

        Returns
        -------
        ndarray (8,), dimensionless
            As a row of ``rows``.
        """
        x, y, direction = pivot.line
        normal = cmath.rect(1.0, np.deg2rad(direction) + 0.5 * pi)
        at = self.scaled(complex(x, y), pivot.of)
        offset = (normal.conjugate() * at).real
        row = np.zeros(8)
        first = 3 if pivot.of == FIXED else 1
        row[0] = offset if pivot.of == FIXED else -offset
        row[first : first + 2] = normal.real, normal.imag
        return row

    def scaled(self, z: complex, of: str) -> complex:
        """A point [mm] of the frame or of the body in the unit of length."""
        return (z - self.mean) / self.size if of == FIXED else z / self.size


def dyads_through(poses: ScaledPoses, pivots: Sequence[Pivot]) -> list[Dyad]:
    """All real dyads through poses, where these and the conditions on pivots leave a finite number.

    Parameters
    ----------
    poses : ScaledPoses
    pivots : sequence of Pivot
        With the poses five conditions.

    Returns
    -------
    list of Dyad
    """
    rows = [*poses.rows(), *(poses.line_row(pivot) for pivot in pivots if pivot.line)]
    placed = {pivot.of: poses.scaled(pivot.z, pivot.of) for pivot in pivots if pivot.z is not None}
    points = _with_placed_pivots(np.array(rows), placed) if placed else _conic_points(np.array(rows))
    dyads = [dyad for q in points if (dyad := _dyad(q, poses)) is not None]
    return [_as_typed(dyad, pivots) for dyad in dyads]


def _as_typed(dyad: Dyad, pivots: Sequence[Pivot]) -> Dyad:
    """The dyad with its given pivots exactly as typed."""
    given = {pivot.of: pivot.z for pivot in pivots if pivot.z is not None}
    fixed = dyad.fixed if dyad.kind == GUIDE else given.get(FIXED, dyad.fixed)
    moving = dyad.moving if dyad.kind == TURNING_GUIDE else given.get(MOVING, dyad.moving)
    return replace(dyad, fixed=fixed, moving=moving)


def _with_placed_pivots(rows: np.ndarray, placed: dict[str, complex]) -> list[np.ndarray]:
    """Dyads (8,) with given pivots: a linear problem, since W = -ḡA of a fixed pivot g, and W = Ḡa of a moving one a."""
    basis = []
    if FIXED in placed and MOVING in placed:
        g, a = placed[FIXED], placed[MOVING]
        basis = [_vector(1.0, a, -g, -g.conjugate() * a, 0.0), _vector(0.0, 0j, 0j, 0j, 1.0)]
    elif FIXED in placed:
        g = placed[FIXED]
        basis = [_vector(1.0, 0j, -g, 0j, 0.0), _vector(0.0, 0j, 0j, 0j, 1.0)]
        basis += [_vector(0.0, a, 0j, -g.conjugate() * a, 0.0) for a in (1.0 + 0j, 1j)]
    else:
        a = placed[MOVING]
        basis = [_vector(1.0, a, 0j, 0j, 0.0), _vector(0.0, 0j, 0j, 0j, 1.0)]
        basis += [_vector(0.0, 0j, g, g.conjugate() * a, 0.0) for g in (1.0 + 0j, 1j)]
    inside = np.array(basis)
    inside /= np.linalg.norm(inside, axis=1)[:, None]
    _, values, vectors = np.linalg.svd(rows @ inside.T, full_matrices=True)
    if np.count_nonzero(values > 1e-10 * values[0]) != len(basis) - 1:
        return []  # more than one dyad, or none
    return [vectors[-1] @ inside]


def _vector(q1: float, a: complex, g: complex, w: complex, q8: float) -> np.ndarray:
    return np.array([q1, a.real, a.imag, g.real, g.imag, w.real, w.imag, q8])


def _conic_points(rows: np.ndarray) -> list[np.ndarray]:
    """Dyads (8,) of five conditions (5, 8): the real intersections of two conics in the conditions' null space."""
    rows = rows / np.linalg.norm(rows, axis=1)[:, None]
    _, values, vectors = np.linalg.svd(rows, full_matrices=True)
    if values[4] <= 1e-12 * values[0]:
        return []
    basis = vectors[5:]
    conics = _conics(basis)
    points: list[np.ndarray] = []
    for x in _starts(conics):
        point = _refined(conics, x)
        if point is None:
            continue
        q = point @ basis
        if all(min(np.linalg.norm(q - p), np.linalg.norm(q + p)) > SAME_DYAD for p in points):
            points.append(q)
    return points


def _conics(basis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Symmetric matrices (3, 3) of Re(q₁W - ḠA) and Im(q₁W - ḠA) in coordinates of a basis (3, 8)."""
    q1 = basis[:, 0]
    a, g, w = (basis[:, k] + 1j * basis[:, k + 1] for k in (1, 3, 5))
    form = np.outer(q1, w) - np.outer(np.conj(g), a)
    form = 0.5 * (form + form.T)
    return form.real, form.imag


def _starts(conics: tuple[np.ndarray, np.ndarray]) -> Iterator[np.ndarray]:
    """Approximate real intersections (3,): roots of the resultant, in rotated coordinates."""
    generator = np.random.default_rng(1)
    for _ in range(ROTATIONS):
        rotation, _ = np.linalg.qr(generator.normal(size=(3, 3)))
        (p2, p1, p0), (r2, r1, r0) = (_in_first(rotation.T @ conic @ rotation) for conic in conics)
        outer = _minus(p2 * r0, r2 * p0)
        first, last = _minus(p2 * r1, r2 * p1), _minus(p1 * r0, r1 * p0)
        for y in _minus(outer * outer, first * last).roots:
            if abs(y.imag) > 1e-3 * (1.0 + abs(y)):
                continue
            below = first(y.real)
            x = -outer(y.real) / below if below else 0.0
            start = rotation @ np.array([x, y.real, 1.0])
            yield start / np.linalg.norm(start)


def _in_first(conic: np.ndarray) -> tuple[np.poly1d, np.poly1d, np.poly1d]:
    """A conic (3, 3) as a polynomial of degree 2 in the first coordinate; its coefficients by the second, with the third 1."""
    return (
        np.poly1d([conic[0, 0]]),
        np.poly1d([2.0 * conic[0, 1], 2.0 * conic[0, 2]]),
        np.poly1d([conic[1, 1], 2.0 * conic[1, 2], conic[2, 2]]),
    )


def _minus(left: np.poly1d, right: np.poly1d) -> np.poly1d:
    return np.poly1d(np.polysub(left, right))


def _refined(conics: tuple[np.ndarray, np.ndarray], x: np.ndarray) -> np.ndarray | None:
    """Intersection by Newton's method on the unit sphere; None where it does not converge."""
    for _ in range(30):
        values = np.array([x @ conics[0] @ x, x @ conics[1] @ x, 0.5 * (x @ x - 1.0)])
        slopes = np.array([2.0 * conics[0] @ x, 2.0 * conics[1] @ x, x])
        try:
            step = np.linalg.solve(slopes, values)
        except np.linalg.LinAlgError:
            return None
        x = x - step
        if np.abs(step).max() < 1e-15:
            break
    scale = max(np.abs(conics[0]).max(), np.abs(conics[1]).max())
    error = max(abs(x @ conics[0] @ x), abs(x @ conics[1] @ x))
    return x / np.linalg.norm(x) if np.isfinite(x).all() and error <= CONVERGED * scale else None


def _dyad(q: np.ndarray, poses: ScaledPoses) -> Dyad | None:
    """The dyad of a point (8,); None where it has no pivot."""
    q = q / np.linalg.norm(q)
    q1 = float(q[0])
    a, g, w = (complex(q[k], q[k + 1]) for k in (1, 3, 5))
    first_d, first_turn = complex(poses.d[0]), complex(poses.turn[0])
    if abs(q1) * FARTHEST > max(abs(a), abs(g)) > 0.0 or abs(q1) > max(abs(a), abs(g)):
        fixed, moving = -g / q1, a / q1
        return Dyad(PIN, poses.mean + poses.size * fixed, poses.size * moving)
    if abs(g) > abs(a):
        moving = w / g.conjugate()
        at = first_d + moving * first_turn
        return Dyad(GUIDE, poses.mean + poses.size * at, poses.size * moving, _direction(1j * g))
    if abs(a) > 0.0:
        fixed = -(w / a).conjugate()
        at = (fixed - first_d) / first_turn
        return Dyad(TURNING_GUIDE, poses.mean + poses.size * fixed, poses.size * at, _direction(1j * a))
    return None


def _direction(z: complex) -> float:
    """Direction of a line [rad], -π/2 < … ≤ π/2."""
    angle = cmath.phase(z)
    return angle - pi if angle > 0.5 * pi else angle + pi if angle <= -0.5 * pi else angle


# -- sweeps of missing conditions -------------------------------------------------------------------------------


LINES, AREA_LINES, GRID, COARSE_GRID, COARSE_LINES = 48, 30, 16, 10, 7
SKEW = 70.0  # direction of lines for moving pivots [deg]


def sweeps(poses: int, pivots: Sequence[Pivot], area: Area, reach: float) -> tuple[tuple[Pivot, ...], ...]:
    """Conditions that complete those of a task to five, swept over an area for the fixed pivot.

    Parameters
    ----------
    poses : int
        Number of poses.
    pivots : sequence of Pivot
        Conditions of the task on the dyad.
    area : Area
        For fixed pivots.
    reach : float
        Largest distance of a swept moving pivot from the body's origin [mm].

    Returns
    -------
    tuple of tuple of Pivot
        Complete sets of conditions; one where nothing is missing.
    """
    missing = 5 - poses - sum(pivot.conditions for pivot in pivots)
    pivots = tuple(pivots)
    fixed = next((pivot for pivot in pivots if pivot.of == FIXED), None)
    moving = next((pivot for pivot in pivots if pivot.of == MOVING), None)
    if missing == 0:
        return (pivots,)
    if missing == 1:
        if fixed is None:
            return tuple((*pivots, row) for row in _area_lines(area, AREA_LINES))
        if moving is None:
            return tuple((*pivots, row) for row in _moving_lines(reach, LINES))
        if fixed.line:  # both pivots have a line: the fixed one is swept along its own
            return tuple((moving, row) for row in _along(fixed, area, LINES))
        return tuple((fixed, row) for row in _along(moving, area, LINES))
    if missing == 2:
        if fixed is None:
            return tuple((*pivots, row) for row in _area_points(area, GRID))
        points = _along(fixed, area, 2 * GRID) if fixed.line else [fixed]
        return tuple((point, row) for point in points for row in _moving_lines(reach, COARSE_LINES))
    lines = _moving_lines(reach, COARSE_LINES)
    return tuple((point, row) for point in _area_points(area, COARSE_GRID) for row in lines)


def _spread(low: float, high: float, n: int) -> np.ndarray:
    """Middles of n equal parts."""
    return low + (high - low) * (np.arange(n) + 0.5) / n


def _area_lines(area: Area, n: int) -> list[Pivot]:
    """Lines upright and across: a curve that is steep for the ones is flat for the others."""
    upright = [(float(x), 0.0, 90.0) for x in _spread(area.low_x_mm, area.high_x_mm, n)]
    across = [(0.0, float(y), 0.0) for y in _spread(area.low_y_mm, area.high_y_mm, n)]
    return [Pivot(of=FIXED, line=line) for line in (*upright, *across)]


def _area_points(area: Area, n: int) -> list[Pivot]:
    ys = _spread(area.low_y_mm, area.high_y_mm, n)
    return [
        Pivot(of=FIXED, x_mm=float(x), y_mm=float(y)) for x in _spread(area.low_x_mm, area.high_x_mm, n) for y in ys
    ]


def _moving_lines(reach: float, n: int) -> list[Pivot]:
    """Skew lines: poses without a turn have dyads on a line that is often upright or across."""
    return [Pivot(of=MOVING, line=(float(x), 0.0, SKEW)) for x in _spread(-reach, reach, n)]


def _along(pivot: Pivot, area: Area, n: int) -> list[Pivot]:
    """Points of the line of a pivot, as far from its point as the area is large."""
    x, y, direction = pivot.line
    reach = max(area.high_x_mm - area.low_x_mm, area.high_y_mm - area.low_y_mm)
    along = cmath.rect(1.0, np.deg2rad(direction))
    places = [complex(x, y) + along * float(s) for s in _spread(-reach, reach, n)]
    return [Pivot(of=pivot.of, x_mm=z.real, y_mm=z.imag) for z in places]


def is_inside(dyad: Dyad, area: Area) -> bool:
    """Whether the fixed pivot is in the area; a guide has none."""
    z = dyad.fixed
    inside = area.low_x_mm <= z.real <= area.high_x_mm and area.low_y_mm <= z.imag <= area.high_y_mm
    return dyad.kind == GUIDE or inside
