"""One mass in place of an elastic follower: its equivalents in the coordinate of the motion."""

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

# -- one mass in place of an elastic follower -------------------------------------------------------------------


PLACES = 17  # of the stroke, at which the natural frequency is looked at
STIFFNESS, DAMPING = "loads.follower_stiffness_n_per_mm", "loads.follower_damping_ratio"


@frozen
class Equivalent:
    """The one mass m z'' + c z' + k (z - s) + ks z = 0 in the motion's coordinate, SI; of a motion that turns all of it by angle.

    mass       m [kg, or kg m²]
    stiffness  k [N/m, or N m/rad] between the cam's motion s and the mass
    closing    ks, of closing spring, further springs and weight: the second derivative of their potential
    damping    c = 2 ζ √(m (k + ks)) and what dampers add, against the frame [N s/m, or N m s/rad]
    dampers    that part of c which the rigid follower has too
    """

    mass: float
    stiffness: float
    closing: float
    damping: float
    dampers: float = 0.0

    @property
    def natural(self) -> float:
        """ω0 = √((k + ks)/m) [rad/s], without damping."""
        return math.sqrt((self.stiffness + self.closing) / self.mass)

    @property
    def ratio(self) -> float:
        """ζ = c/(2 √(m (k + ks))), of all damping."""
        return self.damping / (2.0 * self.mass * self.natural)

    @property
    def share(self) -> float:
        """k/(k + ks): how far the mass goes where the cam goes 1, at standstill."""
        return self.stiffness / (self.stiffness + self.closing)


@frozen
class Elasticity:
    """The equivalents in the middle of the stroke; way: |dR/dy| there [m per m or rad], of the point at which the stiffness is given;
    the least and the greatest natural frequency over the stroke [rad/s]."""

    middle: Equivalent
    way: float
    lowest: float
    highest: float


def equivalent(
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
    """The follower as one mass, by its equivalents in the middle of the stroke: m = J of the kinetic energy J ẏ²/2; ks = V'' of the
    potential energy; c of dampers from the heat c ẏ²; k = k_R |dR/dy|², R the roller's centre (else the contact in the middle of the
    stroke) and k_R the stiffness there along its path, so that k = k_R arm² for an arm.

    stiffness  k_R [N/m]; ratio: ζ of critical damping 2 √(m (k + ks)), of the follower on its stiffness and all springs
    stroke     lowest and highest motion [m or rad]

    Process forces and constant ones only move the place about which it vibrates, and are left out. Raises NoSolution where there is
    no mass, the springs push it away from the cam more strongly than k holds it, or it is damped so much that nothing vibrates.
    """
    low, high = stroke
    y = np.concatenate(([0.5 * (low + high)], np.linspace(low, high, PLACES)))
    still = by_motion(mechanism, driver_ranges, y, 0.0)
    moving = by_motion(mechanism, driver_ranges, y, 1.0)
    flank = envelope(still, face, cam, sense).flank
    place = flank.contact if flank.straight else flank.reference
    held, pose = still.bodies[flank.body], moving.bodies[flank.body]
    way = pose.origin[1] + 1j * pose.turn[1] * (place - held.origin[0])
    steady = Loading(loading.masses, tuple(e for e in loading.others if not isinstance(e, ScheduledForce)))
    ways = np.broadcast_to(np.abs(way), y.size)
    k = stiffness * ways**2
    mass, closing = steady.inertia(moving, 1)[0], steady.potential(moving)[1]
    dampers = sum((element.lost(moving, 1.0) for element in steady.elements), np.zeros(y.size))
    if not (mass > 0.0).all():
        raise NoSolution(
            "an elastic follower without a mass does not vibrate",
            "loads",
            "give its masses, or take its stiffness away",
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
    found = Equivalent(float(mass[0]), float(k[0]), float(closing[0]), float(damping[0]), float(dampers[0]))
    if found.ratio >= 1.0:
        raise NoSolution(
            f"with its dampers the follower's damping ratio is {found.ratio:.4g}: nothing vibrates",
            DAMPING,
            "allowed with them: below 1; weaken the dampers, or enlarge the stiffness",
        )
    return Elasticity(found, float(ways[0]), float(natural.min()), float(natural.max()))


def by_motion(mechanism: Mechanism, driver_ranges: DriverRanges, y: np.ndarray, speed: float) -> Kinematics:
    """The mechanism at motions (n,), at cam angle 0, with derivatives by the motion times ``speed``."""
    one, none = np.full(y.size, speed), np.zeros(y.size)
    angles = Angles(none, np.zeros(y.size, dtype=int))
    return solve_mechanism(mechanism, MotionState(angles, Derivatives.of((y, one, none, none)), one), driver_ranges)


# -- the motion as pieces with their coefficients, and the exact answer of the one mass over a piece ------------


SERIES = 40  # terms of a power series at the most
SMALL = 1e-17  # of its first term: what is left out


class Oscillator(NamedTuple):
    """S oscillators, each (S, 1): λ complex, δ and Ω_s² [per radian of cam angle]."""

    root: np.ndarray
    decay: np.ndarray
    closing: np.ndarray

    @property
    def conjugate(self) -> np.ndarray:
        """λ̄, real parts negative."""
        return np.conj(self.root)

    def errors(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """e and e' (S, n) of the states Y (S, n)."""
        e = y.imag / self.root.imag
        return e, y.real - self.decay * e

    def resting(self, s: np.ndarray) -> np.ndarray:
        """The state Y in which it stands still in a dwell at s: e = -ks/(k + ks) s."""
        square = self.root.real**2 + self.root.imag**2
        return np.asarray(self.conjugate * (self.closing / square) * s)


@frozen(eq=False)
class MotionPieces:
    """n pieces of the motion, SI by cam angle: where each starts, how wide it is (n,), coefficients of its powers (k, n), and
    amplitude, frequency and phase of its sines (3, j, n)."""

    starts: np.ndarray
    widths: np.ndarray
    powers: np.ndarray
    sines: np.ndarray

    @staticmethod
    def of(program: CompiledMotion) -> MotionPieces:
        """Those of a compiled motion."""
        return MotionPieces(program.starts, program.ends - program.starts, program.powers, program.sines)

    def only(self, at: np.ndarray, widths: np.ndarray | None = None) -> MotionPieces:
        """The pieces ``at`` (m,), indices, as wide as said."""
        wide = self.widths[at] if widths is None else widths
        return MotionPieces(self.starts[at], wide, self.powers[:, at], self.sines[:, :, at])

    def cut(self, step: float) -> tuple[MotionPieces, np.ndarray]:
        """Each in equal parts no wider than step [rad]; and the numbers (m,) of the pieces that the parts are of."""
        counts = np.ceil(self.widths / step).astype(int)
        of = np.repeat(np.arange(counts.size), counts)
        part = np.arange(of.size) - np.repeat(np.cumsum(counts) - counts, counts)
        widths = (self.widths / counts)[of]
        by, powers = part * widths, self.powers[:, of]
        moved = np.zeros_like(powers)
        for j in range(powers.shape[0]):
            for k in range(powers.shape[0] - 1, j - 1, -1):
                moved[j] = moved[j] * by + comb(k, j) * powers[k]
        sines = self.sines[:, :, of]
        sines[2] += sines[1] * by
        return MotionPieces(self.starts[of] + by, widths, moved, sines), of

    def at_end(self, order: int) -> np.ndarray:
        """s, s' or s'' (n,) at the ends of the pieces."""
        return self._value(self.widths, order)

    def at_start(self, order: int) -> np.ndarray:
        """s, s' or s'' (n,) at their starts."""
        return self._value(np.zeros(self.widths.size), order)

    def _value(self, w: np.ndarray, order: int) -> np.ndarray:
        total = np.zeros(w.size)
        for k in range(self.powers.shape[0] - 1, order - 1, -1):
            total = total * w + self.powers[k] * (factorial(k) // factorial(k - order))
        amplitude, frequency, phase = self.sines
        waves = amplitude * frequency**order * np.sin(frequency * w + phase + 0.5 * np.pi * order)
        return np.asarray(total + waves.sum(axis=0))

    @np.errstate(under="ignore")
    def driven(self, oscillator: Oscillator) -> tuple[np.ndarray, np.ndarray]:
        """Over each piece Y -> E Y + G: both (S, n)."""
        lam, decay, closing = oscillator
        w, powers = self.widths, self.powers
        most = powers.shape[0]
        wide, of = np.unique(w, return_inverse=True)  # parts of one piece are equally wide
        phi = [row[:, of] for row in _phi(lam * wide, most)]
        total = np.zeros((lam.shape[0], w.size), dtype=complex)
        for k in range(most):
            forcing = closing * powers[k]
            if k + 1 < most:
                forcing = forcing + 2.0 * (k + 1) * decay * powers[k + 1]
            if k + 2 < most:
                forcing = forcing + (k + 1) * (k + 2) * powers[k + 2]
            total -= (factorial(k) * w ** (k + 1)) * forcing * phi[k + 1]
        for amplitude, frequency, phase in zip(*self.sines, strict=True):
            has = np.flatnonzero(amplitude)
            if has.size:
                a = frequency[has]
                forced = -amplitude[has] * (closing - a * a + 2j * decay * a) * np.exp(1j * phase[has])
                same, of = np.unique(w[has] + 1j * a, return_inverse=True)
                up, down = (_beat(lam, sign * same.imag, same.real)[:, of] for sign in (1.0, -1.0))
                total[:, has] += (forced * up - np.conj(forced) * down) / 2j
        return phi[0], total


def _beat(lam: np.ndarray, frequency: np.ndarray, w: np.ndarray) -> np.ndarray:
    """∫ e^{λ(w-τ)} e^{iaτ} dτ over 0 ... w (S, n), also where λ is near ia."""
    apart, decayed = 1j * frequency - lam, np.exp(lam * w)
    x = apart * w
    near, zero = np.abs(x) < 1.0, x == 0.0
    inner = np.where(near & ~zero, x, 1.0)
    close = decayed * w * np.where(zero, 1.0, np.expm1(inner) / inner)
    far = (np.exp(1j * frequency * w) - decayed) / np.where(near, 1.0, apart)
    return np.where(near, close, far)


def _phi(x: np.ndarray, most: int) -> list[np.ndarray]:
    """φ_0 = e^x, φ_k(x) = Σ x^j/(j + k)! for k = 0 ... most: by φ_{k+1} = (φ_k - 1/k!)/x upwards as long as |x| > k, else
    downwards from the series of the last."""
    size = np.abs(x)
    up = [np.exp(x)]
    safe = np.where(size < 1.0, 1.0, x)
    for k in range(most):
        up.append((up[-1] - 1.0 / factorial(k)) / safe)
    small = size < most + 1.0
    if not small.any():
        return up
    inner, least = x[small], size[small]
    down = _phi_series(inner, most)
    for k in range(most, 0, -1):
        up[k][small] = np.where(least < k, down, up[k][small])
        down = inner * down + 1.0 / factorial(k - 1)
    return up


def _phi_series(x: np.ndarray, k: int) -> np.ndarray:
    """φ_k by its power series: for |x| up to about k."""
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


# -- what the elastic follower does at one speed ----------------------------------------------------------------


NODES, PANELS = 16, 4  # of the balance of energy: angles of a panel, panels of a piece at least, one in half a period
MOST_PERIODS = 1000  # in a turn, up to which energy is balanced
ROUNDING = 64.0
RESONANT = 1e-9  # of a turn's change of the state: nearer to none there is no steady response


@frozen
class Dwell:
    """A dwell: its first and its last piece, and its cam angles [rad]; from > to passes 360°."""

    first: int
    last: int
    start: float
    end: float


@frozen
class ResidualVibration:
    """How the mass vibrates in a dwell, at its start, about the place where it would stand there [m or rad]: amplitude of z - s.

    from_rest  what the motion since the dwell before leaves, if it stood still at its end
    steady     of the response that repeats every turn, which also holds what is left of all earlier ones
    """

    dwell: Dwell
    from_rest: float
    steady: float


def dwells(program: CompiledMotion) -> tuple[Dwell, ...]:
    """The dwells in the order of their starts; one that passes 360° is one, and the last. None where nothing else is."""
    stands = program.velocity_signs == 0.0
    n = stands.size
    if stands.all():
        return ()
    firsts = [i for i in range(n) if stands[i] and not stands[i - 1]]
    found = []
    for first in firsts:
        last = first
        while stands[(last + 1) % n]:
            last = (last + 1) % n
        found.append(Dwell(first, last, float(program.starts[first]), float(program.ends[last])))
    return tuple(found)


class States(NamedTuple):
    """Y (S, n) at the starts of n pieces of a turn, steady and from rest: begun at rest at the end of every dwell, or at cam angle
    0 where there is none; and the vibration Y - Y_rest (S, d) at the start of each dwell of both."""

    steady: np.ndarray
    from_rest: np.ndarray
    in_dwells: np.ndarray
    in_dwells_from_rest: np.ndarray


class ProgramTurn:
    """The program's turn in n pieces: as they are, or cut into parts no wider than ``step`` [rad]."""

    def __init__(self, program: CompiledMotion, step: float | None = None) -> None:
        whole = MotionPieces.of(program)
        self.pieces, of = (whole, np.arange(whole.widths.size)) if step is None else whole.cut(step)
        first = np.searchsorted(of, np.arange(whole.widths.size))
        last = np.searchsorted(of, np.arange(whole.widths.size), side="right") - 1
        self.dwells = tuple(Dwell(int(first[d.first]), int(last[d.last]), d.start, d.end) for d in dwells(program))
        self.jumps = np.zeros((2, of.size))  # of s and s' at the starts of pieces
        for join in program.joins:
            at = int(first[np.searchsorted(program.starts - SNAP, join.theta, side="right") - 1])
            self.jumps[:, at] = np.where(join.jumps[:2], join.jump[:2], 0.0)
        self.places = self.pieces.at_start(0)

    def states(self, oscillator: Oscillator) -> States:
        """Of S oscillators. The steady response is infinite where nothing damps it and the turn holds whole periods."""
        change, drive = self.pieces.driven(oscillator)
        jump = -(self.jumps[1] - oscillator.conjugate * self.jumps[0])  # the mass goes on as before
        n = change.shape[1]
        begin, rest = np.zeros(change.shape[:1], dtype=complex), oscillator.resting(self.places)
        free = self._march(begin, change, drive, jump, 0, n)
        at_end = free[:, n]
        left = -np.expm1(TURN * oscillator.root[:, 0])  # 1 - e^{λ 2π}
        with np.errstate(divide="ignore", invalid="ignore"):
            start = np.where(np.abs(left) > RESONANT, at_end / left, np.inf)
        grown = np.concatenate((np.ones((change.shape[0], 1)), np.cumprod(change, axis=1)[:, :-1]), axis=1)
        with np.errstate(invalid="ignore"):
            steady = free[:, :n] + grown * start[:, None]
        alone = self._from_rest(rest, change, drive, jump)
        at = [d.first for d in self.dwells]
        return States(steady, alone, steady[:, at] - rest[:, at], alone[:, at] - rest[:, at])

    def _march(
        self, begin: np.ndarray, change: np.ndarray, drive: np.ndarray, jump: np.ndarray, first: int, count: int
    ) -> np.ndarray:
        """Y (S, count + 1) at the starts of pieces from ``first`` on, and after the last; begin (S,) there."""
        n = change.shape[1]
        found = np.empty((change.shape[0], count + 1), dtype=complex)
        found[:, 0] = begin
        columns = [(first + i) % n for i in range(count)]
        for i, at in enumerate(columns):
            found[:, i + 1] = change[:, at] * found[:, i] + drive[:, at] + jump[:, (at + 1) % n]
        checkpoint()
        return found

    def _from_rest(self, rest: np.ndarray, change: np.ndarray, drive: np.ndarray, jump: np.ndarray) -> np.ndarray:
        n = change.shape[1]
        if not self.dwells:
            return self._march(rest[:, 0], change, drive, jump, 0, n)[:, :n]
        found = np.empty(change.shape, dtype=complex)
        for before, dwell in zip((self.dwells[-1], *self.dwells), self.dwells, strict=False):
            first = (before.last + 1) % n
            count = (dwell.last - first) % n + 1
            begin = rest[:, before.last] + jump[:, first]
            found[:, np.arange(first, first + count) % n] = self._march(begin, change, drive, jump, first, count)[
                :, :count
            ]
        return found


def oscillators(one: Equivalent, omega: np.ndarray) -> Oscillator:
    """At speeds (S,) [rad/s]."""
    omega = omega[:, None]
    decay = 0.5 * one.damping / (one.mass * omega)
    natural = one.natural / omega
    return Oscillator(-decay + 1j * natural * math.sqrt(1.0 - one.ratio**2), decay, one.closing / (one.mass * omega**2))


class Response:
    """The follower at one speed omega [rad/s]. Raises NoSolution where nothing damps it and its turn holds whole periods: each turn
    adds to its vibration.

    steady: the response that repeats every turn; else that from rest, begun anew at the end of each dwell.
    """

    def __init__(self, one: Equivalent, program: CompiledMotion, omega: float) -> None:
        self.one, self.program, self.omega = one, program, omega
        self._turn, self._oscillator = ProgramTurn(program), oscillators(one, np.array([omega]))

    @cached_property
    def _states(self) -> States:
        return self._turn.states(self._oscillator)

    @property
    def resonant(self) -> bool:
        """Whether there is no steady response."""
        return not bool(np.isfinite(self._states.steady).all())

    def require_steady(self) -> None:
        """Raises NoSolution where there is no steady response."""
        if self.resonant:
            periods = round(self.one.natural / self.omega)
            raise NoSolution(
                f"the follower vibrates {periods} times in a turn and nothing damps it, so that every turn adds to it",
                DAMPING,
                "give it a damping ratio, or change the speed",
            )

    def error(self, angles: Angles, order: int = 0, steady: bool = True) -> np.ndarray:
        """e = z - s (n,) [m or rad], or its first or second derivative by cam angle."""
        if steady:
            self.require_steady()
        states = self._states.steady if steady else self._states.from_rest
        within = self._turn.pieces.only(angles.piece, angles.theta - self._turn.pieces.starts[angles.piece])
        change, drive = within.driven(self._oscillator)
        e, speed = (row[0] for row in self._oscillator.errors(change * states[:, angles.piece] + drive))
        if order < 2:
            return np.asarray(e if order == 0 else speed)
        s = self.program.state(angles).displacement
        _, decay, closing = (float(part[0, 0]) if part.dtype == float else part[0, 0] for part in self._oscillator)
        square = (self.one.natural / self.omega) ** 2
        return np.asarray(-(s[2] + 2.0 * decay * (s[1] + speed) + closing * s[0] + square * e))

    @cached_property
    def residuals(self) -> tuple[ResidualVibration, ...]:
        """Of every dwell; infinite where there is no steady response."""
        width = self._oscillator.root.imag[0, 0]
        rows = np.abs(np.concatenate((self._states.in_dwells_from_rest, self._states.in_dwells))) / width
        rows = np.where(np.isnan(rows), np.inf, rows)
        return tuple(
            ResidualVibration(d, float(a), float(b)) for d, a, b in zip(dwells(self.program), *rows, strict=True)
        )

    @property
    def energy_residual(self) -> Residual:
        """Of the steady response: ∮ k (s - z) ż dt = ∮ c ż² dt, since mass and springs give back in a turn all that they take;
        relative to what goes to and fro. What rounding may make of it grows where hardly anything is damped, near resonance."""
        self.require_steady()
        if self.one.natural > MOST_PERIODS * self.omega:
            return Residual(0.0, 0.0, 1, f"1 turn of more than {MOST_PERIODS} periods")
        x, weight = gauss_legendre(NODES)
        starts, ends = self.program.starts, self.program.ends
        counts = np.maximum(PANELS, np.ceil((ends - starts) * self.one.natural / (self.omega * math.pi))).astype(int)
        piece = np.repeat(np.arange(counts.size), counts)
        half = 0.5 * ((ends - starts) / counts)[piece]
        number = np.arange(piece.size) - np.repeat(np.cumsum(counts) - counts, counts)
        theta = (starts[piece] + half * (2 * number + 1))[:, None] + half[:, None] * x
        angles = Angles(theta.ravel(), np.repeat(piece, NODES))
        weights = (half[:, None] * weight).ravel()
        speed = (self.program.state(angles).displacement[1] + self.error(angles, 1)) * self.omega
        given = -self.one.stiffness * self.error(angles) * speed
        taken = self.one.damping * speed * speed
        size = float(weights @ (np.abs(given) + taken)) or 1.0
        left = abs(np.expm1(TURN * self._oscillator.root[0, 0]))
        return Residual(abs(float(weights @ (given - taken))) / size, ROUNDING * EPS * max(1.0, 1.0 / float(left)))


# -- the response spectrum of an elastic follower ---------------------------------------------------------------


STEP = np.deg2rad(0.5)  # widest distance of the angles at which the largest values are taken
AT_ONCE = 50  # speeds


@frozen(eq=False)
class Spectrum:
    """At speeds omega (m,) [rad/s], from rest and steady (see ``ResidualVibration``), the latter infinite where there is none; SI by time.

    residual      (2, d, m) amplitude of z - s at the start of each dwell
    error         (2, m) largest |z - s| over the turn, and ``acceleration`` (2, m) largest |z''|: of angles 0.5° apart at the most;
                  both empty, (2, 0), where they were not asked for
    """

    omega: np.ndarray
    dwells: tuple[Dwell, ...]
    residual: np.ndarray
    error: np.ndarray
    acceleration: np.ndarray


def spectrum(one: Equivalent, program: CompiledMotion, omega: np.ndarray, largest: bool = True) -> Spectrum:
    """At speeds (m,) > 0 [rad/s]; largest: with the largest values over the turn. Raises Cancelled where it is no longer wanted."""
    turn, parts = ProgramTurn(program, STEP if largest else None), []
    for first in range(0, omega.size, AT_ONCE):
        checkpoint()
        parts.append(_at(one, turn, omega[first : first + AT_ONCE], largest))
    residual, error, acceleration = (np.concatenate(rows, axis=-1) for rows in zip(*parts, strict=True))
    return Spectrum(omega, dwells(program), residual, error, acceleration)


@np.errstate(invalid="ignore")
def _at(
    one: Equivalent, turn: ProgramTurn, omega: np.ndarray, largest: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    oscillator = oscillators(one, omega)
    states = turn.states(oscillator)
    width = oscillator.root.imag[:, 0]
    residual = np.array([np.abs(rows).T / width for rows in (states.in_dwells_from_rest, states.in_dwells)])
    error, acceleration = np.zeros((2, 0)), np.zeros((2, 0))
    if largest:
        both = (_largest(one, turn, oscillator, rows, omega) for rows in (states.from_rest, states.steady))
        error, acceleration = (np.array(rows) for rows in zip(*both, strict=True))
    return _finite(residual), _finite(error), _finite(acceleration)


def _largest(
    one: Equivalent, turn: ProgramTurn, oscillator: Oscillator, states: np.ndarray, omega: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """|z - s| and |z''| (m,) of the states (m, n)."""
    e, speed = oscillator.errors(states)
    natural = (one.natural / omega[:, None]) ** 2
    z2 = -(2.0 * oscillator.decay * (turn.pieces.at_start(1) + speed) + oscillator.closing * turn.places + natural * e)
    return np.abs(e).max(axis=1), np.abs(z2).max(axis=1) * omega**2


def _finite(values: np.ndarray) -> np.ndarray:
    """Infinite where there is no number."""
    return np.where(np.isnan(values), np.inf, values)
