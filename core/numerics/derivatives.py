"""Quantities with their derivatives, each order made when it is first read: few scenes need all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from core.numerics.vectors import spread, turned

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
