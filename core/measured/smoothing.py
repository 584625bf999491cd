"""The least jerk that the errors of a stretch of rows allow: weighted least squares over the states at knots.

    minimise  Σ_k Σ_i ((y_ki - s⁽ᵏ⁾(x_i))/σ_k)² + λ ∫ s'''²

over curves that are quintics between knots, with s, s', s'' at each (``laws.polynomial``); λ so that the squares come to one a row
(Reinsch 1967), and to less where the only error is the rounding of many digits. What is known of an end is kept exactly. The equations
are banded, so that the cost grows with rows and knots.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import log, log10, sqrt
from typing import Any

import numpy as np

from core.frozen import frozen
from core.laws.polynomial import STATES, jerk_rows, quintics
from core.numerics.cancellation import checkpoint

FEWEST, MOST = 12, 3000  # steps between knots
STIFF = 1e-6  # weight of the jerk, at least: it leads the curve where no rows are; less where the errors are a smaller part of the values
FINE, MET = 1e-6, 6.0  # of the values: rows with smaller errors, those of rounding, are met within so many
AT_ONCE = 20_000  # rows whose equations are made together
_BAND = 2 * STATES


@frozen(eq=False)
class Smoothed:
    """The curve of a stretch: knots (m,) [deg] and the states s, s', s'' there (m, 3), by degrees; left: rms of the residuals in errors;
    freedom: how many values the curve was free to choose; smoothing: λ by degrees with σ of the displacement in front."""

    knots: np.ndarray
    states: np.ndarray
    left: float
    freedom: float
    smoothing: float


End = Sequence[float | None]
"""s, s', s'' at an end, as far as they are known."""


def smooth(
    x: np.ndarray,
    values: Mapping[int, np.ndarray],
    errors: Mapping[int, float],
    start: float,
    end: float,
    ends: tuple[End, End],
) -> Smoothed:
    """Rows x (n,) [deg] with the values (n,) of each derivative, nan where there is none, between the cam angles start and end."""
    from scipy.optimize import brentq

    count = sum(int(np.isfinite(y).sum()) for y in values.values())
    most = min(MOST, max(x.size // 2, 1))
    steps, enough = min(FEWEST, most), False
    while True:
        checkpoint()
        system = _System(x, values, errors, np.linspace(start, end, steps + 1), ends)
        states, left = system.solved(0.0)
        if enough or steps >= most:
            break
        enough = left <= count + 2.0 * sqrt(2.0 * count)  # and once more, so that it is the jerk which decides
        steps = min(2 * steps, most)
    known = [(order, y[np.isfinite(y)]) for order, y in values.items() if np.isfinite(y).any()]
    least = max(min([STIFF, *(errors[order] / (float(np.ptp(y)) or 1.0) for order, y in known)]), 1e-14)
    weight = least
    if left < count:

        def beyond(power: float) -> float:
            checkpoint()
            return log(max(system.solved(10.0**power)[1], 1e-300) / count)

        low, high = log10(least), 14.0
        weight = 10.0 ** (
            high if beyond(high) < 0.0 else float(brentq(beyond, low, high, xtol=1e-9)) if beyond(low) < 0.0 else low
        )
    states, left = system.solved(weight)
    order = min(values)
    fine = errors[order] <= FINE * float(np.nanmax(np.abs(values[order]), initial=0.0))
    while fine and weight > least and system.largest(states) > MET:
        weight = max(0.1 * weight, least)
        states, left = system.solved(weight)
    return Smoothed(system.knots, states, sqrt(left / max(count, 1)), system.freedom(weight), weight * system.scale)


class _System:
    """The normal equations of the rows and of the jerk, banded, in the states times powers of the distance of the knots."""

    def __init__(
        self,
        x: np.ndarray,
        values: Mapping[int, np.ndarray],
        errors: Mapping[int, float],
        knots: np.ndarray,
        ends: tuple[End, End],
    ) -> None:
        self.knots, self.h = knots, float(knots[1] - knots[0])
        self.size = self.h ** -np.arange(STATES)  # of a state that counts 1
        n = STATES * knots.size
        self.rows, self.side = np.zeros((_BAND, n)), np.zeros(n)
        self.least: tuple[np.ndarray, float] | None = None
        self.each: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
        m = knots.size - 1
        own = np.eye(_BAND)[None] * np.tile(self.size, 2)[:, None]
        table = quintics(np.array([self.h]), own[:, :STATES], own[:, STATES:])[0]  # (6 powers, 6 states)
        piece = np.clip(((x - knots[0]) / self.h).astype(int), 0, m - 1)
        for order, y in values.items():
            there = np.flatnonzero(np.isfinite(y))
            for first in range(0, there.size, AT_ONCE):
                at = there[first : first + AT_ONCE]
                w, i, right = x[at] - knots[piece[at]], piece[at], y[at] / errors[order]
                powers = np.zeros((at.size, 6))
                for power in range(order, 6):
                    powers[:, power] = np.prod(np.arange(power - order + 1, power + 1)) * w ** (power - order)
                each = powers @ table / errors[order]
                self._add(i, each, right)
                self.each.append((i, each, right))
        # ∫ s'''² of every piece alike; its weight is of the same size as the rows'
        jerk = jerk_rows(np.array([self.h]), own[:, :STATES], own[:, STATES:])[0]
        block, self.jerk = jerk.T @ jerk, np.zeros((_BAND, n))
        for a in range(_BAND):
            for b in range(a + 1):
                self.jerk[a - b, STATES * np.arange(m) + b] += block[a, b]
        self.scale = float(self.rows[0].sum() / self.jerk[0].sum())
        self.fixed, self.known = np.zeros(n, dtype=bool), np.zeros(n)
        for place, end in ((0, ends[0]), (n - STATES, ends[1])):
            for k, value in enumerate(end):
                if value is not None:
                    self.fixed[place + k], self.known[place + k] = True, value / self.size[k]

    def _add(self, piece: np.ndarray, each: np.ndarray, right: np.ndarray) -> None:
        for a in range(_BAND):
            self.side += np.bincount(STATES * piece + a, each[:, a] * right, minlength=self.side.size)
            for b in range(a + 1):
                self.rows[a - b] += np.bincount(STATES * piece + b, each[:, a] * each[:, b], minlength=self.side.size)

    def _banded(self, weight: float) -> tuple[np.ndarray, np.ndarray]:
        band = self.rows + weight * self.scale * self.jerk
        right = self.side - _times(band, self.known)
        right[self.fixed] = self.known[self.fixed]
        band = band.copy()
        for below in range(_BAND):
            n = band.shape[1] - below
            band[below, :n][self.fixed[:n] | self.fixed[below:]] = 0.0
        tiny = 1e-13 * float(band[0].max())
        band[0] = np.where(self.fixed, 1.0, band[0] + tiny)  # a state that no row sees
        return band, right

    def solved(self, weight: float) -> tuple[np.ndarray, float]:
        """States (m, 3) by degrees, and the squares that are left; first asked with no weight."""
        from scipy.linalg import solveh_banded

        band, right = self._banded(weight)
        found = solveh_banded(band, right, lower=True, check_finite=False)
        if (
            self.least is None
        ):  # of the curve that the rows alone ask for; any other leaves as much more as it is away from it
            left, columns = 0.0, np.arange(_BAND)
            for piece, each, wanted in self.each:
                missed = wanted - (each * found[STATES * piece[:, None] + columns]).sum(axis=1)
                left += float(missed @ missed)
            self.least = found, left
        away = found - self.least[0]
        return found.reshape(-1, STATES) * self.size, self.least[1] + float(away @ _times(self.rows, away))

    def largest(self, states: np.ndarray) -> float:
        """The largest residual of the rows, in errors, of the curve with these states (m, 3) by degrees."""
        at, columns = (states / self.size).ravel(), np.arange(_BAND)
        return max(
            float(np.abs(right - (each * at[STATES * piece[:, None] + columns]).sum(axis=1)).max(initial=0.0))
            for piece, each, right in self.each
        )

    def freedom(self, weight: float) -> float:
        """The trace of what takes rows to the curve."""
        from scipy.linalg import cho_solve_banded, cholesky_banded

        band, _ = self._banded(weight)
        factor: Any = cholesky_banded(band, lower=True, check_finite=False)
        n, trace = band.shape[1], 0.0
        for first in range(0, n, 240):
            some = np.arange(first, min(first + 240, n))
            unit = np.zeros((n, some.size))
            for below in range(_BAND):
                inside = some + below < n
                unit[(some + below)[inside], np.flatnonzero(inside)] = self.rows[below, some[inside]]
                inside = some >= below
                unit[(some - below)[inside], np.flatnonzero(inside)] = self.rows[below, (some - below)[inside]]
            unit[self.fixed] = 0.0
            solved = cho_solve_banded((factor, True), unit, check_finite=False)
            trace += float(solved[some, np.arange(some.size)][~self.fixed[some]].sum())
        return trace


def _times(band: np.ndarray, x: np.ndarray) -> np.ndarray:
    """A symmetric matrix given by its lower bands, times a vector."""
    found = band[0] * x
    for below in range(1, band.shape[0]):
        n = x.size - below
        found[below:] += band[below, :n] * x[:n]
        found[:n] += band[below, :n] * x[below:]
    return np.asarray(found)


__all__ = ["End", "Smoothed", "smooth"]
