"""The steady response: wind-up that repeats with every turn, and whether it is stable, the last word on a point of the chart.

Shooting: a state (β, Π) that one turn of the nonlinear equation (13) brings back to itself, by Newton's method with the
exact derivatives of that turn. Small departures from it obey
D δ'' + 4πQC (1-β_p') δ' + [4π²η² + 4π²Q (κ (1-β_p')² + ψ) - 2π D_θ β_p''] δ = 0, whose multipliers are those derivatives'
eigenvalues. Near whole η the response is a resonance that bends over: there are several, found along the branch by its
arc length, through its folds.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from functools import cached_property
from math import ceil, pi
from typing import TypeAlias, TypeVar

import numpy as np

from core.frozen import frozen
from core.motion import TURN, Angles
from core.motion.extremes import Extremes, find_extremes
from core.motion.program import piece_ends
from core.numerics.roots import gauss
from core.stability.coefficients import EQUATIONS, Coefficients, gauss_points
from core.stability.floquet import determinant, growth
from core.stability.integrator import Integrator
from core.stability.tongues import forced_response
from core.stability.windup import History, ShaftContacts, history

# -- the steady response ----------------------------------------------------------------------------------------


NEWTON_STEPS = 30
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
    for _ in range(NEWTON_STEPS):
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


# -- one turn of the steady response ----------------------------------------------------------------------------


LEAST_HARMONICS = 20
TABLE, TURN_NEWTON_STEPS = (
    2048,
    3,
)  # angles of the input over a turn, and refinements, that find where the cam is at an angle of its own
LEAST_RATE = 0.1  # of the cam, in parts of the input's, that a refinement reckons with


@frozen(eq=False)
class Follower:
    """A follower that the shaft drives.

    name          of its drive, '' where there is one alone
    unit          of its motion, mm or deg
    displacement  [m or rad] (n,) at angles of the camshaft (n,) [rad]
    joins         angles of the camshaft [rad] at which its motion's pieces begin
    """

    name: str
    unit: str
    displacement: Callable[[np.ndarray], np.ndarray]
    joins: np.ndarray


@frozen(eq=False)
class SteadyTurn:
    """A steady response over one turn of the input; stiffness K_s [N m/rad].

    ``history`` is the one turn from its state; where it loses contact the equation holds no longer.
    """

    response: SteadyResponse
    history: History
    stiffness: float
    followers: tuple[Follower, ...] = ()

    def wind_up(self, theta: np.ndarray) -> np.ndarray:
        """θ_i - θ_c (n,) [rad] at angles of the input (n,) [rad]."""
        return TURN * self.history.at(np.mod(theta, TURN) / TURN)[0]

    def wind_up_at_cam(self, theta: np.ndarray) -> np.ndarray:
        """θ_i - θ_c (n,) [rad] when the cam stands at the angles θ_c (n,) [rad]; where it turns back and stands there three times, at one
        of them."""
        even = TURN * np.arange(-TABLE // 4, 5 * TABLE // 4 + 1) / TABLE
        cam = np.maximum.accumulate(even - self.wind_up(even))
        there = np.interp(np.mod(theta, TURN), cam, even)
        for _ in range(TURN_NEWTON_STEPS):
            beta, rate = self.history.at(np.mod(there, TURN) / TURN)
            step = (there - TURN * beta - np.mod(theta, TURN)) / np.maximum(1.0 - rate, LEAST_RATE)
            there = there - np.clip(step, -TURN / TABLE, TURN / TABLE)
        return self.wind_up(there)

    def torque(self, theta: np.ndarray) -> np.ndarray:
        """K_s (θ_i - θ_c) (n,) [N m], > 0 where it drives the cam."""
        return self.stiffness * self.wind_up(theta)

    def error(self, theta: np.ndarray, number: int = 0) -> np.ndarray:
        """X(θ_c) - X(θ_i) (n,) [m or rad] of a follower: how far it is from where a rigid shaft would have it."""
        moved = self.followers[number].displacement
        return np.asarray(moved(np.mod(theta - self.wind_up(theta), TURN)) - moved(np.mod(theta, TURN)))

    # -- figures --------------------------------------------------------------------------------------------

    @cached_property
    def _ranges(self) -> Mapping[str, Extremes]:
        def values(angles: Angles) -> Mapping[str, np.ndarray]:
            found = {"": self.wind_up(angles.theta)}
            return found | {str(i): self.error(angles.theta, i) for i in range(len(self.followers))}

        return find_extremes(
            values, _Pieces(piece_ends([TURN * self.history.steps.y, *(each.joins for each in self.followers)]))
        )

    @property
    def wind_up_range(self) -> Extremes:
        """Refined lowest and highest θ_i - θ_c [rad], by the angle of the input."""
        return self._ranges[""]

    @property
    def errors(self) -> tuple[Extremes, ...]:
        """The same of each follower's error [m or rad]."""
        return tuple(self._ranges[str(i)] for i in range(len(self.followers)))

    @property
    def mean_torque(self) -> float:
        """Mean of the torque in the shaft over the turn [N m]."""
        return float(TURN * self.stiffness * self.harmonics(0)[0].real)

    @property
    def torque_amplitude(self) -> float:
        """Half of highest less lowest torque in the shaft [N m], which tires it."""
        return 0.5 * self.stiffness * (self.wind_up_range.high.value - self.wind_up_range.low.value)

    # -- harmonics ------------------------------------------------------------------------------------------

    @property
    def highest(self) -> int:
        """How many harmonics tell of it: beyond that of the shaft's own frequency, η."""
        return max(LEAST_HARMONICS, ceil(2.0 * self.response.eta))

    def harmonics(self, highest: int | None = None) -> np.ndarray:
        """Fourier coefficients c_0 ... c_highest (highest + 1,) of β [turns] by the angle of the input: ∫ β e^{-2πiky} dy, each step's
        polynomial integrated to rounding."""
        last = self.highest if highest is None else highest
        steps = self.history.steps
        part, weight = gauss(gauss_points(pi * last * float(steps.h.max())))
        y = steps.y[:, None] + steps.h[:, None] * part
        beta = steps.within(part[None])[..., 0]
        waves = np.exp(-2j * pi * np.arange(last + 1)[:, None, None] * y)
        return np.asarray(np.einsum("kns,ns,n,s->k", waves, beta, steps.h, weight))

    def linear(self, highest: int | None = None) -> Mapping[str, np.ndarray]:
        """The same of the linear forced response (Kim1990 (27), γ = 0) by (21) and by (22)."""
        at, run = self.response, self.history
        last = self.highest if highest is None else highest
        return {name: forced_response(run.coefficients, at.eta, at.q, at.damping, name, last) for name in EQUATIONS}


def sum_of(harmonics: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """The real function (n,) of Fourier coefficients c_0 ... c_k at angles (n,) [rad]."""
    twice = np.where(np.arange(harmonics.size) == 0, 1.0, 2.0) * harmonics
    return np.asarray((twice @ np.exp(1j * np.arange(harmonics.size)[:, None] * theta)).real)


def steady_turn(
    coefficients: Coefficients,
    eta: float,
    q: float,
    damping: float = 0.0,
    contact: ShaftContacts | None = None,
    stiffness: float = 1.0,
    followers: Sequence[Follower] = (),
) -> SteadyTurn | None:
    """The steady response at a point of the chart; None where there is none."""
    response = steady_response(coefficients, eta, q, damping)
    if response is None:
        return None
    state = (float(response.state[0]), float(response.state[1]))
    return SteadyTurn(
        response, history(coefficients, eta, q, damping, 1.0, state, contact), stiffness, tuple(followers)
    )


class _Pieces:
    """Of a turn, between their ends (m + 1,) [rad]."""

    def __init__(self, ends: np.ndarray) -> None:
        self.starts, self.ends = ends[:-1], ends[1:]
