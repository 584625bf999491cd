"""Curves as tables of coefficients: every piece is a polynomial plus sines, so one evaluator gives them all;
and how they are cut, stretched and mirrored.

A piece starting at u0 is  s(u) = sum_k c_k w**k + sum_j A_j sin(f_j w + p_j),  w = u - u0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from itertools import pairwise
from math import comb
from typing import Any, NamedTuple

import numpy as np

from core.frozen import frozen
from core.numerics.derivatives import ORDERS, QUARTER, Derivatives


@frozen
class Sine:
    """A sin(f w + p)."""

    amplitude: float
    frequency: float
    phase: float = 0.0


@frozen
class Piece:
    """One piece of a law: where it starts, its polynomial (ascending powers of w), its sines."""

    start: float
    polynomial: tuple[float, ...]
    sines: tuple[Sine, ...] = ()


@frozen
class Acceleration:
    """One row of a law given by its acceleration: ``level + amplitude sin(frequency w + phase)`` over ``width``."""

    width: float
    level: float = 0.0
    amplitude: float = 0.0
    frequency: float = 1.0
    phase: float = 0.0


def integrate(rows: Sequence[Acceleration]) -> tuple[Piece, ...]:
    """The rise 0 -> 1 from rest whose acceleration is proportional to the rows; rows of no width are dropped.

    Each row is integrated twice in closed form, with s and v carried over the joins.
    """
    pieces, start, s, v = [], 0.0, 0.0, 0.0
    for row in rows:
        if row.width <= 0.0:
            continue
        f, a = row.frequency, row.amplitude
        speed, place = a / f, a / f**2
        sin0, cos0 = math.sin(row.phase), math.cos(row.phase)
        piece = Piece(
            start,
            (s + place * sin0, v + speed * cos0, row.level / 2.0),
            (Sine(-place, f, row.phase),) if a else (),
        )
        pieces.append(piece)
        w = row.width
        sin1, cos1 = math.sin(f * w + row.phase), math.cos(f * w + row.phase)
        s, v = (
            s + w * (v + speed * cos0 + 0.5 * row.level * w) + place * (sin0 - sin1),
            v + row.level * w + speed * (cos0 - cos1),
        )
        start += w
    return tuple(stretched(pieces, 0.0, 1.0, 0.0, 1.0 / s, 0.0))


class PieceTable:
    """m pieces as arrays, ready for the evaluator.

    starts       (m,) where each starts
    derivatives  of value and three derivatives the coefficients (powers, m)
    sines        amplitude, frequency and phase (3, j, m)
    """

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.starts = np.array([p.start for p in pieces])
        powers = max(len(p.polynomial) for p in pieces)
        waves = max(len(p.sines) for p in pieces)
        m = len(pieces)
        polynomial = np.zeros((powers, m))
        self.sines = np.zeros((3, waves, m))
        for i, piece in enumerate(pieces):
            polynomial[: len(piece.polynomial), i] = piece.polynomial
            for j, q in enumerate(piece.sines):
                self.sines[:, j, i] = q.amplitude, q.frequency, q.phase
        self.derivatives = [polynomial]
        for _ in range(1, ORDERS):
            last = self.derivatives[-1]
            falling = last[1:] * np.arange(1, last.shape[0])[:, None]
            self.derivatives.append(falling if falling.shape[0] else np.zeros((1, m)))

    @classmethod
    def stacked(cls, tables: Sequence[PieceTable]) -> PieceTable:
        """The pieces of several tables one after the other."""
        made = cls.__new__(cls)
        made.starts = np.concatenate([table.starts for table in tables])
        made.derivatives = [_beside([table.derivatives[k] for table in tables], 0) for k in range(ORDERS)]
        made.sines = _beside([table.sines for table in tables], 1)
        return made

    def sizes(self) -> np.ndarray:
        """How large value and derivatives can become on each piece, and so how large their rounding (4, m)."""
        amplitude, frequency, _ = np.abs(self.sines)
        waves = [(amplitude * frequency**order).sum(axis=0) for order in range(ORDERS)]
        return np.array([np.abs(rows).sum(axis=0) for rows in self.derivatives]) + np.array(waves)

    def at(self, u: np.ndarray) -> Derivatives:
        """Value and three derivatives at ``u`` (n,); at a join the right-hand limit."""
        index = np.searchsorted(self.starts, u, side="right") - 1
        np.maximum(index, 0, out=index)
        return Derivatives(self.rows(index, u - self.starts[index]))

    def rows(self, index: np.ndarray, w: np.ndarray) -> Callable[[int], np.ndarray]:
        """order -> the value (n,) or its derivative by w, at ``w`` (n,) of the pieces ``index`` (n,); sines and cosines are
        shared by the orders."""
        runs = _runs_of(index)
        where = [(self._taken(index), slice(None))] if runs is None else [(self._pieces[i], part) for i, part in runs]
        parts = [
            (part, w[part], piece, [(f * w[part] + phase, quarter) for f, phase, quarter in piece.angles])
            for piece, part in where
        ]
        known: dict[int, list[list[np.ndarray]]] = {}

        def row(order: int) -> np.ndarray:
            odd = order % 2
            if odd not in known:
                known[odd] = [[_wave(angle, quarter + odd) for angle, quarter in angles] for *_, angles in parts]
            out = np.empty(w.size)
            for (part, along, piece, _), waves in zip(parts, known[odd], strict=True):
                total, (highest, *lower) = out[part], piece.powers[order]
                total[...] = highest
                for c in lower:
                    total *= along
                    total += c
                for gain, wave in zip(piece.gains[order], waves, strict=True):
                    total += gain * wave
            return out

        return row

    @cached_property
    def _pieces(self) -> list[_Coefficients]:
        """Of each piece, in plain numbers."""
        columns = zip(*(rows.T.tolist() for rows in self.derivatives), strict=True)
        return [
            _coefficients(
                [_descending(c) for c in orders],
                [(*wave, q) for wave, q in zip(waves, quarters, strict=True) if wave[0]],
            )
            for orders, waves, quarters in zip(columns, self.sines.T.tolist(), self._quarters.T.tolist(), strict=True)
        ]

    def _taken(self, index: np.ndarray) -> _Coefficients:
        """Of the pieces ``index`` (n,), each number as (n,)."""
        waves = zip(*self.sines[:, :, index], self._quarters[:, index], strict=True)
        return _coefficients([list(rows[::-1, index]) for rows in self.derivatives], waves)

    @cached_property
    def _quarters(self) -> np.ndarray:
        """Whole quarter turns that the phases of the sines are meant to be, 0 ... 3 (j, m): of a cosine what vanishes at its
        start is exactly 0 there."""
        quarters = np.rint(self.sines[2] / QUARTER)
        return np.where(quarters * QUARTER == self.sines[2], quarters, 0.0).astype(int) % 4


def _beside(tables: Sequence[np.ndarray], axis: int) -> np.ndarray:
    """Tables of pieces (..., m), of which some have less rows along an axis, beside each other."""
    most = max(table.shape[axis] for table in tables)

    def padded(table: np.ndarray) -> np.ndarray:
        lacking = most - table.shape[axis]
        return np.pad(table, [(0, lacking if k == axis else 0) for k in range(table.ndim)]) if lacking else table

    return np.concatenate([padded(table) for table in tables], axis=-1)


class _Coefficients(NamedTuple):
    """powers and gains: of value and derivatives the coefficients, the highest first, and the sines' amplitudes with their
    signs; angles: frequency, phase and quarter turns besides of each sine. Numbers, or (n,)."""

    powers: list[list[Any]]
    gains: list[list[Any]]
    angles: list[tuple[Any, Any, Any]]


def _coefficients(powers: list[list[Any]], sines: Iterable[Any]) -> _Coefficients:
    gains: list[list[Any]] = [[] for _ in range(ORDERS)]
    angles = []
    for a, f, phase, quarter in sines:
        angles.append((f, phase * (quarter == 0), quarter))
        for order, gain in enumerate((a, f * a, f * f * a, f * f * f * a)):
            gains[order].append(gain * (1.0 - 2.0 * ((order + quarter) % 4 > 1)))
    return _Coefficients(powers, gains, angles)


def _wave(angle: np.ndarray, quarters: Any) -> np.ndarray:
    """The sine of an angle (n,) and so many quarter turns, a number or (n,), without its sign."""
    if isinstance(quarters, int):
        return np.asarray((np.cos if quarters % 2 else np.sin)(angle))
    odd = quarters % 2 == 1
    return np.where(odd, np.cos(angle), np.sin(angle)) if odd.any() else np.asarray(np.sin(angle))


def _descending(coefficients: list[float]) -> list[float]:
    """The highest first, and not 0 where there are others."""
    while len(coefficients) > 1 and coefficients[-1] == 0.0:
        coefficients.pop()
    return coefficients[::-1]


_RUN = 100  # as many cam angles cost as much as one more pass over a piece


def _runs_of(index: np.ndarray) -> list[tuple[int, slice]] | None:
    """The stretches of an index (n,) that stay on one piece: piece and where; None where they are too short to be worth
    a pass each."""
    cuts = np.flatnonzero(index[1:] != index[:-1]) + 1
    if cuts.size > index.size // _RUN:
        return None
    ends = [0, *cuts.tolist(), index.size]
    return [(int(index[a]), slice(a, b)) for a, b in pairwise(ends) if b > a]


# -- pieces made of others --------------------------------------------------------------------------------


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
