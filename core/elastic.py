"""Vibration of an elastic follower, modelled as one mass in the coordinate of the motion.

m z'' + c z' + k (z - s) + ks z = 0 is solved exactly over each piece of the motion, whose law is a sum of powers and sines.
"""

from __future__ import annotations

import math
from functools import cached_property
from math import comb, factorial
from typing import Any, NamedTuple

import numpy as np

from core.cam import envelope
from core.dynamics import Loading, ScheduledForce
from core.errors import NoSolution
from core.findings import Residual
from core.frozen import frozen
from core.mechanism import DriverRanges, Mechanism, solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import EPS, SNAP, TURN, Angles, CompiledMotion, MotionState
from core.numerics.derivatives import Derivatives
from core.numerics.lazy import checkpoint
from core.numerics.roots import gauss_legendre

# -- equivalent mass, stiffness and damping ---------------------------------------------------------------------


POSITIONS = 17  # of the stroke, at which the natural frequency is computed
STIFFNESS, DAMPING = "loads.follower_stiffness_n_per_mm", "loads.follower_damping_ratio"


@frozen
class Equivalent:
    """One-mass model m z'' + c z' + k (z - s) + ks z = 0 in the coordinate of the motion, a length or an angle.

    Attributes
    ----------
    mass : m [kg or kg m²]
    stiffness : k between the cam's motion s and the mass [N/m or N m/rad]
    closing : ks of closing spring, further springs and weight, the second derivative of their potential [N/m or N m/rad]
    damping : c = 2 ζ √(m (k + ks)) and the damping of dampers, against the frame [N s/m or N m s/rad]
    dampers : the part of c that acts on the rigid follower too [N s/m or N m s/rad]
    """

    mass: float
    stiffness: float
    closing: float
    damping: float
    dampers: float = 0.0

    @property
    def natural_frequency(self) -> float:
        """Undamped natural frequency ω0 = √((k + ks)/m) [rad/s]."""
        return math.sqrt((self.stiffness + self.closing) / self.mass)

    @property
    def damping_ratio(self) -> float:
        """Ratio of all damping to the critical one, ζ = c/(2 √(m (k + ks)))."""
        return self.damping / (2.0 * self.mass * self.natural_frequency)

    @property
    def static_gain(self) -> float:
        """Displacement of the mass per displacement of the cam at standstill, k/(k + ks)."""
        return self.stiffness / (self.stiffness + self.closing)


@frozen
class Elasticity:
    """One-mass model of an elastic follower over its stroke.

    Attributes
    ----------
    middle : model in the middle of the stroke
    lever_arm : |dR/dy| there of the point R at which the stiffness is given [m per m or rad]
    lowest, highest : natural frequency, least and greatest over the stroke [rad/s]
    """

    middle: Equivalent
    lever_arm: float
    lowest: float
    highest: float


def elasticity(
    mechanism: Mechanism,
    driver_ranges: DriverRanges,
    loading: Loading,
    face: Any,
    cam: Any,
    sense: float,
    stroke: tuple[float, float],
    stiffness: float,
    ratio: float,
) -> Elasticity:
    """One-mass model of the follower in the middle of its stroke.

    m = J of the kinetic energy J ẏ²/2, ks = V'' of the potential energy, c of dampers from their power c ẏ², k = k_R |dR/dy|²
    with the roller's centre R (without a roller the contact in the middle of the stroke). Process forces and constant forces
    only shift the position about which the mass vibrates; they are left out.

    Parameters
    ----------
    mechanism : Mechanism
    driver_ranges : DriverRanges
    loading : Loading
    face, cam : design tables of the follower's face and of the cam
    sense : float
        Sense of rotation, ±1.
    stroke : (float, float) [m or rad]
        Lowest and highest motion.
    stiffness : float [N/m]
        k_R at R along its path.
    ratio : float, dimensionless
        Damping ratio ζ of the follower on its stiffness and all springs.

    Returns
    -------
    Elasticity

    Raises
    ------
    NoSolution
        Where there is no mass, where the springs push it away from the cam more strongly than k holds it, or where it is
        overdamped.
    """
    low, high = stroke
    y = np.concatenate(([0.5 * (low + high)], np.linspace(low, high, POSITIONS)))
    still = kinematics_at_motion(mechanism, driver_ranges, y, 0.0)
    moving = kinematics_at_motion(mechanism, driver_ranges, y, 1.0)
    flank = envelope(still, face, cam, sense).flank
    point = flank.contact if flank.straight else flank.reference
    position, velocity = still.bodies[flank.body], moving.bodies[flank.body]
    point_velocity = velocity.origin[1] + 1j * velocity.turn[1] * (point - position.origin[0])
    steady = Loading(loading.masses, tuple(e for e in loading.others if not isinstance(e, ScheduledForce)))
    lever_arm = np.broadcast_to(np.abs(point_velocity), y.size)
    k = stiffness * lever_arm**2
    mass, closing = steady.inertia(moving, 1)[0], steady.potential(moving)[1]
    dampers = sum((element.dissipation(moving, 1.0) for element in steady.elements), np.zeros(y.size))
    if not (mass > 0.0).all():
        raise NoSolution(
            "an elastic follower without a mass does not vibrate",
            "loads",
            "give its masses, or remove its stiffness",
        )
    if not (k + closing > 0.0).all():
        stronger = float((-closing / k).max())
        raise NoSolution(
            f"weight and springs push the follower's mass away {stronger:.4g} times as strongly as its stiffness holds it",
            STIFFNESS,
            "allowed: less than once; enlarge it, or weaken them",
        )
    natural = np.sqrt((k + closing) / mass)
    damping = 2.0 * ratio * mass * natural + dampers
    middle = Equivalent(float(mass[0]), float(k[0]), float(closing[0]), float(damping[0]), float(dampers[0]))
    if middle.damping_ratio >= 1.0:
        raise NoSolution(
            f"with its dampers the follower's damping ratio is {middle.damping_ratio:.4g}: nothing vibrates",
            DAMPING,
            "allowed with them: below 1; weaken the dampers, or enlarge the stiffness",
        )
    return Elasticity(middle, float(lever_arm[0]), float(natural.min()), float(natural.max()))


def kinematics_at_motion(mechanism: Mechanism, driver_ranges: DriverRanges, y: np.ndarray, speed: float) -> Kinematics:
    """Kinematics of the mechanism at given positions of its motion, at cam angle 0.

    Parameters
    ----------
    mechanism : Mechanism
    driver_ranges : DriverRanges
    y : ndarray (n,) [m or rad]
        Positions of the motion.
    speed : float
        Derivatives are taken with y' = speed.

    Returns
    -------
    Kinematics
    """
    velocity, zero = np.full(y.size, speed), np.zeros(y.size)
    angles = Angles(zero, np.zeros(y.size, dtype=int))
    return solve_mechanism(
        mechanism, MotionState(angles, Derivatives.of((y, velocity, zero, zero)), velocity), driver_ranges
    )


# -- exact solution over a piece of the motion ------------------------------------------------------------------


SERIES = 40  # most terms of a power series
SMALL = 1e-17  # bound of the truncated terms, relative to the first


class Oscillator(NamedTuple):
    """One-mass model at S speeds, by cam angle.

    Attributes
    ----------
    root : (S, 1) complex, λ = -δ + i √(Ω0² - δ²) [1/rad]
    decay : (S, 1) δ = c/(2 m ω) [1/rad]
    closing : (S, 1) Ω_s² = ks/(m ω²) [1/rad²]
    """

    root: np.ndarray
    decay: np.ndarray
    closing: np.ndarray

    @property
    def conjugate(self) -> np.ndarray:
        """Conjugate root λ̄ (S, 1) [1/rad]."""
        return np.conj(self.root)

    def errors(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Error e = z - s and its derivative e' by cam angle, from the state Y.

        Parameters
        ----------
        y : ndarray (S, n) complex [m/rad or dimensionless]
            Y = e' - λ̄ e.

        Returns
        -------
        e, speed : ndarray (S, n) [m or rad], [m/rad or dimensionless]
        """
        e = y.imag / self.root.imag
        return e, y.real - self.decay * e

    def resting(self, s: np.ndarray) -> np.ndarray:
        """State Y at rest in a dwell, e = -ks/(k + ks) s.

        Parameters
        ----------
        s : ndarray (n,) [m or rad]

        Returns
        -------
        ndarray (S, n) complex [m/rad or dimensionless]
        """
        square = self.root.real**2 + self.root.imag**2
        return np.asarray(self.conjugate * (self.closing / square) * s)


@frozen(eq=False)
class MotionPieces:
    """Pieces of the motion as sums of powers and sines of the angle since their start.

    Attributes
    ----------
    starts, widths : (n,) cam angle of the start, and width [rad]
    powers : (k, n) coefficients of the powers [m or rad, per radᵏ]
    sines : (3, j, n) amplitude [m or rad], frequency and phase [rad] of the sines
    """

    starts: np.ndarray
    widths: np.ndarray
    powers: np.ndarray
    sines: np.ndarray

    @staticmethod
    def of(program: CompiledMotion) -> MotionPieces:
        """Pieces of a compiled motion."""
        return MotionPieces(program.starts, program.ends - program.starts, program.powers, program.sines)

    def select(self, indices: np.ndarray, widths: np.ndarray) -> MotionPieces:
        """Select pieces, with new widths.

        Parameters
        ----------
        indices : ndarray (m,) of int, dimensionless
            Numbers of the pieces; a piece may be repeated.
        widths : ndarray (m,) [rad]

        Returns
        -------
        MotionPieces
        """
        return MotionPieces(self.starts[indices], widths, self.powers[:, indices], self.sines[:, :, indices])

    def cut(self, step: float) -> tuple[MotionPieces, np.ndarray]:
        """Divide each piece into equal parts.

        Parameters
        ----------
        step : float [rad]
            Greatest width of a part.

        Returns
        -------
        parts : MotionPieces
        piece : ndarray (m,) of int, dimensionless
            Number of the piece to which each part belongs.
        """
        counts = np.ceil(self.widths / step).astype(int)
        piece = np.repeat(np.arange(counts.size), counts)
        part = np.arange(piece.size) - np.repeat(np.cumsum(counts) - counts, counts)
        widths = (self.widths / counts)[piece]
        offset, powers = part * widths, self.powers[:, piece]
        shifted = np.zeros_like(powers)
        for j in range(powers.shape[0]):
            for k in range(powers.shape[0] - 1, j - 1, -1):
                shifted[j] = shifted[j] * offset + comb(k, j) * powers[k]
        sines = self.sines[:, :, piece]
        sines[2] += sines[1] * offset
        return MotionPieces(self.starts[piece] + offset, widths, shifted, sines), piece

    def at_start(self, order: int) -> np.ndarray:
        """Motion s, or its derivative of this order by cam angle, at the starts of the pieces.

        Returns
        -------
        ndarray (n,) [m or rad, per radⁿ]
        """
        w = np.zeros(self.widths.size)
        total = np.zeros(w.size)
        for k in range(self.powers.shape[0] - 1, order - 1, -1):
            total = total * w + self.powers[k] * (factorial(k) // factorial(k - order))
        amplitude, frequency, phase = self.sines
        waves = amplitude * frequency**order * np.sin(frequency * w + phase + 0.5 * np.pi * order)
        return np.asarray(total + waves.sum(axis=0))

    @np.errstate(under="ignore")
    def exact_step(self, oscillator: Oscillator) -> tuple[np.ndarray, np.ndarray]:
        """Exact step of the state over each piece, Y(end) = E Y(start) + G.

        Parameters
        ----------
        oscillator : Oscillator
            At S speeds.

        Returns
        -------
        step, forcing : ndarray (S, n) complex, dimensionless and [m/rad or dimensionless]
            E and G.
        """
        lam, decay, closing = oscillator
        w, powers = self.widths, self.powers
        count = powers.shape[0]
        distinct, index = np.unique(w, return_inverse=True)  # parts of one piece are equally wide
        phi = [row[:, index] for row in _phi(lam * distinct, count)]
        total = np.zeros((lam.shape[0], w.size), dtype=complex)
        for k in range(count):
            forcing = closing * powers[k]
            if k + 1 < count:
                forcing = forcing + 2.0 * (k + 1) * decay * powers[k + 1]
            if k + 2 < count:
                forcing = forcing + (k + 1) * (k + 2) * powers[k + 2]
            total -= (factorial(k) * w ** (k + 1)) * forcing * phi[k + 1]
        for amplitude, frequency, phase in zip(*self.sines, strict=True):
            present = np.flatnonzero(amplitude)
            if present.size:
                a = frequency[present]
                forced = -amplitude[present] * (closing - a * a + 2j * decay * a) * np.exp(1j * phase[present])
                distinct, index = np.unique(w[present] + 1j * a, return_inverse=True)
                up, down = (_sine_integral(lam, sign * distinct.imag, distinct.real)[:, index] for sign in (1.0, -1.0))
                total[:, present] += (forced * up - np.conj(forced) * down) / 2j
        return phi[0], total


def _sine_integral(lam: np.ndarray, frequency: np.ndarray, w: np.ndarray) -> np.ndarray:
    """∫ e^{λ(w-τ)} e^{iaτ} dτ over 0 ... w (S, n), also where λ is near ia."""
    difference, decayed = 1j * frequency - lam, np.exp(lam * w)
    x = difference * w
    near, zero = np.abs(x) < 1.0, x == 0.0
    inner = np.where(near & ~zero, x, 1.0)
    close = decayed * w * np.where(zero, 1.0, np.expm1(inner) / inner)
    far = (np.exp(1j * frequency * w) - decayed) / np.where(near, 1.0, difference)
    return np.where(near, close, far)


def _phi(x: np.ndarray, most: int) -> list[np.ndarray]:
    """φ_0 = e^x, φ_k(x) = Σ x^j/(j + k)! for k = 0 ... most.

    By φ_{k+1} = (φ_k - 1/k!)/x upwards while |x| > k, else downwards from the series of the last.
    """
    size = np.abs(x)
    up = [np.exp(x)]
    safe = np.where(size < 1.0, 1.0, x)
    for k in range(most):
        up.append((up[-1] - 1.0 / factorial(k)) / safe)
    small = size < most + 1.0
    if not small.any():
        return up
    inner, inner_size = x[small], size[small]
    down = _phi_series(inner, most)
    for k in range(most, 0, -1):
        up[k][small] = np.where(inner_size < k, down, up[k][small])
        down = inner * down + 1.0 / factorial(k - 1)
    return up


def _phi_series(x: np.ndarray, k: int) -> np.ndarray:
    """φ_k by its power series, for |x| up to about k."""
    term = np.full(x.shape, 1.0 / factorial(k), dtype=complex)
    total = term.copy()
    largest = float(np.abs(x).max(initial=0.0))
    bound = 1.0
    for j in range(1, SERIES):
        term = term * x / (j + k)
        total += term
        bound *= largest / (j + k)
        if bound < SMALL:
            break
    return total


# -- response at one speed --------------------------------------------------------------------------------------


NODES, PANELS = (
    16,
    4,
)  # of the energy balance: nodes of a panel, least panels of a piece; a panel is at most half a period
MOST_PERIODS = 1000  # in a turn, up to which the energy balance is computed
ROUNDING = 64.0
RESONANT = 1e-9  # |1 - e^{2πλ}| below which there is no steady response


@frozen
class Dwell:
    """A dwell: numbers of its first and last piece, and its cam angles [rad]; start > end where it contains 360°."""

    first: int
    last: int
    start: float
    end: float


@frozen
class ResidualVibration:
    """Amplitude of z - s about its rest position at the start of a dwell [m or rad].

    Attributes
    ----------
    dwell : the dwell
    from_rest : after the motion since the previous dwell, begun at rest [m or rad]
    steady : of the response that repeats every turn [m or rad]
    """

    dwell: Dwell
    from_rest: float
    steady: float


def dwells(program: CompiledMotion) -> tuple[Dwell, ...]:
    """Dwells in the order of their starts; one that contains 360° is the last. Empty where the motion is one dwell."""
    is_dwell = program.velocity_signs == 0.0
    n = is_dwell.size
    if is_dwell.all():
        return ()
    firsts = [i for i in range(n) if is_dwell[i] and not is_dwell[i - 1]]
    result = []
    for first in firsts:
        last = first
        while is_dwell[(last + 1) % n]:
            last = (last + 1) % n
        result.append(Dwell(first, last, float(program.starts[first]), float(program.ends[last])))
    return tuple(result)


class States(NamedTuple):
    """States Y of the one-mass model at S speeds, complex [m/rad or dimensionless].

    Attributes
    ----------
    steady : (S, n) of the response that repeats every turn, at the starts of n pieces of a turn
    from_rest : (S, n) begun at rest at the end of every dwell, or at cam angle 0 where there is none
    in_dwells, in_dwells_from_rest : (S, d) Y - Y_rest of both at the starts of d dwells
    """

    steady: np.ndarray
    from_rest: np.ndarray
    in_dwells: np.ndarray
    in_dwells_from_rest: np.ndarray


class TurnPieces:
    """One turn of a motion in n pieces, divided into parts no wider than ``step`` [rad] where it is given.

    Attributes
    ----------
    pieces : the pieces
    dwells : dwells, by numbers of these pieces
    jumps : (2, n) of s and s' at the starts of the pieces [m or rad], [m/rad or dimensionless]
    displacement : (n,) s at the starts of the pieces [m or rad]
    """

    def __init__(self, program: CompiledMotion, step: float | None = None) -> None:
        pieces = MotionPieces.of(program)
        numbers = np.arange(pieces.widths.size)
        self.pieces, piece = (pieces, numbers) if step is None else pieces.cut(step)
        first = np.searchsorted(piece, numbers)
        last = np.searchsorted(piece, numbers, side="right") - 1
        self.dwells = tuple(Dwell(int(first[d.first]), int(last[d.last]), d.start, d.end) for d in dwells(program))
        self.jumps = np.zeros((2, piece.size))
        for join in program.joins:
            i = int(first[np.searchsorted(program.starts - SNAP, join.theta, side="right") - 1])
            self.jumps[:, i] = np.where(join.jumps[:2], join.jump[:2], 0.0)
        self.displacement = self.pieces.at_start(0)

    def states(self, oscillator: Oscillator) -> States:
        """States at S speeds. The steady response is infinite where it is undamped and a turn has a whole number of periods."""
        change, forcing = self.pieces.exact_step(oscillator)
        jump = -(self.jumps[1] - oscillator.conjugate * self.jumps[0])  # the mass itself does not jump
        n = change.shape[1]
        begin, rest = np.zeros(change.shape[:1], dtype=complex), oscillator.resting(self.displacement)
        free = self._march(begin, change, forcing, jump, 0, n)
        at_end = free[:, n]
        loss = -np.expm1(TURN * oscillator.root[:, 0])  # 1 - e^{λ 2π}
        with np.errstate(divide="ignore", invalid="ignore"):
            start = np.where(np.abs(loss) > RESONANT, at_end / loss, np.inf)
        growth = np.concatenate((np.ones((change.shape[0], 1)), np.cumprod(change, axis=1)[:, :-1]), axis=1)
        with np.errstate(invalid="ignore"):
            steady = free[:, :n] + growth * start[:, None]
        from_rest = self._from_rest(rest, change, forcing, jump)
        at = [dwell.first for dwell in self.dwells]
        return States(steady, from_rest, steady[:, at] - rest[:, at], from_rest[:, at] - rest[:, at])

    def _march(
        self, begin: np.ndarray, change: np.ndarray, forcing: np.ndarray, jump: np.ndarray, first: int, count: int
    ) -> np.ndarray:
        """Y (S, count + 1) at the starts of ``count`` pieces from ``first`` on, and after the last, from Y = begin (S,)."""
        n = change.shape[1]
        states = np.empty((change.shape[0], count + 1), dtype=complex)
        states[:, 0] = begin
        columns = [(first + i) % n for i in range(count)]
        for i, at in enumerate(columns):
            states[:, i + 1] = change[:, at] * states[:, i] + forcing[:, at] + jump[:, (at + 1) % n]
        checkpoint()
        return states

    def _from_rest(self, rest: np.ndarray, change: np.ndarray, forcing: np.ndarray, jump: np.ndarray) -> np.ndarray:
        n = change.shape[1]
        if not self.dwells:
            return self._march(rest[:, 0], change, forcing, jump, 0, n)[:, :n]
        states = np.empty(change.shape, dtype=complex)
        for previous, dwell in zip((self.dwells[-1], *self.dwells), self.dwells, strict=False):
            first = (previous.last + 1) % n
            count = (dwell.last - first) % n + 1
            begin = rest[:, previous.last] + jump[:, first]
            columns = np.arange(first, first + count) % n
            states[:, columns] = self._march(begin, change, forcing, jump, first, count)[:, :count]
        return states


def oscillators(model: Equivalent, omega: np.ndarray) -> Oscillator:
    """One-mass model by cam angle, at several speeds.

    Parameters
    ----------
    model : Equivalent
    omega : ndarray (S,) [rad/s]
        Speeds.

    Returns
    -------
    Oscillator
    """
    omega = omega[:, None]
    decay = 0.5 * model.damping / (model.mass * omega)
    natural = model.natural_frequency / omega
    root = -decay + 1j * natural * math.sqrt(1.0 - model.damping_ratio**2)
    return Oscillator(root, decay, model.closing / (model.mass * omega**2))


class Response:
    """Response of the elastic follower at one speed.

    The steady response repeats every turn; the one from rest begins at rest at the end of each dwell. Without damping, and
    with a whole number of periods in a turn, there is no steady response.
    """

    def __init__(self, model: Equivalent, program: CompiledMotion, omega: float) -> None:
        self.model, self.program, self.omega = model, program, omega
        self._turn, self._oscillator = TurnPieces(program), oscillators(model, np.array([omega]))

    @cached_property
    def _states(self) -> States:
        return self._turn.states(self._oscillator)

    @property
    def is_resonant(self) -> bool:
        """Whether there is no steady response."""
        return not bool(np.isfinite(self._states.steady).all())

    def require_steady(self) -> None:
        """Raise NoSolution where there is no steady response."""
        if self.is_resonant:
            periods = round(self.model.natural_frequency / self.omega)
            raise NoSolution(
                f"the follower vibrates {periods} times in a turn without damping, so that every turn adds to the vibration",
                DAMPING,
                "give it a damping ratio, or change the speed",
            )

    def error(self, angles: Angles, order: int = 0, steady: bool = True) -> np.ndarray:
        """Error e = z - s, or its first or second derivative by cam angle.

        Parameters
        ----------
        angles : Angles (n,)
        order : int
            Of the derivative, 0, 1 or 2.
        steady : bool
            Of the steady response, else of the one from rest.

        Returns
        -------
        ndarray (n,) [m or rad, per radⁿ]

        Raises
        ------
        NoSolution
            Where there is no steady response.

        References
        ----------
        One mass on the follower's stiffness, m z̈ + c ż + k (z - s) + k_s z = 0.
        """
        if steady:
            self.require_steady()
        states = self._states.steady if steady else self._states.from_rest
        within = self._turn.pieces.select(angles.piece, angles.theta - self._turn.pieces.starts[angles.piece])
        change, forcing = within.exact_step(self._oscillator)
        e, speed = (row[0] for row in self._oscillator.errors(change * states[:, angles.piece] + forcing))
        if order < 2:
            return np.asarray(e if order == 0 else speed)
        s = self.program.state(angles).displacement
        _, decay, closing = (float(part[0, 0]) if part.dtype == float else part[0, 0] for part in self._oscillator)
        square = (self.model.natural_frequency / self.omega) ** 2
        return np.asarray(-(s[2] + 2.0 * decay * (s[1] + speed) + closing * s[0] + square * e))

    @cached_property
    def residuals(self) -> tuple[ResidualVibration, ...]:
        """Residual vibration in every dwell; infinite where there is no steady response."""
        width = self._oscillator.root.imag[0, 0]
        rows = np.abs(np.concatenate((self._states.in_dwells_from_rest, self._states.in_dwells))) / width
        rows = np.where(np.isnan(rows), np.inf, rows)
        return tuple(
            ResidualVibration(dwell, float(a), float(b))
            for dwell, a, b in zip(dwells(self.program), *rows, strict=True)
        )

    @property
    def energy_residual(self) -> Residual:
        """Residual of the energy balance of the steady response over a turn, ∮ k (s - z) ż dt = ∮ c ż² dt.

        Relative to the energy exchanged in both directions. The bound of its rounding error grows near an undamped resonance.

        Raises
        ------
        NoSolution
            Where there is no steady response.
        """
        self.require_steady()
        if self.model.natural_frequency > MOST_PERIODS * self.omega:
            return Residual(0.0, 0.0, 1, f"1 turn of more than {MOST_PERIODS} periods")
        x, w = gauss_legendre(NODES)
        starts, ends = self.program.starts, self.program.ends
        counts = np.maximum(
            PANELS, np.ceil((ends - starts) * self.model.natural_frequency / (self.omega * math.pi))
        ).astype(int)
        piece = np.repeat(np.arange(counts.size), counts)
        half = 0.5 * ((ends - starts) / counts)[piece]
        number = np.arange(piece.size) - np.repeat(np.cumsum(counts) - counts, counts)
        theta = (starts[piece] + half * (2 * number + 1))[:, None] + half[:, None] * x
        angles = Angles(theta.ravel(), np.repeat(piece, NODES))
        weights = (half[:, None] * w).ravel()
        speed = (self.program.state(angles).displacement[1] + self.error(angles, 1)) * self.omega
        power_in = -self.model.stiffness * self.error(angles) * speed
        heat = self.model.damping * speed * speed
        size = float(weights @ (np.abs(power_in) + heat)) or 1.0
        loss = abs(np.expm1(TURN * self._oscillator.root[0, 0]))
        return Residual(abs(float(weights @ (power_in - heat))) / size, ROUNDING * EPS * max(1.0, 1.0 / float(loss)))


# -- response spectrum ------------------------------------------------------------------------------------------


STEP = np.deg2rad(0.5)  # greatest distance of the angles at which the largest values are computed
BLOCK = 50  # speeds computed together


@frozen(eq=False)
class Spectrum:
    """Response spectrum: amplitudes over the speed, from rest and steady; infinite where there is no steady response.

    Attributes
    ----------
    omega : (m,) speeds [rad/s]
    dwells : the d dwells
    residual : (2, d, m) amplitude of z - s at the start of each dwell [m or rad]
    error : (2, m) largest |z - s| over the turn, at angles at most 0.5° apart [m or rad]; (2, 0) where not requested
    acceleration : (2, m) largest |z''| over the turn, at the same angles [m/s² or rad/s²]
    """

    omega: np.ndarray
    dwells: tuple[Dwell, ...]
    residual: np.ndarray
    error: np.ndarray
    acceleration: np.ndarray


def spectrum(model: Equivalent, program: CompiledMotion, omega: np.ndarray, with_peaks: bool = True) -> Spectrum:
    """Response spectrum of the elastic follower.

    Parameters
    ----------
    model : Equivalent
    program : CompiledMotion
    omega : ndarray (m,) [rad/s]
        Speeds, positive.
    with_peaks : bool
        Also compute the largest error and acceleration over the turn.

    Returns
    -------
    Spectrum

    Raises
    ------
    Cancelled
        Where the calculation is cancelled.
    """
    turn, parts = TurnPieces(program, STEP if with_peaks else None), []
    for first in range(0, omega.size, BLOCK):
        checkpoint()
        parts.append(_block(model, turn, omega[first : first + BLOCK], with_peaks))
    residual, error, acceleration = (np.concatenate(rows, axis=-1) for rows in zip(*parts, strict=True))
    return Spectrum(omega, dwells(program), residual, error, acceleration)


@np.errstate(invalid="ignore")
def _block(
    model: Equivalent, turn: TurnPieces, omega: np.ndarray, with_peaks: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    oscillator = oscillators(model, omega)
    states = turn.states(oscillator)
    width = oscillator.root.imag[:, 0]
    residual = np.array([np.abs(rows).T / width for rows in (states.in_dwells_from_rest, states.in_dwells)])
    error, acceleration = np.zeros((2, 0)), np.zeros((2, 0))
    if with_peaks:
        both = (_peaks(model, turn, oscillator, rows, omega) for rows in (states.from_rest, states.steady))
        error, acceleration = (np.array(rows) for rows in zip(*both, strict=True))
    return _finite(residual), _finite(error), _finite(acceleration)


def _peaks(
    model: Equivalent, turn: TurnPieces, oscillator: Oscillator, states: np.ndarray, omega: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Largest |z - s| and |z''| (m,) of the states (m, n)."""
    e, speed = oscillator.errors(states)
    natural = (model.natural_frequency / omega[:, None]) ** 2
    z2 = -(
        2.0 * oscillator.decay * (turn.pieces.at_start(1) + speed)
        + oscillator.closing * turn.displacement
        + natural * e
    )
    return np.abs(e).max(axis=1), np.abs(z2).max(axis=1) * omega**2


def _finite(values: np.ndarray) -> np.ndarray:
    """NaN replaced by infinity."""
    return np.where(np.isnan(values), np.inf, values)
