"""The wind-up of the shaft in time, from rest or from any state, by the nonlinear equation (13) of Kim1990.

Samples of it within the steps of the integrator, the integrals of its size, and its means over the first turn from rest by η,
for some rows of Q (Kim1990 Figs. 6, 7).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from core.cam import CamShape
from core.dynamics import Loading, OutputForce, newton_euler
from core.errors import NoStability
from core.frozen import frozen
from core.mechanism.kinematics import Kinematics
from core.motion import TURN, Angles, CompiledMotion
from core.stability.by_cam import follow
from core.stability.coefficients import RETUNED, Coefficients, Sizes
from core.stability.integrator import OUTSIDE, STAGES, IntegrationStep, OnPieces, WindUpEquation
from core.stability.panels import Panels, fit, powers
from core.stability.tongues import ETA_MAX

# -- the contact force of a cam that does not turn evenly -------------------------------------------------------


KinematicsAndShapeAt = Callable[[Angles], tuple[Kinematics, CamShape]]


@frozen(eq=False)
class Touching:
    """A follower on its cam, one of those that a shaft drives.

    at       its kinematics and its cam's shape at any of its own angles
    program  pieces of its motion by its own angle
    sizes    its own, by which its valve spring is retuned; without inertia it has none
    own      its own angles at those of the shaft, and +1, or -1 where they fall as the shaft turns
    name     of its drive, and number in the list of drives
    """

    at: KinematicsAndShapeAt
    loading: Loading
    program: CompiledMotion
    sizes: Sizes
    own: Callable[[Angles], Angles] = lambda angles: angles
    sense: float = 1.0
    name: str = ""
    number: int = 0


@frozen(eq=False)
class ShaftContacts:
    """Contact forces of k followers by the shaft's angle, as multiples of M X''m ω², M = max J / X'm².

    panels  for each follower rows f_0 (to be multiplied by η² where the loads are fixed), f_v, f_a
    fixed   as in ``Coefficients``
    moves   (k, m) False on panels where the follower dwells
    unit    M X''m [N s²]: times ω² it is the force 1
    names   of the drives, and their numbers in the list (k,)
    """

    panels: Panels
    fixed: bool
    moves: np.ndarray
    unit: float
    names: tuple[str, ...] = ("",)
    numbers: tuple[int, ...] = (0,)

    def force(
        self, values: np.ndarray, eta: float | np.ndarray, speed: np.ndarray, acceleration: np.ndarray
    ) -> np.ndarray:
        """f (...) from the rows ``values`` (3, ...) at the cam angles, speed θ̇/ω and acceleration θ̈/ω²."""
        standing = values[0] * (eta * eta if self.fixed else 1.0)
        return np.asarray(standing + values[1] * speed * speed + values[2] * acceleration)


def contact(
    followers: Sequence[Touching], turn: Any, sizes: Sizes, spring: str, factor: float, q: float, stiffness: float
) -> ShaftContacts:
    """The contact forces of a machine: Q, K_s [N m/rad]; turn: pieces of the shaft's turn, in none of which one of the followers has a
    join; sizes: of all together. Raises NoSolution where there is no cam."""
    unit = _unit(sizes)
    # F_0 / (M X''m ω²) = η² F_0 I_c / (K_s M X''m)
    scale = unit if spring == RETUNED else unit * q * stiffness / sizes.inertia

    def held(each: Touching) -> Loading:
        if spring != RETUNED:
            return each.loading.frictionless
        rate = factor * _unit(each.sizes) / each.sizes.stroke if each.sizes.inertia else 0.0
        return Loading((), (OutputForce(rate * each.sizes.lowest, rate),))

    loads = [(each, held(each), each.loading.inertial) for each in followers]

    def functions(angles: Angles) -> np.ndarray:
        rows = []
        for each, standing, inertial in loads:
            kinematics, shape = each.at(each.own(angles))
            rows += [
                newton_euler(kinematics, shape, standing, 0.0).contact / scale,
                newton_euler(kinematics, shape, inertial, 1.0).contact / unit,
                each.sense * newton_euler(kinematics, shape, inertial, 0.0, acceleration=1.0).contact / unit,
            ]
        return np.array(rows)

    panels = fit(functions, turn, 3 * len(followers))
    middle = Angles(panels.start + 0.5 * panels.width, panels.piece)
    moves = np.array([each.program.velocity_signs[each.own(middle).piece] != 0.0 for each in followers])
    names, numbers = tuple(each.name for each in followers), tuple(each.number for each in followers)
    return ShaftContacts(panels, spring != RETUNED, moves, unit, names, numbers)


def _unit(sizes: Sizes) -> float:
    return sizes.inertia / sizes.slope**2 * sizes.curvature


# -- the wind-up of the shaft in time, from rest or from any state, by the nonlinear equation (13) --------------


SAMPLES = np.linspace(0.0, 1.0, 25)  # parts of a step
STEPS_AT_ONCE = 1000  # whose contact is looked at: memory does not grow with the number of points
CELLS = 6  # cells between samples in which the largest wind-up is searched
BISECTIONS, NEWTON = 50, 3
FIRST_ETA, ETA_STEP, MOST_ETA = 0.5, 0.05, 102  # η of the means of the first turn


@frozen(eq=False)
class History:
    """Wind-up β [turns] of one point of the chart over y = 0 ... ``periods`` turns of the input.

    Each step holds the polynomials of its collocation, of degree 16 in y, so β is known everywhere as well as at the ends.

    eta, q, damping  η, Q and the damping ratio
    steps            (n,) all steps, one after the other
    ended            where it ends [turns]: before ``periods`` where the cam only spins
    contact          contact forces, None where the design has no cam that could be lifted off; of several drives those of each
    """

    coefficients: Coefficients
    eta: float
    q: float
    damping: float
    periods: float
    steps: IntegrationStep
    ended: float
    contact: ShaftContacts | None = None

    # -- values -----------------------------------------------------------------------------------------

    def at(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """β and β' (n,) at y (n,) [turns of the input], 0 ... ended."""
        samples = self._sampled(y)
        return samples.beta[:, 0], samples.rate[:, 0]

    @cached_property
    def _equation(self) -> WindUpEquation:
        return WindUpEquation(self.coefficients, self.eta, self.q, self.damping)

    def _sampled(self, y: np.ndarray) -> StepSamples:
        """At y (n,), one sample a step; where two steps meet, of the later one."""
        step = np.clip(np.searchsorted(self.steps.y, y, side="right") - 1, 0, None)
        part = np.clip((y - self.steps.y[step]) / self.steps.h[step], 0.0, 1.0)
        return StepSamples.of(self._equation, self.steps.only(step), part[:, None])

    @cached_property
    def samples(self) -> StepSamples:
        """At ``SAMPLES`` of every step."""
        return StepSamples.of(self._equation, self.steps, SAMPLES[None])

    # -- figures ----------------------------------------------------------------------------------------

    @cached_property
    def largest(self) -> tuple[float, float]:
        """max |β| and the y where it stands, where β' = 0, to rounding."""
        y, rate, size = self.samples.y, self.samples.rate, np.abs(self.samples.beta)
        # every cell in which β' changes its sign may hold the top, the highest ones first
        tops = np.where(rate[:, :-1] * rate[:, 1:] <= 0.0, np.maximum(size[:, :-1], size[:, 1:]), -1.0)
        order = np.argsort(-tops, axis=None)[:CELLS]
        i, j = np.unravel_index(order[tops.flat[order] >= 0.0], tops.shape)
        top = _bisected(y[i, j], y[i, j + 1], lambda at: np.sign(self.at(at)[1]) == np.sign(rate[i, j]))
        places = np.append(top, y.flat[size.argmax()])
        sizes = np.abs(self.at(places)[0])
        best = int(sizes.argmax())
        return float(sizes[best]), float(places[best])

    def averages(self) -> tuple[float, float]:
        """Means of |β| and |β'| over the whole history (Kim1990 Figs. 6, 7: over the first turn)."""
        wind_up, slope = (float(sizes.sum()) / self.ended for sizes in size_integrals(self.steps))
        return wind_up, slope

    # -- contact ----------------------------------------------------------------------------------------

    def force(self, y: np.ndarray) -> np.ndarray:
        """Contact force (n,) at y (n,) as a multiple of M X''m ω², the lowest of several; nan without a ``contact``."""
        if self.contact is None:
            return np.full(np.shape(y), np.nan)
        return np.asarray(self.forces(y).min(axis=0))

    def forces(self, y: np.ndarray) -> np.ndarray:
        """That of each follower (k, n), in the order of ``contact``, which must be there."""
        assert self.contact is not None
        return self._sampled(y).force(self.contact, self.eta)[..., 0]

    @cached_property
    def _losing(self) -> np.ndarray:
        """Samples (n, 3) at which a contact force is below zero while its follower moves, in their order: step, place, follower."""
        if self.contact is None:
            return np.zeros((0, 3), dtype=int)
        lost = self.samples.moves(self.contact) & (self.samples.force(self.contact, self.eta) < 0.0)
        return np.argwhere(np.moveaxis(lost, 0, -1))

    @property
    def loses_contact(self) -> bool:
        """The follower leaves the cam (False where no contact is known)."""
        return self._losing.size > 0

    @cached_property
    def contact_lost(self) -> float | None:
        """The first y at which the contact force falls through zero while the follower moves, None where it never does
        (and where no contact is known)."""
        if self.contact is None or not self.loses_contact:
            return None
        (i, j, follower), y = self._losing[0], self.samples.y
        before = (
            j - 1 if j > 0 and self.samples.moves(self.contact)[follower, i, j - 1] else j
        )  # else it begins to move so
        return float(_bisected(y[i, [before]], y[i, [j]], lambda at: self.forces(at)[follower] >= 0.0)[0])

    @property
    def leaving(self) -> str:
        """Of several drives the one whose follower leaves its cam first; else ''."""
        return self.contact.names[self._losing[0][2]] if self.contact is not None and self.loses_contact else ""

    # -- frequencies ------------------------------------------------------------------------------------

    def spectrum(self, highest: float = 12.0) -> tuple[np.ndarray, np.ndarray]:
        """Orders (multiples of the shaft's speed) and amplitudes of β: a Hann window over the whole history, so a lasting
        wave of amplitude 1 stands as 1."""
        count = int(2 ** np.ceil(np.log2(4.0 * highest * self.ended)))
        beta, _ = self.at(self.ended * np.arange(count) / count)
        window = 0.5 - 0.5 * np.cos(TURN * np.arange(count) / count)
        amplitude = np.abs(np.fft.rfft(beta * window)) * (4.0 / count)
        amplitude[0] *= 0.5
        order = np.arange(amplitude.size) / self.ended
        return order[order <= highest], amplitude[order <= highest]


def history(
    coefficients: Coefficients,
    eta: float,
    q: float,
    damping: float = 0.0,
    periods: float = 30.0,
    start: tuple[float, float] | None = None,
    contact: ShaftContacts | None = None,
) -> History:
    """From a state (β, Π) at y = 0, or from rest, β = β' = 0 (Kim1990 §6); see ``histories``."""
    states = None if start is None else np.array([start])
    return histories(coefficients, np.array([eta]), np.array([q]), damping, periods, states, contact)[0]


def histories(
    coefficients: Coefficients,
    eta: np.ndarray,
    q: np.ndarray,
    damping: float = 0.0,
    periods: float = 30.0,
    start: np.ndarray | None = None,
    contact: ShaftContacts | None = None,
) -> tuple[History, ...]:
    """Several points (m,) side by side, from states (m, 2) or from rest: many take hardly longer than one of them.

    Raises NoStability where the equation cannot be followed from the very start.
    """
    steps, arrived = follow(coefficients, eta, q, damping, start, periods)
    made = []
    for index in range(eta.size):
        own = steps.only(np.flatnonzero(steps.trajectory == index))
        if own.y.size == 0:
            raise _not_followed()
        ended = periods if arrived[index] else float(own.y[-1] + own.h[-1])
        own = replace(own, trajectory=np.zeros_like(own.trajectory))
        made.append(History(coefficients, float(eta[index]), float(q[index]), damping, periods, own, ended, contact))
    return tuple(made)


def _not_followed() -> NoStability:
    return NoStability("the wind-up cannot be followed from its start", "shaft.camshaft_inertia_kg_m2", "enlarge it")


# -- within the steps ----------------------------------------------------------------------------------------

_POWERS = powers(2.0 * SAMPLES - 1.0, STAGES + 2).T


@frozen(eq=False)
class StepSamples:
    """The wind-up at k places of each of n steps, at a step's ends from inside it.

    y             (n, k) turns of the input
    beta          (n, k) β [turns]
    rate          (n, k) β'
    acceleration  (n, k) θ̈/ω² = -β''/2π of the cam
    theta         (n, k) cam angle within its turn [rad]; at a join it may lie beyond it by rounding
    inward        (n, k) [rad] a little towards the middle of the motion's piece: the side of a join that holds here
    """

    y: np.ndarray
    beta: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray
    theta: np.ndarray
    inward: np.ndarray

    @staticmethod
    def of(equation: WindUpEquation, steps: IntegrationStep, part: np.ndarray) -> StepSamples:
        """At parts (n or 1, k) of the steps, 0 ... 1."""
        x = steps.within(part)
        y = steps.y[:, None] + steps.h[:, None] * part
        theta = TURN * (y - x[..., 0] - steps.turn[:, None])
        middle = 0.5 * (equation.begins + equation.ends)[steps.piece]
        rate, second = OnPieces(equation, steps.trajectory, steps.piece, steps.turn).velocities(y, x)
        return StepSamples(y, x[..., 0], rate, second / -TURN, theta, OUTSIDE * np.sign(middle[:, None] - theta))

    def moves(self, contact: ShaftContacts) -> np.ndarray:
        """Where each follower moves (·, n, k)."""
        return np.asarray(contact.moves[:, contact.panels.index(self.theta + self.inward)])

    def force(self, contact: ShaftContacts, eta: float | np.ndarray) -> np.ndarray:
        """Contact forces (·, n, k) at η, or (n, 1) of each follower as multiples of M X''m ω²."""
        count = len(contact.names)
        rows = contact.panels.at(self.theta.ravel(), 3 * count, self.inward.ravel()).reshape(
            count, 3, *self.theta.shape
        )
        return contact.force(rows.swapaxes(0, 1), eta, 1.0 - self.rate, self.acceleration)


def size_integrals(steps: IntegrationStep) -> tuple[np.ndarray, np.ndarray]:
    """∫ |β| dy and ∫ |β'| dy (n,) over steps (n,), of the polynomials of β through the nodes."""
    beta = steps.powers[:, 0]
    order = np.arange(1, beta.shape[1] + 1)
    primitive = np.pad(beta / order, ((0, 0), (1, 0)))
    by_part = beta[:, 1:] * order[:-1]
    return 0.5 * steps.h * _absolute(beta, primitive), _absolute(by_part, beta)


def _absolute(f: np.ndarray, primitive: np.ndarray) -> np.ndarray:
    """∫ |f| dt (n,) over t = -1 ... 1 of polynomials (n, K), powers of t, with their primitives (n, K + 1).

    Between two samples f changes its sign once at most; the place is found by Newton's method.
    """
    values, area = f @ _POWERS[: f.shape[1]], primitive @ _POWERS[: primitive.shape[1]]
    total = np.abs(np.diff(area))
    i, j = np.nonzero(values[:, :-1] * values[:, 1:] < 0.0)
    f, slope = f[i], f[i, 1:] * np.arange(1, f.shape[1])
    low, high = 2.0 * SAMPLES[j] - 1.0, 2.0 * SAMPLES[j + 1] - 1.0
    root = low + (high - low) * values[i, j] / (values[i, j] - values[i, j + 1])
    for _ in range(NEWTON):
        rise = _values(slope, root)
        root = np.clip(root - _values(f, root) / np.where(rise == 0.0, np.inf, rise), low, high)
    top = _values(primitive[i], root)
    total[i, j] = np.abs(top - area[i, j]) + np.abs(area[i, j + 1] - top)
    return np.asarray(total.sum(axis=1))


def _bisected(low: np.ndarray, high: np.ndarray, before: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Where (n,) in the cells low ... high ``before`` ceases to be true: the upper ends after ``BISECTIONS`` halvings."""
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        lower = before(middle)
        low, high = np.where(lower, middle, low), np.where(lower, high, middle)
    return high


def _values(f: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Values (m,) of polynomials (m, K) at t (m,)."""
    return np.einsum("mk,mk->m", f, powers(t, f.shape[1]))


# -- means of the first turn ---------------------------------------------------------------------------------


@frozen(eq=False)
class Averages:
    """Means from rest.

    eta       (n,) rising
    q         (rows,)
    wind_up   (rows, n) mean |β| [turns]; nan where the equation could not be followed
    slope     (rows, n) mean |β'|
    lost      (rows, n) True where the follower leaves the cam within that time; None where no contact is known
    periods   turns of the input that are averaged
    """

    eta: np.ndarray
    q: np.ndarray
    wind_up: np.ndarray
    slope: np.ndarray
    lost: np.ndarray | None
    periods: float


def etas(eta_max: float = ETA_MAX) -> np.ndarray:
    """0.5, 0.55, ... up to eta_max (n,); where that is far, no more than Kim1990's range has."""
    count = max(1, min(round((eta_max - FIRST_ETA) / ETA_STEP), MOST_ETA) + 1)
    return FIRST_ETA + np.arange(count) * max(ETA_STEP, (eta_max - FIRST_ETA) / MOST_ETA)


def mean_wind_up(
    coefficients: Coefficients,
    q: Sequence[float] | np.ndarray,
    eta: np.ndarray,
    damping: float = 0.0,
    contact: ShaftContacts | None = None,
    periods: float = 1.0,
) -> Averages:
    """The means of the rows q (rows,) at η (n,), over the first ``periods`` turns from rest."""
    rows = np.atleast_1d(np.asarray(q, dtype=float))
    shape = (rows.size, eta.size)
    equation = WindUpEquation(coefficients, np.tile(eta, rows.size), np.repeat(rows, eta.size), damping)
    steps, arrived = follow(coefficients, equation.eta, equation.q, damping, None, periods)
    count = equation.eta.size
    if np.bincount(steps.trajectory, minlength=count).min() == 0:
        raise _not_followed()
    sums = [np.bincount(steps.trajectory, size, count) for size in size_integrals(steps)]
    wind_up, slope = (np.where(arrived, each / periods, np.nan).reshape(shape) for each in sums)
    lost = None if contact is None else np.isin(np.arange(count), _losing(equation, steps, contact)).reshape(shape)
    return Averages(eta, rows, wind_up, slope, lost, periods)


def _losing(equation: WindUpEquation, steps: IntegrationStep, contact: ShaftContacts) -> np.ndarray:
    """The trajectories in whose steps a contact force is below zero while the follower moves."""
    found = []
    for first in range(0, steps.y.size, STEPS_AT_ONCE):
        some = steps.only(np.arange(first, min(first + STEPS_AT_ONCE, steps.y.size)))
        samples = StepSamples.of(equation, some, SAMPLES[None])
        pulled = samples.moves(contact) & (samples.force(contact, equation.eta[some.trajectory, None]) < 0.0)
        found.append(some.trajectory[pulled.any(axis=(0, 2))])
    return np.concatenate(found)
