"""Monodromy matrices: one turn of the shaft as a map of a small wind-up and its rate, panel by panel.

With damping ζ_d the equation for ζ = √D β is ζ'' + p1 ζ' + p0 ζ = 0, p1 = 4π ζ_d η/D,
p0 = 4π² [η² w + p - 2 ζ_d η Q C/D²]. ζ and ζ' are continuous where X'', and C with it, jumps. Each panel is one step of
the
collocation at its 16 Gauss-Legendre nodes (order 32); panels are narrowed where a wave would be too short for them.
Liouville: the determinant is exp(-4π ζ_d η ∫ dy/D).

Tongue edges from these matrices give the last digits where harmonics converge slowly, and tongues with damping. At an
edge
the matrix M(η) has the multiplier s = +1 (n even) or -1 (n odd): det(M - s) = 0. The trace only touches 2 at the tip of
a
tongue, so that its zero is lost in rounding. But M(η + δ) - s = E + δ K, K = dM/dη, is singular at both edges of a
tongue
at once, and det(E + δK) = det E + δ tr(adj(E) K) + δ² det K has both as its roots: a pencil of 2 x 2 matrices, well
conditioned at the tip too; Newton's method for two zeros that may coincide.

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

PHASE = 2.0  # [rad] greatest phase of the wave over one panel
SWEEPS = 40
BATCH = 15_000  # nodes in one batch, which fit a processor's cache
STEPS = 40  # most steps of Newton's method for an edge
CLOSE = 1e-5  # a step of η below it is the last: the remaining error is its square
FARTHEST = 0.2  # a step must not reach the next tongue
CLEARLY = 0.1  # of the imaginary part of complex roots: a smaller step proves them
ROUNDS = 3  # steps that are not smaller than the previous one: then only rounding remains
NARROW = 0.2  # half width over ζη, below which damping has certainly closed a tongue; at 1 it closes it for small Q
ROUNDING = 4.0  # times eps
UNKNOWN = 0.05  # a tenth of the distance between tongues: an edge with a larger error is unknown to the harmonics
WRONG_TONGUE = 1e-6  # an edge with a larger error belongs to another tongue
ORDER_GROWTH, FARTHEST_ORDER = 2, 160
BY_MONODROMY = "harmonic balance, refined by monodromy matrices"


@frozen(eq=False)
class Monodromy:
    """Map of one turn at each of L points.

    Attributes
    ----------
    matrix : ndarray (L, 2, 2), dimensionless
        (ζ, ζ') after one turn as a function of the values before it.
    slope : ndarray (L, 2, 2), dimensionless
        Its derivative by η.
    det : ndarray (L,), dimensionless
        Its determinant by Liouville's formula.
    error : ndarray (L,), dimensionless
        Bound of the error of an entry in coordinates (2πη ζ, ζ'), which give all entries the same size.
    """

    matrix: np.ndarray
    slope: np.ndarray
    det: np.ndarray
    error: np.ndarray

    @property
    def trace(self) -> np.ndarray:
        """Traces (L,), dimensionless: the sum of both multipliers."""
        return np.trace(self.matrix, axis1=1, axis2=2)

    @property
    def growth(self) -> np.ndarray:
        """Logarithm (L,), dimensionless, of the largest |multiplier|: growth per turn, negative where it decays."""
        return growth(self.trace, self.det)


def size(matrix: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """Largest entry of each matrix, in coordinates (2πη ζ, ζ') that give all entries the same size.

    Parameters
    ----------
    matrix : ndarray (L, 2, 2), dimensionless
    eta : ndarray (L,), dimensionless

    Returns
    -------
    ndarray (L,), dimensionless
    """
    scale = 2.0 * pi * np.maximum(eta, 0.1)
    entries = np.abs(matrix) * np.stack((np.ones_like(scale), scale, 1.0 / scale, np.ones_like(scale)), -1).reshape(
        -1, 2, 2
    )
    return np.asarray(entries.max(axis=(1, 2)))


def determinant(matrix: np.ndarray) -> np.ndarray:
    """Determinants of 2 x 2 matrices.

    Parameters
    ----------
    matrix : ndarray (L, 2, 2), dimensionless

    Returns
    -------
    ndarray (L,), dimensionless
    """
    return np.asarray(matrix[:, 0, 0] * matrix[:, 1, 1] - matrix[:, 0, 1] * matrix[:, 1, 0])


def growth(trace: np.ndarray, det: np.ndarray) -> np.ndarray:
    """Logarithm of the larger |root| of μ² - trace μ + det.

    Parameters
    ----------
    trace, det : ndarray (L,), dimensionless
        det > 0.

    Returns
    -------
    ndarray (L,), dimensionless
    """
    half, root = 0.5 * np.abs(trace), np.sqrt(det)
    beyond = np.sqrt(np.maximum(half - root, 0.0)) * np.sqrt(half + root)  # half² may overflow
    return np.where(beyond > 0.0, np.log(np.where(beyond > 0.0, half + beyond, 1.0)), np.log(root))


@lru_cache(maxsize=1)
def _collocation() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Integration matrix (NODES, NODES), its square, and the columns for the slope and the value at the end.

    All multiply from the right and are contiguous for that, which makes the product five times as fast.
    """
    x, b = gauss(NODES)
    once = integration(NODES)
    return once.T.copy(), (once @ once).T.copy(), np.stack((b * (1.0 - x), b), axis=1)


def monodromy(
    coefficients: Coefficients, eta: np.ndarray, q: np.ndarray, equation: str = EXACT, damping: float = 0.0
) -> Monodromy:
    """Monodromy matrices of the linear equation.

    Parameters
    ----------
    coefficients : Coefficients
    eta, q : ndarray (L,), dimensionless
        Frequency ratio η and Q of the points.
    equation : str
        Key of `EQUATIONS`.
    damping : float
        Damping ratio ζ_d.

    Returns
    -------
    Monodromy

    References
    ----------
    Kim1990 (21).
    """
    eta, q = np.broadcast_arrays(np.atleast_1d(np.asarray(eta, dtype=float)), np.asarray(q, dtype=float))
    nodes = coefficients.panels.count * NODES
    batch = max(1, BATCH // nodes)
    if eta.size > batch:
        parts = [
            monodromy(coefficients, eta[i : i + batch], q[i : i + batch], equation, damping)
            for i in range(0, eta.size, batch)
        ]
        return Monodromy(*(np.concatenate([getattr(p, f) for p in parts]) for f in ("matrix", "slope", "det", "error")))
    narrow = _narrowed(coefficients, float(eta.max(initial=0.0)), float(q.max(initial=0.0)), equation)
    return _one_turn(narrow, eta, q, equation, damping)


def _narrowed(coefficients: Coefficients, eta: float, q: float, equation: str) -> Coefficients:
    """Coefficients on panels over which their own fastest wave has at most the phase ``PHASE``."""
    w, p = weight_and_potential(coefficients, equation, np.array([q]))
    fastest = np.sqrt(np.abs(eta * eta * w[0] + p[0]).max(axis=1))
    panels = coefficients.panels.split(PHASE / np.maximum(fastest, 1e-300))
    return coefficients if panels is coefficients.panels else replace(coefficients, panels=panels)


def _one_turn(coefficients: Coefficients, eta: np.ndarray, q: np.ndarray, equation: str, damping: float) -> Monodromy:
    panels = coefficients.panels
    maps, slopes, decay = _panel_terms(coefficients, eta, q, equation, damping)
    matrix, slope = _product(maps, slopes)
    error = 8.0 * EPS * panels.count**0.5 * size(matrix, eta) + 0.5 * panels.tail * eta * size(slope, eta)
    return Monodromy(matrix, slope, np.exp(-decay), error)


def _panel_terms(
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
    """Deviation |Π det M_i / exp(-4π ζ_d η ∫ dy/D) - 1| of the maps M_i of the panels, and its rounding.

    It is computed panel by panel, since no panel grows much. The determinant of the full turn is the small difference
    of two
    products: where a turn grows by e^20 it has no correct digit, however accurate the matrix is.

    Parameters
    ----------
    coefficients : Coefficients
    eta : ndarray (L,), dimensionless
    q : float
    equation : str
        Key of `EQUATIONS`.
    damping : float
        Damping ratio ζ_d.

    Returns
    -------
    deviation, rounding : ndarray (L,), dimensionless
        The deviation, zero in exact arithmetic, and the bound of its rounding.
    """
    rows = np.full(eta.shape, q)
    narrow = _narrowed(coefficients, float(eta.max(initial=0.0)), q, equation)
    maps, _, decay = _panel_terms(narrow, eta, rows, equation, damping)
    m = np.abs(maps)
    products = (m[..., 0, 0] * m[..., 1, 1] + m[..., 0, 1] * m[..., 1, 0]).sum(axis=1)
    full_turn = determinant(maps.reshape(-1, 2, 2)).reshape(maps.shape[:2]).prod(axis=1)
    return np.abs(full_turn * np.exp(decay) - 1.0), 16.0 * EPS * products


def zeros_at_standstill(coefficients: Coefficients, q: float, equation: str = EXACT) -> int:
    """Number of sign changes of the solution ζ(0) = 1, ζ'(0) = 0 over a turn at η = 0.

    By Sturm's oscillation theorem the edges of tongue n have n zeros in a turn, and the number of zeros grows with η²:
    with
    n + 2 at η = 0, both edges of that tongue are at η² < 0. A panel has at most one zero, since the phase of its
    fastest wave
    is at most ``PHASE`` < π.
    """
    narrow = _narrowed(coefficients, 0.0, q, equation)
    maps = _panel_terms(narrow, np.zeros(1), np.array([q]), equation, 0.0)[0][0]
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

    Collocation for v = ζ'' at the nodes, by sweeps, each of which reduces the error by phase² / 50 or better.
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
    maps = np.empty((*p0.shape[:2], 2, 2))
    for j in range(2):
        maps[..., 0, j] = (width if j else 1.0) + width * width * end[j, ..., 0]
        maps[..., 1, j] = j + width * end[j, ..., 1]
    # dF/dη = F ∫ Φ⁻¹ (0, -∂p0 φ - ∂p1 φ')
    force = p0_slope * value
    if p1_slope is not None:
        force += p1_slope * speed
    weight = h * b
    if p1 is not None:
        weight = weight / (value[0] * speed[1] - value[1] * speed[0])
    inner = np.empty_like(maps)
    for j in range(2):
        inner[..., 0, j] = (weight * value[1] * force[j]).sum(axis=-1)
        inner[..., 1, j] = -(weight * value[0] * force[j]).sum(axis=-1)
    return maps, maps @ inner


def _largest(values: np.ndarray) -> float:
    """Largest absolute value, without a temporary array."""
    return float(max(values.max(), -values.min()))


def _product(maps: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Map (L, 2, 2) of consecutive panels, and its derivative, by pairs."""
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
    """Tongues 1 ... count to the target error of η, with or without damping.

    By harmonic balance where ``most_order`` harmonics reach the target; else, and always with damping, refined by
    monodromy
    matrices. Where the refinement from few harmonics does not converge to an edge it is repeated from more harmonics.

    Parameters
    ----------
    coefficients : Coefficients
    q : ndarray (rows,), dimensionless
    count : int
    equation : str
        Key of `EQUATIONS`.
    damping : float
        Damping ratio ζ_d.
    error : float
        Target error of the edges η; the `error` of the result is what was reached.
    most_order : int
        Highest order of the harmonic balance.

    Returns
    -------
    Tongues
    """
    result = harmonic_tongues(coefficients, q, count, equation, error, most_order)
    if damping == 0.0 and float(result.error.max(initial=0.0)) <= error:
        return result
    result = refined(coefficients, result, damping)
    failed = np.flatnonzero(np.nanmax(result.error, axis=1, initial=0.0) > max(error, WRONG_TONGUE))
    if failed.size and most_order < FARTHEST_ORDER:
        order = min(ORDER_GROWTH * most_order, FARTHEST_ORDER)
        return with_rows(
            result, failed, tongues(coefficients, result.q[failed], count, equation, damping, error, order)
        )
    return result


def refined(coefficients: Coefficients, harmonic: Tongues, damping: float = 0.0) -> Tongues:
    """Tongues refined to the accuracy of the monodromy matrices; NaN where damping has closed them."""
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
    """Set the error of edges at 0 that are not proven to be there.

    An edge is at 0 where the harmonics give a negative η². Where these are not accurate enough (``UNKNOWN``) and the
    zeros of
    the solution do not prove it either, the error (rows count, 2) is that of the harmonics.
    """
    rows, count = harmonic.error.shape
    numbers = np.tile(np.arange(1, count + 1), rows)
    unsure = (edges == 0.0) & (harmonic.error.reshape(-1, 1) > UNKNOWN)
    for row in sorted({at // count for at in np.flatnonzero(unsure.any(axis=1)).tolist()}):
        proven = numbers + 2 <= zeros_at_standstill(coefficients, float(harmonic.q[row]), harmonic.equation)
        unsure[row * count : (row + 1) * count] &= ~proven[:count, None]
    error[unsure] = np.repeat(harmonic.error.reshape(-1, 1), 2, axis=1)[unsure]


@frozen(eq=False)
class _Pencil:
    """The two roots δ = middle ± √discriminant (L,) of det(E + δK) = 0, and the bound of their rounding."""

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
    # without damping K is a definite matrix rotated by 90°: its smaller eigenvalue bounds the error of both roots
    error = turn.error * size(k, eta) / np.abs(square)
    # where a turn grows a millionfold, det E is the small difference of large products
    rounding = ROUNDING * EPS * (np.abs(e[:, 0, 0] * e[:, 1, 1]) + np.abs(e[:, 0, 1] * e[:, 1, 0])) / np.abs(square)
    error = error + rounding / np.maximum(np.sqrt(np.abs(discriminant) + rounding), 1e-300)
    if damping:  # the error of two roots that coincide grows like a square root
        half_distance = np.sqrt(np.abs(discriminant))
        reach = np.abs(middle) + half_distance
        error = error * np.maximum(1.0, reach / np.maximum(half_distance, np.sqrt(error * reach + error**2)))
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
    """The lower (side -1) or upper (+1) edge near each η (L,), and its error.

    The edge is 0 where η² would be negative, and NaN where the tongue is closed.
    """
    eta, error = start.copy(), np.zeros(start.size)
    previous, stuck = np.full(eta.size, np.inf), np.zeros(eta.size, dtype=int)
    at = np.arange(eta.size)
    for _ in range(STEPS):
        if at.size == 0:
            break
        pair = pencil(eta[at], q[at], sign[at])
        step = pair.middle + side * np.sqrt(np.maximum(pair.discriminant, 0.0))
        eta[at] = np.maximum(eta[at] + np.clip(step, -FARTHEST, FARTHEST), 0.0)
        length = np.abs(step)
        # the next step would be the square of this one; where steps do not shrink, the error is unknown
        error[at] = pair.error + np.where(length <= CLOSE * (1.0 + eta[at]), step * step, length)
        stuck[at] = np.where(length < 0.5 * previous[at], 0, stuck[at] + 1)
        previous[at] = length
        converged = (length <= CLOSE * (1.0 + eta[at])) | (stuck[at] >= ROUNDS) | (eta[at] == 0.0)
        if damped:
            eta[at[converged & (pair.discriminant < -pair.error * (np.abs(pair.middle) + np.sqrt(pair.error)))]] = (
                np.nan
            )
        at = at[~converged]
    return eta, error
