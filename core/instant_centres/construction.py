"""Circle diagram: the order in which Kennedy's theorem gives the instant centres, each from two triangles.

Bodies are points on a circle, known centres are lines between them. By Kennedy's theorem the three centres of any three bodies lie
on one line. So a centre that belongs to two triangles with known centres is the intersection of two such lines.

Source: lecture *Velocity*, 6.3.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache
from heapq import heappop, heappush
from itertools import combinations

import numpy as np

from core.frozen import frozen

# -- homogeneous coordinates of a centre ------------------------------------------------------------------------


Key = tuple[str, str]
"""Names of two bodies, in the order of the mechanism's bodies."""
FAR = 1e12  # sizes of the mechanism: a centre beyond this distance is at infinity


def key_of(a: str, b: str, order: Mapping[str, int]) -> Key:
    """Key of two bodies given in either order; `order` gives the index of each body in the mechanism."""
    return (a, b) if order[a] < order[b] else (b, a)


@frozen(eq=False)
class Centres:
    """Instant centre of two bodies at n positions, in homogeneous coordinates: point/weight.

    Attributes
    ----------
    point : ndarray (n,) complex [m times the unit of weight]
        Direction of the centre where the weight is 0 (at infinity).
    weight : ndarray (n,), dimensionless
    error_bound : float or ndarray (n,), dimensionless
        Error of the vector (point/size, weight) of length 1, as a multiple of that of the centres from which it is constructed.
    """

    point: np.ndarray
    weight: np.ndarray
    error_bound: np.ndarray | float = 1.0

    @property
    def finite(self) -> np.ndarray:
        """Positions (n,) complex [m], inf where the centre is at infinity."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.weight == 0.0, complex(np.inf, np.inf), self.point / self.weight)

    @property
    def homogeneous(self) -> np.ndarray:
        """Coordinates x, y [m] times the weight, and the weight, as rows (3, n)."""
        return np.array([self.point.real, self.point.imag, self.weight])

    def is_far(self, size: float) -> np.ndarray:
        """Whether the centre is at infinity, within rounding.

        Parameters
        ----------
        size : float
            Size [m] of the mechanism.

        Returns
        -------
        ndarray (n,) of bool, dimensionless
        """
        return np.abs(self.weight) * (FAR * size) <= np.abs(self.point)

    @property
    def direction(self) -> np.ndarray:
        """Direction (n,) [rad] of a centre at infinity, 0 ... π."""
        angle = np.remainder(np.angle(self.point), np.pi)
        return np.where(angle >= np.pi, 0.0, angle)

    def scaled(self, size: float) -> Centres:
        """The same centres, scaled so that |point|/size and weight are on the unit circle; size [m] of the mechanism."""
        length = np.hypot(np.abs(self.point) / size, self.weight)
        length = np.where(length == 0.0, 1.0, length)
        return Centres(self.point / length, self.weight / length, self.error_bound)


# -- the circle diagram -----------------------------------------------------------------------------------------


@frozen
class Triangle:
    """A triangle of the circle diagram: the centres `first` and `second`, with a third body, are on a line with the new centre."""

    third: str
    first: Key
    second: Key


@frozen
class KennedyStep:
    """A new centre and the triangles that give it; the first two are drawn."""

    key: Key
    triangles: tuple[Triangle, ...]


@frozen
class Construction:
    """Order of the construction.

    Attributes
    ----------
    known : tuple of Key
        Centres given by pairs.
    steps : tuple of KennedyStep
        Further centres, in the order of their construction.
    unreachable : tuple of Key
        Centres that belong to no two triangles of known centres; the linkage is indeterminate by this construction.
    """

    known: tuple[Key, ...]
    steps: tuple[KennedyStep, ...]
    unreachable: tuple[Key, ...] = ()


@lru_cache(maxsize=64)
def construction(bodies: tuple[str, ...], known: frozenset[Key]) -> Construction:
    """Order of the construction, lowest bodies first.

    A pair of bodies is reached when two other bodies have a known centre with both. A new centre reaches at most 2 (b - 2) pairs of
    b bodies, so that the order takes about b³ steps.
    """
    order = {name: i for i, name in enumerate(bodies)}
    all_keys = list(combinations(bodies, 2))
    known_centres = [0] * len(bodies)  # bit j of row i: the centre of i and j is known
    ready: list[tuple[int, int]] = []  # reached pairs, the lowest first
    reached: set[tuple[int, int]] = set()

    def add(a: int, b: int) -> None:
        known_centres[a] |= 1 << b
        known_centres[b] |= 1 << a

    def reach(a: int, b: int) -> None:
        """Add the pairs that the centre of a and b completes to two triangles."""
        for first, second in ((a, b), (b, a)):
            for third in _bits(known_centres[second] & ~(known_centres[first] | 1 << first)):
                pair = (first, third) if first < third else (third, first)
                if pair not in reached and (known_centres[first] & known_centres[third]).bit_count() > 1:
                    reached.add(pair)
                    heappush(ready, pair)

    known_pairs = [(order[first], order[second]) for first, second in known]
    for pair in known_pairs:
        add(*pair)
    for pair in known_pairs:
        reach(*pair)
    steps: list[KennedyStep] = []
    while ready:
        a, b = heappop(ready)
        steps.append(
            KennedyStep(
                (bodies[a], bodies[b]),
                tuple(
                    Triangle(bodies[c], key_of(bodies[a], bodies[c], order), key_of(bodies[b], bodies[c], order))
                    for c in _bits(known_centres[a] & known_centres[b])
                ),
            )
        )
        add(a, b)
        reach(a, b)
    constructed = known.union(step.key for step in steps)
    return Construction(
        tuple(key for key in all_keys if key in known),
        tuple(steps),
        tuple(key for key in all_keys if key not in constructed),
    )


def _bits(mask: int) -> Iterator[int]:
    """Indices of the bits that are set, lowest first."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def triangle_line(centres: Mapping[Key, Centres], triangle: Triangle) -> np.ndarray:
    """Line a x + b y + c = 0 through the two known centres of a triangle.

    Parameters
    ----------
    centres : mapping of Key to Centres
    triangle : Triangle

    Returns
    -------
    ndarray (3, n) [dimensionless for a and b, m for c]
        Rows a, b, c, with (a, b) of length 1 where the line is finite; 0 where the centres coincide.
    """
    p, q = (centres[key].homogeneous for key in (triangle.first, triangle.second))
    line = np.cross(p, q, axis=0)
    length = np.hypot(line[0], line[1])
    return np.where(length > 0.0, line / np.where(length > 0.0, length, 1.0), line)


def kennedy(centres: Mapping[Key, Centres], step: KennedyStep, size: float) -> Centres:
    """Centre at the intersection of the lines of two of its triangles, at each position of the two at the greatest angle.

    Parameters
    ----------
    centres : mapping of Key to Centres
        Known centres.
    step : KennedyStep
    size : float
        Size [m] of the mechanism, the unit of lengths.

    Returns
    -------
    Centres
    """
    best, square, error_bound = np.zeros(1), np.full(1, -1.0), np.zeros(1)
    for (first, first_bound), (second, second_bound) in combinations(_lines(centres, step, size), 2):
        cut = np.cross(first, second, axis=0)
        cut_square = (cut * cut).sum(axis=0)
        better = cut_square > square
        best, error_bound = np.where(better, cut, best), np.where(better, first_bound + second_bound, error_bound)
        square = np.where(better, cut_square, square)
    with np.errstate(divide="ignore"):
        return Centres(size * (best[0] + 1j * best[1]), best[2], error_bound / np.sqrt(square))


def agreement(centres: Mapping[Key, Centres], step: KennedyStep, centre: Centres, size: float) -> np.ndarray:
    """Largest distance of a centre from the lines of its triangles, as unit vectors; 0 by Kennedy's theorem.

    Parameters
    ----------
    centres : mapping of Key to Centres
        Known centres.
    step : KennedyStep
        Triangles of the centre.
    centre : Centres
    size : float
        Size [m] of the mechanism.

    Returns
    -------
    ndarray (n,), dimensionless
    """
    at = _vector(centre, size)
    return np.asarray(np.max([np.abs((line * at).sum(axis=0)) for line, _ in _lines(centres, step, size)], axis=0))


_LEAST_LENGTH = 1e-7  # of unit vectors: rounding determines the line of centres nearer to each other


def _lines(centres: Mapping[Key, Centres], step: KennedyStep, size: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Lines (3, n) of all triangles with their error bounds (n,).

    Lines have length 1 with coordinates in units of the size, and are 0 where rounding determines them. The error bound is the sum
    of those of the two centres, divided by their distance.
    """
    lines = []
    for triangle in step.triangles:
        first, second = centres[triangle.first], centres[triangle.second]
        line = np.cross(_vector(first, size), _vector(second, size), axis=0)
        length = np.sqrt((line * line).sum(axis=0))
        bound = (first.error_bound + second.error_bound) / np.maximum(length, _LEAST_LENGTH)
        lines.append((_unit(np.where(length > _LEAST_LENGTH, line, 0.0)), bound))
    return lines


def _vector(centre: Centres, size: float) -> np.ndarray:
    """Vectors (x/size, y/size, weight) (3, n) of length 1."""
    return _unit(np.array(np.broadcast_arrays(centre.point.real / size, centre.point.imag / size, centre.weight)))


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (3, n) scaled to length 1; zero vectors stay 0."""
    length = np.sqrt((vectors * vectors).sum(axis=0))
    return vectors / np.where(length > 0.0, length, 1.0)
