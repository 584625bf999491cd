"""The steady response: the wind-up that repeats with every turn, and its stability.

Shooting: a state (β, Π) that one turn of the nonlinear equation (13) brings back to itself, by Newton's method with the
exact derivatives of that turn. Small departures from it obey
D δ'' + 4πQC (1-β_p') δ' + [4π²η² + 4π²Q (κ (1-β_p')² + ψ) - 2π D_θ β_p''] δ = 0, whose multipliers are the
eigenvalues of those derivatives. Near integer η the resonance curve folds: there are several responses, computed along
the branch by its arc length, through its folds.
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
CLOSE = 1e-13  # greatest residual of a turn, relative to the state
FARTHEST = 0.1  # [wind-up, momentum] longest step of Newton's method
ARC = 0.02  # first step along a branch
LONGEST_ARC, SHORTEST_ARC = 0.1, 1e-6
MOST_POINTS = 2000
MOST_BY_BRANCH = 60  # points of a branch from its origin to the target η
LARGEST = np.array([0.35, 2.5])  # wind-up [turns] and momentum beyond an even turn's at which a branch ends
SMALL = np.array([0.1, 0.3])  # the same, below which the response from an even turn is no resonance
SCALE = np.array([4.0, 1.0, 1.0])  # weights of β, Π and η in the arc length of the branch

Turn = tuple[np.ndarray, np.ndarray]
"""Difference (2,) between the end and the start of a turn, and its derivatives (2, 3) by β, Π and η."""
Result = TypeVar("Result")
Search: TypeAlias = Generator[np.ndarray, Turn, Result]
"""Yields points (β, Π, η) whose turn it requests, and returns its result."""


@frozen(eq=False)
class SteadyResponse:
    """A steady response.

    Attributes
    ----------
    state : ndarray (2,) [turns], dimensionless
        β and Π at y = 0.
    matrix : ndarray (2, 2), dimensionless
        Derivatives of one turn.
    residual : float
        Difference between end and start of the turn.
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
        """Logarithm of the largest |multiplier|: growth per turn of a small departure, negative where it decays."""
        det = np.maximum(determinant(self.matrix[None]), 1e-300)
        return float(growth(np.array([self.trace]), det)[0])

    @property
    def stable(self) -> bool:
        """Whether no small departure grows over a turn."""
        return self.growth <= TOLERANCE


TOLERANCE = 1e-7  # growth below it is rounding, near a trace of 2 the square root of the trace's error


def steady_response(coefficients: Coefficients, eta: float, q: float, damping: float = 0.0) -> SteadyResponse | None:
    """The steady response at a point of the chart.

    It belongs to the branch through the nearest η = n + 1/2, between two resonances; of the two branches from both
    sides of
    a resonance, to that with the smaller wind-up. None where neither reaches the point.
    """
    direct = shoot(coefficients, eta, q, damping, None)
    if direct is not None and (np.abs(direct.state - (0.0, 1.0)) < SMALL).all():
        return direct
    origins = sorted({np.floor(eta) + 0.5, np.ceil(eta) - 0.5})
    resting = _resting(coefficients, eta, q)
    searches = [_by_branch(resting, max(float(origin), 0.25), eta, q, damping, direct) for origin in origins]
    best = direct
    for response in _run_searches(coefficients, q, damping, searches):
        if response is not None and (best is None or _relative_size(response.state) < _relative_size(best.state)):
            best = response
    return best


def _relative_size(state: np.ndarray) -> float:
    """Distance of a state from an even turn, relative to ``LARGEST``."""
    return float(np.abs((state - (0.0, 1.0)) / LARGEST).max())


def _resting(coefficients: Coefficients, eta: float, q: float) -> np.ndarray:
    """The state (2,) of an even turn."""
    return np.asarray(Integrator(coefficients, eta, q).resting()[0], dtype=float)


# -- searches as generators ----------------------------------------------------------------------------------
# A search yields the point (β, Π, η) of a turn and is sent the result of that turn, so that the turns of several
# searches are integrated together.


def _turns(coefficients: Coefficients, points: np.ndarray, q: float, damping: float) -> list[Turn]:
    """Differences (2,) of end and start of the turns from m points (m, 3), and derivatives (2, 3) by β, Π, η."""
    integrator = Integrator(coefficients, points[:, 2], q, damping)
    turn = integrator.run(points[:, :2], 0.0, 1.0, change=True)
    assert turn.change is not None
    return list(zip(turn.x - points[:, :2], turn.change - np.eye(2, 3), strict=True))


def _run_searches(
    coefficients: Coefficients, q: float, damping: float, searches: Sequence[Search[Result]]
) -> list[Result]:
    """Result of each search."""
    results: dict[int, Result] = {}
    waiting: dict[int, np.ndarray] = {}

    def resume(number: int, turn: Turn | None) -> None:
        try:
            waiting[number] = searches[number].send(turn)  # type: ignore[arg-type]
        except StopIteration as stop:
            waiting.pop(number, None)
            results[number] = stop.value

    for number in range(len(searches)):
        resume(number, None)
    while waiting:
        numbers = list(waiting)
        turns = _turns(coefficients, np.array([waiting[number] for number in numbers]), q, damping)
        for number, turn in zip(numbers, turns, strict=True):
            resume(number, turn)
    return [results[number] for number in range(len(searches))]


def _by_branch(
    resting: np.ndarray, origin: float, eta: float, q: float, damping: float, known: SteadyResponse | None
) -> Search[SteadyResponse | None]:
    """The response at η on the branch that starts at another η, ``origin``.

    None where the branch does not reach it, or only with a larger response than the known one.
    """
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
    """The steady response near a guess, by Newton's method.

    Parameters
    ----------
    coefficients : Coefficients
    eta, q, damping : float
    guess : ndarray (2,) [turns], dimensionless, or None
        State (β, Π); None for that of an even turn.

    Returns
    -------
    SteadyResponse or None
        None where Newton's method does not converge.
    """
    start = _resting(coefficients, eta, q) if guess is None else np.asarray(guess, dtype=float)
    return _run_searches(coefficients, q, damping, [_shooting(start, eta, q, damping)])[0]


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
            return best  # only rounding remains
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
    """Steady responses along the branch from one of them, at first towards larger (+1) or smaller (-1) η.

    The branch passes through folds; it ends where it cannot be continued or its responses exceed ``LARGEST``.
    """
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
    """Walk along the branch: yields points whose turn it requests, and responses that it has computed."""
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
        new_tangent = _tangent(slopes)
        new_tangent *= np.sign(new_tangent @ tangent)
        if new_tangent @ tangent < 0.9 and arc > SHORTEST_ARC:  # the branch curves too sharply for this step
            arc *= 0.5
            continue
        point, tangent = new, new_tangent
        if _relative_size(point[:2]) > 1.0:
            return
        yield SteadyResponse(float(point[2]), q, damping, point[:2], slopes[:, :2] + np.eye(2), miss)
        arc = min(LONGEST_ARC, arc * (1.5 if sweeps <= 4 else 0.7))


def _tangent(slopes: np.ndarray) -> np.ndarray:
    """Unit vector of the branch in scaled coordinates."""
    along = np.cross(slopes[0] / SCALE, slopes[1] / SCALE)
    return np.asarray(along / np.linalg.norm(along))


def _correcting(
    point: np.ndarray, tangent: np.ndarray, arc: float
) -> Search[tuple[np.ndarray, float, np.ndarray, int] | None]:
    """Point of the branch on the plane across the tangent at a distance; None where Newton's method fails."""
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
TABLE = 2048  # angles of the input over a turn, from which the input angle at a cam angle is interpolated
TURN_NEWTON_STEPS = 3  # refinements of that angle
LEAST_RATE = 0.1  # least speed of the cam in a refinement, relative to the input's


@frozen(eq=False)
class Follower:
    """A follower that the shaft drives.

    Attributes
    ----------
    name : str
        Name of its drive; '' in a design of one drive.
    unit : str
        Unit of its motion, mm or deg.
    displacement : callable
        [m or rad] (n,) at angles of the camshaft (n,) [rad].
    joins : ndarray (k,) [rad]
        Angles of the camshaft at which its motion's pieces begin.
    """

    name: str
    unit: str
    displacement: Callable[[np.ndarray], np.ndarray]
    joins: np.ndarray


@frozen(eq=False)
class SteadyTurn:
    """A steady response over one turn of the input.

    Attributes
    ----------
    response : SteadyResponse
    history : History
        The turn from its state; the equation does not hold where it loses contact.
    stiffness : float
        K_s [N m/rad].
    followers : tuple of Follower
    """

    response: SteadyResponse
    history: History
    stiffness: float
    followers: tuple[Follower, ...] = ()

    def wind_up(self, theta: np.ndarray) -> np.ndarray:
        """Wind-up θ_i - θ_c by the angle of the input.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Angle of the input θ_i.

        Returns
        -------
        ndarray (n,) [rad]

        References
        ----------
        Kim1990 (13).
        """
        return TURN * self.history.at(np.mod(theta, TURN) / TURN)[0]

    def wind_up_at_cam(self, theta: np.ndarray) -> np.ndarray:
        """Wind-up θ_i - θ_c by the angle of the cam; where the cam passes it three times, at one of them.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Cam angle θ_c.

        Returns
        -------
        ndarray (n,) [rad]
        """
        even = TURN * np.arange(-TABLE // 4, 5 * TABLE // 4 + 1) / TABLE
        cam = np.maximum.accumulate(even - self.wind_up(even))
        input_angle = np.interp(np.mod(theta, TURN), cam, even)
        for _ in range(TURN_NEWTON_STEPS):
            beta, rate = self.history.at(np.mod(input_angle, TURN) / TURN)
            step = (input_angle - TURN * beta - np.mod(theta, TURN)) / np.maximum(1.0 - rate, LEAST_RATE)
            input_angle = input_angle - np.clip(step, -TURN / TABLE, TURN / TABLE)
        return self.wind_up(input_angle)

    def torque(self, theta: np.ndarray) -> np.ndarray:
        """Torque in the shaft K_s (θ_i - θ_c), positive where it drives the cam.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Angle of the input.

        Returns
        -------
        ndarray (n,) [N m]

        References
        ----------
        Kim1990 §1.
        """
        return self.stiffness * self.wind_up(theta)

    def error(self, theta: np.ndarray, number: int = 0) -> np.ndarray:
        """Error X(θ_c) - X(θ_i) of a follower relative to a rigid shaft.

        Parameters
        ----------
        theta : ndarray (n,) [rad]
            Angle of the input.
        number : int
            Index of the follower.

        Returns
        -------
        ndarray (n,) [m or rad]

        References
        ----------
        Kim1990 §1.
        """
        displacement = self.followers[number].displacement
        actual = displacement(np.mod(theta - self.wind_up(theta), TURN))
        return np.asarray(actual - displacement(np.mod(theta, TURN)))

    # -- figures --------------------------------------------------------------------------------------------

    @cached_property
    def _ranges(self) -> Mapping[str, Extremes]:
        def values(angles: Angles) -> Mapping[str, np.ndarray]:
            wind_up = {"": self.wind_up(angles.theta)}
            return wind_up | {str(i): self.error(angles.theta, i) for i in range(len(self.followers))}

        return find_extremes(
            values, _Pieces(piece_ends([TURN * self.history.steps.y, *(follower.joins for follower in self.followers)]))
        )

    @property
    def wind_up_range(self) -> Extremes:
        """Refined lowest and highest θ_i - θ_c [rad], by the angle of the input."""
        return self._ranges[""]

    @property
    def errors(self) -> tuple[Extremes, ...]:
        """Refined lowest and highest error of each follower [m or rad]."""
        return tuple(self._ranges[str(i)] for i in range(len(self.followers)))

    @property
    def mean_torque(self) -> float:
        """Mean of the torque in the shaft over the turn [N m]."""
        return float(TURN * self.stiffness * self.harmonics(0)[0].real)

    @property
    def torque_amplitude(self) -> float:
        """Half the difference of the highest and lowest torque in the shaft [N m], its fatigue load."""
        return 0.5 * self.stiffness * (self.wind_up_range.high.value - self.wind_up_range.low.value)

    # -- harmonics ------------------------------------------------------------------------------------------

    @property
    def highest(self) -> int:
        """Highest harmonic of the tables: well above the shaft's own frequency η."""
        return max(LEAST_HARMONICS, ceil(2.0 * self.response.eta))

    def harmonics(self, highest: int | None = None) -> np.ndarray:
        """Fourier coefficients ∫ β e^{-2πiky} dy by the angle of the input, integrated to rounding.

        Parameters
        ----------
        highest : int or None
            Highest harmonic; None for `highest` of the turn.

        Returns
        -------
        ndarray (highest + 1,) complex [turns]
        """
        last = self.highest if highest is None else highest
        steps = self.history.steps
        part, weight = gauss(gauss_points(pi * last * float(steps.h.max())))
        y = steps.y[:, None] + steps.h[:, None] * part
        beta = steps.within(part[None])[..., 0]
        waves = np.exp(-2j * pi * np.arange(last + 1)[:, None, None] * y)
        return np.asarray(np.einsum("kns,ns,n,s->k", waves, beta, steps.h, weight))

    def linear(self, highest: int | None = None) -> Mapping[str, np.ndarray]:
        """Fourier coefficients of the linear forced responses by (21) and by (22).

        Parameters
        ----------
        highest : int or None
            Highest harmonic; None for `highest` of the turn.

        Returns
        -------
        dict of ndarray (highest + 1,) complex [turns]
            By key of `EQUATIONS`.

        References
        ----------
        Kim (1990), eq. (27) with γ = 0.
        """
        at, run = self.response, self.history
        last = self.highest if highest is None else highest
        return {name: forced_response(run.coefficients, at.eta, at.q, at.damping, name, last) for name in EQUATIONS}


def fourier_sum(harmonics: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """The real function with Fourier coefficients c_0 ... c_k.

    Parameters
    ----------
    harmonics : ndarray (k + 1,) complex, dimensionless
        The result has their unit.
    theta : ndarray (n,) [rad]

    Returns
    -------
    ndarray (n,), dimensionless
    """
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
    """One turn of the steady response at a point of the chart; None where it has none."""
    response = steady_response(coefficients, eta, q, damping)
    if response is None:
        return None
    state = (float(response.state[0]), float(response.state[1]))
    return SteadyTurn(
        response, history(coefficients, eta, q, damping, 1.0, state, contact), stiffness, tuple(followers)
    )


class _Pieces:
    """Pieces of a turn between their ends (m + 1,) [rad]."""

    def __init__(self, ends: np.ndarray) -> None:
        self.starts, self.ends = ends[:-1], ends[1:]
