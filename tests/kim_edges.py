"""Tongue edges of the flexible camshaft of Kim1990 at fifty digits, by power series.

Everything is a power series in time between two joins of the motion, from the formulas of Kim's cam alone: X = (1 - cos
2θ)/2 on half a turn, rest on the other half. No formula of ``core`` stands here.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from references import MP

Row = list[Any]

Q, SAFETY = MP.mpf(1) / 20, MP.mpf(3) / 2
ORDER = 64  # of a power series
STEPS = 18  # of a half turn: a series then gains a digit and more with every term


# -- power series as plain rows of numbers ----------------------------------------------------------------


def _times(a: Row, b: Row) -> Row:
    return [MP.fdot(a[: k + 1], b[k::-1]) for k in range(len(a))]


def _wave(number: int, theta: Any, step: Any, order: int = ORDER) -> tuple[Row, Row]:
    """sin and cos of number·(θ + 2π step r) in powers of r."""
    s, c = MP.sin(number * theta), MP.cos(number * theta)
    w, power = number * 2 * MP.pi * step, MP.one
    sines, cosines = [], []
    for k in range(order):
        sines.append(power * (s, c, -s, -c)[k % 4])
        cosines.append(power * (c, -s, -c, s)[k % 4])
        power *= w / (k + 1)
    return sines, cosines


# -- the linear equation ----------------------------------------------------------------------------------


@cache
def _coefficients(theta: Any, step: Any, q: Any, order: int) -> tuple[Row, Row, Row, Row, Row]:
    """D², D, C, D ψ and C² in powers of r; d = sin² 2θ, C = sin 4θ, ψ = 2a (cos 2θ - cos 4θ)."""
    (_, c2), (s4, c4) = _wave(2, theta, step, order), _wave(4, theta, step, order)
    d = [-q * c / 2 for c in c4]
    d[0] += 1 + q / 2
    psi = [2 * SAFETY * (a - b) for a, b in zip(c2, c4, strict=True)]
    return _times(d, d), d, s4, _times(d, psi), _times(s4, s4)


def _moved(z: tuple[Any, Any], theta: Any, step: Any, eta: Any, damping: Any, q: Any, order: int) -> tuple[Any, Any]:
    """(ζ, ζ') a step on: D² ζ'' + 4πζ_d η D ζ' + 4π² (η² D + Q D ψ + Q² C² - 2 ζ_d η Q C) ζ = 0, ' by y = θ/2π."""
    square, d, c, d_psi, c_square = _coefficients(theta, step, q, order)
    four = 4 * MP.pi * MP.pi
    drag = [4 * MP.pi * damping * eta * v for v in d]
    pull = [
        four * (eta * eta * a + q * b + q * q * e - 2 * damping * eta * q * f)
        for a, b, e, f in zip(d, d_psi, c_square, c, strict=True)
    ]
    rows = [z[0], z[1] * step]  # in powers of r
    first: Row = [rows[1]]  # of dζ/dr, and of d²ζ/dr²
    second: Row = []
    for n in range(order - 2):
        known = step * MP.fdot(drag[: n + 1], first[n::-1]) + step * step * MP.fdot(pull[: n + 1], rows[n::-1])
        if n:
            known += MP.fdot(square[1 : n + 1], second[n - 1 :: -1])
        second.append(-known / square[0])
        rows.append(second[n] / ((n + 1) * (n + 2)))
        first.append((n + 2) * rows[n + 2])
    return MP.fsum(rows), MP.fsum(first) / step


def _rest(z: tuple[Any, Any], part: Any, eta: Any, damping: Any) -> tuple[Any, Any]:
    """ζ'' + 4πζ_d η ζ' + 4π²η² ζ = 0 over a part of a turn."""
    decay, wave = 2 * MP.pi * damping * eta, 2 * MP.pi * eta * MP.sqrt(1 - damping * damping)
    c, s, e = MP.cos(wave * part), MP.sin(wave * part), MP.exp(-decay * part)
    a, b = z[0], (z[1] + decay * z[0]) / wave
    value = e * (a * c + b * s)
    return value, -decay * value + e * wave * (b * c - a * s)


def _gone(
    z: tuple[Any, Any], begin: int, end: int, eta: Any, damping: Any, q: Any = Q, order: int = ORDER
) -> tuple[Any, Any]:
    """From the begin-th of ``STEPS`` parts of the rise and fall to the end-th."""
    for i in range(begin, end):
        z = _moved(z, MP.pi * i / STEPS, MP.one / (2 * STEPS), eta, damping, q, order)
    return z


def _half_way(eta: Any, q: Any, order: int) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """The even and the odd solution about the top of the lift, at the middle of the dwell.

    The cam is the same both ways from there, and so every edge of a tongue is a simple zero of one of these four numbers
    (Magnus and Winkler, Hill's Equation, theorem 1.1).
    """
    half = [_gone(z, STEPS // 2, STEPS, eta, MP.zero, q, order) for z in ((1, 0), (0, 1))]
    told = [_rest(z, MP.mpf(1) / 4, eta, MP.zero) for z in half]
    return told[0], told[1]


def edge(number: int, near: Any, q: Any = Q, order: int = ORDER) -> Any:
    """An edge η of a tongue, by secants from a value near it that tells which of the zeros is meant; ``order`` 30 is good
    for twenty digits."""

    def numbers(eta: Any) -> list[Any]:
        even, odd = _half_way(eta, q, order)
        return [even[1], odd[0]] if number % 2 == 0 else [even[0], odd[1]]

    x0, x1 = MP.convert(near), MP.convert(near) * (1 + MP.mpf(10) ** -12)
    f0, f1 = numbers(x0), numbers(x1)
    # one step of each: the shorter belongs to the zero that is near
    lengths = [abs(a * (x1 - x0) / (b - a)) for a, b in zip(f0, f1, strict=True)]
    which = lengths.index(min(lengths))
    a, b = f0[which], f1[which]
    while abs(x1 - x0) > MP.mpf(10) ** -24 and b != a:
        x0, x1 = x1, x1 - b * (x1 - x0) / (b - a)
        a, b = b, numbers(x1)[which]
    return x1 - b * (x1 - x0) / (b - a) if b != a else x1
