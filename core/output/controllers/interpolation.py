"""What controllers run between the rows of a table: one function an interpolation gives the pieces' coefficients."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from core.frozen import frozen

REACH = 14  # rows: what shakes a spline falls by 2 - √3 from one to the next, to 1e-8


@frozen(eq=False)
class Table:
    """The rows of one turn, both ends of it among them.

    x       (n,) angles of the master [deg]
    states  (3, n) value, velocity and acceleration [unit, per degree]; of what the interpolation does not run through: anything
    slopes  of a clamped spline at both ends
    """

    x: np.ndarray
    states: np.ndarray
    slopes: tuple[float, float] = (0.0, 0.0)


def linear(table: Table) -> np.ndarray:
    """Straight lines: (2, n - 1) coefficients of the powers of the angle from the start of each piece."""
    s = table.states[0]
    return np.array([s[:-1], np.diff(s) / np.diff(table.x)])


def cubic_hermite(table: Table) -> np.ndarray:
    """Cubics through value and velocity of both ends."""
    h, (s, v) = np.diff(table.x), table.states[:2]
    rise, v0, v1 = np.diff(s) / h, v[:-1], v[1:]
    return np.array([s[:-1], v0, (3.0 * rise - 2.0 * v0 - v1) / h, (v0 + v1 - 2.0 * rise) / h**2])


def quintic_hermite(table: Table) -> np.ndarray:
    """Quintics through value, velocity and acceleration of both ends."""
    h, (s, v, a) = np.diff(table.x), table.states
    # what value, velocity and acceleration at the end lack, times the powers of h that give all of them the unit of the value
    d0 = np.diff(s) - h * (v[:-1] + 0.5 * h * a[:-1])
    d1 = h * (np.diff(v) - h * a[:-1])
    d2 = h**2 * np.diff(a)
    return np.array(
        [s[:-1], v[:-1], 0.5 * a[:-1],
         (10.0 * d0 - 4.0 * d1 + 0.5 * d2) / h**3, (-15.0 * d0 + 7.0 * d1 - d2) / h**4, (6.0 * d0 - 3.0 * d1 + 0.5 * d2) / h**5]
    )  # fmt: skip


def clamped_spline(table: Table) -> np.ndarray:
    """The cubic spline of these slopes at both ends: velocity and acceleration are continuous."""
    from scipy.interpolate import CubicSpline

    ends = ((1, table.slopes[0]), (1, table.slopes[1]))
    return np.asarray(CubicSpline(table.x, table.states[0], bc_type=ends).c[::-1])


def spline_of_equal(h: np.ndarray, states: np.ndarray) -> np.ndarray:
    """The same of many tables (2, n, k) of equal steps (k,), of each with its own slopes at both ends: (4, n - 1, k)."""
    from scipy.interpolate import CubicSpline

    s, v = states[:2]
    made = CubicSpline(np.arange(s.shape[0]), s, bc_type=((1, v[0] * h), (1, v[-1] * h)))
    return np.asarray(made.c[::-1] / h ** np.arange(4)[:, None, None])


def zebra(table: Table) -> np.ndarray:
    """Quintic and straight segments in turn, the last one straight; a quintic has the slopes of its straight neighbours, and no
    acceleration at its ends (ISG kernel; that is inferred)."""
    slope = np.diff(table.states[0]) / np.diff(table.x)
    straight = np.arange(slope.size) % 2 == 1
    v = np.empty(table.x.size)
    v[1:][straight] = slope[straight]
    v[:-1][straight] = slope[straight]
    v[0], v[-1] = v[-1], v[-1]
    quintic = quintic_hermite(Table(table.x, np.array([table.states[0], v, np.zeros(v.size)])))
    return np.where(straight, np.concatenate([linear(table), np.zeros((4, slope.size))]), quintic)


@frozen
class Interpolation:
    """One row.

    coefficients  of a table's pieces
    order     the error of the value falls as this power of the step
    through   how many of value, velocity and acceleration it runs through; needs: how many of them it is made of
    derivatives  how many of them it has
    jump      largest error of the value that one row at a jump of velocity or of acceleration leaves, by h|Δv| and h²|Δa|
    reach     of what runs through all rows: beyond so many of them on either side a piece takes no notice; of_equal: the coefficients of
              tables of so many rows
    """

    coefficients: Callable[[Table], np.ndarray]
    order: int
    through: int
    needs: int
    derivatives: int = 3
    jump: tuple[float, float] = (0.0, 0.0)
    reach: int = 0
    of_equal: Callable[[np.ndarray, np.ndarray], np.ndarray] = spline_of_equal


KINDS: Mapping[str, Interpolation] = MappingProxyType(
    {
        "linear": Interpolation(linear, 2, 1, 1, 2, (0.25, 0.125)),
        "cubic-hermite": Interpolation(cubic_hermite, 4, 2, 2, 3, (4.0 / 27.0, 0.01615)),
        "clamped-spline": Interpolation(clamped_spline, 4, 1, 2, 3, (0.25, 0.125), REACH),
        "quintic-hermite": Interpolation(quintic_hermite, 6, 3, 3, 3, (16.0 / 81.0, 0.01728)),
        "zebra": Interpolation(zebra, 2, 1, 1, 3, (0.25, 0.125)),
    }
)
"""By the name in a controller's row; of ``unknown`` there is none."""


def evaluated(coefficients: np.ndarray, w: np.ndarray, orders: int = 3) -> np.ndarray:
    """Value and derivatives (orders, ...) of polynomials (k, ...) at w from their starts, by Horner's scheme."""
    made = []
    for _ in range(orders):
        value = np.zeros(np.broadcast_shapes(coefficients.shape[1:], w.shape))
        for row in coefficients[::-1]:
            value = value * w + row
        made.append(value)
        k = np.arange(1, coefficients.shape[0]).reshape(-1, *([1] * (coefficients.ndim - 1)))
        coefficients = coefficients[1:] * k if coefficients.shape[0] > 1 else np.zeros_like(coefficients)
    return np.array(made)


__all__ = ["KINDS", "Interpolation", "Table", "evaluated"]
