"""Response of the elastic follower: dwells and residual vibration, the response at one speed, and the spectrum over speeds."""

from __future__ import annotations

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np

from core.elastic.follower import DAMPING, Equivalent, MotionPieces, Oscillator
from core.errors import NoSolution
from core.findings import Residual
from core.frozen import frozen
from core.motion import EPS, SNAP, TURN, Angles, CompiledMotion
from core.numerics.lazy import checkpoint
from core.numerics.roots import gauss_legendre

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
