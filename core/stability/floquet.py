"""Monodromy matrices: what one turn of the shaft does to a small wind-up and its rate, panel by panel, never across a join.

With damping ζ_d the equation for ζ = √D β is ζ'' + p1 ζ' + p0 ζ = 0, p1 = 4π ζ_d η/D,
p0 = 4π² [η² w + p - 2 ζ_d η Q C/D²]. ζ and ζ' are continuous where X'' jumps, C with it. Each panel is one step of the
collocation at its 16 Gauss-Legendre nodes (order 32); panels are narrowed where a wave would be shorter than they can
hold. Liouville: the determinant is exp(-4π ζ_d η ∫ dy/D).

Tongue edges from these matrices: the last digits where harmonics converge slowly, and tongues with damping. At an edge the
matrix M(η) has the multiplier s = +1 (n even) or -1 (n odd): det(M - s) = 0. The trace only touches 2 at the tip of a tongue,
so that its zero is lost in rounding. But M(η + δ) - s = E + δ K, K = dM/dη, is singular at both edges of a tongue at once, and
det(E + δK) = det E + δ tr(adj(E) K) + δ² det K has both as its roots: a pencil of 2 x 2 matrices, well conditioned at the tip
too; Newton's method for two zeros that may be one.

Damping closes a tongue from its tip: where the roots are complex there is none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from math import pi

import numpy as np

from core.frozen import frozen
from core.motion import EPS, TURN
from core.numerics.derivatives import distinct
from core.numerics.lazy import checkpoint
from core.numerics.roots import gauss
from core.stability.coefficients import EXACT, Coefficients, inertia_and_pull, weight_and_potential
from core.stability.panels import NODES, integration
from core.stability.tongues import EDGE_ERROR, MOST_ORDER, Tongues, harmonic_tongues, with_rows

PHASE = 2.0  # [rad] of the wave that one panel may hold
SWEEPS = 40
TOGETHER = 15_000  # nodes that are worked on at once: what a processor's cache still likes
STEPS = 40  # most steps of Newton's method for an edge
CLOSE = 1e-5  # a step of η no larger is the last: what is left is its square
FARTHEST = 0.2  # a step must not reach the next tongue
CLEARLY = 0.1  # of the imaginary part of complex roots: a step no larger proves them
ROUNDS = 3  # of steps no smaller than the one before: then rounding is all that is left
NARROW = 0.2  # half width over ζη, below which damping has surely closed a tongue; at 1 it closes it for small Q
ROUNDING = 4.0  # times eps
UNKNOWN = 0.05  # a tenth of what tongues stand apart: an edge that harmonics leave less certain is unknown to them
ASTRAY = 1e-6  # an edge of a larger error belongs to another tongue
ONWARDS, FARTHEST_ORDER = 2, 160
BY_MONODROMY = "harmonic balance, refined by monodromy matrices"


@frozen(eq=False)
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
        """Traces (L,) of the matrices of one turn: the sum of both multipliers."""
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
    """Determinants (L,) of matrices (L, 2, 2)."""
    return np.asarray(matrix[:, 0, 0] * matrix[:, 1, 1] - matrix[:, 0, 1] * matrix[:, 1, 0])


def growth(trace: np.ndarray, det: np.ndarray) -> np.ndarray:
    """ln of the larger |root| of μ² - trace μ + det, det > 0."""
    half, root = 0.5 * np.abs(trace), np.sqrt(det)
    beyond = np.sqrt(np.maximum(half - root, 0.0)) * np.sqrt(
        half + root
    )  # the square of half may be beyond all numbers
    return np.where(beyond > 0.0, np.log(np.where(beyond > 0.0, half + beyond, 1.0)), np.log(root))


@lru_cache(maxsize=1)
def _collocation() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Integration matrix (NODES, NODES), its square, and the columns that give the end's slope and value: all to be multiplied
    by from the right, and laid out for that, which makes the product five times as quick."""
    x, b = gauss(NODES)
    once = integration(NODES)
    return once.T.copy(), (once @ once).T.copy(), np.stack((b * (1.0 - x), b), axis=1)


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
    rows = distinct(q)
    at = np.searchsorted(rows, q)
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
        v -= new
        change, v = _largest(v), new
        value = v @ twice
        value *= square
        value += start
        if p1 is not None:
            speed = v @ once
            speed *= h
            speed += start_slope
        if change <= 4.0 * EPS * _largest(v):
            break
    if p1 is None:
        speed = start_slope + h * (v @ once)
    end = v @ ends  # (2, L, m, 2)
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


def _largest(values: np.ndarray) -> float:
    """Of their sizes, without an array of these."""
    return float(max(values.max(), -values.min()))


def _product(maps: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The map (L, 2, 2) of all panels one after the other, and its derivative; by halves."""
    while maps.shape[1] > 1:
        odd_map, odd_slope = (maps[:, -1:], slopes[:, -1:]) if maps.shape[1] % 2 else (maps[:, :0], slopes[:, :0])
        n = maps.shape[1] // 2 * 2
        a, b, da, db = maps[:, 0:n:2], maps[:, 1:n:2], slopes[:, 0:n:2], slopes[:, 1:n:2]
        maps = np.concatenate((b @ a, odd_map), axis=1)
        slopes = np.concatenate((db @ a + b @ da, odd_slope), axis=1)
    return maps[:, 0], slopes[:, 0]


# -- edges -------------------------------------------------------------------------------------------------


def tongues(
    coefficients: Coefficients,
    q: np.ndarray,
    count: int,
    equation: str = EXACT,
    damping: float = 0.0,
    error: float = EDGE_ERROR,
    most_order: int = MOST_ORDER,
) -> Tongues:
    """Tongues 1 ... count of the rows q (rows,) to the wanted error of η, with damping or without.

    By harmonic balance where that reaches it with ``most_order`` harmonics; else, and always with damping, refined by
    monodromy matrices from there. Where these do not find to an edge, for so few harmonics begin too far from it, again
    from more. ``error`` of the answer says what was reached.
    """
    result = harmonic_tongues(coefficients, q, count, equation, error, most_order)
    if damping == 0.0 and float(result.error.max(initial=0.0)) <= error:
        return result
    result = refined(coefficients, result, damping)
    lost = np.flatnonzero(np.nanmax(result.error, axis=1, initial=0.0) > max(error, ASTRAY))
    if lost.size and most_order < FARTHEST_ORDER:
        order = min(ONWARDS * most_order, FARTHEST_ORDER)
        return with_rows(result, lost, tongues(coefficients, result.q[lost], count, equation, damping, error, order))
    return result


def refined(coefficients: Coefficients, harmonic: Tongues, damping: float = 0.0) -> Tongues:
    """The same tongues to the accuracy of the monodromy matrices; with damping nan where it has closed them."""
    rows, count = harmonic.edges.shape[:2]
    q, sign = np.repeat(harmonic.q, count), np.tile(np.where(np.arange(count) % 2 == 0, -1.0, 1.0), rows)
    edges = harmonic.edges.reshape(-1, 2).copy()
    error = np.zeros((edges.shape[0], 2))
    pencil = partial(_pencil, coefficients, harmonic.equation, damping)
    if damping:
        middle, half = edges.mean(axis=1), 0.5 * (edges[:, 1] - edges[:, 0])
        at = np.flatnonzero(half > NARROW * damping * middle)
        edges[:] = np.nan
        edges[at] = np.maximum(_open_roots(pencil, middle[at], q[at], sign[at]), 0.0)  # nan stays
    for side in (0, 1):
        at = np.flatnonzero(edges[:, side] > 0.0)
        edges[at, side], error[at, side] = _newton(
            pencil, edges[at, side], q[at], sign[at], 2.0 * side - 1.0, damping > 0.0
        )
    _unproven_zeros(coefficients, harmonic, edges, error)
    closed = np.isnan(edges).any(axis=1)
    edges[closed] = error[closed] = np.nan
    shape = (rows, count, 2)
    largest = error.reshape(shape).max(axis=2)
    return replace(harmonic, edges=edges.reshape(shape), error=largest, damping=damping, method=BY_MONODROMY)


def _unproven_zeros(coefficients: Coefficients, harmonic: Tongues, edges: np.ndarray, error: np.ndarray) -> None:
    """An edge stands at 0 where its η² is negative, as the harmonics say. Where these say nothing (``UNKNOWN``) and zeros of
    the solution do not prove it either, its error is theirs: into ``error`` (rows count, 2)."""
    rows, count = harmonic.error.shape
    numbers = np.tile(np.arange(1, count + 1), rows)
    unsure = (edges == 0.0) & (harmonic.error.reshape(-1, 1) > UNKNOWN)
    for row in sorted({at // count for at in np.flatnonzero(unsure.any(axis=1)).tolist()}):
        proven = numbers + 2 <= zeros_at_standstill(coefficients, float(harmonic.q[row]), harmonic.equation)
        unsure[row * count : (row + 1) * count] &= ~proven[:count, None]
    error[unsure] = np.repeat(harmonic.error.reshape(-1, 1), 2, axis=1)[unsure]


@frozen(eq=False)
class _Pencil:
    """The two roots δ = middle ± √discriminant (L,) of det(E + δK) = 0, and what rounding makes of them."""

    middle: np.ndarray
    discriminant: np.ndarray
    error: np.ndarray


PencilAt = Callable[[np.ndarray, np.ndarray, np.ndarray], _Pencil]
"""The pencil at η, Q for the multiplier s, each (L,)."""


def _pencil(
    coefficients: Coefficients, equation: str, damping: float, eta: np.ndarray, q: np.ndarray, sign: np.ndarray
) -> _Pencil:
    turn = monodromy(coefficients, eta, q, equation, damping)
    e, k = turn.matrix - sign[:, None, None] * np.eye(2), turn.slope
    across = e[:, 0, 0] * k[:, 1, 1] - e[:, 0, 1] * k[:, 1, 0] - e[:, 1, 0] * k[:, 0, 1] + e[:, 1, 1] * k[:, 0, 0]
    square = determinant(k)
    middle = -0.5 * across / square
    discriminant = middle * middle - determinant(e) / square
    # without damping K is a definite matrix turned by a quarter: it holds both roots as firmly as its smaller eigenvalue
    error = turn.error * size(k, eta) / np.abs(square)
    # where a turn grows a millionfold, det E is the small difference of large products
    rounding = ROUNDING * EPS * (np.abs(e[:, 0, 0] * e[:, 1, 1]) + np.abs(e[:, 0, 1] * e[:, 1, 0])) / np.abs(square)
    error = error + rounding / np.maximum(np.sqrt(np.abs(discriminant) + rounding), 1e-300)
    if damping:  # two roots that meet give way like a square root
        apart = np.sqrt(np.abs(discriminant))
        reach = np.abs(middle) + apart
        error = error * np.maximum(1.0, reach / np.maximum(apart, np.sqrt(error * reach + error**2)))
    return _Pencil(middle, discriminant, error)


def _open_roots(pencil: PencilAt, middle: np.ndarray, q: np.ndarray, sign: np.ndarray) -> np.ndarray:
    """First guesses (L, 2) of the edges with damping, starting in the middle of each tongue; nan where it is closed."""
    eta, at = middle.copy(), np.arange(middle.size)
    out = np.full((eta.size, 2), np.nan)
    for _ in range(STEPS):
        if at.size == 0:
            break
        pair = pencil(eta[at], q[at], sign[at])
        real = pair.discriminant >= 0.0
        centre, half = eta[at] + pair.middle, np.sqrt(np.abs(pair.discriminant))
        out[at[real]] = (centre[:, None] + half[:, None] * (-1.0, 1.0))[real]
        clearly = ~real & (np.abs(pair.middle) <= CLEARLY * half + EDGE_ERROR)
        eta[at] += np.clip(pair.middle, -FARTHEST, FARTHEST)
        at = at[~real & ~clearly]
    return out


def _newton(
    pencil: PencilAt, start: np.ndarray, q: np.ndarray, sign: np.ndarray, side: float, damped: bool
) -> tuple[np.ndarray, np.ndarray]:
    """The lower (side -1) or upper (+1) edge near each η (L,), 0 where η² would be negative, nan where there is none; and
    its error."""
    eta, error = start.copy(), np.zeros(start.size)
    last, stuck = np.full(eta.size, np.inf), np.zeros(eta.size, dtype=int)
    at = np.arange(eta.size)
    for _ in range(STEPS):
        if at.size == 0:
            break
        pair = pencil(eta[at], q[at], sign[at])
        step = pair.middle + side * np.sqrt(np.maximum(pair.discriminant, 0.0))
        eta[at] = np.maximum(eta[at] + np.clip(step, -FARTHEST, FARTHEST), 0.0)
        length = np.abs(step)
        # the next step would be the square of this one; where steps wander, its error is not known
        error[at] = pair.error + np.where(length <= CLOSE * (1.0 + eta[at]), step * step, length)
        stuck[at] = np.where(length < 0.5 * last[at], 0, stuck[at] + 1)
        last[at] = length
        done = (length <= CLOSE * (1.0 + eta[at])) | (stuck[at] >= ROUNDS) | (eta[at] == 0.0)
        if damped:
            eta[at[done & (pair.discriminant < -pair.error * (np.abs(pair.middle) + np.sqrt(pair.error)))]] = np.nan
        at = at[~done]
    return eta, error
