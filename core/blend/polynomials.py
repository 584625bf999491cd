"""Polynomials of one number above 0, and all their roots.

A polynomial is a tuple of coefficients, that of the constant first. Those that equations are made into have whole
numbers, so that what cancels leaves nothing; the roots are those of the same with floating-point ones. Between the roots
of its derivative a polynomial is monotone: so its roots are bracketed one by one, from the derivatives downwards, and
none is missed. Above 1 the polynomial of the reciprocal is looked at: roots near 0 and near infinity are as exact as any.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce
from itertools import zip_longest
from math import inf, ldexp, sqrt
from operator import or_

Exact = tuple[int, ...]
Poly = tuple[float, ...]

NOTHING: Exact = ()
UNIT: Exact = (1,)
MOST_BITS = 1000  # a longer number is none in floating point
BITS = 160  # behind the point, of a coefficient made whole
TOUCHED = 1e-10  # an extreme that misses zero by no more, as a share of the terms, counts as a root
STEPS = 200


# -- exactly ----------------------------------------------------------------------------------------------


def whole(value: float) -> int:
    """value 2^BITS."""
    return int(ldexp(value, BITS))


ONE = whole(1.0)


def trimmed(coefficients: Iterable[int]) -> Exact:
    """Without zeros at the end."""
    p = tuple(coefficients)
    while p and not p[-1]:
        p = p[:-1]
    return p


def plus(a: Exact, b: Exact) -> Exact:
    return trimmed([x + y for x, y in zip_longest(a, b, fillvalue=0)])


def minus(a: Exact, b: Exact) -> Exact:
    if not b:
        return a
    return trimmed([x - y for x, y in zip_longest(a, b, fillvalue=0)])


def times(a: Exact, b: Exact) -> Exact:
    if not a or not b:
        return NOTHING
    if len(a) == 1:
        return scaled(a[0], b)
    made = [0] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        if x:
            for j, y in enumerate(b):
                if y:
                    made[i + j] += x * y
    return tuple(made)


def scaled(factor: int, p: Exact) -> Exact:
    return tuple([factor * c for c in p]) if factor else NOTHING


def weighed(p: int, a: Exact, q: int, b: Exact) -> Exact:
    """p a - q b of numbers p and q."""
    if not b:
        return scaled(p, a)
    return trimmed([p * x - q * y for x, y in zip_longest(a, b, fillvalue=0)])


def crossed(a: Exact, b: Exact, c: Exact, d: Exact) -> Exact:
    """a b - c d."""
    return minus(times(a, b), times(c, d))


def divided(p: Exact, q: Exact) -> Exact:
    """p/q where that comes out even."""
    if q == UNIT:
        return p
    if len(q) == 1:
        return tuple(c // q[0] for c in p)
    rest, made = list(p), [0] * (len(p) - len(q) + 1)
    for i in range(len(p) - len(q), -1, -1):
        made[i] = rest[i + len(q) - 1] // q[-1]
        for j, c in enumerate(q):
            rest[i + j] -= made[i] * c
    return trimmed(made)


def derivative(p: Exact) -> Exact:
    return tuple(i * c for i, c in enumerate(p) if i)


def lowest_power(p: Sequence[float]) -> int:
    for i, c in enumerate(p):
        if c:
            return i
    return 0


def shortened(polynomials: Iterable[Exact]) -> tuple[Exact, ...]:
    """Without a common power of 2."""
    polynomials = tuple(polynomials)
    together = reduce(or_, [c for p in polynomials for c in p], 0)
    shift = (together & -together).bit_length() - 1 if together else 0
    return tuple([tuple([c >> shift for c in p]) for p in polynomials])


def rounded(polynomials: Sequence[Exact]) -> list[Poly]:
    """The same but for one common factor, a power of 2, in floating point."""
    bits = max([c.bit_length() for p in polynomials for c in p], default=0)
    if bits >= MOST_BITS:
        shift = 1 << bits
        return [tuple(c / shift for c in p) for p in polynomials]
    scale = ldexp(1.0, -bits)
    return [tuple([c * scale for c in p]) for p in polynomials]


# -- in floating point ------------------------------------------------------------------------------------


def at(p: Poly, x: float) -> float:
    value = 0.0
    for c in reversed(p):
        value = value * x + c
    return value


def size_at(p: Poly, x: float) -> float:
    """Sum of the terms' sizes: what the rounding of the value is to be compared with."""
    value = 0.0
    for c in reversed(p):
        value = value * x + abs(c)
    return value


def vanishes(p: Poly, x: float, share: float) -> bool:
    return abs(at(p, x)) <= share * size_at(p, x)


def quotient_at(p: Poly, q: Poly, x: float) -> float:
    """p/q, as the limit at 0 and infinity."""
    if not p:
        return 0.0
    if x == 0.0:
        i, j = lowest_power(p), lowest_power(q)
        return p[i] / q[j] if i == j else 0.0 if i > j else inf * p[i] * q[j]
    if x == inf:
        i, j = len(p), len(q)
        return p[-1] / q[-1] if i == j else 0.0 if i < j else inf * p[-1] * q[-1]
    if x > 1.0:  # the powers of a great number do not overflow
        shift = len(p) - len(q)
        below = at(q[::-1], 1.0 / x)
        return at(p[::-1], 1.0 / x) / below * x**shift if below else inf
    below = at(q, x)
    return at(p, x) / below if below else inf


def roots(exact: Exact, low: float = 0.0, high: float = inf) -> list[float]:
    """All roots in low ... high, 0 <= low < high, ascending and each once; 0 is none. An extreme that misses zero by
    rounding counts as one: the caller, who knows the equations, decides."""
    if not exact or _one_sign(exact):
        return []
    p = rounded([exact[lowest_power(exact) :]])[0]
    found = _within(p, low, min(high, 1.0)) if low < 1.0 else []
    if high > 1.0:
        mirrored = _within(p[::-1], 0.0 if high == inf else 1.0 / high, 1.0 / max(low, 1.0))
        found += [1.0 / x for x in reversed(mirrored) if not found or 1.0 / x > found[-1]]
    return found


def _one_sign(p: Sequence[float]) -> bool:
    """No change of sign in the coefficients: no root above 0 (Descartes)."""
    return min(p) >= 0 or max(p) <= 0


def _within(p: Poly, a: float, b: float) -> list[float]:
    """Roots of a polynomial in a ... b, 0 <= a < b <= 1."""
    p = p[lowest_power(p) :]
    if len(p) < 2 or _one_sign(p):
        return []
    if len(p) == 2:
        x = -p[0] / p[1]
        return [x] if a <= x <= b else []
    if len(p) == 3:
        return [x for x in _of_quadratic(*p) if a <= x <= b]
    slope = _slope(p)
    nodes = [a, *(x for x in _within(slope, a, b) if a < x < b), b]
    values = [at(p, x) for x in nodes]
    found: set[float] = set()
    for i, (x, value) in enumerate(zip(nodes, values, strict=True)):
        if x > 0.0 and abs(value) <= TOUCHED * size_at(p, x):
            found.add(x)
        if i + 1 < len(nodes) and value * values[i + 1] < 0.0:
            found.add(_bracketed(p, slope, x, nodes[i + 1], value))
    return sorted(found)


def _slope(p: Poly) -> Poly:
    return tuple(i * c for i, c in enumerate(p) if i)


def _of_quadratic(c: float, b: float, a: float) -> list[float]:
    """a x² + b x + c = 0: the root that is greater in size, the other from their product."""
    square = b * b - 4.0 * a * c
    least = TOUCHED * b * b
    if square < -least or a == 0.0:
        return [] if a else [-c / b]
    q = -0.5 * (b + (sqrt(max(square, 0.0)) if b >= 0.0 else -sqrt(max(square, 0.0))))
    found = {q / a, *([c / q] if q else []), *([-0.5 * b / a] if square <= least else [])}
    return sorted(found)


def _bracketed(p: Poly, slope_of: Poly, a: float, b: float, fa: float) -> float:
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
