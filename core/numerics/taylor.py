"""Taylor series of second order: a quantity at n places with its first two derivatives, through sums, products and roots."""

from __future__ import annotations

import numpy as np

ORDERS = 3  # value and two derivatives


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
