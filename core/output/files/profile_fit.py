"""Circular arcs and cubics through the points of a curve, and their distance from it.

An arc is stored as in DXF: by its ends p, q and its bulge b = tan(turn/4), positive where it turns left; 0 is a line.
"""

from __future__ import annotations

from cmath import phase
from collections.abc import Callable, Mapping
from math import atan, pi, tan
from types import MappingProxyType
from typing import Protocol

import numpy as np

from core.frozen import frozen
from core.numerics.derivatives import cross, dot
from core.output.files.profile_curve import SpanEnds

# -- circular arcs ----------------------------------------------------------------------------------------------


SAME_TURN = 1e-9  # relative tolerance of half a turn
SAME_TANGENT = 1e-11  # [rad] tolerance of the tangents of arcs on one circle
SAME_POINT = 1e-12  # relative tolerance of their common end


def bulge(p: np.ndarray, q: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Bulge of the arc from p to q that starts along a tangent: its turn is twice the angle δ from tangent to chord.

    Parameters
    ----------
    p, q : ndarray (n,) complex [mm]
        Ends of the arcs.
    tangent : ndarray (n,) complex, dimensionless
        Tangent at p.

    Returns
    -------
    ndarray (n,), dimensionless
        tan(δ/2).
    """
    chord = q - p

    along = dot(tangent, chord)
    return cross(tangent, chord) / (np.abs(tangent) * np.abs(chord) + along)


def biarc(
    p: np.ndarray, q: np.ndarray, start: np.ndarray, end: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Two arcs with a common tangent where they join.

    Of all such pairs, the one with equally long tangents d from p and q to the common tangent:
    v = q - p, t = start + end, d = v²/(v·t + √((v·t)² + 2(1 - start·end)v²)); joint (p + q + d(start - end))/2.

    Parameters
    ----------
    p, q : ndarray (n,) complex [mm]
        Ends of the pairs.
    start, end : ndarray (n,) complex, dimensionless
        Unit tangents at p and q.

    Returns
    -------
    joint : ndarray (n,) complex [mm]
    first, second : ndarray (n,), dimensionless
        Bulges of both arcs.
    """
    v, t = q - p, start + end
    square, along = dot(v, v), dot(v, t)
    d = square / (along + np.sqrt(along * along + 2.0 * np.maximum(1.0 - dot(start, end), 0.0) * square))
    joint = 0.5 * (p + q + d * (start - end))
    return joint, bulge(p, joint, start), -bulge(q, joint, -end)


def arc_distance(p: np.ndarray, q: np.ndarray, b: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Distance of points from arcs of at most half a turn.

    In the chord's frame, p = 0 and q = 1, the circle is b(x² + y² - x) - (1 - b²)y/2 = 0, also where it is a line.

    Parameters
    ----------
    p, q : ndarray (...) complex [mm]
        Ends of the arcs; all arrays broadcast.
    b : ndarray (...), dimensionless
        Bulges.
    z : ndarray (...) complex [mm]
        Points.

    Returns
    -------
    ndarray (...) [mm]
    """
    chord = q - p
    size = np.abs(chord)
    with np.errstate(invalid="ignore", divide="ignore"):
        local = (z - p) / chord
    x, y = local.real, local.imag
    level = b * (x * x + y * y - x) - 0.5 * (1.0 - b * b) * y
    from_centre = np.hypot(b * (x - 0.5), b * y - 0.25 * (1.0 - b * b))
    distance = np.abs(level) / (0.25 * (1.0 + b * b) + from_centre)
    ends = np.minimum(np.abs(z - p), np.abs(z - q))
    return np.where(_is_in_sector(x, y, b) & (size > 0.0), distance * size, ends)


def _is_in_sector(x: np.ndarray, y: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Whether points of the chord's frame are between the normals at the ends of an arc of at most half a turn."""
    cosine, sine = 1.0 - b * b, 2.0 * b  # of half the turn, times 1 + b²: angle between chord and tangents
    return (x * cosine - y * sine >= 0.0) & ((1.0 - x) * cosine - y * sine >= 0.0)


def merge_arcs(p: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Merge neighbouring arcs of one circle in a closed chain, up to half a turn; tangents stay continuous.

    Parameters
    ----------
    p : ndarray (n,) complex [mm]
        Ends: arc i runs from p_i to the next; the first is retained.
    b : ndarray (n,), dimensionless
        Bulges.

    Returns
    -------
    p : ndarray (m,) complex [mm]
    b : ndarray (m,), dimensionless
    """
    size = float(np.abs(p).max())
    ends, bulges = np.roll(p, -1).tolist(), b.tolist()
    arcs: list[tuple[complex, complex, float]] = []
    for start, end, turn in zip(p.tolist(), ends, bulges, strict=True):
        merged = _merged_bulge(*arcs[-1], end, turn, size) if arcs else None
        if merged is None:
            arcs.append((start, end, turn))
        else:
            arcs[-1] = (arcs[-1][0], end, merged)
    return np.array([start for start, _, _ in arcs]), np.array([turn for _, _, turn in arcs])


def _merged_bulge(p: complex, middle: complex, first: float, q: complex, second: float, size: float) -> float | None:
    """Bulge of the arc from p over ``middle`` to q; None where the halves are not on one circle, or exceed half a turn."""
    half = atan(first) + atan(second)  # of the total turn
    if p == q or abs(half) > 0.25 * pi * (1.0 + SAME_TURN):
        return None
    merged = tan(half)
    distance = float(arc_distance(np.array(p), np.array(q), np.array(merged), np.array(middle)))
    # angles between chord and both tangents, less those of the merged arc
    start_error = phase((middle - p) / (q - p)) - 2.0 * atan(first) + 2.0 * half
    end_error = phase((q - middle) / (q - p)) + 2.0 * atan(second) - 2.0 * half
    return merged if distance <= SAME_POINT * size and max(abs(start_error), abs(end_error)) <= SAME_TANGENT else None


# -- curves through the points of a file ------------------------------------------------------------------------


NEWTON_STEPS = 5  # to the nearest point of a polynomial


class CurveChain(Protocol):
    """Pieces of a curve over n spans, from each point to the next."""

    def distance(self, span: np.ndarray, z: np.ndarray, part: np.ndarray) -> np.ndarray:
        """Distance of points from the pieces over given spans.

        Parameters
        ----------
        span : ndarray (m,), dimensionless
            Indices of the spans.
        z : ndarray (m, k) complex [mm]
            Points, k for a span.
        part : ndarray (m, k), dimensionless
            Their approximate position along the span, 0 ... 1.

        Returns
        -------
        ndarray (m, k) [mm]
        """


def polynomial_distance(powers: np.ndarray, z: np.ndarray, part: np.ndarray) -> np.ndarray:
    """Distance of points from polynomial curves in x = 0 ... 1, by Newton's method.

    The second derivative is neglected: it counts little near the curve.

    Parameters
    ----------
    powers : ndarray (m, d + 1) complex [mm]
        Coefficients of the m curves of degree d, lowest order first.
    z : ndarray (m, k) complex [mm]
        Points, k for a curve.
    part : ndarray (m, k), dimensionless
        Their approximate x.

    Returns
    -------
    ndarray (m, k) [mm]
    """
    rows = powers.T[:, :, None]
    t = np.clip(part, 0.0, 1.0)
    for step in range(NEWTON_STEPS + 1):
        value, slope = rows[-1] * t + rows[-2], rows[-1]
        for row in rows[-3::-1]:
            value, slope = value * t + row, slope * t + value
        if step < NEWTON_STEPS:
            t = np.clip(t - dot(value - z, slope) / dot(slope, slope), 0.0, 1.0)
    return np.abs(value - z)


@frozen(eq=False)
class Arcs:
    """One or more arcs over each of n spans.

    Attributes
    ----------
    p : (n, k + 1) complex ends of the k arcs of a span [mm]
    b : (n, k) bulges
    """

    p: np.ndarray
    b: np.ndarray

    def distance(self, span: np.ndarray, z: np.ndarray, part: np.ndarray) -> np.ndarray:
        """Distance of points from the pieces over given spans.

        Parameters
        ----------
        span : ndarray (m,), dimensionless
            Indices of the spans.
        z : ndarray (m, k) complex [mm]
            Points, k for a span.
        part : ndarray (m, k), dimensionless
            Their approximate position along the span, 0 ... 1.

        Returns
        -------
        ndarray (m, k) [mm]
        """
        distances = [
            arc_distance(self.p[span, i, None], self.p[span, i + 1, None], self.b[span, i, None], z)
            for i in range(self.b.shape[1])
        ]
        return np.asarray(np.min(distances, axis=0))

    @property
    def vertices(self) -> np.ndarray:
        """Points where arcs meet (n k,), complex [mm]; the last arc ends at the first point."""
        return self.p[:, :-1].ravel()

    def simplified(self) -> Arcs:
        """The chain with one arc a span, neighbouring arcs of one circle merged."""
        if not self.b.any():
            return self
        p, b = merge_arcs(self.vertices, self.b.ravel())
        return Arcs(np.stack((p, np.roll(p, -1)), axis=1), b[:, None])


_POWERS = np.array([[1, -3, 3, -1], [0, 3, -6, 3], [0, 0, 3, -3], [0, 0, 0, 1]], dtype=float)
"""Bézier points of a cubic times this: its coefficients, lowest order first."""


@frozen(eq=False)
class Cubics:
    """One cubic over each of n spans.

    Attributes
    ----------
    points : (n, 4) complex Bézier points [mm]
    lengths : (n,) lengths of the spans, which are the differences of the knots [mm]
    """

    points: np.ndarray
    lengths: np.ndarray

    def distance(self, span: np.ndarray, z: np.ndarray, part: np.ndarray) -> np.ndarray:
        """Distance of points from the pieces over given spans.

        Parameters
        ----------
        span : ndarray (m,), dimensionless
            Indices of the spans.
        z : ndarray (m, k) complex [mm]
            Points, k for a span.
        part : ndarray (m, k), dimensionless
            Their approximate position along the span, 0 ... 1.

        Returns
        -------
        ndarray (m, k) [mm]
        """
        return polynomial_distance(self.points[span] @ _POWERS, z, part)

    @property
    def vertices(self) -> np.ndarray:
        """Points at which the spans begin (n,), complex [mm]."""
        return self.points[:, 0]

    def simplified(self) -> Cubics:
        """The chain itself: no cubic can be omitted."""
        return self


def chords(a: SpanEnds, b: SpanEnds) -> Arcs:
    """Straight lines from point to point."""
    return Arcs(np.stack((a.z, b.z), axis=1), np.zeros((a.z.size, 1)))


def tangent_arcs(a: SpanEnds, b: SpanEnds) -> Arcs:
    """Two arcs from point to point, along the curve's tangents at both."""
    joint, first, second = biarc(a.z, b.z, a.tangent, b.tangent)
    return Arcs(np.stack((a.z, joint, b.z), axis=1), np.stack((first, second), axis=1))


def spline(a: SpanEnds, b: SpanEnds) -> Cubics:
    """Cubic Hermite spline by arc length with the curve's tangents: one C1 spline with double knots."""
    length = b.s - a.s
    third = length / 3.0
    return Cubics(np.stack((a.z, a.z + third * a.tangent, b.z - third * b.tangent, b.z), axis=1), length)


@frozen
class FitMethod:
    """One row of ``FITS``.

    Attributes
    ----------
    label : name in a sentence
    pieces : the pieces between points a and b
    order : the deviation grows with this power of the span's length
    most_turning : largest turn of the tangent over one span [rad]
    """

    label: str
    pieces: Callable[[SpanEnds, SpanEnds], Arcs | Cubics]
    order: float
    most_turning: float


FITS: Mapping[str, FitMethod] = MappingProxyType(
    {
        "spline": FitMethod("cubic spline", spline, 4.0, 0.5 * pi),
        "polyline": FitMethod("closed polyline", chords, 2.0, 0.75 * pi),
        "arcs": FitMethod("tangent arcs", tangent_arcs, 3.0, pi),
    }
)
