"""The least jerk that the errors of a stretch of rows allow: weighted least squares over the states at knots.

    minimise  Σ_k Σ_i ((y_ki - s⁽ᵏ⁾(x_i))/σ_k)² + λ ∫ s'''²

over curves that are quintics between knots, with s, s', s'' at each (``laws.polynomial``); λ so that the squares come to one a row
(Reinsch 1967), and to less where the only error is the rounding of many digits. What is known of an end is kept exactly. The equations
are banded, so that the cost grows with rows and knots.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from math import log, log10, sqrt
from typing import Any

import numpy as np

from core.frozen import frozen
from core.laws.polynomial import STATES, jerk_rows, least_jerk_states, quintics
from core.measured.table import MeasuredTable, distinct_angles
from core.numerics.lazy import checkpoint

# -- splines of least jerk over one turn with given knots, in the coordinates in which smoothing is -------------


SPLINES_AT_ONCE = 240  # splines, or knots, that are computed together: memory does not grow with them
CLOSE = 0.05  # of the usual distance: knots closer together than this are one


def choose_knots(angles: np.ndarray, most: int) -> np.ndarray:
    """At most so many cam angles [deg] of a table's own, as dense as its rows, none very close to the next."""
    x, _ = distinct_angles(angles)
    if x.size > most:
        x = x[(np.arange(most) * x.size) // most]
    width = np.diff(np.append(x, x[0] + 360.0))
    return x[np.append(True, width[:-1] > CLOSE * float(np.median(width)))]


def given_order(order: int) -> int:
    """Of the derivative that the knots of a spline for a table of s⁽ᵏ⁾ are given. Accelerations are left to splines
    through positions: the curve of least jerk through accelerations has broken lines for them."""
    return order if order < 2 else 0


def natural(knots: np.ndarray, order: int, given: np.ndarray) -> np.ndarray:
    """States s, s', s'' by u = angle/360 (m, 3, r) at the knots [deg] of the natural splines for s⁽ᵏ⁾ with these values
    (m, r) given there; the first knot is at s = 0, so where s is given it must be 0 there."""
    order = given_order(order)
    fixed = np.zeros((knots.size, STATES), dtype=bool)
    fixed[:, order], fixed[0, 0] = True, True
    found = np.empty((knots.size, STATES, given.shape[1]))
    for first in range(0, given.shape[1], SPLINES_AT_ONCE):
        part = given[:, first : first + SPLINES_AT_ONCE]
        known = np.zeros((knots.size, STATES, part.shape[1]))
        known[:, order] = part
        found[:, :, first : first + SPLINES_AT_ONCE] = least_jerk_states(distances(knots), known, fixed)
    return found


def distances(knots: np.ndarray) -> np.ndarray:
    """From each knot [deg] to the next around the turn, as parts of the turn (m,)."""
    return np.diff(np.append(knots, knots[0] + 360.0)) / 360.0


def derivative(knots: np.ndarray, at: np.ndarray, order: int, angles: np.ndarray) -> np.ndarray:
    """s⁽ᵏ⁾ by u (n, r) at cam angles [deg] of the curves with the states ``at`` (m, 3, r) at the knots [deg]."""
    return np.asarray(_by_states(knots, order, angles) @ at.reshape(STATES * knots.size, -1))


def _by_states(knots: np.ndarray, order: int, angles: np.ndarray) -> Any:
    """What takes states (3m,) at the knots to s⁽ᵏ⁾ by u at cam angles, sparse (n, 3m): each depends on the knots before and behind it."""
    from scipy.sparse import csr_array

    m, n = knots.size, angles.size
    piece = (np.searchsorted(knots, angles, side="right") - 1).astype(np.int32)  # half the memory of a long table
    w = np.mod(angles - knots[piece], 360.0) / 360.0
    own = np.broadcast_to(np.eye(2 * STATES), (m, 2 * STATES, 2 * STATES))  # one curve for each state at either end
    rows = quintics(distances(knots), own[:, :STATES], own[:, STATES:])
    values = np.zeros((n, 2 * STATES))
    for power in range(5, order - 1, -1):  # Horner
        falling = float(np.prod(np.arange(power - order + 1, power + 1)))
        values = values * w[:, None] + falling * rows[piece, power]
    columns = STATES * np.stack((piece % m, (piece + 1) % m), axis=1)[:, :, None] + np.arange(STATES, dtype=np.int32)
    ends = np.arange(0, values.size + 1, 2 * STATES, dtype=np.int32)
    return csr_array((values.ravel(), columns.ravel(), ends), shape=(n, STATES * m))


@frozen(eq=False)
class SplineBasis:
    """A table's rows in the diagonal coordinates of its splines.

    at        (m, 3, r) states at the knots of each coordinate's curve
    seen      (r,) share of a coordinate that the rows determine, 0 ... 1; the rest, 1 - seen, is its jerk times ``scale``
    answer    (r,) projection of the rows on it
    mean      (r,) its mean over the rows
    scale     λ at which rows and jerk weigh the same in the mean
    least     mean square of what no curve of these knots can follow
    """

    knots: np.ndarray
    order: int
    values: np.ndarray
    at: np.ndarray
    seen: np.ndarray
    answer: np.ndarray
    mean: np.ndarray
    scale: float
    least: float

    def weights(self, smoothing: float | np.ndarray) -> np.ndarray:
        """Coordinates (..., r) of the curve for λ."""
        stiff = np.asarray(smoothing)[..., None] / self.scale
        return self.answer / (self.seen + stiff * (1.0 - self.seen))

    def mean_square(self, smoothing: float | np.ndarray) -> np.ndarray:
        """Mean square of the residuals for λ; rises with it."""
        stiff = np.asarray(smoothing)[..., None] / self.scale * (1.0 - self.seen)
        with np.errstate(divide="ignore", invalid="ignore"):
            part = self.answer**2 / self.seen * (stiff / (self.seen + stiff)) ** 2
        return self.least + np.where(self.seen > 0.0, part, 0.0).sum(axis=-1)

    def freedom(self, smoothing: float | np.ndarray) -> np.ndarray:
        """How many values the curve is free to choose for λ: the trace of what takes rows to the curve, c included."""
        stiff = np.asarray(smoothing)[..., None] / self.scale * (1.0 - self.seen)
        return 1.0 + (self.seen / (self.seen + stiff)).sum(axis=-1)


def _stiffness(knots: np.ndarray, at: np.ndarray) -> np.ndarray:
    """∫ of the product of two curves' jerks (r, r), of the curves with these states."""
    width, after = distances(knots), np.append(np.arange(1, knots.size), 0)
    found = np.zeros((at.shape[2], at.shape[2]))
    for first in range(0, knots.size, SPLINES_AT_ONCE):
        some = slice(first, first + SPLINES_AT_ONCE)
        jerk = jerk_rows(width[some], at[some], at[after[some]]).reshape(-1, at.shape[2])
        found += jerk.T @ jerk
    return found


@lru_cache(maxsize=8)
def basis(table: MeasuredTable, most: int, left_out: tuple[int, ...] = ()) -> SplineBasis:
    """Of the rows of a table but those left out, with at most so many knots. Values by u = angle/360."""
    used = table.used_rows(left_out)
    angles, order = table.angles[used], table.layout.order
    y = table.values[used] * 360.0**order
    knots = choose_knots(angles, most)
    given = np.eye(knots.size)[:, 1 - given_order(order) :]
    at = natural(knots, order, given)
    rows, states_of = (
        _by_states(knots, order, angles),
        at.reshape(-1, given.shape[1]),
    )  # their product would hold n m numbers
    mean = rows.mean(axis=0) @ states_of
    square = states_of.T @ ((rows.T @ rows) @ states_of) / used.size - np.outer(mean, mean)  # c takes the mean
    normal, stiff = 0.5 * (square + square.T), _stiffness(knots, at)
    scale = float(np.trace(normal) / np.trace(stiff))
    half = np.linalg.inv(np.linalg.cholesky(normal + scale * stiff))
    unseen, turn = np.linalg.eigh(half @ (scale * stiff) @ half.T)
    turn = half.T @ turn
    seen = np.clip(1.0 - unseen, 0.0, 1.0)
    seen[seen < 1e-13] = 0.0
    off = y - y.mean()
    answer = np.where(seen > 0.0, turn.T @ (states_of.T @ (rows.T @ off)) / used.size, 0.0)
    best = turn @ np.divide(answer, seen, out=np.zeros_like(answer), where=seen > 0.0)
    exact = rows @ (states_of @ best) - mean @ best
    least = float(np.mean((off - exact) ** 2))
    turned = (at.reshape(-1, turn.shape[0]) @ turn).reshape(at.shape)  # one product, not one for each knot
    return SplineBasis(knots, order, y, turned, seen, answer, mean @ turn, scale, least)


# -- the least jerk that the errors of a stretch of rows allow --------------------------------------------------


FEWEST, MOST = 12, 3000  # steps between knots
STIFF = 1e-6  # weight of the jerk, at least: it leads the curve where no rows are; less where the errors are a smaller part of the values
FINE, MET = 1e-6, 6.0  # of the values: rows with smaller errors, those of rounding, are met within so many
ROWS_AT_ONCE = 20_000  # rows whose equations are made together
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
            for first in range(0, there.size, ROWS_AT_ONCE):
                at = there[first : first + ROWS_AT_ONCE]
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
