"""Monodromy matrices: what one turn of the shaft does to a small wind-up and its rate, panel by panel, never across a join.

With damping ζ_d the equation for ζ = √D β is ζ'' + p1 ζ' + p0 ζ = 0, p1 = 4π ζ_d η/D,
p0 = 4π² [η² w + p - 2 ζ_d η Q C/D²]. ζ and ζ' are continuous where X'' jumps, C with it. Each panel is one step of the
collocation at its 16 Gauss-Legendre nodes (order 32); panels are narrowed where a wave would be shorter than they can
hold. Liouville: the determinant is exp(-4π ζ_d η ∫ dy/D).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import pi

import numpy as np

from core.motion import EPS, TURN
from core.numerics.cancellation import checkpoint
from core.stability.hill.coefficients import EXACT, Coefficients, inertia_and_pull, weight_and_potential
from core.stability.panels import NODES, gauss, integration

PHASE = 2.0  # [rad] of the wave that one panel may hold
SWEEPS = 40
TOGETHER = 400_000  # nodes that are worked on at once: what a processor's cache still likes


@dataclass(frozen=True, eq=False)
class Monodromy:
    """One turn at each of L points.

    matrix  (L, 2, 2): (ζ, ζ') after one turn from before
    slope   (L, 2, 2): its derivative by η
    det     (L,) what Liouville says its determinant is
    error   (L,) what an entry may be wrong by, in coordinates (2πη ζ, ζ') that make all entries of a size
    """

    matrix: np.ndarray
    slope: np.ndarray
    det: np.ndarray
    error: np.ndarray

    @property
    def trace(self) -> np.ndarray:
        return np.trace(self.matrix, axis1=1, axis2=2)

    @property
    def growth(self) -> np.ndarray:
        """Natural logarithm (L,) of the largest |multiplier|: growth per turn, negative where it decays."""
        return growth(self.trace, self.det)


def size(matrix: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """The largest entry (L,) of matrices (L, 2, 2), ζ counted 2πη-fold so that all are of a kind."""
    scale = 2.0 * pi * np.maximum(eta, 0.1)
    entries = np.abs(matrix) * np.stack((np.ones_like(scale), scale, 1.0 / scale, np.ones_like(scale)), -1).reshape(
        -1, 2, 2
    )
    return np.asarray(entries.max(axis=(1, 2)))


def determinant(matrix: np.ndarray) -> np.ndarray:
    """Of 2 x 2 matrices (L, 2, 2)."""
    return np.asarray(matrix[:, 0, 0] * matrix[:, 1, 1] - matrix[:, 0, 1] * matrix[:, 1, 0])


def growth(trace: np.ndarray, det: np.ndarray) -> np.ndarray:
    """ln of the larger |root| of μ² - trace μ + det, det > 0."""
    half, root = 0.5 * np.abs(trace), np.sqrt(det)
    beyond = np.sqrt(np.maximum(half - root, 0.0)) * np.sqrt(half + root)  # the square of half may be beyond all numbers
    return np.where(beyond > 0.0, np.log(np.where(beyond > 0.0, half + beyond, 1.0)), np.log(root))


@lru_cache(maxsize=1)
def _collocation() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Integration matrix (NODES, NODES), its square, and the rows that give the end's slope and value."""
    x, b = gauss(NODES)
    once = integration(NODES)
    return once, once @ once, np.array([b * (1.0 - x), b])


def monodromy(
    coefficients: Coefficients, eta: np.ndarray, q: np.ndarray, equation: str = EXACT, damping: float = 0.0
) -> Monodromy:
    """Monodromy matrices at the points η, Q (L,)."""
    eta, q = np.broadcast_arrays(np.atleast_1d(np.asarray(eta, dtype=float)), np.asarray(q, dtype=float))
    nodes = coefficients.panels.count * NODES
    together = max(1, TOGETHER // nodes)
    if eta.size > together:
        parts = [
            monodromy(coefficients, eta[i : i + together], q[i : i + together], equation, damping)
            for i in range(0, eta.size, together)
        ]
        return Monodromy(*(np.concatenate([getattr(p, f) for p in parts]) for f in ("matrix", "slope", "det", "error")))
    narrow = _narrowed(coefficients, float(eta.max(initial=0.0)), float(q.max(initial=0.0)), equation)
    return _one_turn(narrow, eta, q, equation, damping)


def _narrowed(coefficients: Coefficients, eta: float, q: float, equation: str) -> Coefficients:
    """The coefficients on panels that hold no more than ``PHASE`` of their own fastest wave. A short steep segment narrows
    itself and nothing else."""
    w, p = weight_and_potential(coefficients, equation, np.array([q]))
    fastest = np.sqrt(np.abs(eta * eta * w[0] + p[0]).max(axis=1))
    panels = coefficients.panels.split(PHASE / np.maximum(fastest, 1e-300))
    return coefficients if panels is coefficients.panels else replace(coefficients, panels=panels)


def _one_turn(coefficients: Coefficients, eta: np.ndarray, q: np.ndarray, equation: str, damping: float) -> Monodromy:
    panels = coefficients.panels
    maps, slopes, decay = _each_panel(coefficients, eta, q, equation, damping)
    matrix, slope = _product(maps, slopes)
    error = 8.0 * EPS * panels.count**0.5 * size(matrix, eta) + 0.5 * panels.tail * eta * size(slope, eta)
    return Monodromy(matrix, slope, np.exp(-decay), error)


def _each_panel(
    coefficients: Coefficients, eta: np.ndarray, q: np.ndarray, equation: str, damping: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Maps (L, m, 2, 2) of the panels, their derivatives by η, and 4π ζ_d η ∫ dy/D of the turn (L,)."""
    panels = coefficients.panels
    p0, p0_slope, p1_slope = _terms(coefficients, eta, q, equation, damping)
    p1 = None if p1_slope is None else eta[:, None, None] * p1_slope
    maps, slopes = _panel_maps(panels.width / TURN, p0, p0_slope, p1, p1_slope)
    return maps, slopes, np.zeros(eta.size) if p1 is None else (p1 * panels.weights).sum(axis=(1, 2))


def liouville(
    coefficients: Coefficients, eta: np.ndarray, q: float, equation: str = EXACT, damping: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """|Π det M_i / exp(-4π ζ_d η ∫ dy/D) - 1| of the maps M_i of the panels, which exact arithmetic would make zero, and
    what rounding may make of it, both (L,).

    Panel by panel, for no panel grows much. The determinant of the whole turn is the small difference of two products: where
    a turn grows by e^20 no digit of it is left, however right the matrix is.
    """
    rows = np.full(eta.shape, q)
    narrow = _narrowed(coefficients, float(eta.max(initial=0.0)), q, equation)
    maps, _, decay = _each_panel(narrow, eta, rows, equation, damping)
    m = np.abs(maps)
    products = (m[..., 0, 0] * m[..., 1, 1] + m[..., 0, 1] * m[..., 1, 0]).sum(axis=1)
    whole = determinant(maps.reshape(-1, 2, 2)).reshape(maps.shape[:2]).prod(axis=1)
    return np.abs(whole * np.exp(decay) - 1.0), 16.0 * EPS * products


def zeros_at_standstill(coefficients: Coefficients, q: float, equation: str = EXACT) -> int:
    """How often the solution ζ(0) = 1, ζ'(0) = 0 changes sign in a turn at η = 0.

    By Sturm's oscillation theorem the edges of tongue n have n zeros in a turn, and zeros become more as η² rises: where
    there are n + 2 at η = 0 already, both edges of that tongue stand at η² < 0. No panel holds more than one zero, for it
    holds no more than ``PHASE`` < π of its fastest wave.
    """
    narrow = _narrowed(coefficients, 0.0, q, equation)
    maps = _each_panel(narrow, np.zeros(1), np.array([q]), equation, 0.0)[0][0]
    state, count = np.array([1.0, 0.0]), 0
    for step in maps:
        ahead = step @ state
        count += bool(ahead[0] * state[0] < 0.0)
        state = ahead / np.abs(ahead).max()
    return count


def _terms(
    coefficients: Coefficients, eta: np.ndarray, q: np.ndarray, equation: str, damping: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """p0, dp0/dη and p1/η (None without damping) of each point at the nodes of the panels (L, m, NODES)."""
    rows, at = np.unique(q, return_inverse=True)
    w, p = (f[at] for f in weight_and_potential(coefficients, equation, rows))
    etas = eta[:, None, None]
    p0_slope = (8.0 * pi * pi * etas) * w
    p0 = (0.5 * etas) * p0_slope + (4.0 * pi * pi) * p
    if not damping:
        return p0, p0_slope, None
    d, c, _ = (f[at] for f in inertia_and_pull(coefficients, equation, rows))
    shift = (8.0 * pi * pi * damping) * c / (d * d)
    return p0 - etas * shift, p0_slope - shift, (4.0 * pi * damping) / d


def _panel_maps(
    width: np.ndarray, p0: np.ndarray, p0_slope: np.ndarray, p1: np.ndarray | None, p1_slope: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """Maps (L, m, 2, 2) of the panels and their derivatives by η; width (m,) in turns, p0 ... (L, m, NODES).

    Collocation for v = ζ'' at the nodes, solved by sweeps, each of which brings the phase² / 50 or better of the last.
    """
    once, twice, ends = _collocation()
    x, b = gauss(NODES)
    h = width[:, None]
    # two solutions: (ζ, ζ') = (1, 0) and (0, 1) at the panel's start
    start = np.stack((np.ones((width.size, NODES)), h * x))[:, None]
    start_slope = np.array([0.0, 1.0]).reshape(2, 1, 1, 1)
    square = h * h
    value, speed = start, start_slope
    v = np.zeros((2, *p0.shape))
    for _ in range(SWEEPS):
        checkpoint()
        new = p0 * value
        if p1 is not None:
            new += p1 * speed
        np.negative(new, out=new)
        change = np.abs(new - v).max()
        v = new
        value = v @ twice.T
        value *= square
        value += start
        if p1 is not None:
            speed = start_slope + h * (v @ once.T)
        if change <= 4.0 * EPS * np.abs(v).max():
            break
    if p1 is None:
        speed = start_slope + h * (v @ once.T)
    end = v @ ends.T  # (2, L, m, 2)
    first = np.empty((*p0.shape[:2], 2, 2))
    for j in range(2):
        first[..., 0, j] = (width if j else 1.0) + width * width * end[j, ..., 0]
        first[..., 1, j] = j + width * end[j, ..., 1]
    # dF/dη = F ∫ Φ⁻¹ (0, -∂p0 φ - ∂p1 φ')
    force = p0_slope * value
    if p1_slope is not None:
        force += p1_slope * speed
    weight = h * b
    if p1 is not None:
        weight = weight / (value[0] * speed[1] - value[1] * speed[0])
    inner = np.empty_like(first)
    for j in range(2):
        inner[..., 0, j] = (weight * value[1] * force[j]).sum(axis=-1)
        inner[..., 1, j] = -(weight * value[0] * force[j]).sum(axis=-1)
    return first, first @ inner


def _product(maps: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The map (L, 2, 2) of all panels one after the other, and its derivative; by halves."""
    while maps.shape[1] > 1:
        odd_map, odd_slope = (maps[:, -1:], slopes[:, -1:]) if maps.shape[1] % 2 else (maps[:, :0], slopes[:, :0])
        n = maps.shape[1] // 2 * 2
        a, b, da, db = maps[:, 0:n:2], maps[:, 1:n:2], slopes[:, 0:n:2], slopes[:, 1:n:2]
        maps = np.concatenate((b @ a, odd_map), axis=1)
        slopes = np.concatenate((db @ a + b @ da, odd_slope), axis=1)
    return maps[:, 0], slopes[:, 0]
