"""Where a quantity passes zero: bracketed by samples, then all brackets narrowed at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core.motion import EPS, TURN, Angles
from core.numerics.vectors import distinct

PASSES = 100
FINEST = EPS * TURN  # [rad] half width at which a root is found
BETWEEN = 33  # points by which a dip towards zero is sampled closer

Quantity = Callable[[Angles], np.ndarray]


@np.errstate(invalid="ignore")  # inf - inf, where a crank locks
def crossings(quantity: Quantity, angles: Angles, value: np.ndarray) -> Angles:
    """The cam angles at which the quantity changes its sign, each with the piece it is in, by piece and angle.

    quantity  gives (n,) at any cam angles; of several quantities (k, n), whose angles are found together
    angles    samples (n,), rising within each piece; value (n,) or (k, n) of the quantity there. A sign that changes twice
              between two samples is noticed where the samples beside bend that way.
    """
    values = np.atleast_2d(value)
    dips = distinct(np.concatenate([_dips(angles, row) for row in values]))
    theta, piece = angles.theta, angles.piece
    if dips.size:
        more = [np.linspace(theta[i - 1], theta[i + 1], BETWEEN)[1:-1] for i in dips]
        closer = Angles(np.concatenate(more), np.repeat(piece[dips], BETWEEN - 2))
        theta, piece = np.append(theta, closer.theta), np.append(piece, closer.piece)
        values = np.hstack([values, np.atleast_2d(quantity(closer))])
        order = np.lexsort((theta, piece))
        theta, piece, values = theta[order], piece[order], values[:, order]
    same = piece[:-1] == piece[1:]
    row, turns = np.nonzero((values[:, :-1] * values[:, 1:] < 0.0) & same)
    root = _narrowed(quantity, theta, piece, values, row, turns)
    # a sample that is zero itself counts where the sign differs on its two sides
    met = (values[:, 1:-1] == 0.0) & (values[:, :-2] * values[:, 2:] < 0.0) & same[:-1] & same[1:]
    exact = np.nonzero(met)[1] + 1
    result, where = np.append(root, theta[exact]), np.append(piece[turns], piece[exact])
    order = np.lexsort((result, where))
    return Angles(result[order], where[order])


def _dips(angles: Angles, value: np.ndarray) -> np.ndarray:
    """Samples nearer to zero than both their neighbours of the same sign and piece, whose second difference, taken
    eightfold as that of a parabola, would bring it beyond."""
    size, same = np.abs(value), np.diff(angles.piece) == 0
    middle = (size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:]) & same[:-1] & same[1:]
    middle &= (value[1:-1] * value[:-2] > 0.0) & (value[1:-1] * value[2:] > 0.0)
    bend = np.abs(value[:-2] - 2.0 * value[1:-1] + value[2:])
    return np.flatnonzero(middle & (bend >= size[1:-1])) + 1


def _narrowed(
    quantity: Quantity, theta: np.ndarray, piece: np.ndarray, value: np.ndarray, row: np.ndarray, turns: np.ndarray
) -> np.ndarray:
    """The roots (m,) between samples and their next, each of its row of the values (k, n), to the last bits: false position,
    where an end that stays a second time counts half (Illinois), which kinks do not slow down."""
    ends, values = np.array([theta[turns], theta[turns + 1]]), np.array([value[row, turns], value[row, turns + 1]])
    at, root = piece[turns], ends.mean(axis=0)
    moved = np.full(turns.size, -1)  # which end moved last
    for _ in range(PASSES):
        wide = np.flatnonzero(ends[1] - ends[0] > 2.0 * FINEST)
        if not wide.size:
            break
        (a, b), (fa, fb) = ends[:, wide], values[:, wide]
        x = np.clip(a + (b - a) * (fa / (fa - fb)), a + FINEST, b - FINEST)
        f = np.atleast_2d(quantity(Angles(x, at[wide])))[row[wide], np.arange(wide.size)]
        side = np.where(f * fa > 0.0, 0, 1)  # the end that x takes the place of
        again = moved[wide] == side
        values[1 - side, wide] *= np.where(again, 0.5, 1.0)
        ends[side, wide], values[side, wide] = x, f
        moved[wide], root[wide] = side, x
        met = wide[f == 0.0]
        ends[:, met] = root[met]
    return root
