"""The least acceleration that linear wishes allow, exactly.

With t given every height h and the speed S are linear in the other numbers, and the largest S²/h has no other minimum
than the least: it lies where as many curves have the same acceleration, or constant velocities end, as numbers are free;
or, with one of them fewer, where S²/h of these curves is stationary, which is a linear equation too. Both leave curves
along t, on which the acceleration is a quotient of polynomials.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import combinations, pairwise

from core.blend.arcs import kink, spread
from core.blend.curve import Curve
from core.blend.equations import Row
from core.blend.family import Bend, Family
from core.blend.flats import Flat, flats
from core.blend.metering import Meter
from core.blend.polynomials import minus, plus, scaled, times

Place = tuple[float, tuple[float, ...]]


def least_acceleration(meter: Meter, rows: Sequence[Row], floors: Sequence[Row] = ()) -> tuple[float, Place] | None:
    """The least of the largest accelerations and t, x there; None where nothing is feasible. The rows must be 0, the
    floors not below 0."""
    best: tuple[float, Place] | None = None
    for free in _curves(meter, list(rows), [*(meter.equations.exact(n) for n in meter.family.constant), *floors]):
        curve = replace(free, limits=tuple(times(free.over_row(row), free.under) for row in floors))
        quotients = curve.quotients("acceleration")
        for stretch in curve.stretches:
            least = min(curve.extremes(quotients, stretch), key=lambda e: e.value)
            if best is None or least.value < best[0]:
                best = least.value, curve.place(least.p)
    return best


def _curves(meter: Meter, rows: list[Row], ends: list[Row]) -> Iterator[Curve]:
    free = meter.family.freedom - len(rows)
    for _, active in _active(meter, free - 1, ends):
        yield from (Curve.of(meter.family, f) for f in flats(meter.equations, [*rows, *active]) if f.freedom == 1)
    for bend, active in _active(meter, free - 2, ends):
        for flat in flats(meter.equations, [*rows, *active]):
            if flat.freedom == 2 and flat.t is None:
                yield from _stationary(meter.family, flat, bend)


def _active(meter: Meter, count: int, ends: list[Row]) -> Iterable[tuple[Bend, list[Row]]]:
    """Sets of so many equations: curves that have the same acceleration, one of which is named, and constant velocities
    that end."""
    bends = meter.family.bends
    for several in range(1, min(len(bends), count + 1) + 1):
        for equal in combinations(bends, several):
            kinks = [kink(meter.equations, a, b) for a, b in pairwise(equal)]
            yield from ((equal[0], [*kinks, *rows]) for rows in combinations(ends, count - several + 1))


def _stationary(family: Family, flat: Flat, bend: Bend) -> Iterator[Curve]:
    """S²/h stationary along y: y S1 h1 = S0 h1 - 2 S1 h0."""
    (s0, s1), (h0, h1) = spread(flat, bend.speed), spread(flat, bend.height)
    below = times(s1, h1)
    if below:
        y = minus(times(s0, h1), scaled(2, times(s1, h0)))
        x = tuple(plus(times(a, below), times(b, y)) for a, b in flat.x)
        yield Curve(family, flat.equations, None, x, times(flat.below, below), flat.equations.top)
