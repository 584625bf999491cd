"""Equivalent mass, stiffness and damping of a follower, and its exact vibration over a piece of the motion."""

from __future__ import annotations

import math
from math import comb, factorial
from typing import Any, NamedTuple

import numpy as np

from core.cam import envelope
from core.dynamics import Loading, ScheduledForce
from core.errors import NoSolution
from core.frozen import frozen
from core.mechanism import DriverRanges, Mechanism, solve_mechanism
from core.mechanism.kinematics import Kinematics
from core.motion import Angles, CompiledMotion, MotionState
from core.number_text import result_text
from core.numerics.derivatives import Derivatives

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
            f"weight and springs push the follower's mass away {result_text(stronger)} times as strongly as its stiffness holds it",
            STIFFNESS,
            "allowed: less than once; enlarge it, or weaken them",
        )
    natural = np.sqrt((k + closing) / mass)
    damping = 2.0 * ratio * mass * natural + dampers
    middle = Equivalent(float(mass[0]), float(k[0]), float(closing[0]), float(damping[0]), float(dampers[0]))
    if middle.damping_ratio >= 1.0:
        raise NoSolution(
            f"with its dampers the follower's damping ratio is {result_text(middle.damping_ratio)}: nothing vibrates",
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
