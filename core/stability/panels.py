"""Functions of the cam angle as polynomials on short panels, the table that every method of this package reads.

A panel never crosses a join of the motion's pieces, so that polynomials hold on both sides of what jumps there.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache

import numpy as np

from core.errors import NoStability
from core.frozen import frozen
from core.motion import TURN, Angles, CompiledMotion
from core.numerics.roots import gauss, gauss_legendre, integrated, legendre, legendre_powers

NODES = 16  # Gauss-Legendre nodes per panel; the polynomial has this many coefficients
WIDEST = np.deg2rad(30.0)
TAIL = 1e-13  # of the largest value: what the last Legendre coefficients may be
ROUNDS = 14  # of halving
MOST = 4000  # panels that are worked on: run time and memory grow with their number
GAIN = 0.25  # a half whose tail is no smaller than this part of the whole's is at its rounding ...
NOISE = 1e-6  # ... where that is so small: before a narrow peak is resolved, halving gains nothing either

Functions = Callable[[Angles], np.ndarray]


@lru_cache(maxsize=8)
def to_legendre(n: int) -> np.ndarray:
    """Matrix (n, n) from the values at the nodes to the coefficients of the Legendre polynomials on the panel."""
    x, w = gauss_legendre(n)
    return (np.arange(n)[:, None] + 0.5) * w * legendre(x, n)


@lru_cache(maxsize=8)
def _legendre_to_powers(n: int) -> np.ndarray:
    """Matrix (n, n) from Legendre coefficients to those of t**k, t = -1...1."""
    return legendre_powers(n).T


@lru_cache(maxsize=8)
def _legendre_integrals(n: int) -> np.ndarray:
    """Matrix (n + 1, n) from Legendre coefficients to the coefficients of t**k of half the integral from t = -1."""
    return 0.5 * integrated(legendre_powers(n + 1), np.eye(n + 1)[0]).T


def to_powers(values: np.ndarray) -> np.ndarray:
    """Coefficients (..., n) of t**k, t = -1...1, of the polynomials with values (..., n) at the nodes.

    By way of Legendre coefficients, step by step: the large entries of the second matrix meet coefficients that have died
    away; both matrices in one would meet the values and spoil five digits.
    """
    n = values.shape[-1]
    return np.asarray((values @ to_legendre(n).T) @ _legendre_to_powers(n).T)


def integrals(values: np.ndarray) -> np.ndarray:
    """Coefficients (..., n + 1) of t**k of the integrals over the panel, taken as long as 1, from its start."""
    n = values.shape[-1]
    return np.asarray((values @ to_legendre(n).T) @ _legendre_integrals(n).T)


@lru_cache(maxsize=8)
def integration(n: int) -> np.ndarray:
    """Matrix (n, n) from the values at the nodes of 0...1 to the integrals from 0 to each node."""
    return 0.5 * integrated(legendre(gauss_legendre(n)[0], n + 1), np.ones(n)).T @ to_legendre(n)


def powers(t: np.ndarray, n: int) -> np.ndarray:
    """1, t, t², ... (..., n); by multiplying, which is much quicker than raising."""
    out = np.empty((*t.shape, n))
    out[...] = t[..., None]
    out[..., 0] = 1.0
    return np.multiply.accumulate(out, axis=-1, out=out)


@frozen(eq=False)
class Panels:
    """k functions on m panels.

    start, width  (m,) [rad]
    piece         (m,) piece of the motion
    values        (k, m, NODES) at the Gauss-Legendre nodes
    tail          what the polynomials leave of the functions, relative to each one's largest value
    """

    start: np.ndarray
    width: np.ndarray
    piece: np.ndarray
    values: np.ndarray
    tail: float

    @property
    def count(self) -> int:
        """How many panels there are."""
        return self.start.size

    @cached_property
    def theta(self) -> np.ndarray:
        """Cam angles of the nodes (m, NODES) [rad]."""
        return self.start[:, None] + self.width[:, None] * gauss(NODES)[0]

    @cached_property
    def weights(self) -> np.ndarray:
        """Weights (m, NODES): their sum over a function is its mean over the turn."""
        return self.width[:, None] * gauss(NODES)[1] / TURN

    @cached_property
    def powers(self) -> np.ndarray:
        """Coefficients (m, k, NODES) of t**j, t = -1 ... 1 on the panel."""
        return np.ascontiguousarray(np.moveaxis(to_powers(self.values), 0, 1))

    def index(self, theta: np.ndarray) -> np.ndarray:
        """The panels (n,) of cam angles (n,) in 0 ... 2π; at a join the one above."""
        return np.clip(np.searchsorted(self.start, theta, side="right") - 1, 0, None)

    def at(self, theta: np.ndarray, rows: int, beyond: float | np.ndarray = 0.0) -> np.ndarray:
        """The first rows (rows, n) at cam angles (n,), by the panels that hold these and so much beyond, in 0 ... 2π."""
        at = self.index(theta + beyond)
        t = 2.0 * (theta - self.start[at]) / self.width[at] - 1.0
        return np.einsum("nrk,nk->rn", self.powers[at, :rows], powers(t, NODES))

    def split(self, widest: np.ndarray) -> Panels:
        """The same functions on panels no wider than ``widest`` (m,) [rad]."""
        parts = np.maximum(1, np.ceil(self.width / widest - 1e-9)).astype(int)
        if (parts == 1).all():
            return self
        owner = np.repeat(np.arange(self.count), parts)
        number = np.concatenate([np.arange(p) for p in parts])
        width = self.width[owner] / parts[owner]
        t = 2.0 * (number[:, None] + gauss(NODES)[0]) / parts[owner, None] - 1.0
        values = np.einsum("mkj,mnj->kmn", self.powers[owner], powers(t, NODES))
        same = parts[owner] == 1
        values[:, same] = self.values[:, owner[same]]
        return Panels(self.start[owner] + number * width, width, self.piece[owner], values, self.tail)


def fit(functions: Functions, program: CompiledMotion, rows: int) -> Panels:
    """Panels short enough that polynomials leave nothing but rounding of the functions.

    functions  values (k, n) at any cam angles; the first ``rows`` of them are kept, the others only ask for panels
               short enough for themselves
    Raises NoStability where more than ``MOST`` would be needed.
    """
    cuts = [
        np.linspace(a, b, max(1, int(np.ceil((b - a) / WIDEST - 1e-9))) + 1)
        for a, b in zip(program.starts, program.ends, strict=True)
    ]
    low, high = np.concatenate([c[:-1] for c in cuts]), np.concatenate([c[1:] for c in cuts])
    piece = np.repeat(np.arange(len(cuts)), [c.size - 1 for c in cuts])
    above = np.full(low.size, np.inf)  # the tail of the panel that this one is half of
    done: list[tuple[np.ndarray, ...]] = []
    count, tail, scale = 0, 0.0, np.ones(0)
    for number in range(ROUNDS + 1):
        if count + low.size > MOST:
            raise NoStability(
                f"the motion falls into {count + low.size} short panels, more than the {MOST} that the shaft is followed through",
                "motion.segments",
                "take fewer segments",
            )
        values, tails = _sampled(functions, low, high, piece)
        if number == 0:
            scale = np.abs(values).max(axis=(1, 2))
            scale[scale == 0.0] = 1.0
        worst = (tails / scale[:, None]).max(axis=0)
        fine = (worst <= TAIL) | ((worst > GAIN * above) & (worst <= NOISE)) | (number == ROUNDS)
        done.append((low[fine], high[fine], piece[fine], values[:rows, fine].swapaxes(0, 1)))
        count, tail = count + done[-1][0].size, max(tail, float(worst[fine].max(initial=0.0)))
        low, high, piece, above = low[~fine], high[~fine], np.tile(piece[~fine], 2), np.tile(worst[~fine], 2)
        middle = 0.5 * (low + high)
        low, high = np.concatenate((low, middle)), np.concatenate((middle, high))
        if low.size == 0:
            break
    start, end, of, made = (np.concatenate(column) for column in zip(*done, strict=True))
    order = np.argsort(start)
    return Panels(start[order], (end - start)[order], of[order], np.ascontiguousarray(made[order].swapaxes(0, 1)), tail)


def _sampled(
    functions: Functions, low: np.ndarray, high: np.ndarray, piece: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Values (k, m, NODES) on m panels from ``low`` to ``high``, and the last Legendre coefficients (k, m)."""
    theta = low[:, None] + (high - low)[:, None] * gauss(NODES)[0]
    values = functions(Angles(theta.ravel(), np.repeat(piece, NODES)))
    values = values.reshape(values.shape[0], *theta.shape)
    return values, np.abs(values @ to_legendre(NODES)[-2:].T).max(axis=-1)
