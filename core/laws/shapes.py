"""How pieces are cut, stretched and mirrored: what asymmetric and blended laws are made of."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb

from core.laws.pieces import Piece, Sine


def moved(polynomial: Sequence[float], by: float) -> tuple[float, ...]:
    """The polynomial p(w) written in w - by."""
    n = len(polynomial)
    return tuple(sum(polynomial[k] * comb(k, j) * by ** (k - j) for k in range(j, n)) for j in range(n))


def cut(pieces: Sequence[Piece], at: float) -> tuple[Piece, ...]:
    """The same curve with a piece starting at u = at."""
    out = []
    for piece, end in zip(pieces, [p.start for p in pieces[1:]] + [1.0], strict=True):
        out.append(piece)
        if piece.start < at < end:
            by = at - piece.start
            sines = tuple(Sine(q.amplitude, q.frequency, q.phase + q.frequency * by) for q in piece.sines)
            out.append(Piece(at, moved(piece.polynomial, by), sines))
    return tuple(out)


def scaled(pieces: Sequence[Piece], by: float) -> tuple[Piece, ...]:
    """by times s(u)."""
    return tuple(
        Piece(
            p.start,
            tuple(by * c for c in p.polynomial),
            tuple(Sine(by * q.amplitude, q.frequency, q.phase) for q in p.sines),
        )
        for p in pieces
    )


def stretched(
    pieces: Sequence[Piece], start: float, by: float, new_start: float, gain: float, lift: float
) -> list[Piece]:
    """lift + gain s, with u - start stretched ``by`` times and begun anew at new_start."""
    out = []
    for p in pieces:
        polynomial = [gain * c / by**k for k, c in enumerate(p.polynomial)]
        polynomial[0] += lift
        sines = tuple(Sine(gain * q.amplitude, q.frequency / by, q.phase) for q in p.sines)
        out.append(Piece(new_start + (p.start - start) * by, tuple(polynomial), sines))
    return out


def asymmetric(pieces: Sequence[Piece], crossover: float) -> tuple[Piece, ...]:
    """A symmetric rise whose crossover from acceleration to deceleration stands at u = crossover (0...1).

    The first half is stretched over 0...x and to the height x, the second over the rest, so that s and v are continuous
    and a too where it is 0 in the middle (Norton ch. 3; Neklutin).
    """
    x = crossover
    halves = cut(pieces, 0.5)
    first = stretched([p for p in halves if p.start < 0.5], 0.0, 2.0 * x, 0.0, 2.0 * x, 0.0)
    # 1 - 2(1-x)(1 - L) = (2x - 1) + 2(1-x) L
    second = stretched([p for p in halves if p.start >= 0.5], 0.5, 2.0 - 2.0 * x, x, 2.0 - 2.0 * x, 2.0 * x - 1.0)
    return tuple(first + second)
