"""Plane vectors, Taylor series, and quantities whose derivatives are computed when they are first read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, Protocol

import numpy as np

from core.numerics.lazy import Column

# -- views of points in space -----------------------------------------------------------------------------------


ISOMETRIC = (45.0, float(np.rad2deg(np.arctan(np.sqrt(0.5)))))
"""Turn about the vertical axis and tilt [deg] of the isometric view."""


def seen_from(points: np.ndarray, turn_deg: float, tilt_deg: float) -> np.ndarray:
    """View of points in space, turned about the vertical axis z, then tilted towards the viewer.

    Parameters
    ----------
    points : ndarray (n, 3) [any length]
    turn_deg, tilt_deg : float [deg]

    Returns
    -------
    ndarray (n,) complex [the same]
        x to the right, y upwards.
    """
    turn, tilt = np.deg2rad((turn_deg, tilt_deg))
    x, y, z = np.asarray(points, dtype=float).T
    right = x * np.cos(turn) + y * np.sin(turn)
    depth = -x * np.sin(turn) + y * np.cos(turn)
    return np.asarray(right + 1j * (z * np.cos(tilt) + depth * np.sin(tilt)))


# -- Taylor series of second order ------------------------------------------------------------------------------


class Taylor:
    """Power series c_0 + c_1 w + c_2 w² of a quantity, real or complex.

    Attributes
    ----------
    c : (3, n) coefficients [unit of the quantity, per unit of wᵏ]
    """

    __slots__ = ("c",)

    def __init__(self, c: np.ndarray) -> None:
        self.c = c

    @classmethod
    def turning(cls, angle: np.ndarray, rate: float) -> Taylor:
        """Series of e^{i rate angle} about each angle.

        Parameters
        ----------
        angle : ndarray (n,) [rad]
        rate : float

        Returns
        -------
        Taylor
        """
        u = np.exp(1j * rate * np.asarray(angle, dtype=float))
        return cls(np.array([u, 1j * rate * u, -0.5 * rate * rate * u]))

    @property
    def derivatives(self) -> np.ndarray:
        """Value, first and second derivative (3, n) [unit of the quantity, per unit of wᵏ]."""
        return self.c * np.array([1.0, 1.0, 2.0])[:, None]

    @property
    def real(self) -> Taylor:
        """Series of the real part."""
        return Taylor(self.c.real)

    @property
    def imag(self) -> Taylor:
        """Series of the imaginary part."""
        return Taylor(self.c.imag)

    def conj(self) -> Taylor:
        """Series of the complex conjugate."""
        return Taylor(self.c.conj())

    def __neg__(self) -> Taylor:
        return Taylor(-self.c)

    def __add__(self, other: Taylor | complex) -> Taylor:
        if isinstance(other, Taylor):
            return Taylor(self.c + other.c)
        c = self.c.astype(np.result_type(self.c, type(other)))
        c[0] += other
        return Taylor(c)

    def __sub__(self, other: Taylor | complex) -> Taylor:
        return self + (-other)

    def __mul__(self, other: Taylor | complex) -> Taylor:
        if not isinstance(other, Taylor):
            return Taylor(self.c * other)
        a, b = self.c, other.c
        return Taylor(np.array([a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[1] * b[1] + a[2] * b[0]]))

    def __truediv__(self, other: Taylor) -> Taylor:
        a, b = self.c, other.c
        first = a[0] / b[0]
        second = (a[1] - first * b[1]) / b[0]
        return Taylor(np.array([first, second, (a[2] - first * b[2] - second * b[1]) / b[0]]))

    def sqrt(self) -> Taylor:
        """Series of the square root, for positive values."""
        a = self.c
        root = np.sqrt(a[0])
        first = 0.5 * a[1] / root
        return Taylor(np.array([root, first, 0.5 * (a[2] - first * first) / root]))

    def log(self) -> Taylor:
        """Series of the complex logarithm, with the argument in -π ... π."""
        a = self.c
        first = a[1] / a[0]
        return Taylor(np.array([np.log(a[0]), first, a[2] / a[0] - 0.5 * first * first]))

    def argument(self) -> Taylor:
        """Series of the argument of complex values [rad]."""
        return self.log().imag

    def arccos(self) -> Taylor:
        """Series of the angle 0 ... π of a cosine, the argument of x + i√(1 - x²) [rad]."""
        sine = ((self * -1.0 + 1.0) * (self + 1.0)).sqrt()
        return Taylor(self.c + 1j * sine.c).argument()


def select(condition: np.ndarray, a: Taylor, b: Taylor) -> Taylor:
    """Series a where the condition holds, else b.

    Parameters
    ----------
    condition : ndarray (n,) of bool, dimensionless
    a, b : Taylor
    """
    return Taylor(np.where(condition, a.c, b.c))


# -- plane vectors as complex numbers ---------------------------------------------------------------------------


QUARTER = 0.5 * np.pi
_QUARTERS = np.array([1.0, 1j, -1.0, -1j])


class DerivativeRows(Protocol):
    """Derivatives of a quantity, by order."""

    def __getitem__(self, order: int, /) -> np.ndarray: ...


def cross(a: np.ndarray | complex, b: np.ndarray | complex) -> np.ndarray:
    """Component out of the plane of the cross product a × b.

    Parameters
    ----------
    a, b : ndarray (n,) complex [any]
        Plane vectors.

    Returns
    -------
    ndarray (n,) [unit of a times unit of b]
    """
    out = a.real * b.imag
    out -= a.imag * b.real
    return np.asarray(out)


def dot(a: np.ndarray | complex, b: np.ndarray | complex) -> np.ndarray:
    """Dot product a · b.

    Parameters
    ----------
    a, b : ndarray (n,) complex [any]
        Plane vectors.

    Returns
    -------
    ndarray (n,) [unit of a times unit of b]
    """
    out = a.real * b.real
    out += a.imag * b.imag
    return np.asarray(out)


def between_lines(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Acute angle between the lines along two vectors, tan γ = |a × b|/|a · b|.

    Parameters
    ----------
    a, b : ndarray (n,) complex [any]
        Plane vectors.

    Returns
    -------
    ndarray (n,) [rad]
        NaN where a vector is 0.
    """
    # arctan2 takes twice as long
    with np.errstate(divide="ignore", invalid="ignore"):
        tangent = cross(a, b)
        tangent /= dot(a, b)
        np.abs(tangent, out=tangent)
        return np.arctan(tangent, out=tangent)


def negated(u: np.ndarray) -> np.ndarray:
    """Opposite vector -u, in a third of the time of numpy's minus for complex numbers.

    Parameters
    ----------
    u : ndarray (n,) complex [any]

    Returns
    -------
    ndarray (n,) complex [the same]
    """
    return 0.0 - u


def spread(row: np.ndarray, n: int) -> np.ndarray:
    """Row with a value at each of n positions; a constant row is broadcast, which takes no memory.

    Parameters
    ----------
    row : ndarray (n,), (1,) or, with many designs, (m, n) or (m, 1) [any]
    n : int

    Returns
    -------
    ndarray (n,), or the row itself with many designs [the same]
    """
    if row.size == n or row.ndim > 1:
        return row
    if row.size != 1:
        raise ValueError(f"{row.size} values at {n} positions")
    repeated = np.ndarray((n,), row.dtype, row, 0, (0,))  # broadcast_to takes ten times as long
    repeated.flags.writeable = False
    return repeated


def replace_nan(row: np.ndarray, nan: float) -> np.ndarray:
    """``np.nan_to_num``, in one pass where all values are finite.

    Parameters
    ----------
    row : ndarray (n,) or (m, n) [any]
    nan : float
        Value in place of NaN.

    Returns
    -------
    ndarray (n,) or (m, n) [the same]
    """
    return row if np.isfinite(row).all() else np.nan_to_num(row, nan=nan)


def unit(angle: np.ndarray) -> np.ndarray:
    """Unit vector e^{i angle}; exactly 1, i, -1 or -i at the float nearest to a multiple of a quarter turn.

    Parameters
    ----------
    angle : ndarray (n,) or (m, n) [rad]

    Returns
    -------
    ndarray (n,) or (m, n) complex, dimensionless
    """
    out = np.empty(np.shape(angle), dtype=complex)
    np.cos(angle, out=out.real)
    np.sin(angle, out=out.imag)
    quarters = np.rint(angle * (1.0 / QUARTER))
    is_quarter = angle - quarters * QUARTER == 0.0
    if is_quarter.any():
        out[is_quarter] = _QUARTERS[quarters[is_quarter].astype(int) % 4]
    return out


def heading(angle: Any) -> Any:
    """Unit vector e^{i angle} of one angle [rad]; with many designs a column."""
    if isinstance(angle, Column):
        return unit(angle).view(Column)
    return _heading(angle)


@lru_cache(maxsize=256)
def _heading(angle: float) -> complex:
    return complex(unit(np.array([angle]))[0])


def vector(x: Any, y: Any) -> Any:
    """Vector x + iy of two numbers; with many designs a column."""
    return x + 1j * y if isinstance(x, Column) or isinstance(y, Column) else complex(x, y)


def vector_derivative(u: np.ndarray, angle: DerivativeRows, order: int) -> np.ndarray:
    """Derivative of a vector u fixed in a body that turns by the angle α.

    u' = iα'u, u'' = (iα'' - α'²)u, u''' = (i(α''' - α'³) - 3α'α'')u.

    Parameters
    ----------
    u : ndarray (n,) complex [any]
    angle : DerivativeRows
        Derivatives α', α'', α''' as rows (n,) or (1,).
    order : int
        0 ... 3.

    Returns
    -------
    ndarray (n,) complex [the same, per unit of the parameterᵏ]
    """
    if order == 0:
        return u
    a1 = angle[1]
    rows = [angle[k] for k in range(1, order + 1)]
    factor = np.empty(rows[0].shape if order == 1 else np.broadcast(*rows).shape, dtype=complex)
    if order == 1:
        factor.real, factor.imag = 0.0, a1
    elif order == 2:
        np.multiply(-a1, a1, out=factor.real)
        factor.imag = angle[2]
    else:
        np.multiply(-3.0 * a1, angle[2], out=factor.real)
        np.subtract(angle[3], a1 * a1 * a1, out=factor.imag)
    is_product_shape = factor.size >= u.size and (u.ndim == 1 or factor.shape == u.shape)
    return np.multiply(factor, u, out=factor) if is_product_shape else factor * u


def distinct(values: np.ndarray) -> np.ndarray:
    """Distinct values in ascending order; ``np.unique`` without its import of ``numpy.ma``.

    Parameters
    ----------
    values : ndarray (n,) [any]
        Finite.

    Returns
    -------
    ndarray (m,) [the same]
    """
    ascending = np.sort(values)
    return np.asarray(ascending[np.diff(ascending, prepend=np.nan) != 0.0])


# -- quantities with their derivatives --------------------------------------------------------------------------


ORDERS = 4  # the value and three derivatives
BINOMIAL = ((1.0,), (1.0, 1.0), (1.0, 2.0, 1.0), (1.0, 3.0, 3.0, 1.0))


class Derivatives:
    """Quantity at n positions with its derivatives by cam angle; an order is computed when it is first read.

    d[k] is the read-only derivative (n,) of order k = 0 ... 3; (1,) where it is constant.

    Attributes
    ----------
    constant : whether the quantity is constant, so that all its derivatives are 0
    """

    __slots__ = ("_all", "_compute", "_rows", "constant")

    def __init__(self, compute: Callable[[int], np.ndarray], constant: bool = False) -> None:
        self._compute = compute  # called once for each order; it may read lower orders
        self.constant = constant
        self._rows: list[np.ndarray | None] = [None] * ORDERS
        self._all: np.ndarray | None = None

    @classmethod
    def of(cls, rows: np.ndarray | Sequence[np.ndarray]) -> Derivatives:
        """Derivatives from known rows, of which it makes read-only views.

        Parameters
        ----------
        rows : ndarray (4, n), or a sequence of four (n,) [any, per radᵏ]
        """
        result = cls(lambda order: rows[order].view())
        if isinstance(rows, np.ndarray):
            result._all = rows.view()
            result._all.flags.writeable = False
        return result

    def __getitem__(self, order: int) -> np.ndarray:
        row = self._rows[order]
        if row is None:
            row = self._rows[order] = self._compute(order)
            row.setflags(write=False)
        return row

    @property
    def computed_orders(self) -> tuple[int, ...]:
        """The orders that have been read."""
        return tuple(order for order, row in enumerate(self._rows) if row is not None)

    @property
    def all(self) -> np.ndarray:
        """The quantity and its first three derivatives (4, n) [unit of the quantity, per radᵏ], read-only."""
        if self._all is None:
            rows = [self[order] for order in range(ORDERS)]
            same = all(row.size == rows[0].size for row in rows)
            self._all = np.array(rows if same else np.broadcast_arrays(*rows))
            self._all.flags.writeable = False
        return self._all

    def spread(self, n: int) -> Derivatives:
        """The same quantity with n values in every row; constant rows are broadcast, which takes no memory."""

        def row(order: int) -> np.ndarray:
            return spread(self[order], n).view()

        return Derivatives(row, self.constant)

    def without_warnings(self) -> Derivatives:
        """The same quantity without numpy's warnings where its derivatives are infinite, as at a dead centre."""

        def row(order: int) -> np.ndarray:
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                return self[order]

        return Derivatives(row, self.constant)


Rows = np.ndarray | tuple[np.ndarray, ...]
"""Rows (n,) of several quantities."""


class Chain:
    """Quantities whose derivatives follow from the lower orders of all of them: c[k] are their rows (n,) of order k.

    ``follow`` computes the rows of an order, once. It receives the chain as an argument: with a reference to the chain it
    would form a cycle, which keeps all rows in memory until the garbage collector runs.
    """

    __slots__ = ("_follow", "_rows")

    def __init__(self, follow: Callable[[int, Chain], Rows]) -> None:
        self._follow = follow
        self._rows: dict[int, Rows] = {}

    def __getitem__(self, order: int) -> Rows:
        if order not in self._rows:
            self._rows[order] = self._follow(order, self)
        return self._rows[order]

    def part(self, index: int, first: Callable[[], np.ndarray] | None = None) -> Derivatives:
        """One of the quantities, with its derivatives.

        Parameters
        ----------
        index : int
            Number of the quantity.
        first : callable, returns ndarray (n,) [unit of the quantity]
            Computes the value where the chain has derivatives only.
        """
        return Derivatives(lambda order: self[order][index] if order or first is None else first())


def constant(value: complex | np.ndarray) -> Derivatives:
    """Quantity that is constant over the cam angle.

    Parameters
    ----------
    value : complex or ndarray (n,) [any]
        One number for all positions, or a value at each.
    """
    first = value if isinstance(value, np.ndarray) else np.array([value])
    return Derivatives(lambda order: np.zeros(1, first.dtype) if order else first, constant=True)


def sum_of(a: Derivatives, b: Derivatives) -> Derivatives:
    """Sum a + b."""
    return _combined(b, a, np.add) if a.constant else _combined(a, b, np.add)


def difference(a: Derivatives, b: Derivatives) -> Derivatives:
    """Difference a - b."""
    return _combined(a, b, np.subtract)


def sum_with_multiple(a: Derivatives, b: Derivatives, factor: complex) -> Derivatives:
    """Sum a + factor b, in plain arrays."""

    def row(order: int) -> np.ndarray:
        if order and b.constant:
            return a[order]
        multiple = np.asarray(b[order] * factor)
        return multiple if order and a.constant else a[order] + multiple

    return Derivatives(row, a.constant and b.constant)


def scaled(a: Derivatives, factor: complex) -> Derivatives:
    """Multiple of a quantity, in plain arrays, which are faster than columns with many designs."""
    return Derivatives(lambda order: np.asarray(a[order] * factor), a.constant)


def _combined(a: Derivatives, b: Derivatives, operation: np.ufunc) -> Derivatives:
    def row(order: int) -> np.ndarray:
        return a[order] if order and b.constant else operation(a[order], b[order])

    return Derivatives(row, a.constant and b.constant)


def body_vector(u: np.ndarray, angle: Derivatives) -> Derivatives:
    """Vector fixed in a body that turns by an angle, with its derivatives.

    Parameters
    ----------
    u : ndarray (n,) complex [any]
        The vector at each position.
    angle : Derivatives
        Of the body [rad].
    """
    return constant(u) if angle.constant else Derivatives(lambda order: vector_derivative(u, angle, order))


def lower_order_terms(s: Derivatives, t: Derivatives, order: int) -> np.ndarray:
    """Derivative of s t by Leibniz's rule, order 1 ... 3, without its term in the highest derivative of s.

    Returns
    -------
    ndarray (n,) [unit of s times unit of t, per radᵏ]
    """
    return np.asarray(sum(c * s[k] * t[order - k] for k, c in enumerate(BINOMIAL[order][:-1])))


def product(
    s: Derivatives, t: Derivatives, multiply: Callable[[np.ndarray, np.ndarray], np.ndarray] = np.multiply
) -> Derivatives:
    """Product s t, or another bilinear product of the two, by Leibniz's rule.

    Parameters
    ----------
    s, t : Derivatives
    multiply : callable, ndarray (n,) and ndarray (n,) -> ndarray (n,) [unit of s times unit of t]
        The product of two rows.
    """

    def row(order: int) -> np.ndarray:
        if t.constant:
            return multiply(s[order], t[0])
        return np.asarray(sum(c * multiply(s[k], t[order - k]) for k, c in enumerate(BINOMIAL[order])))

    return Derivatives(row)
