"""Lines and arcs of a plane curve [mm] in complex numbers: their points, distances from a point, and intersections."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence

import numpy as np

from core.errors import KindynaError
from core.frozen import frozen

SAMPLES_PER_TURN = 64
STRAIGHT = 1e-15  # bulge below which an arc is a line to rounding
MOST_PAIRS = 300_000
BLOCK = 256  # elements whose neighbours are searched together
ON = 1e-9  # relative: a point so far beyond the ends of an element is still on it


@frozen
class ContourElement:
    """A line, or an arc with its sweep [rad], positive where it turns left, and its centre; from start to end [mm]."""

    start: complex
    end: complex
    sweep: float = 0.0
    centre: complex = 0j

    @property
    def is_line(self) -> bool:
        """Whether it is a line, not an arc."""
        return self.sweep == 0.0

    @property
    def radius(self) -> float:
        """Radius of an arc [mm]."""
        return abs(self.start - self.centre)

    @property
    def length(self) -> float:
        """Length [mm]."""
        return abs(self.end - self.start) if self.is_line else abs(self.sweep) * self.radius

    @property
    def curvature(self) -> float:
        """Curvature [1/mm], positive where it turns left: convex, on a curve counter-clockwise round its body."""
        return 0.0 if self.is_line else math.copysign(1.0 / self.radius, self.sweep)

    def at(self, part: np.ndarray | float) -> np.ndarray:
        """Points at fractions of the length.

        Parameters
        ----------
        part : float or ndarray (n,), dimensionless
            0 ... 1.

        Returns
        -------
        ndarray (n,) complex [mm]
        """
        part = np.asarray(part, dtype=float)
        if self.is_line:
            return self.start + part * (self.end - self.start)
        return self.centre + (self.start - self.centre) * np.exp(1j * self.sweep * part)

    def tangent(self, part: np.ndarray | float) -> np.ndarray:
        """Unit tangents at fractions of the length.

        Parameters
        ----------
        part : float or ndarray (n,), dimensionless
            0 ... 1.

        Returns
        -------
        ndarray (n,) complex, dimensionless
        """
        part = np.asarray(part, dtype=float)
        if self.is_line:
            return np.full(part.shape, (self.end - self.start) / abs(self.end - self.start))
        radial = (self.start - self.centre) / self.radius
        return 1j * math.copysign(1.0, self.sweep) * radial * np.exp(1j * self.sweep * part)

    def normal(self, part: np.ndarray | float) -> np.ndarray:
        """Unit normals to the right, at fractions of the length: away from a body inside a counter-clockwise curve.

        Parameters
        ----------
        part : float or ndarray (n,), dimensionless
            0 ... 1.

        Returns
        -------
        ndarray (n,) complex, dimensionless
        """
        return -1j * self.tangent(part)

    def reversed(self) -> ContourElement:
        """The same element from its end to its start."""
        return ContourElement(self.end, self.start, -self.sweep, self.centre)

    def transformed(self, shift: complex, scale: float = 1.0) -> ContourElement:
        """The element scaled, then shifted."""
        start, end, centre = (scale * z + shift for z in (self.start, self.end, self.centre))
        return ContourElement(start, end, self.sweep, centre)

    def offset(self, distance: float) -> ContourElement | None:
        """The parallel element at a distance to the right; None for an arc beyond its centre."""
        if self.is_line:
            shift = distance * complex(self.normal(0.0))
            return ContourElement(self.start + shift, self.end + shift)
        ratio = 1.0 + distance * self.curvature
        if ratio <= ON:
            return None
        c = self.centre
        return ContourElement(c + ratio * (self.start - c), c + ratio * (self.end - c), self.sweep, c)

    def fraction_at(self, z: complex) -> float:
        """Fraction 0 ... 1 of the length at a point of its line or circle; outside of 0 ... 1 beyond the ends."""
        if self.is_line:
            chord = self.end - self.start
            return ((z - self.start) * chord.conjugate()).real / abs(chord) ** 2
        turn = cmath.phase((z - self.centre) / (self.start - self.centre)) * math.copysign(1.0, self.sweep)
        half_gap = 0.5 * (2.0 * math.pi - abs(self.sweep))
        return (turn if turn >= -half_gap else turn + 2.0 * math.pi) / abs(self.sweep)

    def piece(self, low: float, high: float) -> ContourElement:
        """The piece between two fractions of the length."""
        start = self.start if low == 0.0 else complex(self.at(low))
        end = self.end if high == 1.0 else complex(self.at(high))
        return ContourElement(start, end, self.sweep * (high - low), self.centre)

    def with_ends(self, start: complex, end: complex) -> ContourElement:
        """The same element with slightly shifted ends; an arc keeps its circle."""
        return ContourElement(start, end) if self.is_line else ContourElement(start, end, self.sweep, self.centre)

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Bounding box: x from, to, y from, to [mm]."""
        if self.is_line:
            (x, y), (u, v) = (self.start.real, self.start.imag), (self.end.real, self.end.imag)
            return min(x, u), max(x, u), min(y, v), max(y, v)
        z = self.at(np.linspace(0.0, 1.0, 9))
        # between samples the distance of an arc from its chord is less than the sagitta
        sagitta = self.radius * (1.0 - math.cos(abs(self.sweep) / 16.0))
        return z.real.min() - sagitta, z.real.max() + sagitta, z.imag.min() - sagitta, z.imag.max() + sagitta


def line(start: complex, end: complex) -> ContourElement:
    """The straight line from start to end [mm]."""
    return ContourElement(start, end)


def arc_of_bulge(start: complex, end: complex, bulge: float) -> ContourElement:
    """Arc with the bulge b, the tangent of a quarter of its sweep.

    Its centre is (start + end)/2 + i(1 - b²)/(4b) (end - start).
    """
    if abs(bulge) < STRAIGHT:
        return ContourElement(start, end)
    chord = end - start
    centre = 0.5 * (start + end) + 0.25j * chord * (1.0 - bulge * bulge) / bulge
    return ContourElement(start, end, 4.0 * math.atan(bulge), centre)


def arc(centre: complex, radius: float, angle: float, sweep: float) -> ContourElement:
    """Arc with a start angle and a sweep [rad] about its centre."""
    start, end = (centre + cmath.rect(radius, a) for a in (angle, angle + sweep))
    return ContourElement(start, start if abs(abs(sweep) - 2.0 * math.pi) < 1e-12 else end, sweep, centre)


def sampled(elements: Sequence[ContourElement]) -> np.ndarray:
    """Points along a chain, without the end of each element, which is the start of the next.

    Parameters
    ----------
    elements : sequence of ContourElement

    Returns
    -------
    ndarray (n,) complex [mm]
    """
    points: list[complex] = []
    for element in elements:
        count = max(1, math.ceil(abs(element.sweep) / (2.0 * math.pi) * SAMPLES_PER_TURN))
        points += [element.start] if count == 1 else element.at(np.arange(count) / count).tolist()
    return np.array(points)


def area(elements: Sequence[ContourElement]) -> float:
    """Area inside a closed chain [mm²], positive where it runs counter-clockwise: polygon and segments of the arcs."""
    total = 0.0
    for element in elements:
        total += 0.5 * (element.start.conjugate() * element.end).imag
        if not element.is_line:
            total += 0.5 * element.radius**2 * (element.sweep - math.sin(element.sweep))
    return total


def winding(elements: Sequence[ContourElement], z: complex) -> int:
    """Winding number of a closed chain around a point."""
    points = sampled(elements) - z
    return round(float(np.angle(np.roll(points, -1) * points.conj()).sum()) / (2.0 * math.pi))


def distances(elements: Sequence[ContourElement], z: complex) -> np.ndarray:
    """Distance of a point from every element.

    Parameters
    ----------
    elements : sequence of ContourElement
    z : complex
        The point [mm].

    Returns
    -------
    ndarray (k,) [mm]
    """
    return np.array([_distance(element, z) for element in elements])


def _distance(element: ContourElement, z: complex) -> float:
    if 0.0 <= element.fraction_at(z) <= 1.0:
        if element.is_line:
            chord = element.end - element.start
            return abs(((z - element.start) * chord.conjugate()).imag) / abs(chord)
        return abs(abs(z - element.centre) - element.radius)
    return min(abs(z - element.start), abs(z - element.end))


# -- intersections ----------------------------------------------------------------------------------------


def intersections(a: ContourElement, b: ContourElement) -> list[complex]:
    """Common points of two elements; none for two on one line or circle."""
    if a.is_line and b.is_line:
        points = _lines(a, b)
    elif a.is_line or b.is_line:
        straight, curved = (a, b) if a.is_line else (b, a)
        points = _line_circle(straight, curved)
    else:
        points = _circles(a, b)
    return [z for z in points if all(-ON <= element.fraction_at(z) <= 1.0 + ON for element in (a, b))]


def _lines(a: ContourElement, b: ContourElement) -> list[complex]:
    u, v = a.end - a.start, b.end - b.start
    cross = (u.conjugate() * v).imag
    if abs(cross) <= 1e-14 * abs(u) * abs(v):
        return []
    return [a.start + u * (((b.start - a.start).conjugate() * v).imag / cross)]


def _line_circle(a: ContourElement, b: ContourElement) -> list[complex]:
    unit = (a.end - a.start) / abs(a.end - a.start)
    local = (b.centre - a.start) * unit.conjugate()
    square = b.radius**2 - local.imag**2
    if square <= 0.0:
        return []
    return [a.start + unit * (local.real + sign * math.sqrt(square)) for sign in (-1.0, 1.0)]


def _circles(a: ContourElement, b: ContourElement) -> list[complex]:
    """Intersections of two circles, from the centre of the smaller one, as the larger may be nearly straight."""
    if a.radius > b.radius:
        a, b = b, a
    between = b.centre - a.centre
    d = abs(between)
    if d <= 1e-12 * max(a.radius, b.radius):
        return []
    along = (a.radius * a.radius + (d - b.radius) * (d + b.radius)) / (2.0 * d)
    square = (a.radius - along) * (a.radius + along)
    if square <= 0.0:
        return []
    return [a.centre + between / d * complex(along, sign * math.sqrt(square)) for sign in (-1.0, 1.0)]


def near_pairs(elements: Sequence[ContourElement]) -> Iterator[tuple[int, int]]:
    """Pairs i < j of elements with overlapping boxes, in order.

    Raises KindynaError where there are far more than on the curve of a cam.
    """
    low_x, high_x, low_y, high_y = np.array([element.box for element in elements]).T
    by_x, last = _sorted(low_x, high_x)
    by_y, last_y = _sorted(low_y, high_y)
    if last_y.sum() < last.sum():  # along the axis on which fewer overlap
        by_x, last, low_y, high_y = by_y, last_y, low_x, high_x
    blocks, total = [], 0
    for first in range(0, by_x.size, BLOCK):
        counts = last[first : first + BLOCK] - np.arange(first, min(first + BLOCK, by_x.size)) - 1
        a = np.repeat(np.arange(first, first + counts.size), counts)
        b = a + 1 + np.arange(a.size) - np.repeat(np.cumsum(counts) - counts, counts)
        a, b = by_x[a], by_x[b]
        overlap = (low_y[b] <= high_y[a]) & (high_y[b] >= low_y[a])
        total += int(np.count_nonzero(overlap))
        if total > MOST_PAIRS:
            raise KindynaError(
                f"the curve: more than {MOST_PAIRS} pairs of its lines and arcs are neighbours; draw it with longer ones"
            )
        blocks.append(np.sort(np.column_stack((a[overlap], b[overlap])), axis=1))
    pairs = np.concatenate(blocks)
    yield from map(tuple, pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))].tolist())


def _sorted(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Order (n,) of ranges by their begin, and in that order the number (n,) of begins before the end of each."""
    order = np.argsort(low, kind="stable")
    return order, np.searchsorted(low[order], high[order], side="right")
