"""Closed outlines in a plane: straight lines, circular arcs and quintic B-splines, with their area and points on them."""

from __future__ import annotations

from cmath import rect
from collections.abc import Sequence
from itertools import pairwise
from math import acos, ceil, comb, pi
from typing import Protocol, TypeAlias

import numpy as np

from core.frozen import frozen
from core.numerics.derivatives import cross
from core.numerics.roots import gauss

DEGREE = 5


class Piece(Protocol):
    """A piece of an outline."""

    @property
    def start(self) -> complex:
        """First point [mm]."""

    @property
    def end(self) -> complex:
        """Last point [mm]."""

    @property
    def area(self) -> float:
        """½∫(x dy - y dx) [mm²]; its sum over a closed outline is the enclosed area, positive counter-clockwise."""

    def reversed(self) -> Piece:
        """The piece in the opposite direction."""

    def polygon(self, tolerance: float) -> np.ndarray:
        """Vertices of chords that keep a tolerance, from the start on, without the end.

        Parameters
        ----------
        tolerance : float [mm]
            Largest distance of the piece from its chords.

        Returns
        -------
        ndarray (n,) complex [mm]
        """


@frozen
class Line:
    """A straight line."""

    start: complex
    end: complex

    @property
    def area(self) -> float:
        """½(start × end) [mm²]."""
        return 0.5 * float(cross(self.start, self.end))

    def reversed(self) -> Line:
        """The line in the opposite direction."""
        return Line(self.end, self.start)

    def polygon(self, tolerance: float) -> np.ndarray:
        """The start: a line is its own chord.

        Parameters
        ----------
        tolerance : float [mm]

        Returns
        -------
        ndarray (1,) complex [mm]
        """
        return np.array([self.start])


@frozen
class Arc:
    """A circular arc of less than a full turn.

    Attributes
    ----------
    centre : complex [mm]
    radius : float [mm]
    from_angle : float [rad]
        Direction of the start, seen from the centre.
    sweep : float [rad]
        Angle of the arc, positive counter-clockwise.
    """

    centre: complex
    radius: float
    from_angle: float
    sweep: float

    @property
    def start(self) -> complex:
        """First point [mm]."""
        return self.centre + rect(self.radius, self.from_angle)

    @property
    def end(self) -> complex:
        """Last point [mm]."""
        return self.centre + rect(self.radius, self.from_angle + self.sweep)

    @property
    def area(self) -> float:
        """½(r² sweep + centre × (end - start)) [mm²]."""
        return 0.5 * (self.radius**2 * self.sweep + float(cross(self.centre, self.end - self.start)))

    def reversed(self) -> Arc:
        """The arc in the opposite direction."""
        return Arc(self.centre, self.radius, self.from_angle + self.sweep, -self.sweep)

    def polygon(self, tolerance: float) -> np.ndarray:
        """Vertices of equal chords, whose distance from the arc is r (1 - cos(sweep/2n)).

        Parameters
        ----------
        tolerance : float [mm]

        Returns
        -------
        ndarray (n,) complex [mm]
        """
        step = 2.0 * acos(max(1.0 - tolerance / self.radius, 0.5))
        count = ceil(abs(self.sweep) / step)
        return self.centre + self.radius * np.exp(1j * (self.from_angle + self.sweep * np.arange(count) / count))


@frozen(eq=False)
class Spline:
    """A quintic B-spline through n + 1 nodes, with a continuous second derivative by its parameter, the arc length.

    Attributes
    ----------
    nodes : ndarray (n + 1,) [mm]
        Parameters of the nodes, rising.
    points : ndarray (3 n + 3,) complex [mm]
        Control points; the knots are the nodes, three times each, the first and the last six times.
    """

    nodes: np.ndarray
    points: np.ndarray

    @property
    def knots(self) -> tuple[np.ndarray, tuple[int, ...]]:
        """Distinct knots (n + 1,) [mm] and their multiplicities."""
        inner = self.nodes.size - 2
        return self.nodes, (DEGREE + 1, *(3,) * inner, DEGREE + 1)

    @property
    def start(self) -> complex:
        """First point [mm]."""
        return complex(self.points[0])

    @property
    def end(self) -> complex:
        """Last point [mm]."""
        return complex(self.points[-1])

    @property
    def bezier(self) -> np.ndarray:
        """Control points (n, 6) complex [mm] of the Bézier curve over every span."""
        lengths = np.diff(self.nodes)
        left, right = np.append(lengths[0], lengths), np.append(lengths, lengths[-1])
        before, middle, after = self.points.reshape(-1, 3).T
        # of the three points at an inner node the first and the last are Bézier points; the node and its tangent follow
        # from the three by the affine ratios of the two spans
        total = left + right
        inner_low = (right * before + left * middle) / total
        inner_high = (right * middle + left * after) / total
        node = (right * inner_low + left * inner_high) / total
        node[0], inner_high[0], last_high = before[0], middle[0], after[0]
        node[-1], inner_low[-1], first_low = after[-1], middle[-1], before[-1]
        high, low = after.copy(), before.copy()
        high[0], low[-1] = last_high, first_low
        return np.stack((node[:-1], inner_high[:-1], high[:-1], low[1:], inner_low[1:], node[1:]), axis=1)

    @property
    def area(self) -> float:
        """½∫(x dy - y dx) [mm²], exact by Gauss' quadrature: the integrand has degree 9."""
        t, weights = gauss(DEGREE)
        spans = self.bezier
        z, slope = spans @ _bernstein(DEGREE, t), DEGREE * np.diff(spans, axis=1) @ _bernstein(DEGREE - 1, t)
        return 0.5 * float((cross(z, slope) @ weights).sum())

    def reversed(self) -> Spline:
        """The curve in the opposite direction."""
        return Spline((self.nodes[0] + self.nodes[-1]) - self.nodes[::-1], self.points[::-1])

    def polygon(self, tolerance: float) -> np.ndarray:
        """Vertices of chords; a chord over the part h of a span is within h² max|z''|/8 of it.

        Parameters
        ----------
        tolerance : float [mm]

        Returns
        -------
        ndarray (m,) complex [mm]
        """
        spans = self.bezier
        second = DEGREE * (DEGREE - 1) * np.abs(np.diff(spans, 2, axis=1)).max(axis=1)  # the hull contains z''
        counts = np.maximum(np.ceil(np.sqrt(second / (8.0 * tolerance))), 1.0).astype(int)
        rows = np.repeat(np.arange(counts.size), counts)
        first = np.cumsum(counts) - counts
        t = (np.arange(rows.size) - first[rows]) / counts[rows]
        return np.asarray((spans[rows] * _bernstein(DEGREE, t).T).sum(axis=1))


def _bernstein(degree: int, t: np.ndarray) -> np.ndarray:
    """Bernstein polynomials (degree + 1, n) at t (n,)."""
    return np.array([comb(degree, i) * t**i * (1.0 - t) ** (degree - i) for i in range(degree + 1)])


def hermite_spline(nodes: np.ndarray, z: np.ndarray, tangent: np.ndarray, curvature: np.ndarray) -> Spline:
    """Quintic B-spline with given points, unit tangents and curvatures at its nodes.

    The blossom of a polynomial f at s is f(s³, p, q) = f + f'(p + q - 2s)/5 + f''(p - s)(q - s)/20, with p and q the
    neighbouring knots; with the arc length as parameter f' = t and f'' = i κ t.

    Parameters
    ----------
    nodes : ndarray (n + 1,) [mm]
        Arc lengths of the nodes, rising.
    z : ndarray (n + 1,) complex [mm]
    tangent : ndarray (n + 1,) complex, dimensionless
    curvature : ndarray (n + 1,) [1/mm]
        Positive where the curve turns to the left.

    Returns
    -------
    Spline

    References
    ----------
    Ramshaw, *Blossoming: a connect-the-dots approach to splines*, DEC SRC 19, 1987.
    """
    lengths = np.diff(nodes)
    left, right = -np.append(0.0, lengths), np.append(lengths, 0.0)  # from a node to the neighbouring knots
    second = 1j * curvature * tangent
    points = np.stack(
        [z + tangent * (p + q) / 5.0 + second * p * q / 20.0 for p, q in ((left, left), (left, right), (right, right))],
        axis=1,
    )
    points[0] = _ramp(z[0], tangent[0], second[0], lengths[0])
    points[-1] = _ramp(z[-1], tangent[-1], second[-1], -lengths[-1])[::-1]
    return Spline(nodes, points.ravel())


def _ramp(z: complex, tangent: complex, second: complex, length: float) -> list[complex]:
    """The three control points at an end of the curve."""
    return [z, z + tangent * length / 5.0, z + tangent * 2.0 * length / 5.0 + second * length * length / 20.0]


# -- closed outlines --------------------------------------------------------------------------------------------


Outline: TypeAlias = tuple[Line | Arc | Spline, ...]
"""Pieces of a closed outline, each starting where the one before ends; the material is on the left."""


def area(outline: Outline) -> float:
    """Enclosed area [mm²], positive for an outline that runs counter-clockwise."""
    return sum(piece.area for piece in outline)


def reversed_outline(outline: Outline) -> Outline:
    """The outline in the opposite direction."""
    return tuple(piece.reversed() for piece in reversed(outline))


def circle(radius: float) -> Outline:
    """Circle about the origin, counter-clockwise, in two halves, so that no edge ends where it begins."""
    return Arc(0j, radius, 0.0, pi), Arc(0j, radius, pi, pi)


def polygon(outline: Outline, tolerance: float) -> np.ndarray:
    """Vertices of a closed polygon within a tolerance of an outline.

    Parameters
    ----------
    outline : Outline
    tolerance : float [mm]

    Returns
    -------
    ndarray (n,) complex [mm]
    """
    return np.concatenate([piece.polygon(tolerance) for piece in outline])


def slot(bore: float, corners: Sequence[complex]) -> Outline:
    """Bore with a keyway, counter-clockwise.

    Parameters
    ----------
    bore : float
        Radius [mm].
    corners : sequence of complex [mm]
        Corners of the keyway from the bore along one side, its floor and the other side, as by `core.cam.keyway_corners`.
    """
    first, last = np.angle(corners[0]), np.angle(corners[-1])
    sweep = float(np.mod(first - last, 2.0 * pi))
    half = 0.5 * sweep
    arcs = Arc(0j, bore, float(last), half), Arc(0j, bore, float(last) + half, half)
    sides = tuple(Line(start, end) for start, end in pairwise(corners))
    return *arcs, *sides
