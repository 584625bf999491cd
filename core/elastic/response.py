"""What the elastic follower does at one speed: its motion over the turn, and how it vibrates in every dwell."""

from __future__ import annotations

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np

from core.elastic.equivalent import DAMPING, Equivalent
from core.elastic.pieces import MotionPieces, Oscillator
from core.errors import NoAnswer
from core.findings import Residual
from core.frozen import frozen
from core.motion import EPS, SNAP, TURN, Angles, Program
from core.numerics.cancellation import checkpoint
from core.numerics.gauss import gauss_legendre

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


def dwells(program: Program) -> tuple[Dwell, ...]:
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

    def __init__(self, program: Program, step: float | None = None) -> None:
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
    """The follower at one speed omega [rad/s]. Raises NoAnswer where nothing damps it and its turn holds whole periods: each turn
    adds to its vibration.

    steady: the response that repeats every turn; else that from rest, begun anew at the end of each dwell.
    """

    def __init__(self, one: Equivalent, program: Program, omega: float) -> None:
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
        """Raises NoAnswer where there is no steady response."""
        if self.resonant:
            periods = round(self.one.natural / self.omega)
            raise NoAnswer(
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
