"""The steady response: wind-up that repeats with every turn, and whether it is stable, the last word on a point of the chart.

Shooting: a state (β, Π) that one turn of the nonlinear equation (13) brings back to itself, by Newton's method with the
exact derivatives of that turn. Small departures from it obey
D δ'' + 4πQC (1-β_p') δ' + [4π²η² + 4π²Q (κ (1-β_p')² + ψ) - 2π D_θ β_p''] δ = 0, whose multipliers are those derivatives'
eigenvalues. Near whole η the response is a resonance that bends over: there are several, found along the branch by its
arc length, through its folds.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import numpy as np

from core.frozen import frozen
from core.stability.floquet import determinant, growth
from core.stability.hill.coefficients import Coefficients
from core.stability.integrator import Integrator

NEWTON = 30
CLOSE = 1e-13  # of the state, a turn must bring it back so well
FARTHEST = 0.1  # [wind-up, momentum] a step of Newton's method
ARC = 0.02  # first step along a branch
LONGEST_ARC, SHORTEST_ARC = 0.1, 1e-6
MOST_POINTS = 2000
MOST_BY_BRANCH = 60  # points of a branch from its origin to the wanted η
LARGEST = np.array([0.35, 2.5])  # wind-up [turns] and momentum beyond an even turn's at which a branch is left
SMALL = np.array([0.1, 0.3])  # the same, up to which a response found straight away is no resonance
SCALE = np.array([4.0, 1.0, 1.0])  # what β, Π and η count along the branch


@frozen(eq=False)
class SteadyResponse:
    """A steady response.

    state     (2,) β and Π at y = 0
    matrix    (2, 2) derivatives of one turn
    residual  how far a turn misses its start
    """

    eta: float
    q: float
    damping: float
    state: np.ndarray
    matrix: np.ndarray
    residual: float

    @property
    def trace(self) -> float:
        return float(np.trace(self.matrix))

    @property
    def growth(self) -> float:
        """ln of the largest |multiplier|: growth per turn of a small departure, negative where it dies away."""
        det = np.maximum(determinant(self.matrix[None]), 1e-300)
        return float(growth(np.array([self.trace]), det)[0])

    @property
    def stable(self) -> bool:
        return self.growth <= TOLERANCE


TOLERANCE = 1e-7  # of the growth, below which it is rounding: near a trace of 2 that is a root of its error


def steady_response(coefficients: Coefficients, eta: float, q: float, damping: float = 0.0) -> SteadyResponse | None:
    """The steady response at a point: the one that the branch leads to which passes η = n + 1/2 beside it, between two
    resonances; of two, from either side of a resonance, that of the smaller wind-up. None where neither reaches the point.
    """
    straight = shoot(coefficients, eta, q, damping, None)
    if straight is not None and (np.abs(straight.state - (0.0, 1.0)) < SMALL).all():
        return straight
    best = straight
    for origin in sorted({np.floor(eta) + 0.5, np.ceil(eta) - 0.5}):
        response = _by_branch(coefficients, max(float(origin), 0.25), eta, q, damping, best)
        best = response if response is not None else best
    return best


def _relative_size(state: np.ndarray) -> float:
    return float(np.abs((state - (0.0, 1.0)) / LARGEST).max())


def _by_branch(
    coefficients: Coefficients, origin: float, eta: float, q: float, damping: float, known: SteadyResponse | None
) -> SteadyResponse | None:
    """The response at η on the branch that starts at another η, ``origin``; None where the branch does not reach it, or only
    with a larger response than the one known already."""
    most = _relative_size(known.state) if known is not None else 1.0
    start = shoot(coefficients, origin, q, damping, None)
    if start is None:
        return None
    before = start
    for point in islice(branch(coefficients, start, np.sign(eta - start.eta)), MOST_BY_BRANCH):
        if (point.eta - eta) * (before.eta - eta) <= 0.0:
            part = (eta - before.eta) / (point.eta - before.eta) if point.eta != before.eta else 0.0
            guess = before.state + part * (point.state - before.state)
            response = shoot(coefficients, eta, q, damping, guess)
            return response if response is not None and _relative_size(response.state) < most else None
        if _relative_size(point.state) > most:
            return None
        before = point
    return None


def shoot(
    coefficients: Coefficients, eta: float, q: float, damping: float, guess: np.ndarray | None
) -> SteadyResponse | None:
    """The steady response near a guess (2,), or near an even turn; None where Newton's method does not settle."""
    if guess is None:
        guess = Integrator(coefficients, eta, q, damping).resting()[0]
    state, best = np.asarray(guess, dtype=float), None
    for _ in range(NEWTON):
        if _relative_size(state) > 2.0:
            return None
        miss, slopes = _derivatives(coefficients, np.append(state, eta), q, damping)
        if not np.isfinite(miss).all():
            return None
        residual = float(np.abs(miss).max())
        if best is not None and residual >= best.residual and residual <= 1e3 * CLOSE:
            return best  # rounding is all that is left
        best = SteadyResponse(eta, q, damping, state, slopes[:, :2] + np.eye(2), residual)
        if residual <= CLOSE * (1.0 + np.abs(state).max()):
            return best
        try:
            step = np.linalg.solve(-slopes[:, :2], miss)
        except np.linalg.LinAlgError:
            return None
        state = state + step * min(1.0, FARTHEST / max(float(np.abs(step).max()), 1e-300))
    return None


def branch(
    coefficients: Coefficients, start: SteadyResponse, direction: float
) -> Iterator[SteadyResponse]:
    """Steady responses along the branch from one of them, at first towards larger (direction +1) or smaller (-1) η, through
    folds; ends where the branch cannot be followed or its responses exceed ``LARGEST``. The caller stops the iteration."""
    q, damping = start.q, start.damping
    point = np.array([*start.state, start.eta])
    tangent = _tangent(_derivatives(coefficients, point, q, damping)[1])
    tangent *= np.sign(tangent[2]) * direction
    arc = ARC
    for _ in range(MOST_POINTS):
        corrected = _corrected(coefficients, point, tangent, arc, q, damping)
        if corrected is None:
            arc *= 0.5
            if arc < SHORTEST_ARC:
                return
            continue
        new, miss, slopes, sweeps = corrected
        turned = _tangent(slopes)
        turned *= np.sign(turned @ tangent)
        if turned @ tangent < 0.9 and arc > SHORTEST_ARC:  # the branch bends too sharply for such a step
            arc *= 0.5
            continue
        point, tangent = new, turned
        if _relative_size(point[:2]) > 1.0:
            return
        yield SteadyResponse(float(point[2]), q, damping, point[:2], slopes[:, :2] + np.eye(2), miss)
        arc = min(LONGEST_ARC, arc * (1.5 if sweeps <= 4 else 0.7))


def _derivatives(
    coefficients: Coefficients, point: np.ndarray, q: float, damping: float
) -> tuple[np.ndarray, np.ndarray]:
    """What a turn misses its start by (2,), and its derivatives (2, 3) by β, Π and η."""
    integrator = Integrator(coefficients, point[2], q, damping)
    turn = integrator.run(point[None, :2], 0.0, 1.0, change=True)
    assert turn.change is not None
    return turn.x[0] - point[:2], turn.change[0] - np.eye(2, 3)


def _tangent(slopes: np.ndarray) -> np.ndarray:
    """The unit vector, in scaled coordinates, along which nothing changes."""
    along = np.cross(slopes[0] / SCALE, slopes[1] / SCALE)
    return np.asarray(along / np.linalg.norm(along))


def _corrected(
    coefficients: Coefficients, point: np.ndarray, tangent: np.ndarray, arc: float, q: float, damping: float
) -> tuple[np.ndarray, float, np.ndarray, int] | None:
    """The point of the branch on the plane across the tangent at a distance; None where Newton's method fails."""
    new = point + arc * tangent / SCALE
    for sweep in range(8):
        if new[2] <= 0.0:
            return None
        miss, slopes = _derivatives(coefficients, new, q, damping)
        if not np.isfinite(miss).all():
            return None
        matrix = np.vstack((slopes / SCALE, tangent))
        try:
            step = np.linalg.solve(matrix, np.append(-miss, 0.0))
        except np.linalg.LinAlgError:
            return None
        if np.abs(step).max() > 4.0 * arc:
            return None
        new = new + step / SCALE
        if np.abs(step).max() <= 1e-9:
            return new, float(np.abs(miss).max()), slopes, sweep
    return None
