"""The flexible camshaft's linear equation: tongue edges of Kim1990's cam, and its monodromy matrices, with damping.

What a reader of the paper would take: the printed determinant on a grid of η, its matrices as an eigenvalue problem,
and a solver for ordinary differential equations for the trace of the monodromy matrix.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact_shafts import DAMPING, ETAS, SAFETY
from benchmarks.exact_shafts import Q as EXACT_Q
from benchmarks.table import Channels, Kernel, Method
from shafts import KIM, of

from core.stability import EXACT, monodromy, tongues

Q, A = float(EXACT_Q), float(SAFETY)
COUNT = 11  # tongues
STEP = 4e-3  # of the grid in η on which edges are looked for
REACH = 0.22  # a tongue n is looked for so far on both sides of n/2
TAU = 2.0 * np.pi
Trace = Callable[[np.ndarray], np.ndarray]


def kim(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """d, C, ψ of X = (1 - cos 2θ)/2 on half the turn and rest on the other."""
    moves = np.mod(theta, TAU) < np.pi
    psi = 2.0 * A * (np.cos(2.0 * theta) - np.cos(4.0 * theta))
    return (np.where(moves, f, 0.0) for f in (np.sin(2.0 * theta) ** 2, np.sin(4.0 * theta), psi))  # type: ignore[return-value]


def hill(theta: np.ndarray, q: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """w, p and QC/D² and 1/D of ζ'' + 4πζ_d η/D ζ' + 4π² (η² w + p - 2 ζ_d η QC/D²) ζ = 0."""
    d, c, psi = kim(theta)
    whole = 1.0 + q * d
    return 1.0 / whole, q * psi / whole + (q * c / whole) ** 2, q * c / whole**2, 1.0 / whole


# -- monodromy matrices -----------------------------------------------------------------------------------


Samples = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def step_samples(steps: int, q: float) -> Samples:
    """The coefficients at the ends and middles of so many steps."""
    return hill(np.arange(2 * steps + 1) * (TAU / (2 * steps)), q)


def by_fixed_steps(eta: np.ndarray, samples: Samples, damping: float) -> np.ndarray:
    """Runge and Kutta's four slopes a step, all η (L,) at once; matrices (L, 2, 2)."""
    w, p, pull, drag = samples
    steps = w.size // 2
    h, lanes = 1.0 / steps, eta[:, None]
    z, v = (np.tile(row, (eta.size, 1)) for row in np.eye(2))

    def slope(i: int, z: np.ndarray, v: np.ndarray) -> np.ndarray:
        force = TAU * TAU * (lanes * lanes * w[i] + p[i] - 2.0 * damping * lanes * pull[i])
        return -force * z - 2.0 * TAU * damping * lanes * drag[i] * v

    for i in range(0, 2 * steps, 2):
        a1, k1 = v, slope(i, z, v)
        a2, k2 = v + h / 2 * k1, slope(i + 1, z + h / 2 * a1, v + h / 2 * k1)
        a3, k3 = v + h / 2 * k2, slope(i + 1, z + h / 2 * a2, v + h / 2 * k2)
        a4, k4 = v + h * k3, slope(i + 2, z + h * a3, v + h * k3)
        z = z + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        v = v + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return np.stack((z, v), axis=1)


def gauss_samples(steps: int, q: float) -> Samples:
    """The coefficients at Gauss's two points of so many steps, (2, steps) each."""
    at = (np.arange(steps) + 0.5 + np.array([[-0.5], [0.5]]) / np.sqrt(3.0)) * (TAU / steps)
    return tuple(f.reshape(2, steps) for f in hill(at.ravel(), q))  # type: ignore[return-value]


def by_magnus(eta: np.ndarray, samples: Samples, damping: float) -> np.ndarray:
    """Magnus' exponentials of fourth order of all steps and all η (L,) at once, multiplied pair by pair."""
    w, p, pull, drag = (f[:, :, None] for f in samples)
    steps = w.shape[1]
    h = 1.0 / steps
    force = -TAU * TAU * (eta * eta * w + p - 2.0 * damping * eta * pull)  # A = ((0, 1), (force, brake))
    brake = -2.0 * TAU * damping * eta * drag
    c = np.sqrt(3.0) / 12.0 * h * h
    f, g = 0.5 * h * (force[0] + force[1]), 0.5 * h * (brake[0] + brake[1])
    # the commutator of the two ends
    a = c * (force[0] - force[1])
    b, d = h + c * (brake[0] - brake[1]), f + c * (force[0] * brake[1] - brake[0] * force[1])
    half, along = 0.5 * g, a - 0.5 * g
    square = along * along + b * d
    root = np.sqrt(np.abs(square))
    even = np.where(square > 0.0, np.cosh(root), np.cos(root))
    odd = np.where(square > 0.0, np.sinh(root), np.sin(root)) / np.where(root > 0.0, root, 1.0)
    grown = np.exp(half)
    rows = (grown * (even + along * odd), grown * b * odd, grown * d * odd, grown * (even - along * odd))
    while rows[0].shape[0] > 1:  # later steps from the left; so many that they halve
        (p00, p01, p10, p11), (q00, q01, q10, q11) = [r[0::2] for r in rows], [r[1::2] for r in rows]
        rows = (q00 * p00 + q01 * p10, q00 * p01 + q01 * p11, q10 * p00 + q11 * p10, q10 * p01 + q11 * p11)
    return np.stack([r[0] for r in rows], axis=-1).reshape(-1, 2, 2)


LANES = 48  # of one call of a solver: LSODA keeps the square of so many


def by_solver(eta: np.ndarray, q: float, damping: float, setting: tuple[str, float]) -> np.ndarray:
    """scipy's solve_ivp over one turn, some η at once."""
    from scipy.integrate import solve_ivp

    method, tolerance = setting
    told = []
    for part in range(0, eta.size, LANES):
        lanes = eta[part : part + LANES, None]

        def slopes(y: float, x: np.ndarray, lanes: np.ndarray = lanes) -> np.ndarray:
            w, p, pull, drag = hill(np.array([TAU * y]), q)
            z, v = x.reshape(2, -1, 2)
            force = TAU * TAU * (lanes * lanes * w + p - 2.0 * damping * lanes * pull)
            return np.concatenate((v, -force * z - 2.0 * TAU * damping * lanes * drag * v)).ravel()

        start = np.repeat(np.eye(2)[:, None], lanes.size, axis=1).ravel()
        solved = solve_ivp(slopes, (0.0, 1.0), start, method, rtol=tolerance, atol=tolerance)
        told.append(solved.y[:, -1].reshape(2, lanes.size, 2).swapaxes(0, 1))
    return np.concatenate(told)


def _entries(matrices: np.ndarray) -> Channels:
    return list(matrices.reshape(-1, 4).T)


def our_matrices(there: Any, setting: None) -> Channels:
    """With their derivatives by η, what Liouville says of them and what they may be wrong by."""
    told = monodromy(there.coefficients, there.eta, np.full(there.eta.size, Q), EXACT, DAMPING)
    return _entries(told.matrix)


def fixed_matrices(there: Any, samples: Samples) -> Channels:
    return _entries(by_fixed_steps(there.eta, samples, DAMPING))


def magnus_matrices(there: Any, samples: Samples) -> Channels:
    parts = [by_magnus(part, samples, DAMPING) for part in np.array_split(there.eta, -(-there.eta.size // LANES))]
    return _entries(np.concatenate(parts))


def extrapolated_samples(there: Any, setting: tuple[int, int]) -> list[Samples]:
    """Of so many steps, of half as many, and so on."""
    steps, levels = setting
    return [gauss_samples(steps >> level, Q) for level in range(levels)]


def extrapolated_matrices(there: Any, samples: Sequence[Samples]) -> Channels:
    """The same with ever fewer steps, extrapolated by Richardson: even powers of the step from the fourth on."""
    told = [np.array(magnus_matrices(there, row)) for row in samples]
    for order in range(4, 2 + 2 * len(samples), 2):
        told = [fine + (fine - coarse) / (2.0**order - 1.0) for fine, coarse in pairwise(told)]
    return list(told[0])


def solved_matrices(there: Any, setting: tuple[str, float]) -> Channels:
    return _entries(by_solver(there.eta, Q, DAMPING, setting))


# -- tongue edges -----------------------------------------------------------------------------------------


def our_edges(there: Any, error: float) -> Channels:
    found = tongues(there.coefficients, there.q, COUNT, EXACT, error=error)
    return list(found.edges.reshape(there.q.size, -1).T)


def _halved(beyond: Trace, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """The zeros (m,) between low and high by false position, all at once (Illinois)."""
    f_low, f_high = beyond(low), beyond(high)
    low, high = low.copy(), high.copy()
    for _ in range(14):
        middle = (low * f_high - high * f_low) / np.where(f_high == f_low, 1.0, f_high - f_low)
        middle = np.where(f_high == f_low, 0.5 * (low + high), middle)
        f = beyond(middle)
        same = f * f_high > 0.0
        low, f_low = np.where(same, low, high), np.where(same, 0.5 * f_low, f_high)
        high, f_high = middle, f
    return high


def _scanned(functions: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """Edges (22,): changes of sign of functions(η, which is the tongue n) along the grid. Where a tongue falls between
    two of its values, a parabola through the nearest three tells where to look again; both edges stand there if that
    shows none either."""
    numbers = np.arange(1, COUNT + 1)
    offsets = np.arange(-REACH, REACH + STEP / 2, STEP)
    grid = numbers[:, None] / 2.0 + offsets
    values = functions(grid.ravel(), np.repeat(numbers, offsets.size)).reshape(grid.shape)
    out, ends = np.empty((COUNT, 2)), np.empty((COUNT, 2, 2))  # (tongue, side, ends of the cell)
    for i, row in enumerate(values):
        cells = np.flatnonzero(row[:-1] * row[1:] < 0.0)
        if cells.size >= 2:
            ends[i] = [grid[i, c : c + 2] for c in (cells[0], cells[-1])]
            continue
        k = int(np.clip(np.abs(row).argmin(), 1, row.size - 2))
        before, here, after = row[k - 1 : k + 2]
        top = grid[i, k] + 0.5 * STEP * (before - after) / (before - 2.0 * here + after)
        ends[i] = (grid[i, k - 1], top), (top, grid[i, k + 1])
    # the middle of a cell that was guessed may lie within the tongue or not
    tops = functions(ends[:, 0, 1], numbers)
    seen = (ends[:, 0, 1] != ends[:, 1, 0]) | (tops * values[:, 0] < 0.0)
    out[:] = ends[:, :1, 1]
    which = np.repeat(numbers[seen], 2)
    found = ends[seen].reshape(-1, 2)
    out[seen] = _halved(lambda eta: functions(eta, which), found[:, 0], found[:, 1]).reshape(-1, 2)
    return out.ravel()


def _by_trace(there: Any, matrices: Callable[[np.ndarray, float], np.ndarray]) -> Channels:
    """Where the trace of the monodromy matrix passes 2 (n even) or -2."""

    def row(q: float) -> np.ndarray:
        def beyond(eta: np.ndarray, number: np.ndarray) -> np.ndarray:
            told = matrices(eta, q)
            return np.where(number % 2 == 0, 1.0, -1.0) * (told[:, 0, 0] + told[:, 1, 1]) - 2.0

        return _scanned(beyond)

    return list(np.array([row(float(q)) for q in there.q]).T)


def fixed_trace(there: Any, steps: int) -> Channels:
    return _by_trace(there, lambda eta, q: by_fixed_steps(eta, step_samples(steps, q), 0.0))


def magnus_trace(there: Any, steps: int) -> Channels:
    return _by_trace(there, lambda eta, q: by_magnus(eta, gauss_samples(steps, q), 0.0))


def solved_trace(there: Any, setting: tuple[str, float]) -> Channels:
    return _by_trace(there, lambda eta, q: by_solver(eta, q, 0.0, setting))


def _toeplitz(order: int, points: int, q: float, half: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """R², T[w], T[p] of Kim1990 (27), (28) for (21): harmonics -N ... N, and half more where the period is two turns."""
    w, p, _, _ = hill(np.arange(points) * (TAU / points), q)
    number = np.arange(-order, order + 1) + 0.5 * half
    apart = (number[:, None] - number).astype(int)
    return np.diag(number**2), *(np.fft.fft(f)[apart] / points for f in (w, p))


Setting = tuple[int, int]  # N, points


def all_matrices(there: Any, setting: Setting) -> Any:
    return [[_toeplitz(*setting, float(q), half) for half in (False, True)] for q in there.q]


def determinant(there: Any, matrices: Any) -> Channels:
    def row(sizes: Any) -> np.ndarray:
        def values(eta: np.ndarray, number: np.ndarray) -> np.ndarray:
            out = np.empty(eta.size)
            for half in (False, True):
                mine = (number % 2 == 1) == half
                square, w, p = sizes[half]
                # each row divided by its size, so that the product does not overflow
                rows = (square - p - eta[mine, None, None] ** 2 * w) / (1.0 + np.diag(square))[:, None]
                out[mine] = np.linalg.det(rows).real
            return out

        return _scanned(values)

    return list(np.array([row(sizes) for sizes in matrices]).T)


def eigenvalues(there: Any, matrices: Any) -> Channels:
    from scipy.linalg import eigh

    def row(sizes: Any) -> np.ndarray:
        out = np.empty((COUNT, 2))
        for half in (False, True):
            square, w, p = sizes[half]
            eta = np.sqrt(np.maximum(eigh(square - p, w, eigvals_only=True), 0.0))
            for n in range(1 if half else 2, COUNT + 1, 2):
                out[n - 1] = eta[n - 1 : n + 1]
        return out.ravel()

    return list(np.array([row(sizes) for sizes in matrices]).T)


def symmetric_matrices(there: Any, setting: Setting) -> Any:
    """Counted from the middle of the lift the cam is the same both ways: cosines and sines part, and all is real."""
    order, points = setting
    made = []
    for q in there.q:
        w, p, _, _ = hill(np.arange(points) * (TAU / points) + 0.25 * TAU, float(q))
        c = [np.fft.rfft(f).real / points for f in (w, p)]
        blocks = []
        for half in (False, True):
            for sign in (1.0, -1.0):
                number = np.arange(0 if half or sign > 0.0 else 1, order + 1) + 0.5 * half
                apart, sums = (np.abs(number[:, None] - number).astype(int), (number[:, None] + number).astype(int))
                scale = np.where(number == 0.0, np.sqrt(0.5), 1.0)
                of_w, of_p = ((f[apart] + sign * f[sums]) * scale[:, None] * scale for f in c)
                blocks.append((np.diag(number**2) - of_p, of_w))
        made.append(blocks)
    return made


def symmetric_eigenvalues(there: Any, matrices: Any) -> Channels:
    from scipy.linalg import eigh

    def row(blocks: Any) -> np.ndarray:
        eta = [np.sqrt(np.maximum(eigh(a, b, eigvals_only=True), 0.0)) for a, b in blocks]
        out = np.empty((COUNT, 2))
        for n in range(1, COUNT + 1):
            even, odd = (eta[2], eta[3]) if n % 2 else (eta[0][1:], eta[1])
            pair = even[(n - 1) // 2], odd[(n - 1) // 2]
            out[n - 1] = min(pair), max(pair)
        return out.ravel()

    return list(np.array([row(blocks) for blocks in matrices]).T)


# -- rows -------------------------------------------------------------------------------------------------


def _given(**values: Any) -> SimpleNamespace:
    return SimpleNamespace(coefficients=of(KIM).coefficients, **values)


def _solvers(run: Callable[[Any, Any], Channels], tolerances: tuple[float, ...]) -> list[Method]:
    return [
        Method(f"solve_ivp {name}", run, tuple((name, tolerance) for tolerance in tolerances), "rtol")
        for name in ("DOP853",)
    ]


def _sampled(name: str, run: Any, samples: Callable[[int, float], Samples], steps: tuple[int, ...]) -> Method:
    return Method(name, run, steps, "steps", keeps=lambda there, count: samples(count, Q))


def _symmetric() -> Method:
    name = "harmonic matrices, even and odd apart"
    return Method(name, symmetric_eigenvalues, BY_MATRIX, "N, points", keeps=symmetric_matrices, special=True)


BY_MATRIX = ((20, 1024), (7, 128), (8, 256), (10, 512), (12, 512), (16, 1024), (28, 2048), (40, 4096), (60, 8192))

FINER = ((256, 3), (32, 2), (64, 2), (128, 2), (128, 3), (256, 2), (256, 4), (512, 3))

TONGUES = Kernel(
    "tongues",
    f"Tongue edges 1 … {COUNT} of a row of Q",
    given=lambda q: _given(q=q),
    grid=lambda n: Q * (1.0 - np.arange(n) / (2.0 * n)),
    methods=(
        Method("KINDYNA", our_edges, (1e-8, 1e-10, 1e-11, 1e-12, 1e-13), "wanted error", ours=True),
        Method("harmonic matrices, scipy's eigh", eigenvalues, BY_MATRIX, "N, points", keeps=all_matrices),
        _symmetric(),
        Method("determinant on a grid", determinant, ((10, 512), (20, 2048)), "N, points", keeps=all_matrices),
        Method("trace on a grid, RK4", fixed_trace, (200, 50), "steps"),
        Method("trace on a grid, Magnus", magnus_trace, (128, 64, 256), "steps"),
        replace(_solvers(solved_trace, (1e-6,))[0], name="trace on a grid, solve_ivp DOP853", one_by_one=True),
    ),
    roundings=8,
    digits=2e-15,
    handed="the cam's coefficients as functions of the cam angle",
    warm="matrices of the row of Q; what KINDYNA knows of the order of harmonics",
    sizes=(1, 4, 16, 64),
    usual=1,
    between=1,
    unit="rows of Q",
)

MONODROMY = Kernel(
    "monodromy",
    "Monodromy matrices, with damping",
    given=lambda eta: _given(eta=eta),
    grid=lambda n: np.linspace(ETAS[0], ETAS[-1], n),
    methods=(
        Method("KINDYNA", our_matrices, ours=True),
        _sampled("RK4, all at once", fixed_matrices, step_samples, (400, 100, 200, 800, 1600, 3200)),
        _sampled(
            "Magnus' exponentials, all at once", magnus_matrices, gauss_samples, (256, 32, 64, 128, 512, 1024, 2048)
        ),
        Method(
            "Magnus' exponentials, extrapolated",
            extrapolated_matrices,
            FINER,
            "steps, levels",
            keeps=extrapolated_samples,
        ),
        *_solvers(solved_matrices, (1e-6, 1e-3, 1e-4, 1e-5, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)),
    ),
    # the product of the panels, each good to some roundings
    roundings=32,
    digits=4e-15,
    handed="the cam's coefficients as functions of the cam angle, 100 points η",
    warm="samples of the coefficients; what KINDYNA knows of its series",
    sizes=(10, 100, 1000),
    usual=100,
    between=1,
    unit="points of the chart",
)
