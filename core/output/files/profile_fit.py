"""Circular arcs: two of them that join two points with given tangents, distances from them, arcs of one circle made one.

An arc is given as DXF gives it: by its ends p, q and its bulge b = tan(turn/4), positive where it turns left; 0 is a line.
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


SAME_TURN = 1e-9  # relative: half a turn may be so much more
SAME_TANGENT = 1e-11  # [rad] and
SAME_PLACE = 1e-12  # relative: arcs of one circle may be this far from it


def bulge(p: np.ndarray, q: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Bulge (n,) of the arc from p to q that starts along the tangent (n,): the turn is twice the angle between tangent and
    chord."""
    chord = q - p
    # tan(δ/2) of the angle δ from tangent to chord
    along = dot(tangent, chord)
    return cross(tangent, chord) / (np.abs(tangent) * np.abs(chord) + along)


def biarc(
    p: np.ndarray, q: np.ndarray, start: np.ndarray, end: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Two arcs with a common tangent where they join: from p along ``start`` to q along ``end``, unit tangents (n,).

    Of all such pairs the one whose tangents, drawn on to where they meet the common one, are equally long (d):
    v = q - p, t = start + end, d = v² / (v·t + √((v·t)² + 2(1 - start·end)v²)); they join at (p + q + d(start - end))/2.
    Returns the joint and both bulges (n,).
    """
    v, t = q - p, start + end
    square, along = dot(v, v), dot(v, t)
    d = square / (along + np.sqrt(along * along + 2.0 * np.maximum(1.0 - dot(start, end), 0.0) * square))
    joint = 0.5 * (p + q + d * (start - end))
    return joint, bulge(p, joint, start), -bulge(q, joint, -end)


def arc_distance(p: np.ndarray, q: np.ndarray, b: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Distance of points z from arcs; all of one shape, or made so.

    In the chord's frame, p = 0 and q = 1, the arc's circle is b(x² + y² - x) - (1 - b²)y/2 = 0, also where it is a line.
    """
    chord = q - p
    size = np.abs(chord)
    with np.errstate(invalid="ignore", divide="ignore"):
        local = (z - p) / chord
    x, y = local.real, local.imag
    level = b * (x * x + y * y - x) - 0.5 * (1.0 - b * b) * y
    from_centre = np.hypot(b * (x - 0.5), b * y - 0.25 * (1.0 - b * b))
    off = np.abs(level) / (0.25 * (1.0 + b * b) + from_centre)
    # beside the arc: seen from the centre the point lies between its ends; a centre at infinity sees x
    inside = _between(x, y, b)
    ends = np.minimum(np.abs(z - p), np.abs(z - q))
    return np.where(inside & (size > 0.0), off * size, ends)


def _between(x: np.ndarray, y: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Whether points of the chord's frame lie in the sector of the arc: on its side of both normals at its ends, for arcs of at
    most half a turn."""
    cosine, sine = 1.0 - b * b, 2.0 * b  # of half the turn, times 1 + b²; the tangents are turned by it from the chord
    return (x * cosine - y * sine >= 0.0) & ((1.0 - x) * cosine - y * sine >= 0.0)


def joined(p: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A closed chain of arcs, from p_i (n,) to the next, with neighbours of one circle made one, of at most half a turn.

    Between arcs of one circle there is no tangent break, and none comes of it. The first point stays.
    """
    size = float(np.abs(p).max())
    ends, bulges = np.roll(p, -1).tolist(), b.tolist()
    done: list[tuple[complex, complex, float]] = []
    for start, end, turn in zip(p.tolist(), ends, bulges, strict=True):
        whole = _one(*done[-1], end, turn, size) if done else None
        if whole is None:
            done.append((start, end, turn))
        else:
            done[-1] = (done[-1][0], end, whole)
    return np.array([start for start, _, _ in done]), np.array([turn for _, _, turn in done])


def _one(p: complex, middle: complex, first: float, q: complex, second: float, size: float) -> float | None:
    """Bulge of the arc from p over the middle to q, where both halves lie on it; None where they do not, or it would be more
    than half a turn."""
    half = atan(first) + atan(second)  # of the whole turn, a quarter of it each
    if p == q or abs(half) > 0.25 * pi * (1.0 + SAME_TURN):
        return None
    whole = tan(half)
    off = float(arc_distance(np.array(p), np.array(q), np.array(whole), np.array(middle)))
    # the chord seen from both tangents: the turn that the whole arc must have
    starts = phase((middle - p) / (q - p)) - 2.0 * atan(first) + 2.0 * half
    ends = phase((q - middle) / (q - p)) + 2.0 * atan(second) - 2.0 * half
    return whole if off <= SAME_PLACE * size and max(abs(starts), abs(ends)) <= SAME_TANGENT else None


# -- what runs through the points of a file ---------------------------------------------------------------------


NEWTON = 5  # steps to the foot of a perpendicular


class CurveChain(Protocol):
    """Curve pieces over n spans, from each point to the next."""

    def distance(self, span: np.ndarray, z: np.ndarray, part: np.ndarray) -> np.ndarray:
        """Distance (m, k) of points z (m, k) from the pieces of the spans (m,); part: roughly where on the span, 0 ... 1."""


@frozen(eq=False)
class Arcs:
    """One or more arcs a span: p (n, parts + 1) where they meet, bulges b (n, parts)."""

    p: np.ndarray
    b: np.ndarray

    def distance(self, span: np.ndarray, z: np.ndarray, part: np.ndarray) -> np.ndarray:
        """Distance (m, k) [mm] of points z (m, k) from the pieces of the spans (m,)."""
        each = [
            arc_distance(self.p[span, i, None], self.p[span, i + 1, None], self.b[span, i, None], z)
            for i in range(self.b.shape[1])
        ]
        return np.asarray(np.min(each, axis=0))

    @property
    def vertices(self) -> np.ndarray:
        """All points where arcs meet, the last span's end being the first point."""
        return self.p[:, :-1].ravel()

    def simplified(self) -> Arcs:
        """Each arc a span of its own, neighbours of one circle made one."""
        if not self.b.any():
            return self
        p, b = joined(self.vertices, self.b.ravel())
        return Arcs(np.stack((p, np.roll(p, -1)), axis=1), b[:, None])


@frozen(eq=False)
class Cubics:
    """A cubic a span: its four Bézier points (n, 4), and the lengths of the spans (n,), which are its knots' distances."""

    points: np.ndarray
    lengths: np.ndarray

    def distance(self, span: np.ndarray, z: np.ndarray, part: np.ndarray) -> np.ndarray:
        """Distance (m, k) [mm] of points z (m, k) from the pieces of the spans (m,)."""
        p = self.points[span]
        # as a polynomial in 0 ... 1
        c0, c1 = p[:, 0, None], 3.0 * (p[:, 1, None] - p[:, 0, None])
        c2 = 3.0 * (p[:, 0, None] - 2.0 * p[:, 1, None] + p[:, 2, None])
        c3 = p[:, 3, None] - 3.0 * p[:, 2, None] + 3.0 * p[:, 1, None] - p[:, 0, None]
        t = np.clip(part, 0.0, 1.0)
        for _ in range(NEWTON):
            slope = c1 + t * (2.0 * c2 + t * 3.0 * c3)
            off = c0 + t * (c1 + t * (c2 + t * c3)) - z
            # without the cubic's own bend, which counts little near the curve
            t = np.clip(t - dot(off, slope) / dot(slope, slope), 0.0, 1.0)
        return np.abs(c0 + t * (c1 + t * (c2 + t * c3)) - z)

    @property
    def vertices(self) -> np.ndarray:
        """The points that it goes through."""
        return self.points[:, 0]

    def simplified(self) -> Cubics:
        """The same chain: a cubic has nothing to leave out."""
        return self


def chords(a: SpanEnds, b: SpanEnds) -> Arcs:
    """Straight from point to point."""
    return Arcs(np.stack((a.z, b.z), axis=1), np.zeros((a.z.size, 1)))


def tangent_arcs(a: SpanEnds, b: SpanEnds) -> Arcs:
    """Two arcs from point to point, with the curve's tangents there."""
    joint, first, second = biarc(a.z, b.z, a.tangent, b.tangent)
    return Arcs(np.stack((a.z, joint, b.z), axis=1), np.stack((first, second), axis=1))


def spline(a: SpanEnds, b: SpanEnds) -> Cubics:
    """The cubic by arc length with the curve's tangents (Hermite): one C1 spline with double knots."""
    length = b.s - a.s
    third = length / 3.0
    return Cubics(np.stack((a.z, a.z + third * a.tangent, b.z - third * b.tangent, b.z), axis=1), length)


@frozen
class FitMethod:
    """One row: what it is called in a sentence; the pieces between points a and b; order of its deviation in the span's
    length; how far the tangent may turn over one span [rad]."""

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
