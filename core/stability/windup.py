"""The wind-up of the shaft in time, from rest or from any state, by the nonlinear equation (13) of Kim1990.

Samples within the steps of the integrator, integrals of its absolute value, and its means over the first turn from rest
by η, for several rows of Q (Kim1990 Figs. 6, 7).
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

# -- the contact force of a cam at varying speed ----------------------------------------------------------------

KinematicsAndShapeAt = Callable[[Angles], tuple[Kinematics, CamShape]]


@frozen(eq=False)
class FollowerContact:
    """A follower on its cam, one of those that a shaft drives.

    Attributes
    ----------
    at : callable
        Its kinematics and its cam's shape at its own angles.
    loading : Loading
    program : CompiledMotion
        Pieces of its motion by its own angle.
    sizes : Sizes
        Its own, by which its valve spring is retuned; without inertia it has no valve spring.
    own : callable
        Its own angles at angles of the shaft.
    rotation_sign : float
        +1, or -1 where its own angle falls as the shaft rotates.
    name : str
        Name of its drive.
    number : int
        Index in the list of drives.
    """

    at: KinematicsAndShapeAt
    loading: Loading
    program: CompiledMotion
    sizes: Sizes
    own: Callable[[Angles], Angles] = lambda angles: angles
    rotation_sign: float = 1.0
    name: str = ""
    number: int = 0


@frozen(eq=False)
class ShaftContacts:
    """Contact forces of k followers by the shaft's angle, as multiples of M X''m ω², M = max J / X'm².

    Attributes
    ----------
    panels : Panels
        For each follower the rows f_0 (to be multiplied by η² where the loads are fixed), f_v, f_a.
    fixed : bool
        As in `Coefficients`.
    moves : ndarray (k, m) of bool
        False on panels where the follower dwells.
    unit : float
        M X''m [N s²]: the dimensionless force times unit ω² is the force in N.
    names : tuple of str
        Names of the drives.
    numbers : tuple of int
        Their indices in the list of drives.
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
        """Dimensionless contact force f = f_0 + f_v (θ̇/ω)² + f_a θ̈/ω², f_0 times η² where the loads are fixed.

        Parameters
        ----------
        values : ndarray (3, ...), dimensionless
            f_0, f_v and f_a at the cam angles.
        eta : float or ndarray (...), dimensionless
        speed : ndarray (...), dimensionless
            θ̇/ω.
        acceleration : ndarray (...), dimensionless
            θ̈/ω².

        Returns
        -------
        ndarray (...), dimensionless
            Multiples of M X''m ω².
        """
        static_force = values[0] * (eta * eta if self.fixed else 1.0)
        return np.asarray(static_force + values[1] * speed * speed + values[2] * acceleration)


def contact(
    followers: Sequence[FollowerContact],
    turn: Any,
    sizes: Sizes,
    spring: str,
    factor: float,
    q: float,
    stiffness: float,
) -> ShaftContacts:
    """Contact forces of the followers on a flexible shaft.

    Parameters
    ----------
    followers : sequence of FollowerContact
    turn : object
        Pieces of the shaft's turn, `starts` and `ends`, inside which no follower has a join.
    sizes : Sizes
        Scales of the complete shaft.
    spring : str
        `FIXED` or `RETUNED`.
    factor : float
        Factor a of the retuned valve spring.
    q : float
    stiffness : float
        K_s [N m/rad].

    Returns
    -------
    ShaftContacts

    Raises
    ------
    NoSolution
        Where a follower has no cam.
    """
    unit = _unit(sizes)
    # F_0 / (M X''m ω²) = η² F_0 I_c / (K_s M X''m)
    scale = unit if spring == RETUNED else unit * q * stiffness / sizes.inertia

    def static_loading(follower: FollowerContact) -> Loading:
        if spring != RETUNED:
            return follower.loading.frictionless
        rate = factor * _unit(follower.sizes) / follower.sizes.stroke if follower.sizes.inertia else 0.0
        return Loading((), (OutputForce(rate * follower.sizes.lowest, rate),))

    loads = [(follower, static_loading(follower), follower.loading.inertial) for follower in followers]

    def functions(angles: Angles) -> np.ndarray:
        rows = []
        for follower, static, inertial in loads:
            kinematics, shape = follower.at(follower.own(angles))
            rows += [
                newton_euler(kinematics, shape, static, 0.0).contact / scale,
                newton_euler(kinematics, shape, inertial, 1.0).contact / unit,
                follower.rotation_sign
                * newton_euler(kinematics, shape, inertial, 0.0, acceleration=1.0).contact
                / unit,
            ]
        return np.array(rows)

    panels = fit(functions, turn, 3 * len(followers))
    middle = Angles(panels.start + 0.5 * panels.width, panels.piece)
    moves = np.array([follower.program.velocity_signs[follower.own(middle).piece] != 0.0 for follower in followers])
    names, numbers = tuple(follower.name for follower in followers), tuple(follower.number for follower in followers)
    return ShaftContacts(panels, spring != RETUNED, moves, unit, names, numbers)


def _unit(sizes: Sizes) -> float:
    """M X''m [N s²]."""
    return sizes.inertia / sizes.slope**2 * sizes.curvature


# -- the wind-up in time, by the nonlinear equation (13) -----------------------------------------------------------

SAMPLES = np.linspace(0.0, 1.0, 25)  # fractions of a step
STEPS_AT_ONCE = 1000  # steps in one evaluation of the contact: memory does not grow with the number of points
CELLS = 6  # cells between samples in which the largest wind-up is searched
BISECTIONS, NEWTON = 50, 3
FIRST_ETA, ETA_STEP, MOST_ETA = 0.5, 0.05, 102  # η of the means of the first turn


@frozen(eq=False)
class History:
    """Wind-up β [turns] of one point of the chart over y = 0 ... ``periods`` turns of the input.

    Each step contains the polynomials of its collocation, of degree 16 in y, so β is known everywhere.

    Attributes
    ----------
    eta, q, damping : float
        η, Q and the damping ratio.
    steps : IntegrationStep
        All steps in their order.
    ended : float
        End of the integration [turns]: before ``periods`` where the cam runs away.
    contact : ShaftContacts or None
        Contact forces; None where no follower can leave its cam.
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
        """Wind-up and its rate.

        Parameters
        ----------
        y : ndarray (n,) [turns of the input]
            Times 0 ... ended.

        Returns
        -------
        beta : ndarray (n,) [turns]
            β.
        rate : ndarray (n,), dimensionless
            β' in turns per turn.
        """
        samples = self._samples_at(y)
        return samples.beta[:, 0], samples.rate[:, 0]

    @cached_property
    def _equation(self) -> WindUpEquation:
        return WindUpEquation(self.coefficients, self.eta, self.q, self.damping)

    def _samples_at(self, y: np.ndarray) -> StepSamples:
        """Samples at y (n,), one of each step that contains it; where two steps meet, of the later one."""
        step = np.clip(np.searchsorted(self.steps.y, y, side="right") - 1, 0, None)
        part = np.clip((y - self.steps.y[step]) / self.steps.h[step], 0.0, 1.0)
        return StepSamples.of(self._equation, self.steps.select(step), part[:, None])

    @cached_property
    def samples(self) -> StepSamples:
        """Samples at the fractions ``SAMPLES`` of every step."""
        return StepSamples.of(self._equation, self.steps, SAMPLES[None])

    # -- figures ----------------------------------------------------------------------------------------

    @cached_property
    def largest(self) -> tuple[float, float]:
        """Largest |β| [turns] and its y [turns of the input], where β' = 0, to rounding."""
        y, rate, size = self.samples.y, self.samples.rate, np.abs(self.samples.beta)
        # every cell in which β' changes its sign may contain the maximum, the highest ones first
        tops = np.where(rate[:, :-1] * rate[:, 1:] <= 0.0, np.maximum(size[:, :-1], size[:, 1:]), -1.0)
        order = np.argsort(-tops, axis=None)[:CELLS]
        i, j = np.unravel_index(order[tops.flat[order] >= 0.0], tops.shape)
        peak = _bisect(y[i, j], y[i, j + 1], lambda at: np.sign(self.at(at)[1]) == np.sign(rate[i, j]))
        candidates = np.append(peak, y.flat[size.argmax()])
        sizes = np.abs(self.at(candidates)[0])
        best = int(sizes.argmax())
        return float(sizes[best]), float(candidates[best])

    def averages(self) -> tuple[float, float]:
        """Means of |β| [turns] and |β'| over the complete history (Kim1990 Figs. 6, 7: over the first turn)."""
        wind_up, slope = (float(sizes.sum()) / self.ended for sizes in size_integrals(self.steps))
        return wind_up, slope

    # -- contact ----------------------------------------------------------------------------------------

    def force(self, y: np.ndarray) -> np.ndarray:
        """Lowest contact force of the followers as a multiple of M X''m ω², NaN without a ``contact``.

        Parameters
        ----------
        y : ndarray (n,) [turns of the input]

        Returns
        -------
        ndarray (n,), dimensionless
        """
        if self.contact is None:
            return np.full(np.shape(y), np.nan)
        return np.asarray(self.forces(y).min(axis=0))

    def forces(self, y: np.ndarray) -> np.ndarray:
        """Contact force of each follower as a multiple of M X''m ω².

        Parameters
        ----------
        y : ndarray (n,) [turns of the input]

        Returns
        -------
        ndarray (k, n), dimensionless
            In the order of ``contact``, which must not be None.
        """
        assert self.contact is not None
        return self._samples_at(y).force(self.contact, self.eta)[..., 0]

    @cached_property
    def _lost_samples(self) -> np.ndarray:
        """Step, sample and follower (n, 3) of each negative contact force of a moving follower, in order of time."""
        if self.contact is None:
            return np.zeros((0, 3), dtype=int)
        is_negative = self.samples.moves(self.contact) & (self.samples.force(self.contact, self.eta) < 0.0)
        return np.argwhere(np.moveaxis(is_negative, 0, -1))

    @property
    def loses_contact(self) -> bool:
        """Whether a follower leaves its cam (False where no contact is known)."""
        return self._lost_samples.size > 0

    @cached_property
    def contact_lost(self) -> float | None:
        """First y [turns] at which the contact force falls through zero while the follower moves.

        None where it never does, and where no contact is known.
        """
        if self.contact is None or not self.loses_contact:
            return None
        (i, j, follower), y = self._lost_samples[0], self.samples.y
        # without an earlier sample in motion the force is negative from the start of the motion
        before = j - 1 if j > 0 and self.samples.moves(self.contact)[follower, i, j - 1] else j
        return float(_bisect(y[i, [before]], y[i, [j]], lambda at: self.forces(at)[follower] >= 0.0)[0])

    @property
    def leaving(self) -> str:
        """Name of the drive whose follower leaves its cam first; '' where none does."""
        return self.contact.names[self._lost_samples[0][2]] if self.contact is not None and self.loses_contact else ""

    # -- frequencies ------------------------------------------------------------------------------------

    def spectrum(self, highest: float = 12.0) -> tuple[np.ndarray, np.ndarray]:
        """Amplitude spectrum of β by a Hann window over the complete history; a lasting wave of amplitude 1 gives 1.

        Parameters
        ----------
        highest : float
            Greatest order.

        Returns
        -------
        order : ndarray (n,), dimensionless
            Multiples of the shaft's speed.
        amplitude : ndarray (n,) [turns]
        """
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
    """Integrate one point from a state (β, Π) at y = 0, or from rest, β = β' = 0 (Kim1990 §6)."""
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
    """Integrate several points together, which takes little longer than one of them.

    Parameters
    ----------
    coefficients : Coefficients
    eta, q : ndarray (m,), dimensionless
    damping : float
        Damping ratio ζ.
    periods : float
        Turns of the input.
    start : ndarray (m, 2) [turns], dimensionless, or None
        States (β, Π) at y = 0; None from rest.
    contact : ShaftContacts or None

    Returns
    -------
    tuple of History

    Raises
    ------
    NoStability
        Where the equation cannot be integrated from its start.
    """
    steps, arrived = follow(coefficients, eta, q, damping, start, periods)
    results = []
    for index in range(eta.size):
        own_steps = steps.select(np.flatnonzero(steps.trajectory == index))
        if own_steps.y.size == 0:
            raise _not_followed()
        ended = periods if arrived[index] else float(own_steps.y[-1] + own_steps.h[-1])
        own_steps = replace(own_steps, trajectory=np.zeros_like(own_steps.trajectory))
        results.append(
            History(coefficients, float(eta[index]), float(q[index]), damping, periods, own_steps, ended, contact)
        )
    return tuple(results)


def _not_followed() -> NoStability:
    return NoStability("the wind-up cannot be followed from its start", "shaft.camshaft_inertia_kg_m2", "enlarge it")


# -- within the steps ----------------------------------------------------------------------------------------

_POWERS = powers(2.0 * SAMPLES - 1.0, STAGES + 2).T


@frozen(eq=False)
class StepSamples:
    """The wind-up at k fractions of each of n steps, at a step's ends from inside it.

    Attributes
    ----------
    y : ndarray (n, k) [turns of the input]
    beta : ndarray (n, k) [turns]
    rate : ndarray (n, k), dimensionless
        β'.
    acceleration : ndarray (n, k), dimensionless
        θ̈/ω² = -β''/2π of the cam.
    theta : ndarray (n, k) [rad]
        Cam angle within its turn; at a join it may exceed it by rounding.
    inward : ndarray (n, k) [rad]
        Small angle towards the middle of the motion's piece, which selects the side of a join.
    """

    y: np.ndarray
    beta: np.ndarray
    rate: np.ndarray
    acceleration: np.ndarray
    theta: np.ndarray
    inward: np.ndarray

    @staticmethod
    def of(equation: WindUpEquation, steps: IntegrationStep, part: np.ndarray) -> StepSamples:
        """Samples at fractions of the steps.

        Parameters
        ----------
        equation : WindUpEquation
        steps : IntegrationStep
        part : ndarray (n, k), dimensionless
            Fractions 0 ... 1 of the steps; (1, k) for the same fractions of every step.

        Returns
        -------
        StepSamples
        """
        x = steps.within(part)
        y = steps.y[:, None] + steps.h[:, None] * part
        theta = TURN * (y - x[..., 0] - steps.turn[:, None])
        middle = 0.5 * (equation.begins + equation.ends)[steps.piece]
        rate, second = OnPieces(equation, steps.trajectory, steps.piece, steps.turn).velocities(y, x)
        return StepSamples(y, x[..., 0], rate, second / -TURN, theta, OUTSIDE * np.sign(middle[:, None] - theta))

    def moves(self, contact: ShaftContacts) -> np.ndarray:
        """Whether each follower moves at the samples.

        Returns
        -------
        ndarray (followers, n, k) of bool, dimensionless
        """
        return np.asarray(contact.moves[:, contact.panels.index(self.theta + self.inward)])

    def force(self, contact: ShaftContacts, eta: float | np.ndarray) -> np.ndarray:
        """Contact force of each follower as a multiple of M X''m ω².

        Parameters
        ----------
        contact : ShaftContacts
        eta : float or ndarray (n, 1), dimensionless

        Returns
        -------
        ndarray (followers, n, k), dimensionless
        """
        count = len(contact.names)
        rows = contact.panels.at(self.theta.ravel(), 3 * count, self.inward.ravel()).reshape(
            count, 3, *self.theta.shape
        )
        return contact.force(rows.swapaxes(0, 1), eta, 1.0 - self.rate, self.acceleration)


def size_integrals(steps: IntegrationStep) -> tuple[np.ndarray, np.ndarray]:
    """Integrals ∫ |β| dy and ∫ |β'| dy over each step, of the polynomials of β through the nodes.

    Parameters
    ----------
    steps : IntegrationStep

    Returns
    -------
    wind_up, slope : ndarray (n,) [turns], dimensionless
        The first in turns of wind-up times turns of the input, the second in turns.
    """
    beta = steps.powers[:, 0]
    order = np.arange(1, beta.shape[1] + 1)
    primitive = np.pad(beta / order, ((0, 0), (1, 0)))
    by_part = beta[:, 1:] * order[:-1]
    return 0.5 * steps.h * _absolute(beta, primitive), _absolute(by_part, beta)


def _absolute(f: np.ndarray, primitive: np.ndarray) -> np.ndarray:
    """∫ |f| dt (n,) over t = -1 ... 1 of polynomials (n, K), powers of t, with their primitives (n, K + 1).

    Between two samples f changes its sign once at most, at a root computed by Newton's method.
    """
    values, area = f @ _POWERS[: f.shape[1]], primitive @ _POWERS[: primitive.shape[1]]
    total = np.abs(np.diff(area))
    i, j = np.nonzero(values[:, :-1] * values[:, 1:] < 0.0)
    f, slope = f[i], f[i, 1:] * np.arange(1, f.shape[1])
    low, high = 2.0 * SAMPLES[j] - 1.0, 2.0 * SAMPLES[j + 1] - 1.0
    root = low + (high - low) * values[i, j] / (values[i, j] - values[i, j + 1])
    for _ in range(NEWTON):
        gradient = _values(slope, root)
        root = np.clip(root - _values(f, root) / np.where(gradient == 0.0, np.inf, gradient), low, high)
    root_area = _values(primitive[i], root)
    total[i, j] = np.abs(root_area - area[i, j]) + np.abs(area[i, j + 1] - root_area)
    return np.asarray(total.sum(axis=1))


def _bisect(low: np.ndarray, high: np.ndarray, before: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Points (n,) of the cells low ... high at which ``before`` becomes false, by bisection."""
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
    """Means of the wind-up from rest.

    Attributes
    ----------
    eta : ndarray (n,), dimensionless
        Rising.
    q : ndarray (rows,), dimensionless
    wind_up : ndarray (rows, n) [turns]
        Mean |β|; NaN where the equation could not be integrated.
    slope : ndarray (rows, n), dimensionless
        Mean |β'|.
    is_contact_lost : ndarray (rows, n) of bool, or None
        True where the follower leaves the cam within that time; None where no contact is known.
    periods : float
        Turns of the input in the mean.
    """

    eta: np.ndarray
    q: np.ndarray
    wind_up: np.ndarray
    slope: np.ndarray
    is_contact_lost: np.ndarray | None
    periods: float


def etas(eta_max: float = ETA_MAX) -> np.ndarray:
    """Values 0.5, 0.55, ... up to eta_max; for a large eta_max the number of values is that of Kim1990's range.

    Returns
    -------
    ndarray (n,), dimensionless
    """
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
    """Means of |β| and |β'| over the first turns from rest.

    Parameters
    ----------
    coefficients : Coefficients
    q : sequence of float or ndarray (rows,), dimensionless
    eta : ndarray (n,), dimensionless
    damping : float
        Damping ratio ζ.
    contact : ShaftContacts or None
    periods : float
        Turns of the input in the mean.

    Returns
    -------
    Averages

    Raises
    ------
    NoStability
        Where the equation cannot be integrated from its start.

    References
    ----------
    Kim (1990), Figs. 6 and 7.
    """
    rows = np.atleast_1d(np.asarray(q, dtype=float))
    shape = (rows.size, eta.size)
    equation = WindUpEquation(coefficients, np.tile(eta, rows.size), np.repeat(rows, eta.size), damping)
    steps, arrived = follow(coefficients, equation.eta, equation.q, damping, None, periods)
    count = equation.eta.size
    if np.bincount(steps.trajectory, minlength=count).min() == 0:
        raise _not_followed()
    totals = [np.bincount(steps.trajectory, size, count) for size in size_integrals(steps)]
    wind_up, slope = (np.where(arrived, total / periods, np.nan).reshape(shape) for total in totals)
    is_contact_lost = (
        None
        if contact is None
        else np.isin(np.arange(count), _lost_trajectories(equation, steps, contact)).reshape(shape)
    )
    return Averages(eta, rows, wind_up, slope, is_contact_lost, periods)


def _lost_trajectories(equation: WindUpEquation, steps: IntegrationStep, contact: ShaftContacts) -> np.ndarray:
    """Trajectories with a negative contact force while the follower moves."""
    lost = []
    for first in range(0, steps.y.size, STEPS_AT_ONCE):
        block = steps.select(np.arange(first, min(first + STEPS_AT_ONCE, steps.y.size)))
        samples = StepSamples.of(equation, block, SAMPLES[None])
        is_negative = samples.moves(contact) & (samples.force(contact, equation.eta[block.trajectory, None]) < 0.0)
        lost.append(block.trajectory[is_negative.any(axis=(0, 2))])
    return np.concatenate(lost)
