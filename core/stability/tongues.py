"""Instability tongues as eigenvalues: all of a row of Q at once, with their own error (Kim1990 §5).

A tongue's edges are the η at which ζ'' + 4π²(η² w + p) ζ = 0 has a solution of one turn (n even) or two (n odd):
[R² - T[p]] a = η² T[w] a, R the harmonics, T[f] multiplication by f. Kim1990 (32) asks for zeros of a determinant, which
overflows at 60 harmonics, on a grid that steps over narrow tongues.

Solved the other way round, T[w] a = μ [R² - T[p] + σ T[w]] a with μ = 1/(η² + σ) and each harmonic scaled by its size:
then rounding does not grow with the order N, while that of η² itself grows like eps N² and from N ≈ 50 on eats what more
harmonics bring. What the harmonics beyond N do enters by second-order perturbation of each pair of edges.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.errors import NoStability
from core.frozen import frozen
from core.motion import EPS
from core.numerics.lazy import checkpoint
from core.stability.coefficients import (
    CENTRIPETAL,
    EXACT,
    LOAD,
    Basis,
    Coefficients,
    basis,
    fourier,
    inertia_and_pull,
    product,
    toeplitz,
    truncation,
    weight_and_potential,
)

# -- instability tongues as eigenvalues -------------------------------------------------------------------------


ETA_MAX = 5.6  # of a chart, as Kim1990 Fig. 8 has it
EDGE_ERROR = 1e-9  # wanted of an edge η
LEAST_ORDER, MOST_ORDER = 8, 40
SPARE = 6  # harmonics above those of the highest requested tongue
GROWTH = 1.4
ROUNDING = 32.0  # times eps times the condition
SHIFTS = (1.0, 4.0, 16.0, 0.25, 64.0, 0.05, 1e3, 2e4, 4e5)  # tried in turn; a load that does much needs a large one


@frozen(eq=False)
class Tongues:
    """The tongues of one equation.

    equation  row of ``EQUATIONS``
    q         (rows,) the Q of each row
    edges     (rows, n, 2) lower and upper η of the tongues 1 ... n, which stand at η ≈ n/2; 0 where η² is negative
    error     (rows, n) what each edge may be wrong by
    bottom    (rows,) below this η all is unstable, 0 where nothing is
    order     highest harmonic taken into the matrices
    damping   ratio ζ; where it closes a tongue the edges are nan
    method    ``harmonic balance``, or how its edges were refined
    """

    equation: str
    q: np.ndarray
    edges: np.ndarray
    error: np.ndarray
    bottom: np.ndarray
    order: int
    damping: float = 0.0
    method: str = "harmonic balance"

    @property
    def count(self) -> int:
        """How many tongues there are."""
        return self.edges.shape[1]


def count_up_to(eta_max: float) -> int:
    """How many tongues may reach below an η: one at each half, and one more whose lower edge may."""
    return max(1, int(np.floor(2.0 * eta_max + 1e-9)))


def harmonic_tongues(
    coefficients: Coefficients,
    q: np.ndarray,
    count: int,
    equation: str = EXACT,
    error: float = EDGE_ERROR,
    most_order: int = MOST_ORDER,
) -> Tongues:
    """Tongues 1 ... count of the rows q (rows,), without damping, by as many harmonics as the wanted error needs.

    ``error`` of the answer says what was reached: with ``most_order`` it may be more than was wanted.
    """
    q = np.atleast_1d(np.asarray(q, dtype=float))
    order = max(LEAST_ORDER, (count + 1) // 2 + SPARE)
    result = tongues_of_order(coefficients, q, count, order, equation)
    while True:
        poor = np.flatnonzero(result.error.max(axis=1, initial=0.0) > error)
        if poor.size == 0 or order >= most_order:
            return result
        order = min(most_order, int(np.ceil(order * GROWTH)))
        result = with_rows(result, poor, tongues_of_order(coefficients, q[poor], count, order, equation))


def with_rows(all_rows: Tongues, at: np.ndarray, better: Tongues) -> Tongues:
    """All rows, those ``at`` (k,) taken from a better answer of k rows."""
    edges, error, bottom = all_rows.edges.copy(), all_rows.error.copy(), all_rows.bottom.copy()
    edges[at], error[at], bottom[at] = better.edges, better.error, better.bottom
    return replace(better, q=all_rows.q, edges=edges, error=error, bottom=bottom)


def tongues_of_order(
    coefficients: Coefficients, q: np.ndarray, count: int, order: int, equation: str = EXACT
) -> Tongues:
    """The same with harmonics up to ``order``; what those above do, up to three times as high, is added.

    Raises ValueError where the order has no room for so many tongues.
    """
    q = np.atleast_1d(np.asarray(q, dtype=float))
    if (count + 1) // 2 > order:
        raise ValueError(f"order {order}: {count} tongues need harmonics up to {(count + 1) // 2}")
    w, p = weight_and_potential(coefficients, equation, q)
    panels = coefficients.panels
    reach = 3 * order
    # a harmonic of the outer block times one of the inner
    both = fourier(panels, np.stack((w, p)), reach + order)
    truncated = truncation(panels, np.stack((w, p)))
    squares = np.empty((q.size, count, 2))
    errors = np.empty((q.size, count))
    bottom = np.zeros(q.size)
    for half in (False, True):
        checkpoint()
        inner, outer = basis(-1, order, half), basis(order, reach, half)
        pairs = count // 2 if not half else (count + 1) // 2
        skip = 0 if half else 1  # the lowest of the whole harmonics has no partner
        wanted = 2 * pairs + skip
        if wanted == 0:
            continue
        try:
            square, wrong = _lowest(both, truncated, inner, outer, wanted, skip)
        except np.linalg.LinAlgError:
            raise NoStability(
                f"at Q = {q.max():.6g} the load is stiffer than the shaft: it does not hold the cam",
                "shaft.stiffness_nm_per_rad",
                "make it larger, or Q smaller",
            ) from None
        if not half:
            bottom = np.sqrt(np.maximum(square[:, 0], 0.0))
        at = slice(0, None, 2) if half else slice(1, None, 2)
        squares[:, at] = square[:, skip:].reshape(q.size, pairs, 2)
        errors[:, at] = wrong[:, skip:].reshape(q.size, pairs, 2).max(axis=2)
    edges = np.sqrt(np.maximum(squares, 0.0))
    # of η² into η, and η itself where η² may be 0
    lower = np.maximum(edges[..., 0], np.sqrt(errors))
    known = (lower > 0.0) & np.isfinite(errors)
    wrong = np.where(known, errors / np.where(known, lower, 1.0), errors)
    return Tongues(equation, q, edges, wrong, bottom, order)


def _lowest(
    fourier_of: np.ndarray, truncated: np.ndarray, inner: Basis, outer: Basis, wanted: int, skip: int
) -> tuple[np.ndarray, np.ndarray]:
    """The lowest η² (rows, wanted) in rising order, and what they may be wrong by; Fourier coefficients of w and p (2,
    rows, order + 1) and what is wrong with these (2, rows)."""
    top = float(inner.numbers[-1] if wanted >= inner.numbers.size else np.sort(inner.numbers)[wanted - 1])
    tw, tp = product(fourier_of, inner, inner)
    mu, vectors, shift = _inverted(tw, tp, inner, top)
    # the largest μ are the lowest η²
    mu, vectors = mu[:, : -wanted - 1 : -1], vectors[:, :, : -wanted - 1 : -1]
    square = 1.0 / mu - shift
    wrong = ROUNDING * EPS * (square + shift) ** 2 * np.abs(mu[:, :1])
    wrong += truncated[1][:, None] + np.abs(square) * truncated[0][:, None]
    square, left_out = _beyond(fourier_of, inner, outer, square, vectors / np.sqrt(mu)[:, None, :], skip)
    return square, wrong + left_out


def _inverted(tw: np.ndarray, tp: np.ndarray, inner: Basis, top: float) -> tuple[np.ndarray, np.ndarray, float]:
    """All μ (rows, n) rising and the vectors (rows, n, n) with aᵀ [R² - T[p] + σ T[w]] a = 1, and σ. Raises LinAlgError
    where no σ makes the matrix in brackets definite."""
    square = inner.numbers**2
    shift = max(1.0, 0.25 * top * top)
    for factor in SHIFTS:
        sigma = factor * shift
        scale = 1.0 / np.sqrt(square + sigma)
        pencil = sigma * tw - tp
        pencil[:, range(square.size), range(square.size)] += square
        try:
            lower = np.linalg.cholesky(pencil * (scale[:, None] * scale))
        except np.linalg.LinAlgError:
            continue
        back = np.linalg.inv(lower)
        mu, vectors = np.linalg.eigh(back @ (tw * (scale[:, None] * scale)) @ back.swapaxes(1, 2))
        return mu, scale[:, None] * (back.swapaxes(1, 2) @ vectors), sigma
    raise np.linalg.LinAlgError


def _beyond(
    fourier_of: np.ndarray, inner: Basis, outer: Basis, square: np.ndarray, vectors: np.ndarray, skip: int
) -> tuple[np.ndarray, np.ndarray]:
    """η² with the harmonics of the outer block, pair by pair, and how much they changed (rows, wanted).

    λ_ij -> λ_ij - Σ_r ρ_ri ρ_rj / (r² - p_0 - λ w_0), ρ = (T[p] + λ T[w]) a: the two edges of a narrow tongue are mixed by
    what is beyond, so each pair is diagonalised together.
    """
    wanted, (cw, cp) = square.shape[1], fourier_of
    by_w, by_p = product(fourier_of, outer, inner) @ vectors
    residual = by_p + square[:, None, :] * by_w
    stiff = outer.numbers[:, None] ** 2 - cp.real[:, :1, None] - cw.real[:, :1, None] * square[:, None, :]
    weighted = residual / stiff
    parts = residual * weighted
    corrected, change = square.copy(), np.abs(parts).sum(axis=1)
    own = parts.sum(axis=1)
    if skip:
        corrected[:, 0] -= own[:, 0]
    first, second = slice(skip, wanted, 2), slice(skip + 1, wanted, 2)
    cross = (residual[..., first] * weighted[..., second]).sum(axis=1)
    a, b = square[:, first] - own[:, first], square[:, second] - own[:, second]
    middle, apart = 0.5 * (a + b), np.hypot(0.5 * (a - b), cross)
    corrected[:, first], corrected[:, second] = middle - apart, middle + apart
    # what is left: the outer harmonics' pull on each other, and those beyond reach, which fall like r⁻⁴ or faster
    pull = 2.0 * (np.abs(cp[:, None, 1:]) + np.abs(square[..., None]) * np.abs(cw[:, None, 1:])).sum(axis=2)
    farthest = outer.numbers > 2.0 * outer.numbers.min()
    least = stiff.min(axis=1)
    with np.errstate(divide="ignore"):
        wrong = change * pull / least + 0.5 * np.abs(parts[:, farthest]).sum(axis=1)
    return corrected, np.where(least > 0.0, wrong, np.inf)  # harmonics that the load outweighs are not beyond


# -- the linear forced response ---------------------------------------------------------------------------------


ORDER = 96  # least number of harmonics that are balanced


def forced_response(
    coefficients: Coefficients, eta: float, q: float, damping: float = 0.0, equation: str = EXACT, highest: int = 24
) -> np.ndarray:
    """Fourier coefficients c_0 ... c_highest (highest + 1,) of β [turns] by the angle of the input, those of -k conjugate; nan where
    η stands on the edge of a tongue, so that there is none.

    κ = C' has a delta function where C jumps: its coefficients are ik times those of C.
    """
    order = max(ORDER, 4 * highest)
    load = eta * eta if coefficients.fixed else 1.0
    inertia, pull, slope = inertia_and_pull(coefficients, equation, np.array([q]))
    rows = coefficients.panels.values
    push = q * (rows[CENTRIPETAL] + load * rows[LOAD])
    d, c, psi, right = fourier(coefficients.panels, np.concatenate((inertia, pull, slope, push[None])), 2 * order)
    r = np.arange(-order, order + 1)
    turning = load * psi + 1j * np.arange(c.size) * c
    matrix = toeplitz(turning, r.size) - r[:, None] * toeplitz(d, r.size) * r
    matrix += np.diag(eta * eta + 2j * damping * eta * r)
    right = right[: order + 1]
    try:
        found = np.linalg.solve(matrix, np.concatenate((right[:0:-1].conj(), right)) / (2.0 * np.pi))
    except np.linalg.LinAlgError:
        return np.full(highest + 1, np.nan + 0j)
    return np.asarray(found[order : order + highest + 1])
