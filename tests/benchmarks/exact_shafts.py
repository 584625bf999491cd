"""Fifty-digit values of the flexible camshaft of Kim1990: monodromy matrices, tongue edges, wind-up; by power series.

Everything is a power series in time between two joins of the motion, from the formulas of Kim's cam alone: X = (1 - cos
2θ)/2 on half a turn, rest on the other half. No formula of ``core`` stands here.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from references import MP

Row = list[Any]

Q, SAFETY = MP.mpf(1) / 20, MP.mpf(3) / 2
DAMPING = 0.02  # of the monodromy matrices and the wind-up
ORDER = 64  # of a power series
STEPS = 18  # of a half turn: a series then gains a digit and more with every term
ETAS = (0.31373, 0.73131, 1.0479, 1.31057, 2.0137, 2.71828, 3.30119, 4.12345, 5.49517)
SPEED = 1.3  # η of the wind-up
SPEEDS = tuple(0.5371 + 0.1733 * k for k in range(16))  # of many at once
TIMES = (0.13731, 0.41379, 0.77317, 1.19319, 1.83173, 2.44197, 3.07391, 3.91317, 4.62193, 4.97131)
TURNS = 5
PRINTED = Path(__file__).parents[1] / "validation" / "kim1990_tongues.json"


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


def matrix(eta: Any, damping: Any = DAMPING) -> list[Any]:
    """The entries of the monodromy matrix, row by row."""
    eta, damping = MP.convert(eta), MP.convert(damping)
    columns = [_rest(_gone(z, 0, STEPS, eta, damping), MP.mpf(1) / 2, eta, damping) for z in ((1, 0), (0, 1))]
    return [columns[0][0], columns[1][0], columns[0][1], columns[1][1]]


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


def edges() -> list[Any]:
    """Both edges of the tongues 1 ... 11 of (21) at Q = 0.05, from where they are printed."""
    rows = json.loads(PRINTED.read_text(encoding="utf-8"))["exact_21"]
    return [edge(row["n"], row[side]) for row in rows for side in ("lo", "hi")]


# -- the wind-up ------------------------------------------------------------------------------------------


def _series(y: Any, beta: Any, momentum: Any, step: Any, moves: bool, eta: Any) -> tuple[Row, Row]:
    """β and Π = D (1 - β') in powers of r over a step: β' = 1 - Π/D, Π' = 2πQ (C (1-β')² - U) + 4π²η²β + 4πζηβ'."""
    eta, pi = MP.convert(eta), MP.pi
    b, p, speed = [beta], [momentum], []
    theta: Row = [2 * pi * (y - beta)]  # θ = 2π (y - β)
    s: Row = [MP.sin(2 * theta[0])]
    c: Row = [MP.cos(2 * theta[0])]
    d, square, pull = [], [], []  # D, (1 - β')² and C = sin 4θ
    for k in range(ORDER):
        if moves:
            both = MP.fdot(s, c[::-1])  # sin 2θ cos 2θ
            d.append(Q * MP.fdot(s, s[::-1]) + (1 if k == 0 else 0))
            speed.append((p[k] - MP.fdot(d[1:], speed[::-1])) / d[0])
            square.append(MP.fdot(speed, speed[::-1]))
            pull.append(2 * both)
            force = 2 * pi * Q * (MP.fdot(pull, square[::-1]) - SAFETY * (s[k] - both))
        else:
            speed.append(p[k])
            force = MP.zero
        rate = (1 if k == 0 else 0) - speed[k]
        force += 4 * pi * pi * eta * eta * b[k] + 4 * pi * DAMPING * eta * rate
        b.append(step * rate / (k + 1))
        p.append(step * force / (k + 1))
        theta.append(2 * pi * ((step if k == 0 else 0) - b[k + 1]))
        turned = [2 * j * theta[j] for j in range(1, k + 2)]
        s_next, c_next = MP.fdot(turned, c[::-1]) / (k + 1), -MP.fdot(turned, s[::-1]) / (k + 1)
        s.append(s_next)
        c.append(c_next)
    return b, p


def _value(row: Row, r: Any) -> Any:
    return MP.polyval(row[::-1], r)


def _join(y: Any, step: Any, b: Row, goal: Any) -> Any:
    """The part r of a step at which θ comes to a join."""
    r = (goal / (2 * MP.pi) - (y - b[0])) / (step - b[1])
    for _ in range(60):
        off = y + step * r - _value(b, r) - goal / (2 * MP.pi)
        move = off / (step - _value([k * v for k, v in enumerate(b)][1:], r))
        r -= move
        if abs(move) < MP.mpf(10) ** -45:
            break
    return r


def windup(eta: float = SPEED) -> list[list[Any]]:
    """β at ``TIMES`` from rest at y = 0 on: values by time."""
    step = MP.one / (2 * STEPS)
    y, beta, momentum, half = MP.zero, MP.zero, MP.one, 0
    found = []
    times = [MP.mpf(t) for t in TIMES]
    while times:
        b, p = _series(y, beta, momentum, step, half % 2 == 0, eta)
        goal = (half + 1) * MP.pi
        crosses = 2 * MP.pi * (y + step - _value(b, MP.one)) > goal
        r = _join(y, step, b, goal) if crosses else MP.one
        while times and times[0] <= y + r * step:
            found.append([_value(b, (times.pop(0) - y) / step)])
        y, beta, momentum = y + r * step, _value(b, r), _value(p, r)
        half += 1 if crosses else 0
    return found


# -- rows for the benchmark -------------------------------------------------------------------------------

Told = tuple[Sequence[float], list[list[Any]], float, list[float]]
"""Where; values by place and channel; condition; scale of each channel."""


def _largest(values: list[list[Any]]) -> list[float]:
    return [float(max(abs(v) for v in channel)) for channel in zip(*values, strict=True)]


def monodromy_values() -> Told:
    """The four entries along η. One rounding of η or of a coefficient moves the phase, 2πη, by so much."""
    values = [[v + 0j for v in matrix(eta)] for eta in ETAS]
    return ETAS, values, 2.0 * float(MP.pi) * max(ETAS), _largest(values)


def tongue_values() -> Told:
    """Edges of the tongues as channels."""
    told = [[v + 0j for v in edges()]]
    return [float(Q)], told, 2.0 * float(MP.pi) * max(ETAS), _largest(told)


def windup_values() -> Told:
    """β along time. A rounding in every step is carried on by the shaft's own wave to the end."""
    values = [[v[0] + 0j] for v in windup()]
    return TIMES, values, 2.0 * float(MP.pi) * SPEED * TURNS, _largest(values)


def windups_values() -> Told:
    """The same at each of ``SPEEDS``, as channels."""
    channels = [[row[0] + 0j for row in windup(eta)] for eta in SPEEDS]
    values = [list(row) for row in zip(*channels, strict=True)]
    return TIMES, values, 2.0 * float(MP.pi) * max(SPEEDS) * TURNS, _largest(values)


OF_SHAFTS: dict[str, Callable[[], Told]] = {
    "tongues": tongue_values,
    "monodromy": monodromy_values,
    "wind-up": windup_values,
    "wind-ups": windups_values,
}
