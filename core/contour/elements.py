"""Lines and arcs of a plane curve [mm], as complex numbers: where they run, how far a point is from them, where two meet."""

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
AT_ONCE = 256  # elements whose neighbours are looked for together
ON = 1e-9  # relative: how far beyond its ends a point still is on an element


@frozen
class ContourElement:
    """A line, or an arc with its sweep [rad], positive where it turns left, and its centre; from start to end."""

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
        """Of an arc."""
        return abs(self.start - self.centre)

    @property
    def length(self) -> float:
        """Its length [mm]."""
        return abs(self.end - self.start) if self.is_line else abs(self.sweep) * self.radius

    @property
    def curvature(self) -> float:
        """Positive where it turns left: on a curve round its body counter-clockwise, where that is convex."""
        return 0.0 if self.is_line else math.copysign(1.0 / self.radius, self.sweep)

    def at(self, part: np.ndarray | float) -> np.ndarray:
        """Points (n,) at parts 0 ... 1 of its length."""
        part = np.asarray(part, dtype=float)
        if self.is_line:
            return self.start + part * (self.end - self.start)
        return self.centre + (self.start - self.centre) * np.exp(1j * self.sweep * part)

    def tangent(self, part: np.ndarray | float) -> np.ndarray:
        """Unit tangents (n,) there."""
        part = np.asarray(part, dtype=float)
        if self.is_line:
            return np.full(part.shape, (self.end - self.start) / abs(self.end - self.start))
        radial = (self.start - self.centre) / self.radius
        return 1j * math.copysign(1.0, self.sweep) * radial * np.exp(1j * self.sweep * part)

    def normal(self, part: np.ndarray | float) -> np.ndarray:
        """Unit normals (n,) to the right: away from a body that the curve goes round counter-clockwise."""
        return -1j * self.tangent(part)

    def reversed(self) -> ContourElement:
        """The same element, run from its end to its start."""
        return ContourElement(self.end, self.start, -self.sweep, self.centre)

    def moved(self, by: complex, scale: float = 1.0) -> ContourElement:
        """Scaled, then shifted."""
        return ContourElement(scale * self.start + by, scale * self.end + by, self.sweep, scale * self.centre + by)

    def beside(self, distance: float) -> ContourElement | None:
        """The element at a distance to its right; None of an arc whose centre is passed."""
        if self.is_line:
            by = distance * complex(self.normal(0.0))
            return ContourElement(self.start + by, self.end + by)
        ratio = 1.0 + distance * self.curvature
        if ratio <= ON:
            return None
        c = self.centre
        return ContourElement(c + ratio * (self.start - c), c + ratio * (self.end - c), self.sweep, c)

    def part_of(self, z: complex) -> float:
        """The part 0 ... 1 at which a point of its line or circle lies on it; beside it less than 0, or more than 1."""
        if self.is_line:
            chord = self.end - self.start
            return ((z - self.start) * chord.conjugate()).real / abs(chord) ** 2
        turn = cmath.phase((z - self.centre) / (self.start - self.centre)) * math.copysign(1.0, self.sweep)
        room = 0.5 * (2.0 * math.pi - abs(self.sweep))
        return (turn if turn >= -room else turn + 2.0 * math.pi) / abs(self.sweep)

    def piece(self, low: float, high: float) -> ContourElement:
        """What lies between two parts of it."""
        start = self.start if low == 0.0 else complex(self.at(low))
        end = self.end if high == 1.0 else complex(self.at(high))
        return ContourElement(start, end, self.sweep * (high - low), self.centre)

    def with_ends(self, start: complex, end: complex) -> ContourElement:
        """The same with ends that have been moved a little; its circle stays."""
        return ContourElement(start, end) if self.is_line else ContourElement(start, end, self.sweep, self.centre)

    @property
    def box(self) -> tuple[float, float, float, float]:
        """A box around it: x from, to, y from, to."""
        if self.is_line:
            (x, y), (u, v) = (self.start.real, self.start.imag), (self.end.real, self.end.imag)
            return min(x, u), max(x, u), min(y, v), max(y, v)
        z = self.at(np.linspace(0.0, 1.0, 9))
        # between samples an arc stands off its chord by less than its sagitta
        room = self.radius * (1.0 - math.cos(abs(self.sweep) / 16.0))
        return z.real.min() - room, z.real.max() + room, z.imag.min() - room, z.imag.max() + room


def line(start: complex, end: complex) -> ContourElement:
    """The straight line from start to end [mm]."""
    return ContourElement(start, end)


def arc_of_bulge(start: complex, end: complex, bulge: float) -> ContourElement:
    """The arc whose quarter sweep has this tangent; its centre is start + end over 2, and i(1 - b²)/(4b) of the chord."""
    if abs(bulge) < STRAIGHT:
        return ContourElement(start, end)
    chord = end - start
    centre = 0.5 * (start + end) + 0.25j * chord * (1.0 - bulge * bulge) / bulge
    return ContourElement(start, end, 4.0 * math.atan(bulge), centre)


def arc(centre: complex, radius: float, angle: float, sweep: float) -> ContourElement:
    """From an angle [rad] of its centre on."""
    start, end = (centre + cmath.rect(radius, a) for a in (angle, angle + sweep))
    return ContourElement(start, start if abs(abs(sweep) - 2.0 * math.pi) < 1e-12 else end, sweep, centre)


def sampled(elements: Sequence[ContourElement]) -> np.ndarray:
    """Points (n,) along a chain, the end of each element left to the next one."""
    rows: list[complex] = []
    for each in elements:
        count = max(1, math.ceil(abs(each.sweep) / (2.0 * math.pi) * SAMPLES_PER_TURN))
        rows += [each.start] if count == 1 else each.at(np.arange(count) / count).tolist()
    return np.array(rows)


def area(elements: Sequence[ContourElement]) -> float:
    """Enclosed by a closed chain [mm²], positive where it runs counter-clockwise: of the polygon and the arcs' segments."""
    total = 0.0
    for each in elements:
        total += 0.5 * (each.start.conjugate() * each.end).imag
        if not each.is_line:
            total += 0.5 * each.radius**2 * (each.sweep - math.sin(each.sweep))
    return total


def winding(elements: Sequence[ContourElement], z: complex) -> int:
    """How often a closed chain goes round a point."""
    points = sampled(elements) - z
    return round(float(np.angle(np.roll(points, -1) * points.conj()).sum()) / (2.0 * math.pi))


def distances(elements: Sequence[ContourElement], z: complex) -> np.ndarray:
    """Distance of a point from each element (k,)."""
    return np.array([_distance(each, z) for each in elements])


def _distance(each: ContourElement, z: complex) -> float:
    if 0.0 <= each.part_of(z) <= 1.0:
        if each.is_line:
            chord = each.end - each.start
            return abs(((z - each.start) * chord.conjugate()).imag) / abs(chord)
        return abs(abs(z - each.centre) - each.radius)
    return min(abs(z - each.start), abs(z - each.end))


# -- where two meet ---------------------------------------------------------------------------------------


def meetings(a: ContourElement, b: ContourElement) -> list[complex]:
    """Points that two elements have in common; none of two that lie on one line or circle."""
    if a.is_line and b.is_line:
        found = _lines(a, b)
    elif a.is_line or b.is_line:
        straight, bent = (a, b) if a.is_line else (b, a)
        found = _line_circle(straight, bent)
    else:
        found = _circles(a, b)
    return [z for z in found if all(-ON <= each.part_of(z) <= 1.0 + ON for each in (a, b))]


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
    """Counted from the centre of the smaller circle, beside which the other may be nearly straight."""
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
    """Pairs i < j of elements whose boxes overlap, in order. Raises KindynaError where they are far more than those of a cam's curve."""
    low_x, high_x, low_y, high_y = np.array([each.box for each in elements]).T
    by_x, last = _sorted(low_x, high_x)
    by_y, last_y = _sorted(low_y, high_y)
    if last_y.sum() < last.sum():  # along the axis on which fewer overlap
        by_x, last, low_y, high_y = by_y, last_y, low_x, high_x
    found, total = [], 0
    for first in range(0, by_x.size, AT_ONCE):
        counts = last[first : first + AT_ONCE] - np.arange(first, min(first + AT_ONCE, by_x.size)) - 1
        a = np.repeat(np.arange(first, first + counts.size), counts)
        b = a + 1 + np.arange(a.size) - np.repeat(np.cumsum(counts) - counts, counts)
        a, b = by_x[a], by_x[b]
        over = (low_y[b] <= high_y[a]) & (high_y[b] >= low_y[a])
        total += int(np.count_nonzero(over))
        if total > MOST_PAIRS:
            raise KindynaError(
                f"the curve: more than {MOST_PAIRS} of its lines and arcs are beside each other; draw it with longer ones"
            )
        found.append(np.sort(np.column_stack((a[over], b[over])), axis=1))
    pairs = np.concatenate(found)
    yield from map(tuple, pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))].tolist())


def _sorted(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Order (n,) by where ranges begin, and in that order (n,) how many begin before each ends."""
    order = np.argsort(low, kind="stable")
    return order, np.searchsorted(low[order], high[order], side="right")
