"""Rows that stand away from their neighbours: what is most likely a typing error, told before any curve is laid."""

from __future__ import annotations

import numpy as np

from core.measured.table import Table, distinct

BESIDE = 5  # neighbours on each side that tell where a row should stand
LEVERAGE = 0.4  # variance of a neighbourhood's cubic where the row stands, in that of a row; 0.26 for even rows
FAR = 5.0  # standard deviations
LARGE = 4.0  # measuring errors
PASSES = 5  # what one wrong row hides shows once it is gone
MOST = 0.05  # of the rows; more are no typing errors


def strays(table: Table, error: float) -> np.ndarray:
    """Rows (n,) that stand away from the cubic through the five neighbours on each side by more than five standard
    deviations and four measuring errors.

    error   the measuring error, in the unit of ``table.values``

    The deviation is the largest of the error, the scatter of the neighbours about their cubic, and the median of all
    such scatters: so neither a coarse table nor an error stated too small makes rows suspicious. Rows whose neighbours
    are spaced too unevenly to tell are not judged.
    """
    found = np.zeros(table.angles.size, dtype=bool)
    for _ in range(PASSES):
        away, room = _away(table.angles[~found], table.values[~found], error)
        new = np.abs(away) > np.maximum(room, LARGE * error)
        if not new.any():
            break
        found[np.flatnonzero(~found)[new]] = True
    return found if found.sum() <= max(1.0, MOST * found.size) else np.zeros_like(found)


def _away(angles: np.ndarray, values: np.ndarray, error: float) -> tuple[np.ndarray, np.ndarray]:
    """How far each row (n,) stands from its neighbours' cubic, and how far it may; infinite where these tell nothing."""
    x, place = distinct(angles)
    room = np.full(x.size, np.inf)
    if x.size < 2 * BESIDE + 2:
        return np.zeros(values.size), room[place]
    mean = np.bincount(place, values) / np.bincount(place)
    beside = np.concatenate((np.arange(-BESIDE, 0), np.arange(1, BESIDE + 1)))
    there = (np.arange(x.size)[:, None] + beside) % x.size
    apart = np.mod(x[there] - x[:, None] + 180.0, 360.0) - 180.0
    far = np.abs(apart).max(axis=1)
    powers = (apart / far[:, None])[:, :, None] ** np.arange(4)
    turned = np.swapaxes(powers, 1, 2)
    inverse = np.linalg.inv(turned @ powers + 1e-12 * np.eye(4))  # rows in few places leave it singular
    y = mean[there]
    cubic = inverse @ (turned @ y[:, :, None])
    left = y - (powers @ cubic)[:, :, 0]
    scatter = np.sqrt((left**2).sum(axis=1) / (2 * BESIDE - 4))
    even = inverse[:, 0, 0] <= LEVERAGE
    usual = np.maximum(scatter, max(float(np.median(scatter)), error))
    room[even] = (FAR * usual * np.sqrt(1.0 + inverse[:, 0, 0]))[even]
    return values - cubic[place, 0, 0], room[place]
