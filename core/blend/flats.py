"""Linear wishes solved: the points that meet them, as polynomials in t or at the values of t that the wishes pin."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from core.blend.equations import Equations, Row
from core.blend.polynomials import (
    NOTHING,
    UNIT,
    Exact,
    at,
    crossed,
    divided,
    lowest_power,
    roots,
    rounded,
    scaled,
    shortened,
    vanishes,
)

VANISHING = 1e-9  # a pivot so much smaller than its terms: the equations are looked at anew there
SINGULAR = 1e-11


@dataclass(frozen=True)
class Flat:
    """Points over some of the free numbers: x_j = (x[j][0] + x[j][1] y1 + ...) / below, polynomials in t; where the wishes
    pin t, x_j = numbers[j][0] + numbers[j][1] y1 + ...

    t     its value where the wishes pin it, None where it is free
    free  the j of the x_j that stay free: y1, y2, ...
    """

    equations: Equations
    t: float | None
    free: tuple[int, ...]
    x: tuple[Row, ...] = ()
    below: Exact = UNIT
    numbers: tuple[tuple[float, ...], ...] = ()

    @property
    def freedom(self) -> int:
        """How many numbers are free on it."""
        return len(self.free) + (self.t is None)


def flats(equations: Equations, rows: Iterable[Row]) -> list[Flat]:
    """All points that meet the equations."""
    k = len(equations.numbers)
    rows = [_lowered(row) for row in rows]
    pivots, below, rest = _eliminated(rows, k)
    pins = [row[0] for row in rest if row[0]]
    if pins:
        first, *others = sorted(pins, key=len)
        shown = [rounded([p])[0] for p in others]
        values = [t for t in roots(first, 0.0, equations.top) if all(vanishes(p, t, VANISHING) for p in shown)]
        return [flat for t in values for flat in _pinned(equations, rows, pivots, t)]
    free = tuple(j for j in range(1, k + 1) if j not in pivots)
    found = [_over_t(equations, pivots, below, free)]
    for t in roots(below, 0.0, equations.top):  # a whole line may meet the equations there
        found += [f for f in _numerically(equations, rows, t) if len(f.free) > len(free)]
    return found


def _lowered(row: Row) -> Row:
    """Without a common power of t."""
    lowest = min([lowest_power(p) for p in row if p], default=0)
    return tuple([p[lowest:] for p in row]) if lowest else row


def _eliminated(rows: list[Row], k: int) -> tuple[dict[int, Row], Exact, list[Row]]:
    """Rows that each give one x_j, which stands in no other row, all with the same factor; that factor; and the rows in
    which no x is left. Bareiss' elimination: every division comes out even, so that no factor is left over."""
    waiting, columns = list(rows), set(range(1, k + 1))
    done: dict[int, Row] = {}
    factor = UNIT
    while choices := [(_cost(row[j]), i, j) for i, row in enumerate(waiting) for j in columns if row[j]]:
        _, i, j = min(choices)
        pivot, last = waiting.pop(i), factor
        factor = pivot[j]
        columns.remove(j)
        waiting = [_without(row, pivot, j, last) for row in waiting]
        done = {**{n: _without(row, pivot, j, last) for n, row in done.items()}, j: pivot}
    return done, factor, waiting


def _cost(pivot: Exact) -> tuple[int, int]:
    """A pivot of one term keeps the degrees low."""
    return len(pivot) - pivot.count(0), len(pivot)


def _without(row: Row, pivot: Row, j: int, last: Exact) -> Row:
    rows = zip(row, pivot, strict=True)
    return tuple([divided(crossed(pivot[j], a, row[j], b), last) for a, b in rows])


def _over_t(equations: Equations, pivots: dict[int, Row], below: Exact, free: tuple[int, ...]) -> Flat:
    width = len(free) + 1
    x: list[Row] = []
    for j in range(1, len(equations.numbers) + 1):
        if j in pivots:
            x.append(tuple(scaled(-1, pivots[j][n]) for n in (0, *free)))
        else:
            x.append((NOTHING, *(below if n == j else NOTHING for n in free)))
    tidied = _lowered(shortened((below, *(p for r in x for p in r))))
    return Flat(equations, None, free, tuple(tidied[1 + i * width :][:width] for i in range(len(x))), tidied[0])


def _pinned(equations: Equations, rows: list[Row], pivots: dict[int, Row], t: float) -> list[Flat]:
    solved = {}
    for j, row in pivots.items():
        polynomials = rounded(row)
        if vanishes(polynomials[j], t, VANISHING):
            return _numerically(equations, rows, t)
        below = at(polynomials[j], t)
        solved[j] = [at(p, t) / below for p in polynomials]
    return [_at_t(equations, t, solved)]


def _numerically(equations: Equations, rows: list[Row], t: float) -> list[Flat]:
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
    return [] if any(abs(r[0]) > VANISHING for r in waiting) else [_at_t(equations, t, solved)]


def _at_t(equations: Equations, t: float, solved: dict[int, list[float]]) -> Flat:
    columns = range(1, len(equations.numbers) + 1)
    free = tuple([j for j in columns if j not in solved])
    alone = {j: (0.0, *[float(n == j) for n in free]) for j in free}
    numbers = [alone[j] if j in alone else tuple([0.0 - solved[j][n] for n in (0, *free)]) for j in columns]
    return Flat(equations, t, free, numbers=tuple(numbers))
