"""Polynomials in one positive variable, with integer coefficients, and all their roots.

Integer coefficients cancel exactly; the roots are those of the same polynomial in floating point. Between the roots of
its derivative a polynomial is monotone: its roots are bracketed one by one, starting from the highest derivative, and
none is missed. Roots above 1 are computed from the polynomial of the reciprocal, so that roots near 0 and near
infinity are equally exact.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce
from itertools import zip_longest
from math import inf, ldexp
from operator import or_

Floats = tuple[float, ...]
"""Coefficients in floating point, lowest power first."""

BITS = 160  # fractional bits of a number converted to an integer
DOUBLE_ROOT = 1e-10  # an extreme closer to zero, relative to the terms, is a double root
STEPS = 200


class Polynomial:
    """Polynomial with integer coefficients, lowest power first; the last one is not 0, and 0 has none."""

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
        product = [0] * (len(self) + len(other) - 1)
        for i, a in enumerate(self.coefficients):
            if a:
                for j, b in enumerate(other.coefficients):
                    product[i + j] += a * b
        return Polynomial(product)

    def __rmul__(self, factor: int) -> Polynomial:
        return Polynomial([factor * c for c in self.coefficients]) if factor else ZERO

    def __floordiv__(self, other: Polynomial) -> Polynomial:
        """Quotient of a division without remainder."""
        p, q = self.coefficients, other.coefficients
        if len(q) == 1:
            return self if q[0] == 1 else Polynomial([c // q[0] for c in p])
        remainder, quotient = list(p), [0] * max(len(p) - len(q) + 1, 0)
        for i in range(len(quotient) - 1, -1, -1):
            quotient[i] = remainder[i + len(q) - 1] // q[-1]
            for j, c in enumerate(q):
                remainder[i + j] -= quotient[i] * c
        return Polynomial(quotient)

    def times_power(self, powers: int) -> Polynomial:
        """Product with the variable to a power; a negative power must divide every term."""
        coefficients = self.coefficients
        return Polynomial(coefficients[-powers:] if powers < 0 else (*[0] * powers, *coefficients))

    def derivative(self) -> Polynomial:
        """Derivative dp/dx."""
        return Polynomial([i * c for i, c in enumerate(self.coefficients) if i])

    @property
    def lowest_power(self) -> int:
        """Power of the first term that is not 0."""
        return _lowest(self.coefficients)


def to_integer(value: float) -> int:
    """Integer part of value·2^BITS."""
    return int(ldexp(value, BITS))


UNIT = to_integer(1.0)
ZERO, ONE = Polynomial(), Polynomial([1])


def without_common_factor(polynomials: Iterable[Polynomial]) -> list[Polynomial]:
    """Polynomials divided by the power of 2 that all their coefficients have in common."""
    polynomials = tuple(polynomials)
    all_bits = reduce(or_, [c for p in polynomials for c in p.coefficients], 0)
    shift = (all_bits & -all_bits).bit_length() - 1 if all_bits else 0
    return [Polynomial([c >> shift for c in p.coefficients]) for p in polynomials]


def to_floats(polynomials: Iterable[Polynomial]) -> list[Floats]:
    """Coefficients in floating point, divided by one common power of 2."""
    rows = [p.coefficients for p in polynomials]
    scale = 1 << max([c.bit_length() for row in rows for c in row], default=0)
    return [tuple([c / scale for c in row]) for row in rows]


# -- values in floating point -----------------------------------------------------------------------------


def evaluate(p: Floats, x: float) -> float:
    """Value at x by Horner's rule."""
    value = 0.0
    for c in reversed(p):
        value = value * x + c
    return value


def size_at(p: Floats, x: float) -> float:
    """Sum of the magnitudes of the terms at x >= 0, the reference for rounding."""
    return evaluate(tuple([abs(c) for c in p]), x)


def is_negligible(p: Floats, x: float, share: float) -> bool:
    """Whether the value at x is within a fraction of the magnitudes of its terms."""
    return abs(evaluate(p, x)) <= share * size_at(p, x)


def quotient_at(p: Floats, q: Floats, x: float) -> float:
    """Value of p/q at x, at 0 and infinity its limit."""
    if not p:
        return 0.0
    if x == 0.0:
        i, j = _lowest(p), _lowest(q)
        return p[i] / q[j] if i == j else 0.0 if i > j else inf * p[i] * q[j]
    if x == inf:
        i, j = len(p), len(q)
        return p[-1] / q[-1] if i == j else 0.0 if i < j else inf * p[-1] * q[-1]
    if x > 1.0:  # in the reciprocal, whose powers do not overflow
        below = evaluate(q[::-1], 1.0 / x)
        return evaluate(p[::-1], 1.0 / x) / below * x ** (len(p) - len(q)) if below else inf
    below = evaluate(q, x)
    return evaluate(p, x) / below if below else inf


# -- roots ------------------------------------------------------------------------------------------------


def roots(p: Polynomial, low: float = 0.0, high: float = inf) -> list[float]:
    """All roots with low <= x <= high and x > 0, 0 <= low < high, in ascending order, each once.

    An extreme that misses zero by rounding counts as a root; the caller checks it with the original equations.
    """
    if not p or _one_sign(p.coefficients):
        return []
    row = to_floats([p.times_power(-p.lowest_power)])[0]
    result = _within(row, low, min(high, 1.0)) if low < 1.0 else []
    if high > 1.0:
        reciprocals = _within(row[::-1], 0.0 if high == inf else 1.0 / high, 1.0 / max(low, 1.0))
        result += [1.0 / x for x in reversed(reciprocals) if not result or 1.0 / x > result[-1]]
    return result


def _lowest(p: Sequence[float]) -> int:
    return next((i for i, c in enumerate(p) if c), 0)


def _one_sign(p: Sequence[float]) -> bool:
    """Whether the coefficients have no change of sign: no positive root (Descartes)."""
    return min(p) >= 0 or max(p) <= 0


def _within(p: Floats, a: float, b: float) -> list[float]:
    """Roots in a ... b, 0 <= a < b <= 1."""
    p = p[_lowest(p) :]
    if len(p) < 2 or _one_sign(p):
        return []
    if len(p) == 2:
        x = -p[0] / p[1]
        return [x] if a <= x <= b else []
    slope = tuple([i * c for i, c in enumerate(p) if i])
    nodes = [a, *(x for x in _within(slope, a, b) if a < x < b), b]
    values = [evaluate(p, x) for x in nodes]
    result: set[float] = set()
    for i, (x, value) in enumerate(zip(nodes, values, strict=True)):
        if x > 0.0 and is_negligible(p, x, DOUBLE_ROOT):
            result.add(x)
        if i + 1 < len(nodes) and value * values[i + 1] < 0.0:
            result.add(_bracketed(p, slope, x, nodes[i + 1], value))
    return sorted(result)


def _bracketed(p: Floats, derivative: Floats, a: float, b: float, fa: float) -> float:
    """The root between a and b by Newton's method; bisection where a step leaves the bracket or is slow."""
    x, last = 0.5 * (a + b), b - a
    for _ in range(STEPS):
        value = evaluate(p, x)
        if value == 0.0:
            return x
        if (value < 0.0) == (fa < 0.0):
            a = x
        else:
            b = x
        slope = evaluate(derivative, x)
        step = value / slope if slope else inf
        if a < x - step < b and abs(step) <= 0.5 * abs(last):
            last, new = step, x - step
        else:
            last, new = 0.5 * (b - a), 0.5 * (a + b)
        if new == x or b - a <= 2.0**-52 * b:
            return new
        x = new
    return x
