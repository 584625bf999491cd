"""Least distance of two moving shapes over a turn, with a proven lower bound, and the ranges in which they meet.

The nearest points of two shapes are corners, or their normal passes through the centre of an arc. The component of the relative
velocity along a normal is the same at all its points. The distance of such a pair of features therefore changes at most by v Δθ,
where v is the speed per radian of the corner or centre relative to the other body, or relative to the other corner or centre. With
V, the largest v of the features that can be nearest in an interval, the distance is at least ½(d₁ + d₂ - V Δθ) there. Intervals
that could contain a smaller distance are halved (branch and bound).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import product
from math import inf
from typing import NamedTuple

import numpy as np

from core.clearance.distance import Distances, Elements, Placement, ShapePair, distances, elements_of
from core.clearance.shapes import Shape
from core.frozen import frozen
from core.motion import TURN, Angles
from core.motion.extremes import Pieces
from core.numerics.derivatives import BINOMIAL
from core.numerics.lazy import checkpoint, locked

STEP = np.deg2rad(0.5)  # [rad] of the first intervals
LEAST = 6  # first intervals of a piece
TOUCHING = 1e-12  # [m]: shapes so near to each other meet
ROUNDS = 60  # of halving
MOST = 200_000  # intervals that are halved at once
SHORTEST_GAP = np.deg2rad(0.05)  # [rad]: shorter gaps within a meeting are not searched
SHORTEST_MEETING = np.deg2rad(1e-4)  # [rad]: shorter meetings between two free angles are not searched
EDGE = 1e-10  # [rad] accuracy of the ends of a meeting


class BodyMotion(NamedTuple):
    """Pose of a body with its derivatives by angle.

    Attributes
    ----------
    origin : ndarray (o, n) complex [m]
        Origin of its frame in the global frame and its derivatives.
    turn : ndarray (o, n) complex, dimensionless
        e^{iφ} with its angle φ, and the derivatives.
    """

    origin: np.ndarray
    turn: np.ndarray


def body_motion(origin: np.ndarray, angle: np.ndarray) -> BodyMotion:
    """Motion of a body by its angle: (e^{iφ})′ = iφ′ e^{iφ}, and so on.

    Parameters
    ----------
    origin : ndarray (o, n) complex [m]
        Value and up to three derivatives.
    angle : ndarray (o, n) [rad]

    Returns
    -------
    BodyMotion
    """
    unit = np.exp(1j * angle[0])
    rows = [unit]
    if len(angle) > 3:
        first, second, third = angle[1:4]
        rows += [
            1j * first * unit,
            (1j * second - first**2) * unit,
            (1j * (third - first**3) - 3.0 * first * second) * unit,
        ]
    return BodyMotion(origin, np.array(rows))


class RelativeMotion(NamedTuple):
    """Motion of one body in the frame of another: a point b has the position P + b Q.

    Attributes
    ----------
    origin : ndarray (o, n) complex [m]
        P and its derivatives.
    turn : ndarray (o, n) complex, dimensionless
        Q and its derivatives.
    """

    origin: np.ndarray
    turn: np.ndarray

    @property
    def placement(self) -> Placement:
        """Poses without derivatives."""
        return Placement(self.origin[0], self.turn[0])


def relative(second: BodyMotion, first: BodyMotion) -> RelativeMotion:
    """Motion of the second body in the frame of the first, by Leibniz's rule: P = (z₂ - z₁) e^{-iφ₁}, Q = e^{i(φ₂ - φ₁)}."""
    distance, back = second.origin - first.origin, first.turn.conj()

    def rows(values: np.ndarray) -> np.ndarray:
        return np.array([sum(c * values[m] * back[k - m] for m, c in enumerate(BINOMIAL[k])) for k in range(len(back))])

    return RelativeMotion(*np.broadcast_arrays(rows(distance), rows(second.turn)))


Motions = Callable[[Angles, int], tuple[BodyMotion, BodyMotion]]
"""Angles and the number of orders -> motions of both bodies."""


@frozen(eq=False)
class Encounter:
    """Two bodies that could meet: their shapes and motions."""

    shapes: ShapePair
    motions: Motions

    def placement(self, angles: Angles, count: int = 1) -> Placement:
        """Poses of the second body in the frame of the first, at least `count` of them where both stand still."""
        first, second = self.motions(angles, 1)
        placement = relative(second, first).placement
        return placement if placement.origin.size >= count else placement.spread(count)


@frozen(eq=False)
class Intervals:
    """First intervals of a turn.

    Attributes
    ----------
    angles : Angles
        Their ends, both limits at the ends of every piece.
    low, high : ndarray (m,) of int, dimensionless
        Numbers of the angles at which each interval begins and ends.
    """

    angles: Angles
    low: np.ndarray
    high: np.ndarray


def intervals_of(turn: Pieces) -> Intervals:
    """First intervals of every piece of a turn."""
    counts = np.maximum(np.ceil((turn.ends - turn.starts) / STEP), LEAST).astype(int)
    theta = np.concatenate(
        [np.linspace(a, b, count + 1) for a, b, count in zip(turn.starts, turn.ends, counts.tolist(), strict=True)]
    )
    piece = np.repeat(np.arange(counts.size), counts + 1)
    low = np.flatnonzero(piece[:-1] == piece[1:])
    return locked(Intervals(Angles(theta, piece, cached=True, search=True), low, low + 1))


class LeastDistance(NamedTuple):
    """Least distance over a turn [m], a lower bound of it [m], and its angle [rad]; not positive where the shapes meet."""

    value: float
    bound: float
    theta: float
    piece: int


def least_distance(encounter: Encounter, first: Intervals, tolerance: float, enough: float = inf) -> LeastDistance:
    """Least distance of two bodies over the turn, proven to a tolerance.

    Parameters
    ----------
    encounter : Encounter
    first : Intervals
    tolerance : float [m]
        Largest distance between the value and its lower bound; more where `MOST` intervals remain.
    enough : float [m]
        Intervals whose lower bound reaches it are not searched, so that the value is exact only where it is less.

    Returns
    -------
    LeastDistance
        Without a proof where the bodies meet: the value is then not positive, and so is the bound.
    """
    search = _Search(encounter, first)
    bound, spread = inf, encounter.shapes.deviation
    for _ in range(ROUNDS):
        if search.least <= TOUCHING:
            break
        lower = search.lower
        may_be_less = lower < min(search.least - tolerance, enough + spread)
        if np.count_nonzero(may_be_less) > MOST:
            may_be_less[:] = False
        bound = min(bound, lower[~may_be_less].min(initial=inf))
        search.select(may_be_less)
        if not search.size:
            break
        search.halve()
    bound = min(bound, search.lower.min(initial=inf), search.least)
    return LeastDistance(search.least, float(bound - spread), search.theta, search.piece)


def meetings(encounter: Encounter, first: Intervals, level: float = 0.0) -> list[tuple[float, float]]:
    """Ranges of angles in which two bodies meet [rad]; a range that begins above its end passes the end of the turn.

    Parameters
    ----------
    encounter : Encounter
    first : Intervals
    level : float [m]
        Bodies nearer than this count as meeting.

    Returns
    -------
    list of (float, float) [rad]
    """
    search = _Search(encounter, first, level)
    ranges: list[tuple[float, float]] = []
    mixed: list[np.ndarray] = []
    while search.size:
        low, high = search.low_value <= TOUCHING, search.high_value <= TOUCHING
        width = search.high - search.low
        is_free = ~low & ~high & ((search.lower > TOUCHING) | (width <= SHORTEST_MEETING))
        is_met = low & high & ((search.upper <= 0.0) | (width <= SHORTEST_GAP))
        is_edge = (low != high) & (width <= SHORTEST_GAP)
        ranges += zip(search.low[is_met].tolist(), search.high[is_met].tolist(), strict=True)
        mixed.append(np.array([search.low, search.high, search.piece_of, low])[:, is_edge])
        search.select(~(is_free | is_met | is_edge))
        if search.size:
            search.halve()
    edges = np.concatenate(mixed, axis=1) if mixed else np.zeros((4, 0))
    ranges += _edge_ranges(encounter, level, *edges)
    return _merged(ranges, first.angles.theta)


def _edge_ranges(
    encounter: Encounter, level: float, low: np.ndarray, high: np.ndarray, piece: np.ndarray, meets_low: np.ndarray
) -> list[tuple[float, float]]:
    """Parts of intervals in which the bodies meet at one end (meets_low: 1 or 0), by bisection."""
    begin, end, is_low = low.copy(), high.copy(), meets_low > 0.0
    pieces = piece.astype(int)
    while low.size and (end - begin).max() > EDGE:
        middle = 0.5 * (begin + end)
        meets = distances(encounter.shapes, encounter.placement(Angles(middle, pieces))).value <= level + TOUCHING
        to_begin = meets == is_low
        begin, end = np.where(to_begin, middle, begin), np.where(to_begin, end, middle)
    edge = 0.5 * (begin + end)
    return list(zip(np.where(is_low, low, edge).tolist(), np.where(is_low, edge, high).tolist(), strict=True))


def _merged(ranges: list[tuple[float, float]], theta: np.ndarray) -> list[tuple[float, float]]:
    """Adjacent ranges joined, also over the end of a full turn."""
    result: list[tuple[float, float]] = []
    for begin, end in sorted(ranges):
        if result and begin <= result[-1][1] + EDGE:
            result[-1] = result[-1][0], max(end, result[-1][1])
        else:
            result.append((begin, end))
    is_turn = theta[0] <= EDGE and theta[-1] >= TURN - EDGE
    if is_turn and len(result) > 1 and result[0][0] <= EDGE and result[-1][1] >= TURN - EDGE:
        begin, _ = result.pop()
        result[0] = begin, result[0][1]
    return result


class _Search:
    """Intervals of a turn with the distances above a level at their ends, and bounds of the distance inside."""

    def __init__(self, encounter: Encounter, first: Intervals, level: float = 0.0) -> None:
        self.encounter, self._level = encounter, level
        angles, low, high = first.angles, first.low, first.high
        bodies = encounter.motions(angles, 4)
        self._speeds = _Speeds(first, relative(bodies[0], bodies[1]), relative(bodies[1], bodies[0]), bodies)
        value = distances(encounter.shapes, self._speeds.second.placement).value - level
        self.low, self.high, self.piece_of = angles.theta[low], angles.theta[high], angles.piece[low]
        self.low_value, self.high_value = value[low], value[high]
        self.base = np.arange(low.size)
        shapes = encounter.shapes
        self.speed = np.minimum(self._speeds.of_disc(shapes.first, 0), self._speeds.of_disc(shapes.second, 1))
        self._floor = np.full(low.size, -inf)
        k = int(value.argmin())
        self.least, self.theta, self.piece = float(value[k]), float(angles.theta[k]), int(angles.piece[k])

    @property
    def size(self) -> int:
        """Number of intervals."""
        return int(self.low.size)

    @property
    def lower(self) -> np.ndarray:
        """Lower bound of the distance in each interval (m,) [m]."""
        return np.maximum(self._floor, 0.5 * (self.low_value + self.high_value - self.speed * (self.high - self.low)))

    @property
    def upper(self) -> np.ndarray:
        """Upper bound of the distance in each interval (m,) [m]."""
        return np.asarray(0.5 * (self.low_value + self.high_value + self.speed * (self.high - self.low)))

    def select(self, mask: np.ndarray) -> None:
        """Keep some of the intervals."""
        for name in ("low", "high", "piece_of", "low_value", "high_value", "base", "speed", "_floor"):
            setattr(self, name, getattr(self, name)[mask])

    def halve(self) -> None:
        """Halve every interval; only features that can be nearest in the halves bound their speed."""
        checkpoint()
        middle, width = 0.5 * (self.low + self.high), 0.5 * (self.high - self.low)
        placement = self.encounter.placement(Angles(middle, self.piece_of))
        near = distances(self.encounter.shapes, placement, 2.0 * self.speed * width)
        fastest, floor = self._features(placement, near, width)
        speed, value = np.minimum(self.speed, fastest), near.value - self._level
        k = int(value.argmin())
        if value[k] < self.least:
            self.least, self.theta, self.piece = float(value[k]), float(middle[k]), int(self.piece_of[k])
        ends = (self.low, middle), (middle, self.high), (self.low_value, value), (value, self.high_value)
        self.low, self.high, self.low_value, self.high_value = (np.concatenate(pair) for pair in ends)
        self.piece_of, self.base, self.speed = np.tile(self.piece_of, 2), np.tile(self.base, 2), np.tile(speed, 2)
        self._floor = np.tile(floor - self._level, 2)

    def _features(self, placement: Placement, near: Distances, width: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Largest speed of the features that can be nearest within a width (m,) of each pose, and the least distance (m,) there."""
        pose, wide = near.pose, width[near.pose]
        rows = list(self._pairs_of_features(placement, near, wide))
        gap, speed = (np.array(parts) for parts in zip(*rows, strict=True))
        # the distance is at most that of the nearest feature, plus its change
        most = np.full(width.size, inf)
        least = np.full(width.size, inf)
        for g, v in zip(gap, speed, strict=True):
            np.minimum.at(most, pose, g + v * wide)
            np.minimum.at(least, pose, g - v * wide)
        fastest = np.zeros(width.size)
        for g, v in zip(gap, speed, strict=True):
            np.maximum.at(fastest, pose, np.where(g - v * wide <= most[pose], v, 0.0))
        enclosed = near.value <= 0.0  # a shape inside another one has no nearest feature
        return np.where(enclosed, inf, fastest), np.where(enclosed, -inf, least)

    def _pairs_of_features(
        self, placement: Placement, near: Distances, width: np.ndarray
    ) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Distance (t,) [m] and largest speed (t,) [m/rad] of pairs of features; an infinite distance where there is none.

        A feature is a corner, or the inside of a line or an arc.
        """
        shapes, base = self.encounter.shapes, self.base[near.pose]
        sides = [
            _Side(shape, number, elements)
            for shape, number, elements in zip(
                (shapes.first, shapes.second),
                (near.first, near.second),
                elements_of(shapes, placement, near),
                strict=True,
            )
        ]
        growth = sides[0].growth + sides[1].growth
        for number, (side, other) in enumerate((sides, sides[::-1])):
            for end in _ENDS:
                if side.is_corner[end].any():
                    gap, speed = self._corner_and_inside(number, side, other, end, base, width)
                    yield np.where(side.is_corner[end], gap - growth, inf), speed
        for first, second in product(_ENDS, _ENDS):
            both = sides[0].is_corner[first] & sides[1].is_corner[second]
            if both.any():
                gap = np.abs(getattr(sides[0].elements, first) - getattr(sides[1].elements, second)) - growth
                points = getattr(sides[0].local, first), getattr(sides[1].local, second)
                yield np.where(both, gap, inf), self._speeds.of_two(base, *points)
        if sides[0].is_arc.any() or sides[1].is_arc.any():
            yield self._two_insides(sides, base, width, near.gap)

    def _corner_and_inside(
        self, number: int, side: _Side, other: _Side, end: str, base: np.ndarray, width: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Distance and speed (t,) of a corner of one body and the inside of a line or an arc of the other."""
        z, local = getattr(side.elements, end), getattr(side.local, end)
        gap, speed = self._point_and_line(number, z, local, other, base, width)
        if other.is_arc.any():
            on_arc = np.abs(z - other.elements.nearest(z))
            points = (local, other.local.centre) if number == 0 else (other.local.centre, local)
            gap = np.where(other.is_arc, on_arc, gap)
            speed = np.where(other.is_arc, self._speeds.of_two(base, *points), speed)
        return gap, speed

    def _point_and_line(
        self, number: int, z: np.ndarray, local: np.ndarray, other: _Side, base: np.ndarray, width: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Distance (t,) of points from lines, and its speed across the line; infinite where the foot is beyond the ends."""
        chord = other.elements.end - other.elements.start
        length = np.abs(chord)
        direction = chord / np.where(length > 0.0, length, 1.0)
        position = direction.conj() * (z - other.elements.start)
        beyond = np.maximum(-position.real, position.real - length)
        chord = other.local.end - other.local.start
        normal = 1j * chord / np.where(length > 0.0, length, 1.0)
        has_foot = (length > 0.0) & (beyond <= self._speeds.of_points(number, base, local) * width)
        return np.where(has_foot, np.abs(position.imag), inf), self._speeds.of_points(number, base, local, normal)

    def _two_insides(
        self, sides: Sequence[_Side], base: np.ndarray, width: np.ndarray, gap: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Distance and largest speed (t,) of the inside of an arc and that of a line or an arc."""
        speed = self._speeds.of_two(base, sides[0].local.centre, sides[1].local.centre)
        has_foot = sides[0].is_arc & sides[1].is_arc
        for number, (side, other) in enumerate((sides, sides[::-1])):
            rows = side.is_arc & ~other.is_arc
            if rows.any():
                distance, across = self._point_and_line(
                    number, side.elements.centre, side.local.centre, other, base, width
                )
                speed = np.where(rows, across, speed)
                has_foot |= rows & np.isfinite(distance)
        of_bodies = [
            self._speeds.of_points(number, base, side.disc_centre)
            + side.disc_radius * self._speeds.of_turn(number, base)
            for number, side in enumerate(sides)
        ]
        return np.where(has_foot, gap, inf), np.minimum(speed, np.minimum(*of_bodies))


_ENDS = ("start", "end")


class _Side:
    """Elements (t,) of one body: in the frame of the first body, and in its own."""

    def __init__(self, shape: Shape, number: np.ndarray, elements: Elements) -> None:
        self.elements = elements
        self.local = Elements(*(getattr(shape, name)[number] for name in Elements._fields))
        self.growth, self.is_arc = shape.growth[number], shape.is_arc[number]
        self.is_corner = {end: rows[number] for end, rows in zip(_ENDS, shape.is_corner, strict=True)}
        self.disc_centre, self.disc_radius = shape.disc_centre[number], shape.disc_radius[number]


class _Speeds:
    """Bounds of speeds in the first intervals of a turn, per radian.

    By speed, acceleration and jerk at both ends of an interval: the motion is smooth inside a piece, and no jerk there is more than
    twice the larger one at the ends. ``first`` is the motion of the first body in the frame of the second, ``second`` the other.
    """

    def __init__(
        self,
        intervals: Intervals,
        first: RelativeMotion,
        second: RelativeMotion,
        bodies: tuple[BodyMotion, BodyMotion],
    ) -> None:
        self.first, self.second, self._bodies = first, second, bodies
        self._ends = intervals.low, intervals.high
        theta = intervals.angles.theta
        self._width = theta[intervals.high] - theta[intervals.low]

    def of_points(
        self, side: int, base: np.ndarray, point: np.ndarray | complex, along: np.ndarray | None = None
    ) -> np.ndarray:
        """Speeds of points (t,) of one body relative to the other, in intervals (t,); `along` unit vectors (t,) of the other."""
        motion = (self.first, self.second)[side]

        def rate(k: int, at: np.ndarray) -> np.ndarray:
            velocity = motion.origin[k][at] + point * motion.turn[k][at]
            return np.asarray(velocity if along is None else (along.conj() * velocity).real)

        return self._bounded(base, rate)

    def of_turn(self, side: int, base: np.ndarray) -> np.ndarray:
        """Speed of rotation of one body relative to the other, in intervals (t,) [rad/rad]."""
        motion = (self.first, self.second)[side]
        return self._bounded(base, lambda k, at: motion.turn[k][at])

    def of_two(self, base: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Speed at which points (t,) of the first and the second body approach or leave each other, in intervals (t,)."""
        (z, unit), (w, turn) = self._bodies

        def difference(k: int, at: np.ndarray) -> np.ndarray:
            a, b, c, d = (row[k][at % row[k].size] for row in (z, unit, w, turn))
            return np.asarray(a + first * b - c - second * d)

        relative_speeds = self.of_points(0, base, first), self.of_points(1, base, second)
        return np.minimum(np.minimum(*relative_speeds), self._bounded(base, difference))

    def of_disc(self, shape: Shape, side: int) -> np.ndarray:
        """Largest speed of all points of a shape relative to the other body, in every interval (m,)."""
        middle, radius = shape.disc
        every = np.arange(self._width.size)
        return self.of_points(side, every, middle) + radius * self.of_turn(side, every)

    def _bounded(self, base: np.ndarray, rate: Callable[[int, np.ndarray], np.ndarray]) -> np.ndarray:
        ends = [rows[base] for rows in self._ends]
        speed, acceleration, jerk = (np.maximum(*(np.abs(rate(k, at)) for at in ends)) for k in (1, 2, 3))
        width = self._width[base]
        return np.asarray(speed + 0.5 * width * (acceleration + width * jerk))
