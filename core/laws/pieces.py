"""Curves as pieces, their evaluation, and curves built from pieces of others.

A piece that starts at u0 is a polynomial plus sines, s(u) = Σ c_k wᵏ + Σ A_j sin(f_j w + p_j), w = u - u0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from math import comb
from typing import Any, NamedTuple

import numpy as np

from core.frozen import frozen
from core.numerics.derivatives import ORDERS, QUARTER, Derivatives


@frozen
class Sine:
    """A sine wave A sin(f w + p)."""

    amplitude: float
    frequency: float
    phase: float = 0.0


@frozen
class Piece:
    """One piece of a curve: its start, coefficients of ascending powers of w, and sines."""

    start: float
    polynomial: tuple[float, ...]
    sines: tuple[Sine, ...] = ()


@frozen
class Acceleration:
    """One section of an acceleration curve: ``level + amplitude sin(frequency w + phase)`` over ``width``."""

    width: float
    level: float = 0.0
    amplitude: float = 0.0
    frequency: float = 1.0
    phase: float = 0.0


def integrate(rows: Sequence[Acceleration]) -> tuple[Piece, ...]:
    """Rise 0 -> 1 from rest with an acceleration proportional to the rows; rows without width are skipped.

    Each row is integrated twice in closed form; s and v are continuous at the joins.
    """
    pieces, start, s, v = [], 0.0, 0.0, 0.0
    for row in rows:
        if row.width <= 0.0:
            continue
        f, a = row.frequency, row.amplitude
        speed, lift = a / f, a / f**2
        sin0, cos0 = math.sin(row.phase), math.cos(row.phase)
        piece = Piece(
            start,
            (s + lift * sin0, v + speed * cos0, row.level / 2.0),
            (Sine(-lift, f, row.phase),) if a else (),
        )
        pieces.append(piece)
        w = row.width
        sin1, cos1 = math.sin(f * w + row.phase), math.cos(f * w + row.phase)
        s, v = (
            s + w * (v + speed * cos0 + 0.5 * row.level * w) + lift * (sin0 - sin1),
            v + row.level * w + speed * (cos0 - cos1),
        )
        start += w
    return tuple(stretched(pieces, 0.0, 1.0, 0.0, 1.0 / s, 0.0))


class PieceTable:
    """Pieces of a curve as arrays, and their evaluation.

    Attributes
    ----------
    starts : (m,) start of each piece [unit of u]
    derivatives : four arrays (powers, m), coefficients of the value and of three derivatives [unit of s, per unit of uᵏ]
    sines : (3, j, m) amplitude [unit of s], frequency [per unit of u] and phase [rad]
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
        """Table of the pieces of several tables, one after the other."""
        result = cls.__new__(cls)
        result.starts = np.concatenate([table.starts for table in tables])
        result.derivatives = [_concatenated([table.derivatives[k] for table in tables], 0) for k in range(ORDERS)]
        result.sines = _concatenated([table.sines for table in tables], 1)
        return result

    def sizes(self) -> np.ndarray:
        """Bound of the value and of three derivatives on each piece, to which their rounding errors are proportional.

        Returns
        -------
        ndarray (4, m) [unit of s, per unit of uᵏ]
        """
        amplitude, frequency, _ = np.abs(self.sines)
        waves = [(amplitude * frequency**order).sum(axis=0) for order in range(ORDERS)]
        return np.array([np.abs(rows).sum(axis=0) for rows in self.derivatives]) + np.array(waves)

    def at(self, u: np.ndarray) -> Derivatives:
        """Value and three derivatives; at a join the right-hand limit.

        Parameters
        ----------
        u : ndarray (n,) [unit of u]

        Returns
        -------
        Derivatives
        """
        index = np.searchsorted(self.starts, u, side="right") - 1
        np.maximum(index, 0, out=index)
        return Derivatives(self.rows(index, u - self.starts[index]))

    def rows(self, index: np.ndarray, w: np.ndarray) -> Callable[[int], np.ndarray]:
        """Function of the order that evaluates s or a derivative; the orders share their sines and cosines.

        Parameters
        ----------
        index : ndarray (n,) of int, dimensionless
            Numbers of the pieces.
        w : ndarray (n,) [unit of u]
            Distances from the starts of these pieces.

        Returns
        -------
        callable, order -> ndarray (n,) [unit of s, per unit of uᵏ]
        """
        runs = _runs(index)
        where = [(self._at(index), slice(None))] if runs is None else [(self._pieces[i], part) for i, part in runs]
        parts = [
            (part, w[part], piece, [(f * w[part] + phase, quarter) for f, phase, quarter in piece.angles])
            for piece, part in where
        ]
        waves_by_parity: dict[int, list[list[np.ndarray]]] = {}

        def row(order: int) -> np.ndarray:
            odd = order % 2
            if odd not in waves_by_parity:
                waves_by_parity[odd] = [
                    [_wave(angle, quarter + odd) for angle, quarter in angles] for *_, angles in parts
                ]
            out = np.empty(w.size)
            for (part, along, piece, _), waves in zip(parts, waves_by_parity[odd], strict=True):
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
        """Coefficients of each piece, as plain numbers."""
        columns = zip(*(rows.T.tolist() for rows in self.derivatives), strict=True)
        return [
            _coefficients(
                [_descending(c) for c in orders],
                [(*wave, q) for wave, q in zip(waves, quarters, strict=True) if wave[0]],
            )
            for orders, waves, quarters in zip(columns, self.sines.T.tolist(), self._quarters.T.tolist(), strict=True)
        ]

    def _at(self, index: np.ndarray) -> _Coefficients:
        """Coefficients of the pieces ``index`` (n,), as arrays (n,)."""
        waves = zip(*self.sines[:, :, index], self._quarters[:, index], strict=True)
        return _coefficients([list(rows[::-1, index]) for rows in self.derivatives], waves)

    @cached_property
    def _quarters(self) -> np.ndarray:
        """Number of quarter turns 0 ... 3 in phases that are multiples of them (j, m).

        A cosine that vanishes at its start is then exactly 0 there.
        """
        quarters = np.rint(self.sines[2] / QUARTER)
        return np.where(quarters * QUARTER == self.sines[2], quarters, 0.0).astype(int) % 4


def _concatenated(tables: Sequence[np.ndarray], axis: int) -> np.ndarray:
    """Tables of pieces (..., m) joined, with zeros where a table has fewer rows along the axis."""
    most = max(table.shape[axis] for table in tables)

    def padded(table: np.ndarray) -> np.ndarray:
        missing = most - table.shape[axis]
        return np.pad(table, [(0, missing if k == axis else 0) for k in range(table.ndim)]) if missing else table

    return np.concatenate([padded(table) for table in tables], axis=-1)


class _Coefficients(NamedTuple):
    """Coefficients of pieces, as numbers or arrays (n,).

    Attributes
    ----------
    powers : of the value and each derivative, the highest power first
    gains : signed amplitudes of the sines, for the value and each derivative
    angles : frequency, phase and further quarter turns of each sine
    """

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
    """Sine of an angle (n,) plus quarter turns, a number or (n,), without its sign."""
    if isinstance(quarters, int):
        return np.asarray((np.cos if quarters % 2 else np.sin)(angle))
    odd = quarters % 2 == 1
    return np.where(odd, np.cos(angle), np.sin(angle)) if odd.any() else np.asarray(np.sin(angle))


def _descending(coefficients: list[float]) -> list[float]:
    """Coefficients from the highest power, without leading zeros."""
    while len(coefficients) > 1 and coefficients[-1] == 0.0:
        coefficients.pop()
    return coefficients[::-1]


_RUN = 100  # angles that cost as much as one more pass over a piece


def _runs(index: np.ndarray) -> list[tuple[int, slice]] | None:
    """Runs of an index (n,) on one piece: the piece and the slice; None where they are too short for a pass over each."""
    cuts = np.flatnonzero(index[1:] != index[:-1]) + 1
    if cuts.size > index.size // _RUN:
        return None
    ends = [0, *cuts.tolist(), index.size]
    return [(int(index[a]), slice(a, b)) for a, b in pairwise(ends) if b > a]


# -- curves built from pieces of others -------------------------------------------------------------------


def shifted(polynomial: Sequence[float], offset: float) -> tuple[float, ...]:
    """Coefficients of a polynomial p(w) in powers of w - offset."""
    n = len(polynomial)
    return tuple(sum(polynomial[k] * comb(k, j) * offset ** (k - j) for k in range(j, n)) for j in range(n))


def trimmed(piece: Piece, offset: float) -> Piece:
    """The piece from an offset after its start on."""
    sines = tuple(Sine(q.amplitude, q.frequency, q.phase + q.frequency * offset) for q in piece.sines)
    return Piece(piece.start + offset, shifted(piece.polynomial, offset), sines)


def split(pieces: Sequence[Piece], at: float) -> tuple[Piece, ...]:
    """Pieces of the same curve, with a piece that starts at u = at."""
    result = []
    for piece, end in zip(pieces, [p.start for p in pieces[1:]] + [1.0], strict=True):
        result.append(piece)
        if piece.start < at < end:
            result.append(replace(trimmed(piece, at - piece.start), start=at))
    return tuple(result)


def stretched(
    pieces: Sequence[Piece], start: float, factor: float, new_start: float, gain: float, lift: float
) -> list[Piece]:
    """Curve lift + gain s(u), with u - start stretched by a factor and moved to new_start."""
    result = []
    for p in pieces:
        polynomial = [gain * c / factor**k for k, c in enumerate(p.polynomial)]
        polynomial[0] += lift
        sines = tuple(Sine(gain * q.amplitude, q.frequency / factor, q.phase) for q in p.sines)
        result.append(Piece(new_start + (p.start - start) * factor, tuple(polynomial), sines))
    return result


def asymmetric(pieces: Sequence[Piece], crossover: float) -> tuple[Piece, ...]:
    """Symmetric rise with its crossover from acceleration to deceleration moved to u = crossover (0...1).

    The first half is stretched over 0...x and to the height x, the second over the rest, so that s and v are continuous,
    and a is continuous where it is 0 in the middle.

    References
    ----------
    R. L. Norton, *Cam Design and Manufacturing Handbook*, ch. 3; C. N. Neklutin 1969, *Mechanisms and Cams for Automatic
    Machines*.
    """
    x = crossover
    halves = split(pieces, 0.5)
    first = stretched([p for p in halves if p.start < 0.5], 0.0, 2.0 * x, 0.0, 2.0 * x, 0.0)
    # 1 - 2(1-x)(1 - L) = (2x - 1) + 2(1-x) L
    second = stretched([p for p in halves if p.start >= 0.5], 0.5, 2.0 - 2.0 * x, x, 2.0 - 2.0 * x, 2.0 * x - 1.0)
    return tuple(first + second)
