"""The shaft's own swing as a turning pointer, and steps of a wind-up in which only the pointer's slow change is kept.

Left alone the shaft obeys β'' + 2a β' + 4π²η² β = 0, a = 2πζη. The complex pointer z = β' + (a + iω) β, ω = 2πη √(1-ζ²),
then only turns and shrinks, z' = λz, λ = -a + iω. What the train adds to (13), a real n = β'' + 2a β' + 4π²η² β, is all
that changes the amplitude A = z e^{-λ(y-y0)}: A' = n e^{-λ(y-y0)}. In a dwell A rests and one step holds any wave.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from math import pi, sqrt

import numpy as np

from core.stability.lanes import Lanes
from core.stability.panels import NODES, gauss, integrals, powers, to_powers

INVERSIONS = 12
CLOSE = 1e-8  # part of a step: a move no longer is the last, what is left is its square
LEAST = 1e-7  # of η: a shaft that swings more slowly does as well as this one


@dataclass(frozen=True, eq=False)
class Swing:
    """a and ω (L,) of some points of the chart."""

    decay: np.ndarray
    omega: np.ndarray

    @staticmethod
    def of(eta: np.ndarray, damping: float) -> Swing:
        return Swing(
            2.0 * pi * damping * eta, 2.0 * pi * sqrt((1.0 - damping) * (1.0 + damping)) * np.maximum(eta, LEAST)
        )

    def only(self, at: np.ndarray, deep: int = 0) -> Swing:
        """Of some points (n,), with so many further axes."""
        shape = (-1,) + (1,) * deep
        return Swing(self.decay[at].reshape(shape), self.omega[at].reshape(shape))

    @property
    def wave(self) -> np.ndarray:
        """λ (L,)."""
        return -self.decay + 1j * self.omega

    def pointer(self, beta: np.ndarray, rate: np.ndarray) -> np.ndarray:
        return np.asarray(rate + (self.decay + 1j * self.omega) * beta)

    def read(self, pointer: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """β and β' of pointers."""
        beta = pointer.imag / self.omega
        return beta, pointer.real - self.decay * beta


@dataclass(frozen=True, eq=False)
class Steps(Lanes):
    """Steps of some lanes, each with a clock that is either the input's turn or the cam's.

    lane       (n,) which
    y, h       (n,) where it starts and how long it is [turns of the input]
    length     (n,) how long it is by its clock [turns]
    by_cam     (n,) 1 where that is the cam's, 0 where it is the input's
    amplitude  (n,) A at its start
    slope      (n, NODES) dA by the clock at the Gauss-Legendre nodes
    wrong      (n, 2) what A may be wrong by within it, and at its end because of it
    """

    lane: np.ndarray
    y: np.ndarray
    h: np.ndarray
    length: np.ndarray
    by_cam: np.ndarray
    amplitude: np.ndarray
    slope: np.ndarray
    wrong: np.ndarray

    @staticmethod
    def joined(parts: list[Steps]) -> Steps:
        return Steps(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Steps)))

    @cached_property
    def powers(self) -> tuple[np.ndarray, np.ndarray]:
        """Coefficients of t**k, t = -1 ... 1, of A (n, NODES + 1) and of dA by the part of the step (n, NODES)."""
        length = self.length[:, None]
        whole = length * integrals(self.slope)
        whole[:, 0] += self.amplitude
        return whole, length * to_powers(self.slope)

    def at(self, swing: Swing, step: np.ndarray, part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """β and β' (m,) at parts (m,) of the durations of steps (m,), of points with these swings (1 or m,)."""
        return swing.read(self._sought(swing, step, part)[0])

    def cut(self, swing: Swing, h: np.ndarray) -> Steps:
        """Steps that end sooner, after h (n,): the same polynomials, of which less is kept; the swings (n,) are their
        points'."""
        clock = self._sought(swing, np.arange(h.size), h / self.h)[1]
        change = self.powers[1] / self.length[:, None]
        slope = np.einsum("nsk,nk->ns", powers(2.0 * clock[:, None] * gauss(NODES)[0] - 1.0, NODES), change)
        return replace(self, h=h, length=clock * self.length, slope=slope)

    def _sought(self, swing: Swing, step: np.ndarray, part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The pointers (m,) at parts of the durations of steps, and the parts of their clocks.

        Where the clock is the cam's it is sought, by Newton's method: what the input has gone on, less what the shaft has
        been wound up.
        """
        whole, change = (each[step] for each in self.powers)
        gone = part * self.h[step]
        turned = np.exp(swing.wave * gone)
        first = (self.amplitude[step] / swing.omega).imag
        length, by_cam = self.length[step], self.by_cam[step]
        clock = part
        for _ in range(INVERSIONS):
            power = powers(2.0 * clock - 1.0, whole.shape[1])
            pointer = turned * (whole * power).sum(axis=1)
            if not by_cam.any():
                break
            slope = turned * (change * power[:, :-1]).sum(axis=1)
            miss = gone - by_cam * (pointer.imag / swing.omega - first) - length * clock
            move = miss / (length + by_cam * slope.imag / swing.omega)
            pointer = pointer + slope * move  # to the square of the move
            clock = np.clip(clock + move, 0.0, 1.0)
            if np.abs(move).max(initial=0.0) <= CLOSE:
                break
        return pointer, clock
