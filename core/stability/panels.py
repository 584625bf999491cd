"""Functions of the cam angle as polynomials on short panels: one table that every method of this package reads.

A panel never crosses a join of the motion's pieces, so that what jumps there is no trouble to anybody.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np

from core.errors import NoStability
from core.motion import TURN, Angles, Program

NODES = 16  # Gauss-Legendre nodes per panel; the polynomial has this many coefficients
WIDEST = np.deg2rad(30.0)
TAIL = 1e-13  # of the largest value: what the last Legendre coefficients may be
ROUNDS = 14  # of halving
MOST = 4000  # panels that are worked on: run time and memory grow with their number
GAIN = 0.25  # a half whose tail is no smaller than this part of the whole's is at its rounding ...
NOISE = 1e-6  # ... where that is so small: before a narrow peak is resolved, halving gains nothing either

Functions = Callable[[Angles], np.ndarray]


@lru_cache(maxsize=8)
def gauss(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss-Legendre on 0...1."""
    x, w = np.polynomial.legendre.leggauss(n)
    return 0.5 + 0.5 * x, 0.5 * w


@lru_cache(maxsize=8)
def to_legendre(n: int) -> np.ndarray:
    """Matrix (n, n) from the values at the nodes to the coefficients of the Legendre polynomials on the panel."""
    x, w = np.polynomial.legendre.leggauss(n)
    return (np.arange(n)[:, None] + 0.5) * w * np.polynomial.legendre.legvander(x, n - 1).T


@lru_cache(maxsize=8)
def _legendre_to_powers(n: int) -> np.ndarray:
    """Matrix (n, n) from Legendre coefficients to those of t**k, t = -1...1."""
    legendre = np.polynomial.legendre
    return np.array([np.pad(legendre.leg2poly(row), (0, n))[:n] for row in np.eye(n)]).T


@lru_cache(maxsize=8)
def _legendre_integrals(n: int) -> np.ndarray:
    """Matrix (n + 1, n) from Legendre coefficients to the coefficients of t**k of half the integral from t = -1."""
    legendre = np.polynomial.legendre
    columns = [0.5 * legendre.leg2poly(legendre.legint(row, lbnd=-1.0)) for row in np.eye(n)]
    return np.array([np.pad(column, (0, n))[: n + 1] for column in columns]).T


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
    legendre = np.polynomial.legendre
    x = 2.0 * gauss(n)[0] - 1.0
    columns = [0.5 * legendre.legval(x, legendre.legint(row, lbnd=-1.0)) for row in np.eye(n)]
    return np.array(columns).T @ to_legendre(n)


def powers(t: np.ndarray, n: int) -> np.ndarray:
    """1, t, t², ... (..., n); by multiplying, which is much quicker than raising."""
    out = np.empty((*t.shape, n))
    out[...] = t[..., None]
    out[..., 0] = 1.0
    return np.multiply.accumulate(out, axis=-1, out=out)


@dataclass(frozen=True, eq=False)
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

    @cached_property
    def ends(self) -> np.ndarray:
        """Values (k, m, 2) at both ends of each panel, from inside."""
        even, odd = self.powers[..., ::2].sum(axis=-1), self.powers[..., 1::2].sum(axis=-1)
        return np.stack([even - odd, even + odd], axis=-1).swapaxes(0, 1)

    def index(self, theta: np.ndarray) -> np.ndarray:
        """The panels (n,) of cam angles (n,) in 0 ... 2π; at a join the one above."""
        return np.clip(np.searchsorted(self.start, theta, side="right") - 1, 0, None)

    def at(self, theta: np.ndarray, rows: int, beyond: float | np.ndarray = 0.0) -> np.ndarray:
        """The first rows (rows, n) at cam angles (n,), by the panels that hold these and so much beyond, in 0 ... 2π."""
        at = self.index(theta + beyond)
        t = 2.0 * (theta - self.start[at]) / self.width[at] - 1.0
        return np.einsum("nrk,nk->rn", self.powers[at, :rows], powers(t, NODES))

    def split(self, widest: float | np.ndarray, which: np.ndarray) -> Panels:
        """The same functions on panels no wider than ``widest`` [rad], one for all or (m,); of those only that ``which`` (m,)
        names."""
        parts = np.where(which, np.maximum(1, np.ceil(self.width / widest - 1e-9)), 1).astype(int)
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


def fit(functions: Functions, program: Program, rows: int, widest: float = WIDEST) -> Panels:
    """Panels short enough that polynomials leave nothing but rounding of the functions.

    functions  values (k, n) at any cam angles; the first ``rows`` of them are kept, the others only ask for panels
               short enough for themselves
    Raises NoStability where more than ``MOST`` would be needed.
    """
    _require_few(program.starts.size)
    cells = [cell for i in range(program.starts.size) for cell in _cells(program, i, widest)]
    done: list[tuple[float, float, int, np.ndarray]] = []
    above = np.full(len(cells), np.inf)  # the tail of the panel that a cell is half of
    scale = np.zeros(0)
    tail = 0.0
    for number in range(ROUNDS + 1):
        values, tails = _looked_at(functions, cells)
        if number == 0:
            scale = np.abs(values).max(axis=(1, 2))
            scale[scale == 0.0] = 1.0
        worst = (tails / scale[:, None]).max(axis=0)
        fine = (worst <= TAIL) | ((worst > GAIN * above) & (worst <= NOISE)) | (number == ROUNDS)
        done += [(*cells[i], values[:rows, i]) for i in np.flatnonzero(fine)]
        tail = max(tail, float(worst[fine].max(initial=0.0)))
        above = np.repeat(worst[~fine], 2)
        cells = [half for i in np.flatnonzero(~fine) for half in _halves(cells[i])]
        if not cells:
            break
        _require_few(len(done) + len(cells))
    done.sort(key=lambda cell: cell[0])
    start, end, piece = (np.array([cell[j] for cell in done]) for j in range(3))
    return Panels(start, end - start, piece.astype(int), np.stack([cell[3] for cell in done], axis=1), tail)


def _require_few(count: int) -> None:
    if count > MOST:
        raise NoStability(
            f"the motion falls into {count} short panels, more than the {MOST} that the shaft is followed through",
            "motion.segments",
            "take fewer segments",
        )


Cell = tuple[float, float, int]


def _cells(program: Program, piece: int, widest: float) -> list[Cell]:
    a, b = float(program.starts[piece]), float(program.ends[piece])
    cuts = np.linspace(a, b, max(1, int(np.ceil((b - a) / widest - 1e-9))) + 1)
    return [(float(lo), float(hi), piece) for lo, hi in pairwise(cuts)]


def _halves(cell: Cell) -> tuple[Cell, Cell]:
    a, b, piece = cell
    middle = 0.5 * (a + b)
    return (a, middle, piece), (middle, b, piece)


def _looked_at(functions: Functions, cells: Sequence[Cell]) -> tuple[np.ndarray, np.ndarray]:
    """Values (k, cells, NODES), and the last Legendre coefficients (k, cells)."""
    a, b = np.array([c[0] for c in cells]), np.array([c[1] for c in cells])
    theta = a[:, None] + (b - a)[:, None] * gauss(NODES)[0]
    piece = np.repeat(np.array([c[2] for c in cells]), NODES)
    values = functions(Angles(theta.ravel(), piece))
    values = values.reshape(values.shape[0], len(cells), NODES)
    tails = np.abs(values @ to_legendre(NODES)[-2:].T).max(axis=-1)
    return values, tails
