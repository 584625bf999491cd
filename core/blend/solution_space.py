"""The points (t, x1, ...) of a family that meet linear constraints: polynomials in t, or at the values of t that the
constraints pin."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from core.blend.equations import Equations, Row
from core.blend.family import Family
from core.blend.polynomials import ONE, UNIT, ZERO, Polynomial, at, roots, rounded, shortened, vanishes, whole
from core.blend.settings import Constraint, ratio

VANISHING = 1e-9  # a pivot so much smaller than its terms: the equations are eliminated anew at this t
SINGULAR = 1e-11  # a pivot of equations of size 1 that counts as 0


def equations_of(constraints: Iterable[Constraint], family: Family, equations: Equations) -> list[Row]:
    """The linear constraints as equations, without any rounding: form - value · other form = 0."""
    found = []
    for constraint in constraints:
        if constraint.linear:
            above, below = (equations.exact(name) for name in ratio(constraint.name, family))
            value = whole(constraint.value)
            found.append(tuple([UNIT * a - value * b for a, b in zip(above, below, strict=True)]))
    return found


@dataclass(frozen=True)
class SolutionSpace:
    """Points over some of the free numbers: x_j = (x[j][0] + x[j][1] y1 + ...)/below, polynomials in t, or numbers where
    the constraints pin t.

    t     its value where the constraints pin it, None where it is free
    free  the j of the x_j that stay free: y1, y2, ...
    """

    equations: Equations
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

    def leading(self, first: int = 0) -> tuple[list[Row], float]:
        """The x_j as polynomials in one number p by 1 and the other free numbers, and the upper end of p: it is t where that
        is free, else y_first."""
        if self.t is None:
            return list(self.x), self.equations.top
        others = [i for i in range(len(self.free)) if i != first]
        rows = [(r[0] + r[1 + first].shifted(1), *(r[1 + i] for i in others)) for r in self.x]
        return rows, self.equations.tops[self.free[first] - 1]


def solution_spaces(equations: Equations, rows: Iterable[Row]) -> list[SolutionSpace]:
    """All points that meet the equations."""
    rows = [_lowered(row) for row in rows]
    pivots, below, rest = _eliminated(rows, len(equations.numbers))
    pins = [row[0] for row in rest if row[0]]
    if pins:
        first, *others = sorted(pins, key=len)
        shown = [rounded([p])[0] for p in others]
        values = [t for t in roots(first, 0.0, equations.top) if all(vanishes(p, t, VANISHING) for p in shown)]
        return [space for t in values for space in _pinned(equations, rows, pivots, t)]
    found = [_over_t(equations, pivots, below)]
    for t in roots(below, 0.0, equations.top):  # a whole line may meet the equations there
        found += [s for s in _at_one_t(equations, rows, t) if len(s.free) > len(found[0].free)]
    return found


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


def _over_t(equations: Equations, pivots: dict[int, Row], below: Polynomial) -> SolutionSpace:
    columns = range(1, len(equations.numbers) + 1)
    free = tuple([j for j in columns if j not in pivots])
    alone = {j: (ZERO, *(below if n == j else ZERO for n in free)) for j in free}
    rows = [alone[j] if j in alone else tuple([-1 * pivots[j][n] for n in (0, *free)]) for j in columns]
    tidied = _lowered(tuple(shortened((below, *(p for row in rows for p in row)))))
    width = len(free) + 1
    return SolutionSpace(equations, None, free, tuple(tidied[1 + i * width :][:width] for i in range(len(rows))), tidied[0])


def _pinned(equations: Equations, rows: list[Row], pivots: dict[int, Row], t: float) -> list[SolutionSpace]:
    solved = {}
    for j, row in pivots.items():
        polynomials = rounded(row)
        if vanishes(polynomials[j], t, VANISHING):
            return _at_one_t(equations, rows, t)
        below = at(polynomials[j], t)
        solved[j] = [at(p, t) / below for p in polynomials]
    return [_of_numbers(equations, t, solved)]


def _at_one_t(equations: Equations, rows: list[Row], t: float) -> list[SolutionSpace]:
    """The rows at one t, eliminated with the greatest pivot; none where they contradict each other."""
    k = len(equations.numbers)
    waiting = [[at(p, t) for p in rounded(row)] for row in rows]
    sizes = [max(map(abs, r)) or 1.0 for r in waiting]
    waiting = [[v / s for v in r] for r, s in zip(waiting, sizes, strict=True)]
    solved: dict[int, list[float]] = {}
    while waiting:
        size, i, j = max(((abs(r[j]), i, j) for i, r in enumerate(waiting) for j in range(1, k + 1)), default=(0.0, 0, 0))
        if size <= SINGULAR:
            break
        row = waiting.pop(i)
        pivot = [v / row[j] for v in row]
        waiting = [[a - r[j] * b for a, b in zip(r, pivot, strict=True)] for r in waiting]
        solved = {n: [a - r[j] * b for a, b in zip(r, pivot, strict=True)] for n, r in solved.items()}
        solved[j] = pivot
    return [] if any(abs(r[0]) > VANISHING for r in waiting) else [_of_numbers(equations, t, solved)]


def _of_numbers(equations: Equations, t: float, solved: dict[int, list[float]]) -> SolutionSpace:
    """x_j = -solved[j][0] - solved[j][free] y."""
    columns = range(1, len(equations.numbers) + 1)
    free = tuple([j for j in columns if j not in solved])
    alone = {j: (0.0, *[float(n == j) for n in free]) for j in free}
    numbers = [alone[j] if j in alone else tuple([-solved[j][n] for n in (0, *free)]) for j in columns]
    x = tuple([tuple([Polynomial([whole(c)]) for c in row]) for row in numbers])
    return SolutionSpace(equations, t, free, x, Polynomial([UNIT]))
