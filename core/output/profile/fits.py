"""What runs through the points of a file: chords, a cubic spline, tangent arcs. One row each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi
from types import MappingProxyType
from typing import Protocol

import numpy as np

from core.frozen import frozen
from core.numerics.vectors import dot
from core.output.profile import biarcs
from core.output.profile.curve import SpanEnds

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
            biarcs.distance(self.p[span, i, None], self.p[span, i + 1, None], self.b[span, i, None], z)
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
        p, b = biarcs.joined(self.vertices, self.b.ravel())
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
    joint, first, second = biarcs.biarc(a.z, b.z, a.tangent, b.tangent)
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


__all__ = ["FITS", "Arcs", "Cubics", "CurveChain", "FitMethod"]
