"""The circle diagram: in which order Kennedy's theorem finds the centres, each from its two triangles (Velocity, 6.3).

Bodies stand on a circle, known centres are solid lines between them. A wanted one is found where it shares two triangles
with known ones: the three centres of any three bodies lie on one line, so it is where two such lines cross.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache
from heapq import heappop, heappush
from itertools import combinations

import numpy as np

from core.frozen import frozen

# -- an instant centre in homogeneous coordinates ---------------------------------------------------------------


Key = tuple[str, str]
"""Two bodies, in the order of a mechanism's."""
FAR = 1e12  # sizes of the mechanism: beyond this a centre counts as at infinity


def key_of(a: str, b: str, order: Mapping[str, int]) -> Key:
    """The key of two bodies, given in either order; ``order``: body -> its place in the mechanism's order."""
    return (a, b) if order[a] < order[b] else (b, a)


@frozen(eq=False)
class Centres:
    """point (n,) complex and weight (n,): the centre is point/weight; weight 0 = at infinity in direction point.

    error_bound: how many times the rounding of the centres that it was constructed from it carries, as a vector (point/size,
    weight) of length 1; (n,) or one for all
    """

    point: np.ndarray
    weight: np.ndarray
    error_bound: np.ndarray | float = 1.0

    @property
    def finite(self) -> np.ndarray:
        """Places (n,) complex [m], inf where the centre is at infinity."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.weight == 0.0, complex(np.inf, np.inf), self.point / self.weight)

    @property
    def homogeneous(self) -> np.ndarray:
        """(3, n): x, y [m] and weight."""
        return np.array([self.point.real, self.point.imag, self.weight])

    def far(self, size: float) -> np.ndarray:
        """(n,) where the centre is at infinity, or so far away that rounding cannot tell."""
        return np.abs(self.weight) * (FAR * size) <= np.abs(self.point)

    @property
    def direction(self) -> np.ndarray:
        """(n,) [rad] of a centre at infinity, 0 ... π."""
        angle = np.remainder(np.angle(self.point), np.pi)
        return np.where(angle >= np.pi, 0.0, angle)

    def scaled(self, size: float) -> Centres:
        """The same centres with |point|/size and weight on the unit circle."""
        length = np.hypot(np.abs(self.point) / size, self.weight)
        length = np.where(length == 0.0, 1.0, length)
        return Centres(self.point / length, self.weight / length, self.error_bound)


# -- the circle diagram -----------------------------------------------------------------------------------------


@frozen
class Triangle:
    """A wanted centre's bodies and a third one: the line through ``first`` and ``second`` holds the wanted centre."""

    third: str
    first: Key
    second: Key


@frozen
class KennedyStep:
    """A centre and the triangles that give it when its turn comes; the first two are drawn."""

    key: Key
    triangles: tuple[Triangle, ...]


@frozen
class Construction:
    """Centres known at sight, then the others in the order they are found; ``beyond``: those that no two triangles
    reach (the linkage is indeterminate by this construction)."""

    known: tuple[Key, ...]
    steps: tuple[KennedyStep, ...]
    beyond: tuple[Key, ...] = ()


@lru_cache(maxsize=64)
def construction(bodies: tuple[str, ...], known: frozenset[Key]) -> Construction:
    """The order of the construction, lowest bodies first, round by round.

    A pair of bodies is reached when two others share a known centre with both: each newly known centre reaches at most
    2 (b - 2) pairs of b bodies, so that the whole order takes about b³ steps.
    """
    order = {name: i for i, name in enumerate(bodies)}
    all_keys = list(combinations(bodies, 2))
    joined = [0] * len(bodies)  # bit j of row i: the centre of i and j is known
    ready: list[tuple[int, int]] = []  # pairs that are reached, the lowest first
    waiting: set[tuple[int, int]] = set()

    def join(a: int, b: int) -> None:
        joined[a] |= 1 << b
        joined[b] |= 1 << a

    def reach(a: int, b: int) -> None:
        """The pairs that the centre of a and b gives a triangle."""
        for one, other in ((a, b), (b, a)):
            for third in _bits(joined[other] & ~(joined[one] | 1 << one)):
                pair = (one, third) if one < third else (third, one)
                if pair not in waiting and (joined[one] & joined[third]).bit_count() > 1:
                    waiting.add(pair)
                    heappush(ready, pair)

    at_sight = [(order[first], order[second]) for first, second in known]
    for pair in at_sight:
        join(*pair)
    for pair in at_sight:
        reach(*pair)
    steps: list[KennedyStep] = []
    while ready:
        a, b = heappop(ready)
        steps.append(
            KennedyStep(
                (bodies[a], bodies[b]),
                tuple(
                    Triangle(bodies[c], key_of(bodies[a], bodies[c], order), key_of(bodies[b], bodies[c], order))
                    for c in _bits(joined[a] & joined[b])
                ),
            )
        )
        join(a, b)
        reach(a, b)
    have = known.union(step.key for step in steps)
    return Construction(
        tuple(key for key in all_keys if key in known), tuple(steps), tuple(key for key in all_keys if key not in have)
    )


def _bits(mask: int) -> Iterator[int]:
    """The numbers of the bits that are set, lowest first."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def line_of(centres: Mapping[Key, Centres], triangle: Triangle) -> np.ndarray:
    """The line of a triangle's two known centres, (3, n): a x + b y + c = 0, (a, b) of length 1 where it is finite;
    all 0 where they coincide."""
    p, q = (centres[key].homogeneous for key in (triangle.first, triangle.second))
    line = np.cross(p, q, axis=0)
    length = np.hypot(line[0], line[1])
    return np.where(length > 0.0, line / np.where(length > 0.0, length, 1.0), line)


def kennedy(centres: Mapping[Key, Centres], wanted: KennedyStep, size: float) -> Centres:
    """The wanted centre where the lines of two of its triangles cross; at each position of the two that cross at the
    steepest angle (n,). size [m] of the mechanism: coordinates are compared in units of it."""
    best, square, error_bound = np.zeros(1), np.full(1, -1.0), np.zeros(1)
    for (one, of_one), (other, of_other) in combinations(_lines(centres, wanted, size), 2):
        cut = np.cross(one, other, axis=0)
        steeper = (cut * cut).sum(axis=0)
        better = steeper > square
        best, error_bound = np.where(better, cut, best), np.where(better, of_one + of_other, error_bound)
        square = np.where(better, steeper, square)
    with np.errstate(divide="ignore"):
        return Centres(size * (best[0] + 1j * best[1]), best[2], error_bound / np.sqrt(square))


def agreement(centres: Mapping[Key, Centres], wanted: KennedyStep, found: Centres, size: float) -> np.ndarray:
    """How far a centre lies off the lines of its triangles at worst (n,), of unit vectors: 0 by Kennedy's theorem."""
    at = _vector(found, size)
    return np.asarray(np.max([np.abs((line * at).sum(axis=0)) for line, _ in _lines(centres, wanted, size)], axis=0))


_LEAST_LENGTH = 1e-7  # of unit vectors: centres nearer to each other leave their line to rounding


def _lines(centres: Mapping[Key, Centres], wanted: KennedyStep, size: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """The lines of all triangles (3, n), of length 1 with coordinates in units of the size, 0 where rounding decides the line;
    and how many times the rounding of the centres at sight each carries: its centres' error bounds over their distance."""
    lines = []
    for triangle in wanted.triangles:
        one, other = centres[triangle.first], centres[triangle.second]
        line = np.cross(_vector(one, size), _vector(other, size), axis=0)
        length = np.sqrt((line * line).sum(axis=0))
        bound = (one.error_bound + other.error_bound) / np.maximum(length, _LEAST_LENGTH)
        lines.append((_unit(np.where(length > _LEAST_LENGTH, line, 0.0)), bound))
    return lines


def _vector(centre: Centres, size: float) -> np.ndarray:
    """(x/size, y/size, weight) (3, n) of length 1."""
    return _unit(np.array(np.broadcast_arrays(centre.point.real / size, centre.point.imag / size, centre.weight)))


def _unit(vectors: np.ndarray) -> np.ndarray:
    """(3, n) of length 1; what is 0 stays so."""
    length = np.sqrt((vectors * vectors).sum(axis=0))
    return vectors / np.where(length > 0.0, length, 1.0)
