"""Points that meet linear wishes and an acceleration, along t: with t given, the height of the curve that has it is a
quadratic equation."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, pairwise
from math import inf, pi

import numpy as np

from core.blend.curve import SAME, Curve
from core.blend.equations import Equations, Row
from core.blend.family import Bend, Family
from core.blend.flats import Flat, flats
from core.blend.metering import Meter
from core.blend.polynomials import (
    ONE,
    Exact,
    Poly,
    crossed,
    plus,
    roots,
    rounded,
    scaled,
    times,
    trimmed,
    weighed,
    whole,
)
from core.blend.wishes import Wish

_SAME_BEND = 1e-9  # another curve may have the same acceleration
_FASTEST = 4.0  # no curve's span is more than twice what its height has at its speed


@dataclass(frozen=True)
class Arc:
    """One branch between two values of t; z runs from 0 to 1."""

    flat: Flat
    low: float
    high: float
    quadratic: tuple[Poly, Poly, Poly]
    branch: int

    @cached_property
    def _polynomials(self) -> list[Poly]:
        return rounded([p for row in self.flat.x for p in row] + [self.flat.below])

    def places(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """t (n,) and x (numbers, n); smooth even where the branches meet."""
        a, b = (1.0 if v == inf else v / (1.0 + v) for v in (self.low, self.high))
        share = a + (b - a) * np.sin(0.5 * pi * z) ** 2
        with np.errstate(all="ignore"):
            t = share / (1.0 - share)
            y = _root(self.quadratic, self.branch, t)
            rows = [np.polyval(p[::-1], t) if p else np.zeros_like(t) for p in self._polynomials]
            x = [(rows[2 * i] + rows[2 * i + 1] * y) / rows[-1] for i in range(len(self.flat.x))]
        return t, np.array(x).reshape(len(x), t.size)


def _root(quadratic: tuple[Poly, Poly, Poly], branch: int, t: np.ndarray) -> np.ndarray:
    """y of a y² + b y + c = 0 on one of its branches."""
    a, b, c = (np.polyval(p[::-1], t) if p else np.zeros_like(t) for p in quadratic)
    if not quadratic[0]:
        return -c / b
    square = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
    q = -0.5 * (b + np.where(b >= 0.0, square, -square))
    return np.where((b >= 0.0) == (branch < 0), q / a, c / q)


def arcs(family: Family, meter: Meter, rows: Sequence[Row], acceleration: float) -> tuple[list[Arc], list[Curve]]:
    """All feasible points that meet equations, which leave two numbers free, and have that largest acceleration: along
    t, or, where the equations pin t, curves."""
    found: list[Arc] = []
    lines: list[Curve] = []
    for flat in flats(meter.equations, rows):
        if flat.freedom != 2:
            continue
        for bend in family.bends:
            if flat.t is None:
                found += _along_t(family, meter, flat, rows, bend, acceleration)
            else:
                lines += _at_one_t(family, flat, flat.t, rows, bend, acceleration)
    return found, lines


def _along_t(
    family: Family, meter: Meter, flat: Flat, rows: Sequence[Row], bend: Bend, acceleration: float
) -> Iterator[Arc]:
    quadratic = _quadratic(flat, bend, acceleration)
    a, b, c = quadratic
    cuts = {*roots(crossed(b, b, scaled(4, a), c)), *roots(a), *([] if a else roots(b))}
    cuts |= set(_cuts(family, meter, rows, acceleration))
    top = meter.equations.top
    shown = rounded(quadratic)
    for low, high in pairwise([0.0, *sorted(t for t in cuts if 0.0 < t < top), top]):
        for branch in (1, -1) if a else (1,):
            arc = Arc(flat, low, high, (shown[0], shown[1], shown[2]), branch)
            if _is_met(family, meter, arc, bend, acceleration):
                yield arc


def _is_met(family: Family, meter: Meter, arc: Arc, bend: Bend, acceleration: float) -> bool:
    """Whether the middle of an arc is feasible and no other curve has more."""
    t, x = arc.places(np.array([0.5]))
    if not (np.isfinite(x).all() and bool(meter.feasible(t, x)[0])):
        return False
    bends = meter.bends(meter.equations.values(t, x))[:, 0]
    here = bends[family.bends.index(bend)]
    return abs(here / acceleration - 1.0) <= 1e-6 and bool(bends.max() <= acceleration * (1.0 + _SAME_BEND))


def spread(flat: Flat, name: str) -> tuple[Exact, Exact]:
    """A form on a flat whose t is free, by 1 and y."""
    row = flat.equations.exact(name)
    made = [times(row[0], flat.below), ()]
    for p, numerators in zip(row[1:], flat.x, strict=True):
        made = [plus(m, times(p, n)) for m, n in zip(made, numerators, strict=True)]
    return made[0], made[1]


def _quadratic(flat: Flat, bend: Bend, acceleration: float) -> tuple[Exact, Exact, Exact]:
    """factor S² - acceleration h = 0 by y², y and 1."""
    (s0, s1), (h0, h1), (under, _) = (spread(flat, n) for n in (bend.speed, bend.height, ""))
    factor, value = whole(bend.factor), whole(acceleration)
    return (
        scaled(factor, times(s1, s1)),
        weighed(2 * factor, times(s0, s1), value, times(h1, under)),
        weighed(factor, times(s0, s0), value, times(h0, under)),
    )


def _cuts(family: Family, meter: Meter, rows: Sequence[Row], acceleration: float) -> Iterable[float]:
    """Values of t where another curve reaches the acceleration, or a constant velocity ends."""
    wish = Wish("acceleration", acceleration)
    kinks = [kink(meter.equations, one, two) for one, two in combinations(family.bends, 2)]
    for row in (*kinks, *(meter.equations.exact(n) for n in family.constant)):
        for flat in flats(meter.equations, [*rows, row]):
            if flat.freedom == 1:
                curve = Curve.of(family, flat)
                yield from ([flat.t] if flat.t is not None else curve.where(wish))


def kink(equations: Equations, one: Bend, two: Bend) -> Row:
    """Where two curves have the same acceleration: c S²/h with R = t W."""
    a, b = equations.exact(one.height), equations.exact(two.height)
    if (one.speed, two.speed) == ("W", "R"):
        a = tuple((0, 0, *p) if p else p for p in a)
    rows = zip(a, b, strict=True)
    return tuple([weighed(whole(two.factor), p, whole(one.factor), q) for p, q in rows])


def _at_one_t(
    family: Family, flat: Flat, t: float, rows: Sequence[Row], bend: Bend, acceleration: float
) -> Iterator[Curve]:
    """Over the plane at one t: the height is a quadratic function of the speed S, which is the curve's number; where it
    is linear in S, or S the same everywhere, lines."""
    equations, factor = flat.equations, bend.factor / acceleration
    numbers = np.array(flat.numbers)
    planes = equations.columns(t) @ np.vstack([[1.0, 0.0, 0.0], numbers])
    s, h = planes[equations.place_of(bend.speed)], planes[equations.place_of(bend.height)]
    spin = s[1] * h[2] - s[2] * h[1]
    if abs(spin) > SAME * np.abs(planes[:, 1:]).max() ** 2:
        y1 = np.array([s[2] * h[0] - s[0] * h[2], h[2], -s[2] * factor]) / spin
        y2 = np.array([s[0] * h[1] - s[1] * h[0], -h[1], s[1] * factor]) / spin
        x = numbers[:, :1] * [1.0, 0.0, 0.0] + numbers[:, 1:2] * y1 + numbers[:, 2:] * y2
        exact = tuple(trimmed(whole(c) for c in row) for row in x)
        top = _FASTEST * (1.0 + 1.0 / t) * (1.0 + t) * (1.0 + max(equations.tops))
        yield _limited(Curve(family, equations, t, exact, (ONE,), top), bend, acceleration)
        return
    name, values = bend.height, [factor * s[0] ** 2]
    if np.abs(s[1:]).max() > SAME:
        slope = (h[1:] @ s[1:]) / (s[1:] @ s[1:])
        quadratic = tuple(whole(c) for c in (slope * s[0] - h[0], -slope, factor))
        name, values = bend.speed, roots(quadratic)
    for value in values:
        pinned = zip(equations.exact(name), equations.exact(""), strict=True)
        row = tuple([weighed(ONE, a, whole(float(value)), b) for a, b in pinned])
        for line in flats(equations, [*rows, row]):
            if line.freedom == 1:
                yield _limited(Curve.of(family, line), bend, acceleration)


def _limited(curve: Curve, bend: Bend, acceleration: float) -> Curve:
    """With no other curve's acceleration above the one that is asked for."""
    limits = []
    for other in curve.family.bends:
        if other != bend:
            above, below = curve.bend(other)
            limits.append(weighed(whole(acceleration), below, ONE, above))
    return replace(curve, limits=tuple(limits))
