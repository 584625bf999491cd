"""What the torque of a shaft, less its mean, gives and takes over the turn: W(θ) = ∫(T - T̄)dθ from 0, exact on panels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.motion import TURN
from core.shaft.curve import NODES, LoadCurve, polyval
from core.shaft.linear import filtered


def unbalanced(curve: LoadCurve) -> np.ndarray:
    """Coefficients (NODES, m) of r**k on the panels, of T - T̄ [N m]."""
    power = curve.torque.copy()
    power[0] -= curve.mean
    return power


def roots_of(power: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where polynomials (k, m) of r = 0 ... 1 change their sign: panel and r (n,), to the square of a sample's error."""
    r = np.linspace(0.0, 1.0, 4 * NODES + 1)
    values = polyval(r, power[:, :, None])  # (m, points)
    panel, cell = np.nonzero(values[:, :-1] * values[:, 1:] < 0.0)
    before, after = values[panel, cell], values[panel, cell + 1]
    # two steps are enough: what has an extreme there is flat, its error is of second order in the root's
    root = r[cell] + (r[cell + 1] - r[cell]) * before / (before - after)
    slope = polyval(root, np.arange(1, power.shape[0])[:, None] * power[1:, panel])
    rest = polyval(root, power[:, panel])
    return panel, np.clip(root - rest / np.where(slope == 0.0, np.inf, slope), r[cell], r[cell + 1])


def turning_points(curve: LoadCurve) -> np.ndarray:
    """Machine angles (n,) among which W has its extremes [rad]: starts of panels, and roots of T - T̄ inside them."""
    panel, root = roots_of(unbalanced(curve))
    return np.concatenate((curve.start, curve.start[panel] + root * curve.width[panel]))


def energy_range(curve: LoadCurve) -> tuple[float, float]:
    """The least and the greatest W [J]."""
    low, high = energy_ranges([curve])
    return float(low[0]), float(high[0])


def energy_ranges(curves: Sequence[LoadCurve]) -> tuple[np.ndarray, np.ndarray]:
    """The same of m loads, both (m,)."""
    power = np.concatenate([unbalanced(curve) for curve in curves], axis=1)
    width = np.concatenate([curve.width for curve in curves])
    integral = np.concatenate((np.zeros((1, width.size)), power / np.arange(1, NODES + 1)[:, None]))
    ends = width * polyval(np.ones(width.size), integral)
    counts = [curve.width.size for curve in curves]
    first = np.append(0, np.cumsum(counts)[:-1])
    begins = np.concatenate([np.append(0.0, np.cumsum(part)[:-1]) for part in np.split(ends, first[1:])])
    panel, root = roots_of(power)
    inside = begins[panel] + width[panel] * polyval(root, integral[:, panel])
    low, high, of = (
        np.minimum.reduceat(begins, first),
        np.maximum.reduceat(begins, first),
        np.repeat(np.arange(len(curves)), counts),
    )
    np.minimum.at(low, of[panel], inside)
    np.maximum.at(high, of[panel], inside)
    return low, high


def highest_at(curve: LoadCurve) -> float:
    """The machine angle of the greatest W [rad], 0 ... 2π: there the shaft has given most, and runs slowest."""
    at = turning_points(curve)
    return float(at[int(np.argmax(filtered(curve, 0.0)(at)))] % TURN)
