"""Splines of least jerk over one turn with given knots, in the coordinates in which smoothing is a division.

The natural spline to knots t is the curve of least ∫ s'''² that has given s there (given s' for a table of
velocities): quintics between the knots. All of them, and a constant c that the table adds to s⁽ᵏ⁾ (for a displacement
the level, for a velocity or an acceleration its offset), are what a table of n rows of s⁽ᵏ⁾ is fitted with:

    minimise  (1/n) Σ (y_i - c - s⁽ᵏ⁾(x_i))² + λ ∫ s'''².

Both terms become diagonal together (Demmler, Reinsch 1975), so that each λ costs one division per knot.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from core.frozen import frozen
from core.laws.polynomial import STATES, jerk_rows, quintics, states
from core.measured.table import MeasuredTable, distinct

AT_ONCE = 240  # splines, or knots, that are computed together: memory does not grow with them
CLOSE = 0.05  # of the usual distance: knots closer together than this are one


def choose_knots(angles: np.ndarray, most: int) -> np.ndarray:
    """At most so many cam angles [deg] of a table's own, as dense as its rows, none very close to the next."""
    x, _ = distinct(angles)
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
    for first in range(0, given.shape[1], AT_ONCE):
        part = given[:, first : first + AT_ONCE]
        known = np.zeros((knots.size, STATES, part.shape[1]))
        known[:, order] = part
        found[:, :, first : first + AT_ONCE] = states(distances(knots), known, fixed)
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
    for first in range(0, knots.size, AT_ONCE):
        some = slice(first, first + AT_ONCE)
        jerk = jerk_rows(width[some], at[some], at[after[some]]).reshape(-1, at.shape[2])
        found += jerk.T @ jerk
    return found


@lru_cache(maxsize=8)
def basis(table: MeasuredTable, most: int, left_out: tuple[int, ...] = ()) -> SplineBasis:
    """Of the rows of a table but those left out, with at most so many knots. Values by u = angle/360."""
    used = table.used(left_out)
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
