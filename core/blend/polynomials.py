"""Polynomials of one number above 0, and all their roots.

The coefficients are whole numbers, so that what cancels leaves nothing; the roots are those of the same polynomial in
floating point. Between the roots of its derivative a polynomial is monotone: its roots are bracketed one by one, from the
derivatives downwards, and none is missed. Above 1 the roots are those of the polynomial of the reciprocal, so that roots
near 0 and near infinity are as exact as any.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce
from itertools import zip_longest
from math import inf, ldexp
from operator import or_

Floats = tuple[float, ...]
"""Coefficients in floating point, that of the constant first."""

BITS = 160  # behind the point, of a coefficient made whole
TOUCHED = 1e-10  # an extreme that misses zero by no more, as a share of the terms, counts as a root
STEPS = 200


class Polynomial:
    """Whole coefficients, that of the constant first, the last of them not 0; without any it is 0."""

    __slots__ = ("coefficients",)

    def __init__(self, coefficients: Iterable[int] = ()) -> None:
        rows = tuple(coefficients)
        while rows and not rows[-1]:
            rows = rows[:-1]
        self.coefficients = rows

    def __len__(self) -> int:
        return len(self.coefficients)

    def __add__(self, other: Polynomial) -> Polynomial:
        pairs = zip_longest(self.coefficients, other.coefficients, fillvalue=0)
        return Polynomial([a + b for a, b in pairs])

    def __sub__(self, other: Polynomial) -> Polynomial:
        if not other:
            return self
        pairs = zip_longest(self.coefficients, other.coefficients, fillvalue=0)
        return Polynomial([a - b for a, b in pairs])

    def __mul__(self, other: Polynomial) -> Polynomial:
        if not self or not other:
            return ZERO
        if len(self) == 1:
            return self.coefficients[0] * other
        made = [0] * (len(self) + len(other) - 1)
        for i, a in enumerate(self.coefficients):
            if a:
                for j, b in enumerate(other.coefficients):
                    made[i + j] += a * b
        return Polynomial(made)

    def __rmul__(self, factor: int) -> Polynomial:
        return Polynomial([factor * c for c in self.coefficients]) if factor else ZERO

    def __floordiv__(self, other: Polynomial) -> Polynomial:
        """The quotient where nothing remains."""
        p, q = self.coefficients, other.coefficients
        if len(q) == 1:
            return self if q[0] == 1 else Polynomial([c // q[0] for c in p])
        rest, made = list(p), [0] * max(len(p) - len(q) + 1, 0)
        for i in range(len(made) - 1, -1, -1):
            made[i] = rest[i + len(q) - 1] // q[-1]
            for j, c in enumerate(q):
                rest[i + j] -= made[i] * c
        return Polynomial(made)

    def shifted(self, powers: int) -> Polynomial:
        """Times the number to so many powers; a negative one takes powers away that are in every term."""
        kept = self.coefficients
        return Polynomial(kept[-powers:] if powers < 0 else (*[0] * powers, *kept))

    def derivative(self) -> Polynomial:
        """dp/dx."""
        return Polynomial([i * c for i, c in enumerate(self.coefficients) if i])

    @property
    def lowest_power(self) -> int:
        """The power of the first term that is not 0."""
        return _lowest(self.coefficients)


def whole(value: float) -> int:
    """value 2^BITS."""
    return int(ldexp(value, BITS))


UNIT = whole(1.0)
ZERO, ONE = Polynomial(), Polynomial([1])


def shortened(polynomials: Iterable[Polynomial]) -> list[Polynomial]:
    """The same without the power of 2 that all coefficients have in common."""
    polynomials = tuple(polynomials)
    together = reduce(or_, [c for p in polynomials for c in p.coefficients], 0)
    shift = (together & -together).bit_length() - 1 if together else 0
    return [Polynomial([c >> shift for c in p.coefficients]) for p in polynomials]


def rounded(polynomials: Iterable[Polynomial]) -> list[Floats]:
    """The same but for one common factor, a power of 2, in floating point."""
    rows = [p.coefficients for p in polynomials]
    scale = 1 << max([c.bit_length() for row in rows for c in row], default=0)
    return [tuple([c / scale for c in row]) for row in rows]


# -- values in floating point -----------------------------------------------------------------------------


def at(p: Floats, x: float) -> float:
    """The value at x, by Horner's rule."""
    value = 0.0
    for c in reversed(p):
        value = value * x + c
    return value


def size_at(p: Floats, x: float) -> float:
    """Sum of the terms' sizes (x >= 0): what the rounding of the value is to be compared with."""
    return at(tuple([abs(c) for c in p]), x)


def vanishes(p: Floats, x: float, share: float) -> bool:
    """Whether the value at x is 0 but for a share of the sizes of its terms."""
    return abs(at(p, x)) <= share * size_at(p, x)


def quotient_at(p: Floats, q: Floats, x: float) -> float:
    """p/q, as the limit at 0 and infinity."""
    if not p:
        return 0.0
    if x == 0.0:
        i, j = _lowest(p), _lowest(q)
        return p[i] / q[j] if i == j else 0.0 if i > j else inf * p[i] * q[j]
    if x == inf:
        i, j = len(p), len(q)
        return p[-1] / q[-1] if i == j else 0.0 if i < j else inf * p[-1] * q[-1]
    if x > 1.0:  # the powers of a great number do not overflow
        below = at(q[::-1], 1.0 / x)
        return at(p[::-1], 1.0 / x) / below * x ** (len(p) - len(q)) if below else inf
    below = at(q, x)
    return at(p, x) / below if below else inf


# -- roots ------------------------------------------------------------------------------------------------


def roots(p: Polynomial, low: float = 0.0, high: float = inf) -> list[float]:
    """All roots in low ... high, 0 <= low < high, ascending and each once; 0 is none. An extreme that misses zero by
    rounding counts as one: the caller, who knows the equations, decides."""
    if not p or _one_sign(p.coefficients):
        return []
    row = rounded([p.shifted(-p.lowest_power)])[0]
    result = _within(row, low, min(high, 1.0)) if low < 1.0 else []
    if high > 1.0:
        reciprocals = _within(row[::-1], 0.0 if high == inf else 1.0 / high, 1.0 / max(low, 1.0))
        result += [1.0 / x for x in reversed(reciprocals) if not result or 1.0 / x > result[-1]]
    return result


def _lowest(p: Sequence[float]) -> int:
    return next((i for i, c in enumerate(p) if c), 0)


def _one_sign(p: Sequence[float]) -> bool:
    """No change of sign in the coefficients: no root above 0 (Descartes)."""
    return min(p) >= 0 or max(p) <= 0


def _within(p: Floats, a: float, b: float) -> list[float]:
    """Roots of a polynomial in a ... b, 0 <= a < b <= 1."""
    p = p[_lowest(p) :]
    if len(p) < 2 or _one_sign(p):
        return []
    if len(p) == 2:
        x = -p[0] / p[1]
        return [x] if a <= x <= b else []
    slope = tuple([i * c for i, c in enumerate(p) if i])
    nodes = [a, *(x for x in _within(slope, a, b) if a < x < b), b]
    values = [at(p, x) for x in nodes]
    result: set[float] = set()
    for i, (x, value) in enumerate(zip(nodes, values, strict=True)):
        if x > 0.0 and vanishes(p, x, TOUCHED):
            result.add(x)
        if i + 1 < len(nodes) and value * values[i + 1] < 0.0:
            result.add(_bracketed(p, slope, x, nodes[i + 1], value))
    return sorted(result)


def _bracketed(p: Floats, slope_of: Floats, a: float, b: float, fa: float) -> float:
    """The one root between a and b: Newton's method, halved where it leaves the bracket or is slow."""
    x, last = 0.5 * (a + b), b - a
    for _ in range(STEPS):
        value = at(p, x)
        if value == 0.0:
            return x
        if (value < 0.0) == (fa < 0.0):
            a = x
        else:
            b = x
        slope = at(slope_of, x)
        step = value / slope if slope else inf
        if a < x - step < b and abs(step) <= 0.5 * abs(last):
            last, new = step, x - step
        else:
            last, new = 0.5 * (b - a), 0.5 * (a + b)
        if new == x or b - a <= 2.0**-52 * b:
            return new
        x = new
    return x
