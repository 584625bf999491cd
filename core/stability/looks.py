"""Steps of wind-ups looked at closely, of many points of the chart at once: for zeros, extremes, sizes and forces.

A step is looked at at fixed parts of its own clock: there its polynomials are the same few products for all steps, and where
the clock is the cam's, the time is found by the shaft's swing alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from core.motion import TURN
from core.stability.contact import Contact
from core.stability.march import OUTSIDE
from core.stability.panels import NODES, powers
from core.stability.swing import INVERSIONS, Steps, Swing

LOOKED_AT = np.linspace(0.0, 1.0, 25)  # parts of a step by its clock
CLOSE = 1e-7  # [rad] of the swing: a move no longer is the last, what is left is its square
ZERO_STEPS = 6  # of Newton's method in a polynomial that passes zero once

_POWERS = powers(2.0 * LOOKED_AT - 1.0, NODES + 1).T


@dataclass(frozen=True, eq=False)
class Looks:
    """What steps (n,) are at ``LOOKED_AT`` of their clocks.

    steps  the steps
    y      (n, looks) [turns of the input]
    beta, rate, bend  (n, looks) β, β' and β'' there, at the ends of a step from inside it
    """

    steps: Steps
    y: np.ndarray
    beta: np.ndarray
    rate: np.ndarray
    bend: np.ndarray

    @property
    def part(self) -> np.ndarray:
        """The looks as parts (n, looks) of the steps' durations."""
        return (self.y - self.steps.y[:, None]) / self.steps.h[:, None]

    def sizes(self) -> np.ndarray:
        """∫ |β| dy and ∫ |β'| dy (2, n) over the steps.

        Between two looks β is the polynomial of degree 5 with their values, slopes and bends (Hermite). Where nothing passes
        zero, ∫ β dy is h (β0 + β1)/2 + h² (β0' - β1')/10 + h³ (β0'' + β1'')/120, and ∫ β' dy the difference of β.
        """
        h = np.diff(self.y)
        before, after = (slice(None), slice(None, -1)), (slice(None), slice(1, None))
        area = 0.5 * (self.beta[before] + self.beta[after])
        area += h * ((self.rate[before] - self.rate[after]) / 10.0 + h * (self.bend[before] + self.bend[after]) / 120.0)
        sums = []
        for values, plain, which in ((self.beta, h * area, 0), (self.rate, np.diff(self.beta), 1)):
            size = np.abs(plain)
            i, j = np.nonzero(values[before] * values[after] < 0.0)
            size[i, j] = _both_signs(self._curves(i, j, h[i, j]), which) * (0.5 * h[i, j] if which == 0 else 1.0)
            sums.append(size.sum(axis=1))
        return np.array(sums)

    def _curves(self, i: np.ndarray, j: np.ndarray, h: np.ndarray) -> np.ndarray:
        """β between looks j and j + 1 of steps i (m,), h apart: coefficients (6, m) on -1 ... 1."""
        b0, b1 = self.beta[i, j], self.beta[i, j + 1]
        r0, r1 = 0.5 * h * self.rate[i, j], 0.5 * h * self.rate[i, j + 1]
        c0, c1 = 0.25 * h * h * self.bend[i, j], 0.25 * h * h * self.bend[i, j + 1]
        even, slope, bend = 0.5 * (b0 + b1), 0.5 * (r1 - r0), 0.5 * (c0 + c1)
        odd, mean, lean = 0.5 * (b1 - b0), 0.5 * (r0 + r1), 0.5 * (c1 - c0)
        fourth, fifth = 0.125 * (bend - slope), 0.125 * (lean - 3.0 * mean + 3.0 * odd)
        second, third = 0.5 * (slope - 4.0 * fourth), 0.5 * (mean - odd - 4.0 * fifth)
        return np.array([even - second - fourth, odd - third - fifth, second, third, fourth, fifth])

    def losing(self, contact: Contact, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where (n, looks) the follower moves, and where it moves and no force presses it on the cam, of points with η (n or 1,)."""
        theta = TURN * (self.y - self.beta)
        # at a join: from inside the step, which is where its bend is from
        inwards = OUTSIDE * np.sign(theta[:, -1:] - theta[:, :1]) * (1.0 - 2.0 * LOOKED_AT)
        theta = np.mod(theta + inwards, TURN) - inwards
        moves = contact.moves[contact.panels.index((theta + inwards).ravel())].reshape(theta.shape)
        losing = np.zeros(moves.shape, dtype=bool)
        speed, acceleration = 1.0 - self.rate[moves], self.bend[moves] / (-2.0 * pi)  # θ̇/ω, θ̈/ω²
        own = np.broadcast_to(np.asarray(eta)[:, None], moves.shape)[moves]
        losing[moves] = contact.force(contact.panels.at(theta[moves], 3, inwards[moves]), own, speed, acceleration) < 0.0
        return moves, losing


def look(steps: Steps, swing: Swing) -> Looks:
    """Look at steps (n,) of points with these swings (n or 1,).

    y - β is what the cam has turned; where that is the clock, y is sought for it by Newton's method.
    """
    whole, change = steps.powers
    amplitude, slope = whole @ _POWERS, (change / steps.length[:, None]) @ _POWERS[:-1]
    lanes = swing.only(np.arange(swing.omega.size), 1)
    wave, omega, decay = lanes.wave, lanes.omega, lanes.decay
    by_cam = steps.by_cam[:, None]
    first = (steps.amplitude[:, None] / omega).imag
    passed = steps.length[:, None] * LOOKED_AT
    gone = steps.h[:, None] * LOOKED_AT
    most = 0.5 / np.abs(wave)
    for _ in range(INVERSIONS):
        pointer = np.exp(wave * gone)
        beta, rate = lanes.read(pointer * amplitude)
        move = by_cam * np.clip((passed - gone + beta - first) / np.where(by_cam > 0.0, 1.0 - rate, 1.0), -most, most)
        gone = gone + move
        if (np.abs(move) * np.abs(wave)).max(initial=0.0) <= CLOSE:
            break
    pointer = pointer * (1.0 + wave * move)  # to the square of the move
    beta, rate = lanes.read(pointer * amplitude)
    added = (slope * pointer).real * (1.0 - by_cam * rate)
    bend = added - 2.0 * decay * rate - (decay * decay + omega * omega) * beta
    return Looks(steps, steps.y[:, None] + gone, beta, rate, bend)


def _both_signs(curves: np.ndarray, order: int) -> np.ndarray:
    """∫ |f| over -1 ... 1 of polynomials (degree + 1, m), or of their first derivatives, that change sign once."""
    polynomial = np.polynomial.polynomial
    f = polynomial.polyder(curves, order, axis=0) if order else curves
    area = curves if order else polynomial.polyint(curves, axis=0)
    slope = polynomial.polyder(f, axis=0)

    def value(at: np.ndarray, of: np.ndarray) -> np.ndarray:
        return np.asarray(polynomial.polyval(at, of, tensor=False))

    ones = np.ones(curves.shape[1:])
    start, end = value(-ones, f), value(ones, f)
    zero = (start + end) / (start - end)
    for _ in range(ZERO_STEPS):
        steep = value(zero, slope)
        zero = np.clip(zero - value(zero, f) / np.where(steep == 0.0, 1.0, steep), -1.0, 1.0)
    low, middle, high = value(-ones, area), value(zero, area), value(ones, area)
    return np.abs(middle - low) + np.abs(high - middle)
