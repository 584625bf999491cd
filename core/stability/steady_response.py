"""The steady response: wind-up that repeats with every turn, and whether it is stable, the last word on a point of the chart.

Shooting: a state (β, Π) that one turn of the nonlinear equation (13) brings back to itself, by Newton's method with the
exact derivatives of that turn. Small departures from it obey
D δ'' + 4πQC (1-β_p') δ' + [4π²η² + 4π²Q (κ (1-β_p')² + ψ) - 2π D_θ β_p''] δ = 0, whose multipliers are those derivatives'
eigenvalues. Near whole η the response is a resonance that bends over: there are several, found along the branch by its
arc length, through its folds.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from typing import TypeAlias, TypeVar

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

Turn = tuple[np.ndarray, np.ndarray]
"""What a turn misses its start by (2,), and its derivatives (2, 3) by β, Π and η."""
Found = TypeVar("Found")
Search: TypeAlias = Generator[np.ndarray, Turn, Found]
"""Gives points (β, Π, η) that it wants the turn of, and ends with what it has found."""


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
        """Trace of the monodromy matrix."""
        return float(np.trace(self.matrix))

    @property
    def growth(self) -> float:
        """ln of the largest |multiplier|: growth per turn of a small departure, negative where it dies away."""
        det = np.maximum(determinant(self.matrix[None]), 1e-300)
        return float(growth(np.array([self.trace]), det)[0])

    @property
    def stable(self) -> bool:
        """Whether no deviation from it grows over a turn."""
        return self.growth <= TOLERANCE


TOLERANCE = 1e-7  # of the growth, below which it is rounding: near a trace of 2 that is a root of its error


def steady_response(coefficients: Coefficients, eta: float, q: float, damping: float = 0.0) -> SteadyResponse | None:
    """The steady response at a point: the one that the branch leads to which passes η = n + 1/2 beside it, between two
    resonances; of two, from either side of a resonance, that of the smaller wind-up. None where neither reaches the point.
    """
    straight = shoot(coefficients, eta, q, damping, None)
    if straight is not None and (np.abs(straight.state - (0.0, 1.0)) < SMALL).all():
        return straight
    origins = sorted({np.floor(eta) + 0.5, np.ceil(eta) - 0.5})
    resting = _resting(coefficients, eta, q)
    searches = [_by_branch(resting, max(float(origin), 0.25), eta, q, damping, straight) for origin in origins]
    best = straight
    for response in _together(coefficients, q, damping, searches):
        if response is not None and (best is None or _relative_size(response.state) < _relative_size(best.state)):
            best = response
    return best


def _relative_size(state: np.ndarray) -> float:
    return float(np.abs((state - (0.0, 1.0)) / LARGEST).max())


def _resting(coefficients: Coefficients, eta: float, q: float) -> np.ndarray:
    """The state (2,) of an even turn."""
    return np.asarray(Integrator(coefficients, eta, q).resting()[0], dtype=float)


# -- searches that wait for turns ----------------------------------------------------------------------------
# Each asks for one turn at a time, by a point (β, Π, η), and is sent what that misses its start by and its derivatives: so several
# searches have their turns integrated at once.


def _turns(coefficients: Coefficients, points: np.ndarray, q: float, damping: float) -> list[Turn]:
    """What the turns from m points (m, 3) miss their starts by (2,), and their derivatives (2, 3) by β, Π and η."""
    integrator = Integrator(coefficients, points[:, 2], q, damping)
    turn = integrator.run(points[:, :2], 0.0, 1.0, change=True)
    assert turn.change is not None
    return list(zip(turn.x - points[:, :2], turn.change - np.eye(2, 3), strict=True))


def _together(coefficients: Coefficients, q: float, damping: float, searches: Sequence[Search[Found]]) -> list[Found]:
    """What each search finds."""
    found: dict[int, Found] = {}
    waiting: dict[int, np.ndarray] = {}

    def go_on(number: int, turn: Turn | None) -> None:
        try:
            waiting[number] = searches[number].send(turn)  # type: ignore[arg-type]
        except StopIteration as done:
            waiting.pop(number, None)
            found[number] = done.value

    for number in range(len(searches)):
        go_on(number, None)
    while waiting:
        numbers = list(waiting)
        made = _turns(coefficients, np.array([waiting[number] for number in numbers]), q, damping)
        for number, turn in zip(numbers, made, strict=True):
            go_on(number, turn)
    return [found[number] for number in range(len(searches))]


def _by_branch(
    resting: np.ndarray, origin: float, eta: float, q: float, damping: float, known: SteadyResponse | None
) -> Search[SteadyResponse | None]:
    """The response at η on the branch that starts at another η, ``origin``; None where the branch does not reach it, or only
    with a larger response than the one known already."""
    most = _relative_size(known.state) if known is not None else 1.0
    start = yield from _shooting(resting, origin, q, damping)
    if start is None:
        return None
    before, points = start, 0
    walk = _walking(start, float(np.sign(eta - start.eta)))
    turn: Turn | None = None
    while points < MOST_BY_BRANCH:
        try:
            point = walk.send(turn)  # type: ignore[arg-type]
        except StopIteration:
            return None
        if not isinstance(point, SteadyResponse):
            turn = yield point
            continue
        turn, points = None, points + 1
        if (point.eta - eta) * (before.eta - eta) <= 0.0:
            part = (eta - before.eta) / (point.eta - before.eta) if point.eta != before.eta else 0.0
            guess = before.state + part * (point.state - before.state)
            response = yield from _shooting(guess, eta, q, damping)
            return response if response is not None and _relative_size(response.state) < most else None
        if _relative_size(point.state) > most:
            return None
        before = point
    return None


def shoot(
    coefficients: Coefficients, eta: float, q: float, damping: float, guess: np.ndarray | None
) -> SteadyResponse | None:
    """The steady response near a guess (2,), or near an even turn; None where Newton's method does not settle."""
    start = _resting(coefficients, eta, q) if guess is None else np.asarray(guess, dtype=float)
    return _together(coefficients, q, damping, [_shooting(start, eta, q, damping)])[0]


def _shooting(start: np.ndarray, eta: float, q: float, damping: float) -> Search[SteadyResponse | None]:
    """Newton's method from a state (2,)."""
    state, best = start, None
    for _ in range(NEWTON):
        if _relative_size(state) > 2.0:
            return None
        miss, slopes = yield np.append(state, eta)
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


def branch(coefficients: Coefficients, start: SteadyResponse, direction: float) -> Iterator[SteadyResponse]:
    """Steady responses along the branch from one of them, at first towards larger (direction +1) or smaller (-1) η, through
    folds; ends where the branch cannot be followed or its responses exceed ``LARGEST``. The caller stops the iteration."""
    walk, turn = _walking(start, direction), None
    while True:
        try:
            point = walk.send(turn)  # type: ignore[arg-type]
        except StopIteration:
            return
        if isinstance(point, SteadyResponse):
            turn = None
            yield point
        else:
            turn = _turns(coefficients, point[None], start.q, start.damping)[0]


def _walking(start: SteadyResponse, direction: float) -> Generator[np.ndarray | SteadyResponse, Turn, None]:
    """The same, which asks for its turns: gives points that it wants the turn of, and responses that it has found."""
    q, damping = start.q, start.damping
    point = np.array([*start.state, start.eta])
    _, slopes = yield point
    tangent = _tangent(slopes)
    tangent *= np.sign(tangent[2]) * direction
    arc = ARC
    for _ in range(MOST_POINTS):
        corrected = yield from _correcting(point, tangent, arc)
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


def _tangent(slopes: np.ndarray) -> np.ndarray:
    """The unit vector, in scaled coordinates, along which nothing changes."""
    along = np.cross(slopes[0] / SCALE, slopes[1] / SCALE)
    return np.asarray(along / np.linalg.norm(along))


def _correcting(
    point: np.ndarray, tangent: np.ndarray, arc: float
) -> Search[tuple[np.ndarray, float, np.ndarray, int] | None]:
    """The point of the branch on the plane across the tangent at a distance; None where Newton's method fails."""
    new = point + arc * tangent / SCALE
    for sweep in range(8):
        if new[2] <= 0.0:
            return None
        miss, slopes = yield new
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
