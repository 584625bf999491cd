"""The flexible camshaft's linear equation: tongue edges of Kim1990's cam, and its monodromy matrices, with damping.

What a reader of the paper would take: the printed determinant on a grid of η, its matrices as an eigenvalue problem,
and a solver for ordinary differential equations for the trace of the monodromy matrix.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact import DAMPING, ETAS, SAFETY, Q
from benchmarks.table import Channels, Kernel, Method
from shafts import KIM, of

from core.stability import EXACT, monodromy, tongues

A = SAFETY
COUNT = 11  # tongues
TAU = 2.0 * np.pi


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


def _entries(matrices: np.ndarray) -> Channels:
    return list(matrices.reshape(-1, 4).T)


def our_matrices(there: Any, setting: None) -> Channels:
    """With their derivatives by η, what Liouville says of them and what they may be wrong by."""
    told = monodromy(there.coefficients, there.eta, np.full(there.eta.size, Q), EXACT, DAMPING)
    return _entries(told.matrix)


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


# -- tongue edges -----------------------------------------------------------------------------------------


def our_edges(there: Any, error: float) -> Channels:
    found = tongues(there.coefficients, there.q, COUNT, EXACT, error=error)
    return list(found.edges.reshape(there.q.size, -1).T)


def _toeplitz(order: int, points: int, q: float, half: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """R², T[w], T[p] of Kim1990 (27), (28) for (21): harmonics -N ... N, and half more where the period is two turns."""
    w, p, _, _ = hill(np.arange(points) * (TAU / points), q)
    number = np.arange(-order, order + 1) + 0.5 * half
    apart = (number[:, None] - number).astype(int)
    return np.diag(number**2), *(np.fft.fft(f)[apart] / points for f in (w, p))


Setting = tuple[int, int]  # N, points


def all_matrices(there: Any, setting: Setting) -> Any:
    return [[_toeplitz(*setting, float(q), half) for half in (False, True)] for q in there.q]


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
    ),
    handed="the cam's coefficients as functions of the cam angle",
    warm="matrices of the row of Q; KINDYNA's data on the order of harmonics",
    rival=("harmonic matrices, scipy's eigh", (20, 1024)),
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
    ),
    handed="the cam's coefficients as functions of the cam angle, 100 points η",
    warm="samples of the coefficients; KINDYNA's data on its series",
    rival=("Magnus' exponentials, extrapolated", (256, 4)),
    usual=100,
    between=1,
    unit="points of the chart",
)
