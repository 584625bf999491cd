"""Functions of the cam angle as polynomials on short panels: the table that every method of this package reads.

A panel never crosses a join of the motion's pieces, so polynomials represent both sides of a jump at a join.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache

import numpy as np

from core.errors import NoStability
from core.frozen import frozen
from core.motion import TURN, Angles, CompiledMotion
from core.numerics.roots import gauss, gauss_legendre, legendre, legendre_coefficients, legendre_integrals

NODES = 16  # Gauss-Legendre nodes per panel; the polynomial has this many coefficients
WIDEST = np.deg2rad(30.0)  # [rad] greatest width of a panel
TAIL = 1e-13  # allowed last Legendre coefficients, relative to the largest value
ROUNDS = 14  # greatest number of halvings
MOST = 4000  # greatest number of panels: run time and memory grow with it
GAIN = 0.25  # halving has reached rounding where the tail remains above this fraction of the parent's ...
NOISE = 1e-6  # ... and is below this: before a narrow peak is resolved, halving does not reduce the tail either

Functions = Callable[[Angles], np.ndarray]


@lru_cache(maxsize=8)
def to_legendre(n: int) -> np.ndarray:
    """Matrix from values at the Gauss-Legendre nodes to Legendre coefficients on the panel.

    Parameters
    ----------
    n : int
        Number of nodes and of coefficients.

    Returns
    -------
    ndarray (n, n), dimensionless
    """
    x, w = gauss_legendre(n)
    return (np.arange(n)[:, None] + 0.5) * w * legendre(x, n)


@lru_cache(maxsize=8)
def _legendre_to_powers(n: int) -> np.ndarray:
    """Matrix (n, n) from Legendre coefficients to those of t**k, t = -1...1."""
    return legendre_coefficients(n).T


@lru_cache(maxsize=8)
def _legendre_integrals(n: int) -> np.ndarray:
    """Matrix (n + 1, n) from Legendre coefficients to the coefficients of t**k of half the integral from t = -1."""
    return 0.5 * legendre_integrals(legendre_coefficients(n + 1), np.eye(n + 1)[0]).T


def to_powers(values: np.ndarray) -> np.ndarray:
    """Power series coefficients of the polynomials through the values at the nodes.

    The conversion goes through Legendre coefficients in two steps: the large entries of the second matrix multiply
    coefficients that have decayed. One combined matrix would multiply the values and lose five digits.

    Parameters
    ----------
    values : ndarray (..., n), dimensionless
        Values at the Gauss-Legendre nodes; the result has their unit.

    Returns
    -------
    ndarray (..., n), dimensionless
        Coefficients of t**k, t = -1 ... 1 over the panel.
    """
    n = values.shape[-1]
    return np.asarray((values @ to_legendre(n).T) @ _legendre_to_powers(n).T)


def integrals(values: np.ndarray) -> np.ndarray:
    """Power series coefficients of the integrals from the start of a panel of length 1.

    Parameters
    ----------
    values : ndarray (..., n), dimensionless
        Values of the integrand at the Gauss-Legendre nodes; the result has their unit.

    Returns
    -------
    ndarray (..., n + 1), dimensionless
        Coefficients of t**k, t = -1 ... 1 over the panel.
    """
    n = values.shape[-1]
    return np.asarray((values @ to_legendre(n).T) @ _legendre_integrals(n).T)


@lru_cache(maxsize=8)
def integration(n: int) -> np.ndarray:
    """Matrix from values at the nodes of 0 ... 1 to the integrals from 0 to each node.

    Parameters
    ----------
    n : int
        Number of Gauss-Legendre nodes.

    Returns
    -------
    ndarray (n, n), dimensionless
    """
    return 0.5 * legendre_integrals(legendre(gauss_legendre(n)[0], n + 1), np.ones(n)).T @ to_legendre(n)


def powers(t: np.ndarray, n: int) -> np.ndarray:
    """Powers 1, t, t², ... by repeated multiplication, which is much faster than exponentiation.

    Parameters
    ----------
    t : ndarray (...), dimensionless
    n : int
        Number of powers.

    Returns
    -------
    ndarray (..., n), dimensionless
    """
    out = np.empty((*t.shape, n))
    out[...] = t[..., None]
    out[..., 0] = 1.0
    return np.multiply.accumulate(out, axis=-1, out=out)


@frozen(eq=False)
class Panels:
    """Polynomials of k functions on m panels.

    Attributes
    ----------
    start, width : ndarray (m,) [rad]
    piece : ndarray (m,) of int
        Piece of the motion that contains the panel.
    values : ndarray (k, m, NODES), dimensionless
        Values at the Gauss-Legendre nodes.
    tail : float
        Truncation error of the polynomials, relative to the largest value of each function.
    """

    start: np.ndarray
    width: np.ndarray
    piece: np.ndarray
    values: np.ndarray
    tail: float

    @property
    def count(self) -> int:
        """Number of panels."""
        return self.start.size

    @cached_property
    def theta(self) -> np.ndarray:
        """Cam angles of the nodes (m, NODES) [rad]."""
        return self.start[:, None] + self.width[:, None] * gauss(NODES)[0]

    @cached_property
    def weights(self) -> np.ndarray:
        """Weights (m, NODES), dimensionless: the weighted sum of a function is its mean over the turn."""
        return self.width[:, None] * gauss(NODES)[1] / TURN

    @cached_property
    def powers(self) -> np.ndarray:
        """Coefficients (m, k, NODES), dimensionless, of t**j, t = -1 ... 1 on the panel."""
        return np.ascontiguousarray(np.moveaxis(to_powers(self.values), 0, 1))

    def index(self, theta: np.ndarray) -> np.ndarray:
        """Panel that contains each cam angle; at a join, the panel above it.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Cam angles in 0 ... 2π.

        Returns
        -------
        ndarray (n,) of int, dimensionless
        """
        return np.clip(np.searchsorted(self.start, theta, side="right") - 1, 0, None)

    def at(self, theta: np.ndarray, rows: int, beyond: float | np.ndarray = 0.0) -> np.ndarray:
        """Values of the first functions at cam angles.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Cam angles in 0 ... 2π.
        rows : int
            Number of functions.
        beyond : float or ndarray (n,) [rad]
            The polynomial is that of the panel at theta + beyond, which selects the side of a join.

        Returns
        -------
        ndarray (rows, n), dimensionless
        """
        at = self.index(theta + beyond)
        t = 2.0 * (theta - self.start[at]) / self.width[at] - 1.0
        return np.einsum("nrk,nk->rn", self.powers[at, :rows], powers(t, NODES))

    def split(self, widest: np.ndarray) -> Panels:
        """Return the same functions on narrower panels.

        Parameters
        ----------
        widest : ndarray (m,) [rad]
            Greatest width of the parts of each panel.

        Returns
        -------
        Panels
        """
        parts = np.maximum(1, np.ceil(self.width / widest - 1e-9)).astype(int)
        if (parts == 1).all():
            return self
        parent = np.repeat(np.arange(self.count), parts)
        index_in_parent = np.concatenate([np.arange(p) for p in parts])
        width = self.width[parent] / parts[parent]
        t = 2.0 * (index_in_parent[:, None] + gauss(NODES)[0]) / parts[parent, None] - 1.0
        values = np.einsum("mkj,mnj->kmn", self.powers[parent], powers(t, NODES))
        same = parts[parent] == 1
        values[:, same] = self.values[:, parent[same]]
        return Panels(self.start[parent] + index_in_parent * width, width, self.piece[parent], values, self.tail)


def fit(functions: Functions, program: CompiledMotion, rows: int) -> Panels:
    """Panels on which polynomials represent the functions to rounding.

    Parameters
    ----------
    functions : callable
        Values (k, n) at cam angles (n,).
    program : CompiledMotion
        Its pieces begin at `starts` and end at `ends`.
    rows : int
        Number of functions that the result contains; the others only require sufficiently short panels.

    Returns
    -------
    Panels

    Raises
    ------
    NoStability
        Where more than `MOST` panels would be necessary.
    """
    cuts = [
        np.linspace(a, b, max(1, int(np.ceil((b - a) / WIDEST - 1e-9))) + 1)
        for a, b in zip(program.starts, program.ends, strict=True)
    ]
    low, high = np.concatenate([c[:-1] for c in cuts]), np.concatenate([c[1:] for c in cuts])
    piece = np.repeat(np.arange(len(cuts)), [c.size - 1 for c in cuts])
    parent_tail = np.full(low.size, np.inf)  # the tail of the panel that this one is half of
    accepted: list[tuple[np.ndarray, ...]] = []
    count, tail, scale = 0, 0.0, np.ones(0)
    for level in range(ROUNDS + 1):
        if count + low.size > MOST:
            raise NoStability(
                f"the motion needs {count + low.size} short panels, more than the {MOST} allowed",
                "motion.segments",
                "use fewer segments",
            )
        values, tails = _sampled(functions, low, high, piece)
        if level == 0:
            scale = np.abs(values).max(axis=(1, 2))
            scale[scale == 0.0] = 1.0
        worst = (tails / scale[:, None]).max(axis=0)
        fine = (worst <= TAIL) | ((worst > GAIN * parent_tail) & (worst <= NOISE)) | (level == ROUNDS)
        accepted.append((low[fine], high[fine], piece[fine], values[:rows, fine].swapaxes(0, 1)))
        count, tail = count + accepted[-1][0].size, max(tail, float(worst[fine].max(initial=0.0)))
        low, high, piece, parent_tail = low[~fine], high[~fine], np.tile(piece[~fine], 2), np.tile(worst[~fine], 2)
        middle = 0.5 * (low + high)
        low, high = np.concatenate((low, middle)), np.concatenate((middle, high))
        if low.size == 0:
            break
    start, end, motion_piece, node_values = (np.concatenate(column) for column in zip(*accepted, strict=True))
    order = np.argsort(start)
    return Panels(
        start[order],
        (end - start)[order],
        motion_piece[order],
        np.ascontiguousarray(node_values[order].swapaxes(0, 1)),
        tail,
    )


def _sampled(
    functions: Functions, low: np.ndarray, high: np.ndarray, piece: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Values (k, m, NODES) on m panels from ``low`` to ``high``, and the last Legendre coefficients (k, m)."""
    theta = low[:, None] + (high - low)[:, None] * gauss(NODES)[0]
    values = functions(Angles(theta.ravel(), np.repeat(piece, NODES)))
    values = values.reshape(values.shape[0], *theta.shape)
    return values, np.abs(values @ to_legendre(NODES)[-2:].T).max(axis=-1)
