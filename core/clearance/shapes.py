"""Shapes of bodies: lines and arcs in the frame of the body [m], each grown by a distance.

A point is a line without length, so that a circle is a grown point and a bar a grown line.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from core.frozen import frozen
from core.numerics.lazy import lazy

if TYPE_CHECKING:  # few outlines are drawings
    from core.contour.elements import ContourElement

LONGEST_SWEEP = 0.5 * np.pi  # of an arc; longer ones are divided, so that a small disc contains each
MM = 1e-3
ARC_STEP = np.deg2rad(3.0)  # [rad] between points of an arc that is drawn
SMOOTH = 1e-7  # [rad]: turn of the tangent at a joint below which it is no corner


@frozen(eq=False)
class Shape:
    """Lines and arcs of one or several outlines of a body, in the frame of the body.

    Attributes
    ----------
    start, end : ndarray (k,) complex [m]
        Ends of the elements.
    centre : ndarray (k,) complex [m]
        Centre of an arc; the middle of a line.
    radius : ndarray (k,) [m]
        Radius of an arc; 0 of a line.
    sweep : ndarray (k,) [rad]
        Turn of an arc, positive counter-clockwise; 0 of a line.
    growth : ndarray (k,) [m]
        Distance by which the outline of the element is grown.
    outline : ndarray (k,) of int, dimensionless
        Number of the outline to which the element belongs.
    layers : ndarray (m, 2) [m]
        Begin and end of the layer of each of the m outlines.
    encloses : ndarray (m,) of bool, dimensionless
        Whether the outline encloses an area.
    deviation : float [m]
        Largest distance of the elements from the true outline.
    """

    start: np.ndarray
    end: np.ndarray
    centre: np.ndarray
    radius: np.ndarray
    sweep: np.ndarray
    growth: np.ndarray
    outline: np.ndarray
    layers: np.ndarray
    encloses: np.ndarray
    deviation: float = 0.0

    @property
    def size(self) -> int:
        """Number k of elements."""
        return int(self.start.size)

    @lazy
    def is_arc(self) -> np.ndarray:
        """Whether each element is an arc, ndarray (k,) of bool."""
        return self.radius > 0.0

    @lazy
    def middle(self) -> np.ndarray:
        """Direction from the centre to the middle of each arc, ndarray (k,) complex; 1 of a line."""
        radius = np.where(self.is_arc, self.radius, 1.0)
        return np.where(self.is_arc, (self.start - self.centre) / radius * np.exp(0.5j * self.sweep), 1.0)

    @lazy
    def cos_half(self) -> np.ndarray:
        """Cosine of half the sweep of each arc, ndarray (k,)."""
        return np.cos(0.5 * self.sweep)

    @lazy
    def disc_centre(self) -> np.ndarray:
        """Centre of a disc that contains the element, ndarray (k,) complex [m]."""
        return np.asarray(0.5 * (self.start + self.end))

    @lazy
    def disc_radius(self) -> np.ndarray:
        """Radius of that disc, ndarray (k,) [m]; no arc turns by more than a quarter."""
        return np.asarray(0.5 * np.abs(self.end - self.start))

    @lazy
    def is_corner(self) -> np.ndarray:
        """Whether the start and the end of each element are corners, where the tangent turns, ndarray (2, k) of bool."""
        chord = np.where(self.end != self.start, self.end - self.start, 1.0)
        first, last = (chord * np.exp(0.5j * sign * self.sweep) for sign in (-1.0, 1.0))
        corners = np.ones((2, self.size), dtype=bool)
        for number in np.flatnonzero(self.encloses):
            of = np.flatnonzero(self.outline == number)
            before = np.roll(of, 1)
            corners[0, of] = np.abs(np.angle(first[of] * last[before].conj())) > SMOOTH
            corners[1, before] = corners[0, of]
        return corners

    @lazy
    def disc(self) -> tuple[complex, float]:
        """Centre [m] and radius [m] of a disc that contains all elements."""
        z = np.concatenate((self.start, self.end))
        middle = complex(0.5 * (z.real.min() + z.real.max()), 0.5 * (z.imag.min() + z.imag.max()))
        return middle, float((np.abs(self.disc_centre - middle) + self.disc_radius).max())

    def reflected(self) -> Shape:
        """The shape seen from the other end of the shaft, x → -x."""
        start, end, centre = (-z.conj() for z in (self.start, self.end, self.centre))
        more = (self.growth, self.outline, self.layers, self.encloses, self.deviation)
        return Shape(start, end, centre, self.radius, -self.sweep, *more)

    def rotated(self, unit: complex) -> Shape:
        """The shape rotated about the origin of its frame by a unit vector."""
        start, end, centre = (z * unit for z in (self.start, self.end, self.centre))
        more = (self.growth, self.outline, self.layers, self.encloses, self.deviation)
        return Shape(start, end, centre, self.radius, self.sweep, *more)

    def curve(self, number: int) -> np.ndarray:
        """Points along one outline, without its growth: the ends of its elements, and points of its arcs every 3 degrees.

        Parameters
        ----------
        number : int
            Number of the outline.

        Returns
        -------
        ndarray (p,) complex [m]
        """
        points: list[np.ndarray] = []
        for i in np.flatnonzero(self.outline == number).tolist():
            count = max(1, int(np.ceil(abs(self.sweep[i]) / ARC_STEP)))
            turn = np.exp(1j * self.sweep[i] * np.arange(count) / count)
            is_arc = self.radius[i] > 0.0
            points.append(self.centre[i] + (self.start[i] - self.centre[i]) * turn if is_arc else self.start[i : i + 1])
        if not self.encloses[number]:
            points.append(self.end[self.outline == number])
        return np.concatenate(points)

    def contains(self, point: complex) -> bool:
        """Whether a point [m] of the body's frame is inside one of the outlines, or on it to rounding."""
        near = _point_distance(self, point) - self.growth <= 1e-9 * (1.0 + abs(point))
        numbers = np.flatnonzero(self.encloses)
        return bool(near.any()) or any(encloses_points(self, int(m), np.array([point]))[0] for m in numbers)


def _point_distance(shape: Shape, z: complex) -> np.ndarray:
    """Distance of a point from every element (k,) [m]."""
    chord = shape.end - shape.start
    square = np.abs(chord) ** 2
    part = np.clip(((z - shape.start) * chord.conj()).real / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    on_line = np.abs(z - shape.start - part * chord)
    w = z - shape.centre
    within = (w * shape.middle.conj()).real >= np.abs(w) * shape.cos_half
    ends = np.minimum(np.abs(z - shape.start), np.abs(z - shape.end))
    on_arc = np.where(within, np.abs(np.abs(w) - shape.radius), ends)
    return np.where(shape.is_arc, on_arc, on_line)


def encloses_points(shape: Shape, number: int, points: np.ndarray) -> np.ndarray:
    """Whether an outline encloses points, by its winding number about each.

    The angle of the chord of an element is Im log((end - z)/(start - z)); between chord and arc an arc adds a full turn.

    Parameters
    ----------
    shape : Shape
    number : int
        Number of the outline.
    points : ndarray (n,) complex [m]
        Points in the frame of the body.

    Returns
    -------
    ndarray (n,) of bool, dimensionless
    """
    of = shape.outline == number
    start, end, centre = shape.start[of], shape.end[of], shape.centre[of]
    radius, sweep = shape.radius[of], shape.sweep[of]
    a, b = start - points[:, None], end - points[:, None]
    turn = np.angle(b * a.conj()).sum(axis=1)
    chord = end - start
    beyond = (chord.conj() * -a).imag  # positive to the left of the chord
    in_segment = (np.abs(points[:, None] - centre) < radius) & (beyond * sweep < 0.0)
    turn += 2.0 * np.pi * np.where(in_segment, np.sign(sweep), 0.0).sum(axis=1)
    return np.abs(turn) > np.pi


# -- shapes from outlines -------------------------------------------------------------------------------------


def joined(shapes: Sequence[Shape]) -> Shape:
    """One shape of several outlines of a body."""
    counts = np.cumsum([0, *(shape.layers.shape[0] for shape in shapes)])
    start, end, centre, radius, sweep, growth = (
        np.concatenate([getattr(shape, name) for shape in shapes])
        for name in ("start", "end", "centre", "radius", "sweep", "growth")
    )
    outline = np.concatenate([shape.outline + int(count) for shape, count in zip(shapes, counts, strict=False)])
    layers = np.concatenate([shape.layers for shape in shapes])
    encloses = np.concatenate([shape.encloses for shape in shapes])
    deviation = max(shape.deviation for shape in shapes)
    return Shape(start, end, centre, radius, sweep, growth, outline, layers, encloses, deviation)


def polygon(corners: np.ndarray, growth: float, layer: tuple[float, float]) -> Shape:
    """Shape of corners in their order: a point, a line, or a closed polygon.

    Parameters
    ----------
    corners : ndarray (c,) complex [m]
    growth : float [m]
    layer : tuple of float [m]
        Begin and end of the layer.

    Returns
    -------
    Shape
    """
    if corners.size < 3:
        return _of_rows(corners[:1], corners[-1:], corners[:1], np.zeros(1), growth, layer, False)
    end = np.roll(corners, -1)
    return _of_rows(corners, end, 0.5 * (corners + end), np.zeros(corners.size), growth, layer, True)


def closed_curve(
    elements: Sequence[ContourElement], growth: float, layer: tuple[float, float], deviation: float = 0.0
) -> Shape:
    """Shape of a closed chain of lines and arcs [mm]; a full circle is a grown point.

    Parameters
    ----------
    elements : sequence of ContourElement
    growth : float [m]
    layer : tuple of float [m]
        Begin and end of the layer.
    deviation : float [m]
        Largest distance of the chain from the true outline.

    Returns
    -------
    Shape
    """
    if len(elements) == 1:  # a circle
        only = elements[0]
        return polygon(np.array([only.centre * MM]), only.radius * MM + growth, layer)
    parts = []
    for element in elements:
        count = max(1, int(np.ceil(abs(element.sweep) / LONGEST_SWEEP - 1e-9)))
        parts += [element.piece(i / count, (i + 1) / count) for i in range(count)]
    start, end = (np.array([getattr(part, name) for part in parts]) * MM for name in ("start", "end"))
    sweep = np.array([part.sweep for part in parts])
    centre = np.where(sweep != 0.0, np.array([part.centre for part in parts]) * MM, 0.5 * (start + end))
    return _of_rows(start, end, centre, sweep, growth, layer, True, deviation)


def arcs(
    start: np.ndarray, end: np.ndarray, bulge: np.ndarray, growth: float, layer: tuple[float, float], deviation: float
) -> Shape:
    """Shape of a closed chain of arcs by their bulges, the tangents of a quarter of their sweeps.

    Parameters
    ----------
    start, end : ndarray (k,) complex [m]
    bulge : ndarray (k,), dimensionless
        Positive where the arc turns left.
    growth : float [m]
    layer : tuple of float [m]
        Begin and end of the layer.
    deviation : float [m]
        Largest distance of the chain from the true outline.

    Returns
    -------
    Shape
    """
    straight = np.abs(bulge) < 1e-9
    b = np.where(straight, 1.0, bulge)
    centre = 0.5 * (start + end) + np.where(straight, 0.0, 0.25j * (end - start) * (1.0 - b * b) / b)
    sweep = np.where(straight, 0.0, 4.0 * np.arctan(bulge))
    return _of_rows(start, end, centre, sweep, growth, layer, True, deviation)


def _of_rows(
    start: np.ndarray,
    end: np.ndarray,
    centre: np.ndarray,
    sweep: np.ndarray,
    growth: float,
    layer: tuple[float, float],
    encloses: bool,
    deviation: float = 0.0,
) -> Shape:
    """Shape of one outline."""
    k = start.size
    radius = np.where(sweep != 0.0, np.abs(start - centre), 0.0)
    numbers = np.zeros(k, dtype=int)
    return Shape(
        start,
        end,
        centre,
        radius,
        sweep,
        np.full(k, growth),
        numbers,
        np.array([layer]),
        np.array([encloses]),
        deviation,
    )


def convex_hull(points: np.ndarray) -> np.ndarray:
    """Corners of the convex hull, counter-clockwise (Andrew's monotone chain).

    Parameters
    ----------
    points : ndarray (n,) complex [m]

    Returns
    -------
    ndarray (h,) complex [m]
        The two ends where all points are on a line.
    """
    rows = sorted({(z.real, z.imag) for z in points.tolist()})
    if len(rows) < 3:
        return np.array([complex(*row) for row in rows])

    def chain(ordered: list[tuple[float, float]]) -> list[tuple[float, float]]:
        result: list[tuple[float, float]] = []
        for x, y in ordered:
            while len(result) > 1:
                (ax, ay), (bx, by) = result[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                    break
                result.pop()
            result.append((x, y))
        return result[:-1]

    return np.array([complex(*row) for row in (*chain(rows), *chain(rows[::-1]))])
