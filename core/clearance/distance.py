"""Exact distance of two shapes at many relative poses.

The nearest points of two elements that do not cross are an end of one and its nearest point on the other, or their normals are
on one line: the perpendicular from the centre of an arc to a line, or the line through the centres of two arcs. Every candidate
is a pair of points of both elements, so that their least distance is exact.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from core.clearance.shapes import Shape, encloses_points
from core.frozen import frozen
from core.numerics.derivatives import cross, dot
from core.numerics.lazy import checkpoint

AT_ONCE = 2_000_000  # pairs of elements whose discs are compared at once, which limits memory


class Placement(NamedTuple):
    """Poses of the frame of one body in that of another.

    Attributes
    ----------
    origin : ndarray (n,) complex [m]
    unit : ndarray (n,) complex, dimensionless
        Direction of the x axis.
    """

    origin: np.ndarray
    unit: np.ndarray

    def spread(self, count: int) -> Placement:
        """The same pose at every angle, where there is one."""
        return Placement(*(np.broadcast_to(row, count) for row in self))

    def part(self, rows: slice) -> Placement:
        """Some of the poses."""
        return Placement(self.origin[rows], self.unit[rows])


@frozen(eq=False)
class ShapePair:
    """Two shapes and the pairs of their elements that have a common layer.

    Attributes
    ----------
    first, second : Shape
    common : ndarray (k, l) of bool, dimensionless
        Whether element i of the first and j of the second have a common layer.
    outlines : tuple of (int, int)
        Numbers of outlines with a common layer, of which one could enclose the other.
    """

    first: Shape
    second: Shape
    common: np.ndarray
    outlines: tuple[tuple[int, int], ...]

    @classmethod
    def of(cls, first: Shape, second: Shape) -> ShapePair:
        """The pair of two shapes; layers that only touch are not common."""
        low = np.maximum(first.layers[:, None, 0], second.layers[None, :, 0])
        high = np.minimum(first.layers[:, None, 1], second.layers[None, :, 1])
        common = low < high
        able = common & (first.encloses[:, None] | second.encloses[None, :])
        outlines = tuple((int(i), int(j)) for i, j in zip(*np.nonzero(able), strict=True))
        return cls(first, second, common[first.outline[:, None], second.outline[None, :]], outlines)

    @property
    def deviation(self) -> float:
        """Largest distance of the elements from the true outlines, both shapes together [m]."""
        return self.first.deviation + self.second.deviation


class Distances(NamedTuple):
    """Distance of two shapes at n poses.

    Attributes
    ----------
    value : ndarray (n,) [m]
        Distance; where grown shapes meet the overlap of their growths as a negative number, else 0.
    pose, first, second : ndarray (t,) of int, dimensionless
        Pairs of elements that may be nearest within the reach: number of the pose, of both elements.
    gap : ndarray (t,) [m]
        Distance of the elements of each pair less their growths.
    """

    value: np.ndarray
    pose: np.ndarray
    first: np.ndarray
    second: np.ndarray
    gap: np.ndarray


def distances(pair: ShapePair, placement: Placement, reach: np.ndarray | None = None) -> Distances:
    """Distance of two shapes at n poses of the second in the frame of the first.

    Parameters
    ----------
    pair : ShapePair
    placement : Placement
    reach : ndarray (n,) [m], optional
        Pairs of elements count as possibly nearest where their discs are at most this much farther than the distance.

    Returns
    -------
    Distances
    """
    n, per_pose = placement.origin.size, pair.common.size
    step = max(1, AT_ONCE // per_pose)
    if n <= step:
        return _distances(pair, placement, np.zeros(n) if reach is None else reach)
    parts = []
    for begin in range(0, n, step):
        checkpoint()
        rows = slice(begin, begin + step)
        part = _distances(pair, placement.part(rows), np.zeros(n)[rows] if reach is None else reach[rows])
        parts.append(part._replace(pose=part.pose + begin))
    return Distances(*(np.concatenate(rows) for rows in zip(*parts, strict=True)))


def _distances(pair: ShapePair, placement: Placement, reach: np.ndarray) -> Distances:
    a, b = pair.first, pair.second
    n, poses = placement.origin.size, np.arange(placement.origin.size)
    growth = np.where(pair.common, a.growth[:, None] + b.growth[None, :], -np.inf)
    centres = placement.origin[:, None] + placement.unit[:, None] * b.disc_centre
    lower = np.abs(a.disc_centre[:, None] - centres[:, None, :])
    lower -= a.disc_radius[:, None] + b.disc_radius + growth
    flat = lower.reshape(n, -1)
    nearest = flat.argmin(axis=1)  # its distance is an upper bound, which leaves few pairs
    first, second = np.unravel_index(nearest, pair.common.shape)
    value = _gap(pair, placement, poses, first, second)
    pose, index = np.nonzero(flat <= (value + reach)[:, None])
    first, second = np.unravel_index(index, pair.common.shape)
    gap = _gap(pair, placement, pose, first, second)
    np.minimum.at(value, pose, gap)
    near = gap <= (value + reach)[pose]
    _set_enclosed(pair, placement, value)
    return Distances(value, pose[near], first[near], second[near], gap[near])


def _gap(pair: ShapePair, placement: Placement, pose: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Distance less growth of pairs of elements (t,) [m] at their poses (t,)."""
    least = np.full(pose.size, np.inf)
    for rows, p, q in _candidates(pair, placement, pose, first, second):
        least[rows] = np.fmin(least[rows], np.abs(p - q))
    return np.asarray(least - pair.first.growth[first] - pair.second.growth[second])


def _set_enclosed(pair: ShapePair, placement: Placement, value: np.ndarray) -> None:
    """Set the distance (n,) where an outline encloses another one that it does not cross."""
    a, b = pair.first, pair.second
    for i, j in pair.outlines:
        p, q = int(np.argmax(a.outline == i)), int(np.argmax(b.outline == j))
        overlap = -(a.growth[p] + b.growth[q])
        rows = np.flatnonzero(value > overlap)
        inside = np.zeros(rows.size, dtype=bool)
        origin, unit = placement.origin[rows], placement.unit[rows]
        if a.encloses[i]:
            inside |= _enclosed(a, i, origin + unit * b.start[q])
        if b.encloses[j]:
            inside |= _enclosed(b, j, (a.start[p] - origin) * unit.conj())
        value[rows[inside]] = overlap


def _enclosed(shape: Shape, number: int, points: np.ndarray) -> np.ndarray:
    """Whether an outline encloses points (n,) [m]; few are near enough to be tested."""
    middle, radius = shape.disc
    near = np.flatnonzero(np.abs(points - middle) <= radius)
    inside = np.zeros(points.size, dtype=bool)
    inside[near] = encloses_points(shape, number, points[near])
    return inside


def nearest_points(pair: ShapePair, placement: Placement) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distance and nearest points of two shapes, on the grown outlines where they are grown.

    Parameters
    ----------
    pair : ShapePair
    placement : Placement
        The n poses.

    Returns
    -------
    distance, first, second : ndarray (n,) [m], (n,) complex [m], (n,) complex [m]
        Points in the frame of the first shape.
    """
    result = distances(pair, placement)
    least = np.full(result.value.size, np.inf)
    points = np.zeros((2, least.size), dtype=complex)
    for rows, p, q in _candidates(pair, placement, result.pose, result.first, result.second):
        growths = pair.first.growth[result.first[rows]], pair.second.growth[result.second[rows]]
        size = np.abs(q - p)
        gap = np.where(np.isnan(size), np.inf, size - growths[0] - growths[1])
        order = np.argsort(-gap, kind="stable")  # the last one that is written to a pose is the nearest
        pose = result.pose[rows][order]
        nearest = np.full(least.size, -1)
        nearest[pose] = order
        at = np.flatnonzero(nearest >= 0)
        row = nearest[at]
        nearer = gap[row] < least[at]
        at, row = at[nearer], row[nearer]
        along = (q[row] - p[row]) / np.where(size[row] > 0.0, size[row], 1.0)
        least[at] = gap[row]
        points[:, at] = p[row] + along * growths[0][row], q[row] - along * growths[1][row]
    return result.value, points[0], points[1]


# -- pairs of points of two elements --------------------------------------------------------------------------


class Elements(NamedTuple):
    """Lines and arcs in one frame, as the attributes of a Shape.

    Attributes
    ----------
    start, end, centre : ndarray (t,) complex [m]
    radius : ndarray (t,) [m]
    middle : ndarray (t,) complex, dimensionless
    cos_half : ndarray (t,), dimensionless
    """

    start: np.ndarray
    end: np.ndarray
    centre: np.ndarray
    radius: np.ndarray
    middle: np.ndarray
    cos_half: np.ndarray

    def at(self, rows: np.ndarray) -> Elements:
        """Some of the elements.

        Parameters
        ----------
        rows : ndarray (r,) of int, dimensionless
            Their numbers.

        Returns
        -------
        Elements
        """
        return Elements(*(values[rows] for values in self))

    def nearest(self, z: np.ndarray) -> np.ndarray:
        """Points of the elements that are nearest to given points.

        Parameters
        ----------
        z : ndarray (t,) complex [m]

        Returns
        -------
        ndarray (t,) complex [m]
        """
        is_arc = self.radius > 0.0
        if not is_arc.any():
            return _on_line(self, z)
        return np.where(is_arc, _on_arc(self, z), _on_line(self, z))


def elements_of(pair: ShapePair, placement: Placement, near: Distances) -> tuple[Elements, Elements]:
    """Both elements of every pair in the frame of the first shape."""
    return _elements(pair, placement, near.pose, near.first, near.second)


def _elements(
    pair: ShapePair, placement: Placement, pose: np.ndarray, first: np.ndarray, second: np.ndarray
) -> tuple[Elements, Elements]:
    a, b = pair.first, pair.second
    origin, unit = placement.origin[pose], placement.unit[pose]
    start, end, centre = (origin + unit * getattr(b, name)[second] for name in ("start", "end", "centre"))
    return (
        Elements(*(getattr(a, name)[first] for name in Elements._fields)),
        Elements(start, end, centre, b.radius[second], unit * b.middle[second], b.cos_half[second]),
    )


_Points = Iterator[tuple[np.ndarray, np.ndarray]]


def _candidates(
    pair: ShapePair, placement: Placement, pose: np.ndarray, first: np.ndarray, second: np.ndarray
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Rows of the pairs of elements (t,), and points of both elements in the frame of the first shape; NaN where none is."""
    of_a, of_b = _elements(pair, placement, pose, first, second)
    arc_a, arc_b = pair.first.is_arc[first], pair.second.is_arc[second]
    for is_kind, points, swaps in (
        (~arc_a & ~arc_b, _lines, False),
        (~arc_a & arc_b, _line_and_arc, False),
        (arc_a & ~arc_b, _line_and_arc, True),
        (arc_a & arc_b, _arcs, False),
    ):
        rows = np.flatnonzero(is_kind)
        if rows.size:
            left, right = (of_b, of_a) if swaps else (of_a, of_b)
            for p, q in points(left.at(rows), right.at(rows)):
                yield (rows, q, p) if swaps else (rows, p, q)


def _on_line(line: Elements, z: np.ndarray) -> np.ndarray:
    """Nearest point of a line."""
    chord = line.end - line.start
    square = dot(chord, chord)
    part = dot(chord, z - line.start) / np.where(square > 0.0, square, 1.0)
    return np.asarray(line.start + np.clip(part, 0.0, 1.0) * chord)


def _is_within(arc: Elements, direction: np.ndarray) -> np.ndarray:
    """Whether a direction from the centre of an arc meets it."""
    return dot(arc.middle, direction) >= np.abs(direction) * arc.cos_half


def _on_arc(arc: Elements, z: np.ndarray) -> np.ndarray:
    """Nearest point of an arc."""
    direction = z - arc.centre
    size = np.abs(direction)
    on_circle = arc.centre + direction * (arc.radius / np.where(size > 0.0, size, 1.0))
    nearer = np.where(np.abs(z - arc.start) <= np.abs(z - arc.end), arc.start, arc.end)
    return np.where(_is_within(arc, direction) & (size > 0.0), on_circle, nearer)


def _lines(a: Elements, b: Elements) -> _Points:
    for z in (a.start, a.end):
        yield z, _on_line(b, z)
    for z in (b.start, b.end):
        yield _on_line(a, z), z
    u, v, w = a.end - a.start, b.end - b.start, b.start - a.start
    slope = cross(u, v)
    safe = np.where(slope != 0.0, slope, 1.0)
    s, t = cross(w, v) / safe, cross(w, u) / safe
    meet = (slope != 0.0) & (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)
    at = np.where(meet, a.start + s * u, np.nan)
    yield at, at


def _line_and_arc(line: Elements, arc: Elements) -> _Points:
    for z in (line.start, line.end):
        yield z, _on_arc(arc, z)
    for z in (arc.start, arc.end):
        yield _on_line(line, z), z
    foot = _on_line(line, arc.centre)
    yield foot, _on_arc(arc, foot)
    chord = line.end - line.start
    square = dot(chord, chord)
    safe = np.where(square > 0.0, square, 1.0)
    middle = dot(chord, arc.centre - line.start) / safe
    off = line.start + middle * chord - arc.centre
    root = np.sqrt(np.maximum(arc.radius**2 - dot(off, off), 0.0) / safe)
    for part in (middle - root, middle + root):
        at = line.start + part * chord
        meet = (np.abs(off) <= arc.radius) & (part >= 0.0) & (part <= 1.0) & _is_within(arc, at - arc.centre)
        at = np.where(meet & (square > 0.0), at, np.nan)
        yield at, at


def _arcs(a: Elements, b: Elements) -> _Points:
    for z in (a.start, a.end):
        yield z, _on_arc(b, z)
    for z in (b.start, b.end):
        yield _on_arc(a, z), z
    between = b.centre - a.centre
    distance = np.abs(between)
    unit = between / np.where(distance > 0.0, distance, 1.0)
    for first, second in ((1.0, -1.0), (1.0, 1.0), (-1.0, -1.0)):
        valid = (distance > 0.0) & _is_within(a, first * unit) & _is_within(b, second * unit)
        yield (
            np.where(valid, a.centre + first * a.radius * unit, np.nan),
            np.where(valid, b.centre + second * b.radius * unit, np.nan),
        )
    # circles that meet, from the centre of the first
    along = (a.radius**2 + (distance - b.radius) * (distance + b.radius)) / np.where(
        distance > 0.0, 2.0 * distance, 1.0
    )
    square = (a.radius - along) * (a.radius + along)
    height = np.sqrt(np.maximum(square, 0.0))
    for side in (1j, -1j):
        direction = unit * (along + side * height)
        at = a.centre + direction
        meet = (distance > 0.0) & (square >= 0.0) & _is_within(a, direction) & _is_within(b, at - b.centre)
        at = np.where(meet, at, np.nan)
        yield at, at
