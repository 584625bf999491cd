"""Heights and speeds of a family as sums of terms c t^e x_j: polynomials in one number t, linear in all others; and the
points (t, x1, ...) where such are 0: polynomials in t, or at the values of t that they pin."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property

import numpy as np

from core.blend.polynomials import ONE, UNIT, ZERO, Polynomial, at, roots, rounded, shortened, size_at, vanishes, whole
from core.frozen import frozen

POWERS = (-2, -1, 0, 1, 2)
Form = np.ndarray
"""Coefficients of t^e x_j, e in ``POWERS``, x_0 = 1: (powers, 1 + numbers)."""
Row = tuple[Polynomial, ...]
"""An equation p0(t) + p1(t) x1 + ... = 0."""
VANISHING = 1e-9  # what is left of an equation, as a share of its terms, where it is met
SINGULAR = 1e-11  # a pivot of equations of size 1 that counts as 0


def term(numbers: int, j: int = 0, e: int = 0) -> Form:
    """t^e x_j beside so many numbers."""
    form = np.zeros((len(POWERS), 1 + numbers))
    form[POWERS.index(e), j] = 1.0
    return form


def times_t(form: Form, powers: int) -> Form:
    """A form times t to so many powers, which stay within ``POWERS``."""
    return np.roll(form, powers, axis=0)


class FamilyEquations:
    """Forms by name, for a stroke of the rise and a span of 1.

    numbers    names of x_1, x_2, ...
    top, tops  t lies between 0 and top, x_j between 0 and tops[j - 1]
    """

    def __init__(self, forms: Mapping[str, Form], numbers: Sequence[str], top: float, tops: Sequence[float]) -> None:
        self.numbers, self.top, self.tops = tuple(numbers), top, tuple(tops)
        self.place = {name: i for i, name in enumerate(forms)}
        """Of each form its row in what ``evaluated`` returns."""
        self._forms = {**forms, "": term(len(self.numbers))}
        used = np.any(list(self._forms.values()), axis=(0, 2))
        self._powers = np.array(POWERS[int(used.argmax()) :], dtype=float)
        self._tensor = np.array(list(forms.values()))[:, -self._powers.size :]

    @cached_property
    def exact(self) -> Mapping[str, Row]:
        """Of each form, and of 1 under an empty name, the polynomials by 1, x_1, ...: all times the same power of t."""
        width, count = len(self.numbers) + 1, self._powers.size
        columns = [column for form in self._forms.values() for column in form[-count:].T.tolist()]
        short = shortened(Polynomial(map(whole, column)) for column in columns)
        return {name: tuple(short[i * width :][:width]) for i, name in enumerate(self._forms)}

    def evaluated(self, t: np.ndarray, x: np.ndarray, slopes: bool = False) -> np.ndarray:
        """All forms at t (n,) and x (numbers, n): (forms, 1, n); with their derivatives by t, x_1, ... behind the value:
        (forms, 2 + numbers, n)."""
        with_one = np.concatenate((np.ones((1, t.size)), x))
        with np.errstate(all="ignore"):
            powers = t ** self._powers[:, None]
            columns = np.einsum("fej,en->fjn", self._tensor, powers)
            values = np.einsum("fjn,jn->fn", columns, with_one)[:, None]
            if not slopes:
                return values
            by_t = np.einsum("fej,en,jn->fn", self._tensor, self._powers[:, None] * powers / t, with_one)[:, None]
        return np.concatenate((values, by_t, columns[:, 1:]), axis=1)


# -- where forms are 0 ------------------------------------------------------------------------------------


@frozen
class SolutionSpace:
    """Points over some of the free numbers: x_j = (x[j][0] + x[j][1] y1 + ...)/below, polynomials in t, or numbers where
    the equations pin t.

    t     its value where the equations pin it, None where it is free
    free  the j of the x_j that stay free: y1, y2, ...
    """

    equations: FamilyEquations
    t: float | None
    free: tuple[int, ...]
    x: tuple[Row, ...]
    below: Polynomial

    @property
    def freedom(self) -> int:
        """How many numbers are free in it."""
        return len(self.free) + (self.t is None)

    @property
    def only(self) -> tuple[float, ...]:
        """The x_j where nothing is free."""
        *rows, below = rounded([*(r[0] for r in self.x), self.below])
        return tuple([row[0] / below[0] if row else 0.0 for row in rows])

    def along(self, first: int = 0) -> Parametrised:
        """The same over one number p, which is t where that is free, else y_first, and the other free numbers."""
        if self.t is None:
            return Parametrised(self.equations, None, self.x, self.below, self.equations.top)
        others = [i for i in range(len(self.free)) if i != first]
        rows = tuple([(r[0] + r[1 + first].shifted(1), *(r[1 + i] for i in others)) for r in self.x])
        return Parametrised(self.equations, self.t, rows, self.below, self.equations.tops[self.free[first] - 1])


@frozen
class Parametrised:
    """Points over a number p, 0 < p < top, and others: x_j = (x[j-1][0](p) + x[j-1][1](p) y1 + ...)/below(p).

    t  its value; None where p is t
    """

    equations: FamilyEquations
    t: float | None
    x: tuple[Row, ...]
    below: Polynomial
    top: float

    def form(self, name: str) -> Row:
        """A form, or 1 for an empty name, by 1, y1, ...: polynomials in p, all forms times the same one."""
        row = self.equations.exact[name]
        if self.t is not None:
            powers = [whole(self.t**e) for e in range(max(map(len, row)))]
            row = tuple([Polynomial([sum(c * p for c, p in zip(r.coefficients, powers, strict=False))]) for r in row])
        made = [row[0] * self.below, *[ZERO] * (len(self.x[0]) - 1 if self.x else 0)]
        for factor, numerators in zip(row[1:], self.x, strict=True):
            if factor:
                made = [m + factor * n if n else m for m, n in zip(made, numerators, strict=True)]
        return tuple(made)

    def t_at(self, p: np.ndarray) -> np.ndarray:
        """t (n,) at p (n,)."""
        return p if self.t is None else np.full_like(p, self.t)


def solution_spaces(equations: FamilyEquations, rows: Iterable[Row]) -> list[SolutionSpace]:
    """All points that meet the equations."""
    rows = [_lowered(row) for row in rows]
    pivots, below, rest = _eliminated(rows, len(equations.numbers))
    pins = [row[0] for row in rest if row[0]]
    if pins:
        first, *others = sorted(pins, key=len)
        shown = [rounded([p])[0] for p in others]
        values = [t for t in roots(first, 0.0, equations.top) if all(vanishes(p, t, VANISHING) for p in shown)]
        return [space for t in values for space in _at_one_t(equations, rows, t)]
    result = [_space(equations, None, pivots, below)]
    for t in roots(below, 0.0, equations.top):  # a whole line may meet the equations there
        result += [s for s in _at_one_t(equations, rows, t) if len(s.free) > len(result[0].free)]
    return result


def _lowered(row: Row) -> Row:
    """Without a common power of t."""
    lowest = min([p.lowest_power for p in row if p], default=0)
    return tuple([p.shifted(-lowest) for p in row]) if lowest else row


def _eliminated(rows: list[Row], k: int) -> tuple[dict[int, Row], Polynomial, list[Row]]:
    """Rows that each give one x_j, which stands in no other row, all with the same factor; that factor; and the rows in
    which no x is left. Bareiss' elimination: every division comes out even, so that no factor is left over."""
    waiting, columns = list(rows), set(range(1, k + 1))
    done: dict[int, Row] = {}
    factor = ONE
    while choices := [(_cost(row[j]), i, j) for i, row in enumerate(waiting) for j in columns if row[j]]:
        _, i, j = min(choices)
        pivot, last = waiting.pop(i), factor
        factor = pivot[j]
        columns.remove(j)
        waiting = [_without(row, pivot, j, last) for row in waiting]
        done = {**{n: _without(row, pivot, j, last) for n, row in done.items()}, j: pivot}
    return done, factor, waiting


def _cost(pivot: Polynomial) -> tuple[int, int]:
    """A pivot of one term keeps the degrees low."""
    return len(pivot) - pivot.coefficients.count(0), len(pivot)


def _without(row: Row, pivot: Row, j: int, last: Polynomial) -> Row:
    return tuple([(pivot[j] * a - row[j] * b) // last for a, b in zip(row, pivot, strict=True)])


def _space(equations: FamilyEquations, t: float | None, pivots: Mapping[int, Row], below: Polynomial) -> SolutionSpace:
    """The points where below x_j + pivots[j][0] + Σ pivots[j][n] x_n = 0, n the numbers without a pivot."""
    columns = range(1, len(equations.numbers) + 1)
    free = tuple([j for j in columns if j not in pivots])
    alone = {j: (ZERO, *(below if n == j else ZERO for n in free)) for j in free}
    rows = [alone[j] if j in alone else tuple([-1 * pivots[j][n] for n in (0, *free)]) for j in columns]
    tidied = _lowered(tuple(shortened((below, *(p for row in rows for p in row)))))
    width = len(free) + 1
    return SolutionSpace(
        equations, t, free, tuple(tidied[1 + i * width :][:width] for i in range(len(rows))), tidied[0]
    )


def _at_one_t(equations: FamilyEquations, rows: list[Row], t: float) -> list[SolutionSpace]:
    """The rows at one t, eliminated with the greatest pivot; none where they contradict each other."""
    k = len(equations.numbers)
    polynomials = [rounded(row) for row in rows]
    sizes = [max(size_at(p, t) for p in row) or 1.0 for row in polynomials]
    waiting = [np.array([at(p, t) / size for p in row]) for row, size in zip(polynomials, sizes, strict=True)]
    solved: dict[int, np.ndarray] = {}
    while waiting:
        size, i, j = max(
            ((abs(r[j]), i, j) for i, r in enumerate(waiting) for j in range(1, k + 1)), default=(0.0, 0, 0)
        )
        if size <= SINGULAR:
            break
        pivot = waiting.pop(i)
        pivot = pivot / pivot[j]
        waiting = [r - r[j] * pivot for r in waiting]
        solved = {**{n: r - r[j] * pivot for n, r in solved.items()}, j: pivot}
    if any(abs(r[0]) > VANISHING for r in waiting):
        return []
    exact = {j: tuple([Polynomial([whole(c)]) for c in row.tolist()]) for j, row in solved.items()}
    return [_space(equations, t, exact, Polynomial([UNIT]))]
