"""One turn of the steady response: what the wind-up does to shaft and followers, and of which harmonics it is made.

The cam stands 2πβ behind the input, θ_c = θ_i - 2πβ: each follower is where it should have been that much earlier, and the shaft
carries K_s (θ_i - θ_c). All by the angle of the input θ_i, which is the machine's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from math import ceil, pi

import numpy as np

from core.frozen import frozen
from core.motion import TURN, Angles
from core.motion.extremes import Range, find_extremes
from core.motion.turn import all_ends
from core.numerics.gauss import gauss
from core.stability.contact import ShaftContacts
from core.stability.hill.coefficients import EQUATIONS, Coefficients, gauss_points
from core.stability.hill.forced import forced_response
from core.stability.steady_response import SteadyResponse, steady_response
from core.stability.windup import History, history

LEAST_HARMONICS = 20
TABLE, NEWTON = (
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
        for _ in range(NEWTON):
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
    def _ranges(self) -> Mapping[str, Range]:
        def values(angles: Angles) -> Mapping[str, np.ndarray]:
            found = {"": self.wind_up(angles.theta)}
            return found | {str(i): self.error(angles.theta, i) for i in range(len(self.followers))}

        return find_extremes(
            values, _Pieces(all_ends([TURN * self.history.steps.y, *(each.joins for each in self.followers)]))
        )

    @property
    def wind_up_range(self) -> Range:
        """Refined lowest and highest θ_i - θ_c [rad], by the angle of the input."""
        return self._ranges[""]

    @property
    def errors(self) -> tuple[Range, ...]:
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
