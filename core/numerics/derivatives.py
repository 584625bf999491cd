"""Quantities with their derivatives, each order made when it is first read: few scenes need all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, Protocol

import numpy as np

from core.numerics.lazy import Column

# -- points in space as they look on paper ----------------------------------------------------------------------


ISOMETRIC = (45.0, float(np.rad2deg(np.arctan(np.sqrt(0.5)))))
"""Turn about the upright axis and tilt [deg] under which all three axes look equally long."""


def seen_from(points: np.ndarray, turn_deg: float, tilt_deg: float) -> np.ndarray:
    """Points (n, 3) as they look (n,), complex, x to the right: turned about the upright axis z, then tilted towards the eye."""
    turn, tilt = np.deg2rad((turn_deg, tilt_deg))
    x, y, z = np.asarray(points, dtype=float).T
    right = x * np.cos(turn) + y * np.sin(turn)
    away = -x * np.sin(turn) + y * np.cos(turn)
    return np.asarray(right + 1j * (z * np.cos(tilt) + away * np.sin(tilt)))


# -- taylor series of second order ------------------------------------------------------------------------------


PAIR_ORDERS = 3  # value and two derivatives


class Taylor:
    """c (3, n): the coefficients c_k of w^k, so that the derivatives are c_0, c_1, 2 c_2; real or complex."""

    __slots__ = ("c",)

    def __init__(self, c: np.ndarray) -> None:
        self.c = c

    @classmethod
    def turning(cls, angle: np.ndarray, rate: float) -> Taylor:
        """e^{i rate angle}, by angle (n,) [rad]."""
        u = np.exp(1j * rate * np.asarray(angle, dtype=float))
        return cls(np.array([u, 1j * rate * u, -0.5 * rate * rate * u]))

    @property
    def derivatives(self) -> np.ndarray:
        """Value, first and second derivative (3, n)."""
        return self.c * np.array([1.0, 1.0, 2.0])[:, None]

    @property
    def real(self) -> Taylor:
        """The real parts."""
        return Taylor(self.c.real)

    @property
    def imag(self) -> Taylor:
        """The imaginary parts."""
        return Taylor(self.c.imag)

    def conj(self) -> Taylor:
        """The complex conjugate."""
        return Taylor(self.c.conj())

    def __neg__(self) -> Taylor:
        return Taylor(-self.c)

    def __add__(self, other: Taylor | complex) -> Taylor:
        if isinstance(other, Taylor):
            return Taylor(self.c + other.c)
        made = self.c.astype(np.result_type(self.c, type(other)))
        made[0] += other
        return Taylor(made)

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
        """The root of positive values."""
        a = self.c
        root = np.sqrt(a[0])
        first = 0.5 * a[1] / root
        return Taylor(np.array([root, first, 0.5 * (a[2] - first * first) / root]))

    def log(self) -> Taylor:
        """The complex logarithm, with the argument in -π ... π."""
        a = self.c
        first = a[1] / a[0]
        return Taylor(np.array([np.log(a[0]), first, a[2] / a[0] - 0.5 * first * first]))

    def argument(self) -> Taylor:
        """The angle of complex values."""
        return self.log().imag

    def arccos(self) -> Taylor:
        """The angle 0 ... π of a cosine: the argument of x + i√(1 - x²)."""
        high = ((self * -1.0 + 1.0) * (self + 1.0)).sqrt()
        return Taylor(self.c + 1j * high.c).argument()


def chosen(first: np.ndarray, one: Taylor, other: Taylor) -> Taylor:
    """One where ``first`` (n,), else the other."""
    return Taylor(np.where(first, one.c, other.c))


# -- plane vectors as complex numbers, and points that turn -----------------------------------------------------


QUARTER = 0.5 * np.pi
_QUARTERS = np.array([1.0, 1j, -1.0, -1j])


class DerivativeRows(Protocol):
    """A quantity's derivatives by order."""

    def __getitem__(self, order: int, /) -> np.ndarray: ...


def cross(a: np.ndarray | complex, b: np.ndarray | complex) -> np.ndarray:
    """a × b (n,), the component out of the plane, of complex plane vectors (n,); unit: that of a times that of b."""
    out = a.real * b.imag
    out -= a.imag * b.real
    return np.asarray(out)


def dot(a: np.ndarray | complex, b: np.ndarray | complex) -> np.ndarray:
    """a · b (n,) of complex plane vectors (n,); unit: that of a times that of b."""
    out = a.real * b.real
    out += a.imag * b.imag
    return np.asarray(out)


def between_lines(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The acute angle (n,) [rad] between the lines along complex plane vectors a and b (n,): tan = |a × b| / |a · b|. Not by arctan2,
    which takes twice as long. NaN where one of them is 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.arctan(np.abs(cross(a, b) / dot(a, b))))


def opposite(u: np.ndarray) -> np.ndarray:
    """-u, in a third of the time that numpy takes to change the signs of complex numbers."""
    return 0.0 - u


def spread(row: np.ndarray, n: int) -> np.ndarray:
    """A value at each of n positions, of which a row of one takes no memory; of many designs, (m, n) or (m, 1), as it is."""
    return row if row.size == n or row.ndim > 1 else np.broadcast_to(row, n)


def finite(row: np.ndarray, nan: float) -> np.ndarray:
    """The same as ``np.nan_to_num``, in one pass where there is nothing to replace."""
    return row if np.isfinite(row).all() else np.nan_to_num(row, nan=nan)


def unit(angle: np.ndarray) -> np.ndarray:
    """e^{i angle}; the number nearest to a quarter turn is meant as that: exactly 1, i, -1 or -i."""
    out = np.empty(np.shape(angle), dtype=complex)
    np.cos(angle, out=out.real)
    np.sin(angle, out=out.imag)
    quarters = np.rint(angle * (1.0 / QUARTER))
    meant = angle - quarters * QUARTER == 0.0
    if meant.any():
        out[meant] = _QUARTERS[quarters[meant].astype(int) % 4]
    return out


def heading(angle: Any) -> Any:
    """e^{i angle} of one angle; of many designs a column."""
    if isinstance(angle, Column):
        return unit(angle).view(Column)
    return _heading(angle)


@lru_cache(maxsize=256)
def _heading(angle: float) -> complex:
    return complex(unit(np.array([angle]))[0])


def vector(x: Any, y: Any) -> Any:
    """x + iy of two numbers; of many designs a column."""
    return x + 1j * y if isinstance(x, Column) or isinstance(y, Column) else complex(x, y)


def turned(u: np.ndarray, angle: DerivativeRows, order: int) -> np.ndarray:
    """A derivative (n,), of order 0 ... 3, of a vector u (n,) fixed in a body whose angle has the derivatives ``angle[1]``
    ..., (n,) or (1,).

    u' = iα'u, u'' = (iα'' - α'²)u, u''' = (i(α''' - α'³) - 3α'α'')u.
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
    inside = factor.size >= u.size and (u.ndim == 1 or factor.shape == u.shape)
    return np.multiply(factor, u, out=factor) if inside else factor * u


def distinct(values: np.ndarray) -> np.ndarray:
    """Finite values (n,) in rising order, each once. Not by np.unique, which imports numpy.ma."""
    rising = np.sort(values)
    return np.asarray(rising[np.diff(rising, prepend=np.nan) != 0.0])


# -- quantities with their derivatives, each order made when it is first read -----------------------------------


ORDERS = 4  # the value and three derivatives
BINOMIAL = ((1.0,), (1.0, 1.0), (1.0, 2.0, 1.0), (1.0, 3.0, 3.0, 1.0))


class Derivatives:
    """A quantity at n positions: d[k] is its derivative of order k, 0 ... 3, by cam angle, (n,) and read-only; (1,) where
    it is the same everywhere.

    make   order -> its row, asked for once and read-only from then on; it may read lower orders
    constant  it never changes: all derivatives are 0, and whoever adds them need not ask
    """

    __slots__ = ("_all", "_make", "_rows", "constant")

    def __init__(self, make: Callable[[int], np.ndarray], constant: bool = False) -> None:
        self._make = make
        self.constant = constant
        self._rows: list[np.ndarray | None] = [None] * ORDERS
        self._all: np.ndarray | None = None

    @classmethod
    def of(cls, rows: np.ndarray | Sequence[np.ndarray]) -> Derivatives:
        """Of what is known: (4, n), or four rows, which stay the caller's."""
        made = cls(lambda order: rows[order].view())
        if isinstance(rows, np.ndarray):
            made._all = rows.view()
            made._all.flags.writeable = False
        return made

    def __getitem__(self, order: int) -> np.ndarray:
        row = self._rows[order]
        if row is None:
            row = self._rows[order] = self._make(order)
            row.setflags(write=False)
        return row

    @property
    def made(self) -> tuple[int, ...]:
        """The orders that somebody has read."""
        return tuple(order for order, row in enumerate(self._rows) if row is not None)

    @property
    def all(self) -> np.ndarray:
        """The quantity and its first three derivatives (4, n); what is made once is read-only."""
        if self._all is None:
            rows = [self[order] for order in range(ORDERS)]
            same = all(row.size == rows[0].size for row in rows)
            self._all = np.array(rows if same else np.broadcast_arrays(*rows))
            self._all.flags.writeable = False
        return self._all

    def spread(self, n: int) -> Derivatives:
        """The same with n values in every row, which take no memory."""

        def row(order: int) -> np.ndarray:
            return spread(self[order], n).view()

        return Derivatives(row, self.constant)

    def without_warnings(self) -> Derivatives:
        """The same where derivatives may be infinite, as at a dead centre: none of its rows warns of that."""

        def row(order: int) -> np.ndarray:
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                return self[order]

        return Derivatives(row, self.constant)


Rows = np.ndarray | tuple[np.ndarray, ...]
"""Of several quantities, a row (n,) each."""


class Chain:
    """Quantities whose derivatives follow from the lower ones of all of them: c[k] are their rows (n,) of order k.

    follow  order, chain -> the rows of this order, asked for once. The chain is handed over: a function that held it would
            be in a circle with it, and all its rows in memory until Python comes to look for circles.
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
        """One of them; its value from elsewhere where the chain has derivatives only."""
        return Derivatives(lambda order: self[order][index] if order or first is None else first())


def constant(value: complex | np.ndarray) -> Derivatives:
    """What never changes; the same everywhere where it is a number."""
    first = value if isinstance(value, np.ndarray) else np.array([value])
    return Derivatives(lambda order: np.zeros(1, first.dtype) if order else first, constant=True)


def sum_of(a: Derivatives, b: Derivatives) -> Derivatives:
    """a + b."""
    return _joined(b, a, np.add) if a.constant else _joined(a, b, np.add)


def difference(a: Derivatives, b: Derivatives) -> Derivatives:
    """a - b."""
    return _joined(a, b, np.subtract)


def scaled(a: Derivatives, by: complex) -> Derivatives:
    """A fixed multiple; of many designs plain rows too, which numpy is quicker with than with columns."""
    return Derivatives(lambda order: np.asarray(a[order] * by), a.constant)


def _joined(a: Derivatives, b: Derivatives, both: np.ufunc) -> Derivatives:
    def row(order: int) -> np.ndarray:
        return a[order] if order and b.constant else both(a[order], b[order])

    return Derivatives(row, a.constant and b.constant)


def turning(u: np.ndarray, angle: Derivatives) -> Derivatives:
    """A vector u (n,) fixed in a body that turns so."""
    return constant(u) if angle.constant else Derivatives(lambda order: turned(u, angle, order))


def earlier(s: Derivatives, t: Derivatives, order: int) -> np.ndarray:
    """The derivative of s t in this order, 1 ... 3, without its term in s's highest derivative (Leibniz)."""
    return np.asarray(sum(c * s[k] * t[order - k] for k, c in enumerate(BINOMIAL[order][:-1])))


def product(
    s: Derivatives, t: Derivatives, by: Callable[[np.ndarray, np.ndarray], np.ndarray] = np.multiply
) -> Derivatives:
    """s t, or another product of the two (Leibniz)."""

    def row(order: int) -> np.ndarray:
        if t.constant:
            return by(s[order], t[0])
        return np.asarray(sum(c * by(s[k], t[order - k]) for k, c in enumerate(BINOMIAL[order])))

    return Derivatives(row)
