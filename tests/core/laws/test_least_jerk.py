"""core.laws.least_jerk against fifty-digit minimisers, closed forms, and what makes a curve the one of least jerk."""

import math
import random
from collections.abc import Sequence
from typing import Any

import mpmath
import numpy as np
import pytest
from references import EPS
from sampled import spread

from core.laws import NoSpline, Piece, PieceTable, least_jerk
from core.laws.polynomial import least_jerk_states

MP = mpmath.mp.clone()
MP.dps = 100  # the reference's own equations lose half of them where knots are close together
Condition = tuple[float, int, float]


def shape(pieces: Sequence[Piece], order: int) -> np.ndarray:
    """s, s' or s'' at the start of each piece."""
    table = PieceTable(pieces)
    return table.rows(np.arange(len(pieces)), np.zeros(len(pieces)))(order)


# -- against a minimiser that shares nothing with the code ------------------------------------------------


class Minimiser:
    """Quintics with free coefficients, joined and conditioned by multipliers (Karush-Kuhn-Tucker), at fifty digits."""

    def __init__(self, knots: Sequence[float], conditions: Sequence[Condition], periodic: bool) -> None:
        self.u = [MP.mpf(x) for x in knots]
        self.h = [b - a for a, b in zip(self.u[:-1], self.u[1:], strict=True)]
        m = self.pieces = len(self.h)
        rows = []
        for a, b in [(i, i + 1) for i in range(m - 1)] + ([(m - 1, 0)] if periodic else []):
            for order in range(3):
                rows.append(self._row(a, 1, order, 1) + self._row(b, 0, order, -1))
        self.joins = len(rows)
        for place, order, _ in conditions:
            k = list(knots).index(place)
            rows.append(self._row(*((k, 0) if k < m else (k - 1, 1)), order, 1))
        n = 6 * m + len(rows)
        system = MP.zeros(n)
        for i in range(m):
            for a in range(3, 6):
                for b in range(3, 6):
                    third = MP.mpf(math.perm(a, 3) * math.perm(b, 3)) / (a + b - 5)
                    system[6 * i + a, 6 * i + b] = third * self.h[i] ** (a + b - 5)
        for j, row in enumerate(rows):
            for place, value in row:
                system[6 * m + j, place] += value
                system[place, 6 * m + j] += value
        self._solved = MP.LU_decomp(system)
        self._size = n

    def _row(self, piece: int, end: int, order: int, sign: int) -> list[tuple[int, Any]]:
        w = self.h[piece] if end else MP.zero
        return [(6 * piece + k, sign * math.perm(k, order) * w ** (k - order)) for k in range(order, 6)]

    def states(self, values: Sequence[float]) -> list[list[Any]]:
        """s, s', s'' at the start of each piece for these values of the conditions."""
        lower, order = self._solved
        right = MP.zeros(self._size, 1)
        for j, value in enumerate(values):
            right[6 * self.pieces + self.joins + j] = value
        c = MP.U_solve(lower, MP.L_solve(lower, right, order))
        return [[c[6 * i], c[6 * i + 1], 2 * c[6 * i + 2]] for i in range(self.pieces)]


def problem(seed: int) -> tuple[list[float], list[Condition], bool]:
    """Two to six pieces, even and very uneven, with values, velocities, accelerations or all of them prescribed."""
    chance = random.Random(seed)
    periodic, kind = chance.random() < 0.5, ("values", "velocities", "accelerations", "mixed")[seed % 4]
    parts = [10.0 ** chance.uniform(-(seed % 3), 0.0) for _ in range(chance.randint(2, 6))]
    knots = [0.0, *np.cumsum(parts[:-1]) / math.fsum(parts), 1.0]
    knots = [float(u) for u in knots]
    conditions: list[Condition] = [(0.0, 0, 0.0)]
    if not periodic:
        conditions += [(1.0, 0, chance.uniform(-1.0, 1.0)), *((u, order, 0.0) for u in (0.0, 1.0) for order in (1, 2))]
    for u in knots[1:-1]:
        order = chance.randrange(3) if kind == "mixed" else ("values", "velocities", "accelerations").index(kind)
        conditions.append((u, order, chance.uniform(-1.0, 1.0)))
    return knots, conditions, periodic


@pytest.mark.parametrize("seed", spread(range(8), 1))
def test_the_curve_is_that_of_a_minimiser_of_fifty_digits(seed: int) -> None:
    """The states miss the exact ones by no more than the rounding of the conditions to their last digit would, times
    the root of the energy's own condition, (longest over shortest distance of knots)^(5/2)."""
    knots, conditions, periodic = problem(seed)
    exact = Minimiser(knots, conditions, periodic)
    values = [value for _, _, value in conditions]
    wanted = exact.states(values)
    each = [exact.states([v if i == j else 0.0 for i, v in enumerate(values)]) for j in range(len(values))]
    pieces = least_jerk(knots, conditions, periodic)
    uneven = (max(np.diff(knots)) / min(np.diff(knots))) ** 2.5
    for order in range(3):
        got = shape(pieces, order)
        size = max(float(sum(abs(one[i][order]) for one in each)) for i in range(len(pieces)))
        error = max(float(abs(wanted[i][order] - MP.mpf(got[i]))) for i in range(len(pieces)))
        assert error <= 16 * EPS * uneven * size, order


# -- against closed forms ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("prescribed", "power"), [(0, 6), (1, 4)])
@pytest.mark.parametrize("m", [24, 360])
def test_through_even_samples_of_a_wave_the_curve_is_the_sum_of_its_aliases(
    m: int, prescribed: int, power: int
) -> None:
    """The periodic spline through cos 2πkx, or with its velocity, at m even knots: its waves are the k + jm, each in
    proportion to (k + jm)^-6, or to (k + jm)^-4 where the velocities are prescribed (Golomb 1968)."""
    k = 3
    aliases = k + m * np.arange(-400, 401)
    weights = aliases.astype(float) ** -power
    weights /= weights.sum()
    u = np.arange(m) / m
    knots = [*u.tolist(), 1.0]
    waves = np.exp(2j * np.pi * np.outer(u, aliases)) * weights

    def exact(order: int) -> np.ndarray:
        """The order-th derivative by u of the prescribed one's spline; a velocity is integrated once."""
        return (waves * (2j * np.pi * aliases) ** (order - prescribed)).sum(axis=1).real

    given = [(float(a), prescribed, float(v)) for a, v in zip(u, np.cos(2 * np.pi * k * u), strict=True)]
    if prescribed:
        given.append((0.0, 0, float(exact(0)[0])))
    pieces = least_jerk(knots, given, periodic=True)
    tail = 2.0 * float(np.sum((m * np.arange(401, 40_000)) ** (2.0 - power)))  # of the sum, in the second derivative
    for order in range(3):
        # a value's rounding grows by the steepest wave that the knots carry
        bound = (
            16 * EPS * (np.pi * m) ** max(order - prescribed, 0) + tail * (2 * np.pi) ** (order - prescribed) * k**power
        )
        assert np.abs(shape(pieces, order) - exact(order)).max() <= bound, order


@pytest.mark.parametrize("uneven", [1.0, 30.0])
def test_through_values_alone_jerk_and_its_slope_are_continuous(uneven: float) -> None:
    """What makes it the curve of least jerk: s⁗ and s''' jump at no knot where only a value is prescribed."""
    chance = np.random.default_rng(5)
    width = uneven ** chance.random(360)
    u = np.concatenate(([0.0], np.cumsum(width)))
    u /= u[-1]
    u[-1] = 1.0
    given = [(float(a), 0, float(np.cos(2 * np.pi * a) + 0.2 * np.sin(10 * np.pi * a))) for a in u[:-1]]
    rows = np.array([p.polynomial for p in least_jerk(u.tolist(), given, periodic=True)])
    w = np.diff(u)
    size = np.abs(rows[:, 1:3]).max(axis=0)  # of s' and s''/2, the largest that the knots' values make
    ends = np.array([[math.comb(k, j) * math.factorial(j) for k in range(6)] for j in range(5)])
    powers = w[:, None] ** np.arange(6)
    for order, bound in ((0, EPS), (1, EPS * size[0]), (2, EPS * size[1] / w.min())):
        end = (rows[:, order:] * ends[order, order:] * powers[:, : 6 - order]).sum(axis=1)
        jump = end - np.roll(rows[:, order], -1) * math.factorial(order)
        assert np.abs(jump).max() <= 64 * bound, order
    for order in (3, 4):
        end = (rows[:, order:] * ends[order, order:] * powers[:, : 6 - order]).sum(axis=1)
        jump = end - np.roll(rows[:, order], -1) * math.factorial(order)
        # a value's last digit, seen over the narrowest interval
        assert np.abs(jump).max() <= 1e3 * EPS / w.min() ** order, order


# -- as least squares -------------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [1, 2, 3, 5, 8, 13])
def test_a_ring_of_any_length_is_solved_as_its_normal_equations(n: int) -> None:
    """Half of the states fixed, those of the first knot among them, against the dense equations for the others."""
    chance = np.random.default_rng(n)
    h = 0.5 + chance.random(n)
    h /= h.sum()
    fixed = chance.random((n, 3)) < 0.5
    fixed[0, :2] = True
    known = np.where(fixed[:, :, None], chance.normal(size=(n, 3, 2)), 0.0)
    got = least_jerk_states(h, known, fixed)
    inner = np.linalg.inv(np.array([[1 / 20, 1 / 8, 1 / 6], [1 / 8, 1 / 3, 1 / 2], [1 / 6, 1 / 2, 1]]))
    normal = np.zeros((3 * n, 3 * n))
    for i in range(n):
        j = (i + 1) % n
        made = np.zeros((3, 3 * n))
        made[:, 3 * i : 3 * i + 3] -= np.array([[1, h[i], h[i] ** 2 / 2], [0, h[i], h[i] ** 2], [0, 0, h[i] ** 2]])
        made[:, 3 * j : 3 * j + 3] += np.diag([1, h[i], h[i] ** 2])
        normal += made.T @ inner @ made / h[i] ** 5
    free, dense = np.flatnonzero(~fixed.ravel()), known.reshape(-1, 2)
    inside = normal[np.ix_(free, free)]
    dense[free] = np.linalg.solve(inside, -(normal @ dense)[free])
    assert np.abs(got.reshape(-1, 2) - dense).max() <= 64 * EPS * np.linalg.cond(inside) * np.abs(dense).max()


# -- what it refuses --------------------------------------------------------------------------------------


def test_conditions_that_contradict_each_other_are_refused() -> None:
    both = [(0.0, 0, 0.0), (0.5, 0, 1.0), (0.5, 0, 2.0)]
    for given, periodic in ((both, True), ([(0.0, 0, 0.0), (1.0, 0, 3.0)], True)):
        with pytest.raises(NoSpline, match="contradict"):
            least_jerk([0.0, 0.5, 1.0], given, periodic)
    assert least_jerk([0.0, 0.5, 1.0], [*both[:2], both[1]], True), "said twice alike"


@pytest.mark.parametrize("given", [[(0.5, 1, 1.0)], [(0.0, 0, 0.0), (1.0, 0, 1.0)]], ids=["height", "bend"])
def test_conditions_that_leave_the_curve_free_are_refused(given: list[Condition]) -> None:
    with pytest.raises(NoSpline, match="do not determine"):
        least_jerk([0.0, 0.5, 1.0], given, periodic=len(given) == 1)


def test_knots_that_cannot_be_told_apart_are_refused() -> None:
    with pytest.raises(NoSpline, match="1e-09 of its span from each other"):
        least_jerk([0.0, 0.5, 0.5 + 1e-10, 1.0], [(0.0, 0, 0.0)], periodic=True)
