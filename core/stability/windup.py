"""The wind-up of the shaft in time, from rest or from any state, by the nonlinear equation (13) of Kim1990."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np

from core.motion import TURN
from core.stability.coefficients import Coefficients
from core.stability.contact import Contact
from core.stability.following import follow
from core.stability.legs import FULL
from core.stability.march import OUTSIDE
from core.stability.nonlinear import Points
from core.stability.swing import Steps, Swing

LOOKED_AT = np.linspace(0.0, 1.0, 25)  # parts of a step that are looked at for zeros and extremes
BISECTIONS = 50
NEARBY, SURE = 1e-6, 1e-4  # of the swing: from so close by another history starts, to be known so well
CELLS = 6  # cells between looks in which the largest wind-up is searched


@dataclass(frozen=True, eq=False)
class History:
    """Wind-up of one point of the chart over y = 0 ... ``periods`` turns of the input.

    steps   all steps, one after the other
    ended   where it ends [turns]: earlier than asked where the equation could not be followed
    """

    coefficients: Coefficients
    eta: float
    q: float
    damping: float
    periods: float
    steps: Steps
    ended: float
    contact: Contact | None = None

    # -- values -----------------------------------------------------------------------------------------

    def at(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """β and β' (n,) at y (n,) [turns of the input], 0 ... ended."""
        step = np.clip(np.searchsorted(self.steps.y, y, side="right") - 1, 0, None)
        part = np.clip((y - self.steps.y[step]) / self.steps.h[step], 0.0, 1.0)
        return self.steps.at(self._swing, step, part)

    @cached_property
    def _swing(self) -> Swing:
        return Swing.of(np.array([self.eta]), self.damping)

    @cached_property
    def _looks(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """y, β and β' (steps, looks) at ``LOOKED_AT`` of every step."""
        y = self.steps.y[:, None] + self.steps.h[:, None] * LOOKED_AT
        step, part = np.repeat(np.arange(len(y)), LOOKED_AT.size), np.tile(LOOKED_AT, len(y))
        beta, rate = (each.reshape(y.shape) for each in self.steps.at(self._swing, step, part))
        return y, beta, rate

    # -- accuracy ---------------------------------------------------------------------------------------

    @cached_property
    def error(self) -> float:
        """What β may be wrong by, relative to the largest |β|: what the steps may be wrong by at their ends, one after the
        other, as much larger as two histories from close by grow apart, and within the worst step. It is computed when it
        is asked for, by these two."""
        top, swing = self.largest[0], self._swing
        if top == 0.0:
            return 0.0
        scale = float(swing.omega[0]) * top
        start = self.steps.amplitude[0]
        near = start + NEARBY * scale * np.array([0.0, 1.0, 1j])
        beta, rate = swing.read(near)
        inertia = 1.0 + self.q * self.coefficients.panels.at(TURN * np.mod(-beta, 1.0), 1)[0]
        points = np.full(3, self.eta), np.full(3, self.q)
        states = np.stack((beta, inertia * (1.0 - rate)), axis=1)
        told = histories(self.coefficients, *points, self.damping, self.ended, states, error=NEARBY * SURE)
        y = np.linspace(0.0, min(each.ended for each in told), max(2, int(LOOKED_AT.size * self.ended)))
        own, *others = (each.at(y)[0] for each in told)
        apart = sum(float(np.abs(other - own).max()) for other in others) / (NEARBY * top)
        inner, outer = self.steps.wrong.T / scale
        return float(outer.sum() * max(1.0, apart) + inner.max())

    # -- figures ----------------------------------------------------------------------------------------

    @cached_property
    def largest(self) -> tuple[float, float]:
        """max |β| and the y where it stands, refined."""
        y, beta, rate = self._looks
        size = np.abs(beta)
        i, j = np.unravel_index(int(size.argmax()), size.shape)
        best = (float(size[i, j]), float(y[i, j]))
        # every cell whose β' changes sign may hide the top, the highest ones first
        tops = np.where(rate[:, :-1] * rate[:, 1:] <= 0.0, np.maximum(size[:, :-1], size[:, 1:]), -1.0)
        for at in np.argsort(-tops, axis=None)[:CELLS]:
            i, j = np.unravel_index(int(at), tops.shape)
            if tops[i, j] < 0.0:
                break
            part = self._zero(int(i), float(LOOKED_AT[j]), float(LOOKED_AT[j + 1]))
            value = abs(float(self.steps.at(self._swing, np.full(1, i), np.array([part]))[0][0]))
            best = max(best, (value, float(self.steps.y[i] + part * self.steps.h[i])))
        return best

    def _zero(self, step: int, low: float, high: float) -> float:
        """The part of a step at which β' changes sign."""
        at = np.full(1, step)
        sign = np.sign(self.steps.at(self._swing, at, np.array([low]))[1][0])
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            if np.sign(self.steps.at(self._swing, at, np.array([middle]))[1][0]) == sign:
                low = middle
            else:
                high = middle
        return 0.5 * (low + high)

    def averages(self) -> tuple[float, float]:
        """Means of |β| and |β'| over the whole history (Kim1990 Figs. 6, 7: over the first turn)."""
        y, beta, rate = self._looks
        sums = _sizes(y, beta, rate)
        return float(sums[0].sum() / self.ended), float(sums[1].sum() / self.ended)

    @property
    def spread(self) -> float:
        """max |β| in the last third over that in the first: above 1 where the wind-up still grows."""
        y, beta, _ = self._looks
        third = self.ended / 3.0
        last, first = np.abs(beta[y >= 2.0 * third]).max(), np.abs(beta[y <= third]).max()
        return float(last / first) if first > 0.0 else 1.0

    @cached_property
    def turned_back(self) -> float | None:
        """The first y at which the cam stands still and turns back (β' = 1), None where it never does."""
        y, _, rate = self._looks
        return _first_zero(y, 1.0 - rate)

    # -- contact ----------------------------------------------------------------------------------------

    def force(self, y: np.ndarray) -> np.ndarray:
        """Contact force (n,) at y (n,) as a multiple of M X''m ω²; nan without a ``contact``."""
        if self.contact is None:
            return np.full(np.shape(y), np.nan)
        beta, rate = self.at(y)
        return self._force(y, beta, rate)[0]

    def _force(self, y: np.ndarray, beta: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """f (n,) and whether the follower moves there (n,)."""
        assert self.contact is not None
        theta = np.mod(TURN * (y - beta) + OUTSIDE, TURN)  # on a join: right of it
        d, c, u = self.coefficients.panels.at(theta, 3)
        whole = 1.0 + self.q * d
        load = self.q * u * (self.eta**2 if self.coefficients.fixed else 1.0)
        # (13); θ̈/ω² = -β''/2π
        push = self.q * c * (1.0 - rate) ** 2 + load - 2.0 * pi * self.eta**2 * beta
        acceleration = -(push - 2.0 * self.damping * self.eta * rate) / whole
        panels = self.contact.panels
        at = panels.index(theta)
        force = self.contact.force(panels.at(theta, 3), self.eta, 1.0 - rate, acceleration)
        return force, self.contact.moves[at]

    @cached_property
    def _first_loss(self) -> tuple[float, float] | None:
        """Two y between which the contact force first falls below zero while the follower moves; they are one where it
        begins to move so; None where it never does."""
        if self.contact is None:
            return None
        y, beta, rate = (each.ravel() for each in self._looks)
        force, moves = self._force(y, beta, rate)
        bad = np.flatnonzero(moves & (force < 0.0))
        if bad.size == 0:
            return None
        i = int(bad[0])
        before = i - 1 if i % LOOKED_AT.size and moves[i - 1] else i
        return float(y[before]), float(y[i])

    @property
    def loses_contact(self) -> bool:
        """The follower leaves the cam (False where no contact is known)."""
        return self._first_loss is not None

    @cached_property
    def contact_lost(self) -> float | None:
        """The first y at which the contact force falls through zero while the follower moves, None where it never does
        (and where no contact is known)."""
        if self._first_loss is None:
            return None
        low, high = self._first_loss
        while low < (middle := 0.5 * (low + high)) < high:
            if self.force(np.array([middle]))[0] < 0.0:
                high = middle
            else:
                low = middle
        return high

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
    contact: Contact | None = None,
    error: float = FULL,
) -> History:
    """From a state (β, Π) at y = 0, or from rest, β = β' = 0 (Kim1990 §6).

    error  wanted, of β relative to its largest value; the history's own ``error`` says what was reached
    """
    states = None if start is None else np.array([start])
    return histories(coefficients, np.array([eta]), np.array([q]), damping, periods, states, contact, error)[0]


def histories(
    coefficients: Coefficients,
    eta: np.ndarray,
    q: np.ndarray,
    damping: float = 0.0,
    periods: float = 30.0,
    start: np.ndarray | None = None,
    contact: Contact | None = None,
    error: float = FULL,
) -> tuple[History, ...]:
    """Several points (L,) side by side, from states (L, 2) or from rest: hardly slower than one of them."""
    steps, ended = follow(coefficients, Points(eta, q, damping), start, periods, error)
    return tuple(
        History(
            coefficients, float(eta[lane]), float(q[lane]), damping, periods,
            steps.only(np.flatnonzero(steps.lane == lane)), float(ended[lane]), contact,
        )
        for lane in range(eta.size)
    )  # fmt: skip


def _sizes(y: np.ndarray, beta: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """∫ |β| dy and ∫ |β'| dy (steps,) of steps looked at closely (steps, looks): the polynomial of degree 5 through three
    looks with their slopes (Hermite), on -1 ... 1."""
    half = y[:, 1:-1:2] - y[:, :-2:2]
    before, here, after = beta[:, :-2:2], beta[:, 1:-1:2], beta[:, 2::2]
    slopes = half * rate[:, :-2:2], half * rate[:, 1:-1:2], half * rate[:, 2::2]
    even, odd = 0.5 * (after + before) - here, 0.5 * (after - before) - slopes[1]
    fourth = 0.25 * (slopes[2] - slopes[0]) - even
    fifth = 0.25 * (slopes[2] + slopes[0]) - 0.5 * slopes[1] - 1.5 * odd
    curve = np.array([here, slopes[1], even - fourth, odd - fifth, fourth, fifth])
    slope = np.polynomial.polynomial.polyder(curve, axis=0)
    return (half * _both_signs(curve)).sum(axis=1), _both_signs(slope).sum(axis=1)


def _both_signs(powers_of: np.ndarray) -> np.ndarray:
    """∫ |f| over -1 ... 1 of polynomials (degree + 1, ...) that change sign once or not at all."""

    def value(at: np.ndarray, polynomial: np.ndarray) -> np.ndarray:
        return np.asarray(np.polynomial.polynomial.polyval(at, polynomial, tensor=False))

    ones = np.ones(powers_of.shape[1:])
    start, end = value(-ones, powers_of), value(ones, powers_of)
    turns = start * end < 0.0
    zero = np.where(turns, (start + end) / np.where(turns, start - end, 1.0), 1.0)
    slope = np.polynomial.polynomial.polyder(powers_of, axis=0)
    for _ in range(4):
        steep = value(zero, slope)
        step = value(zero, powers_of) / np.where(steep == 0.0, 1.0, steep)
        zero = np.where(turns, np.clip(zero - step, -1.0, 1.0), 1.0)
    area = np.polynomial.polynomial.polyint(powers_of, axis=0)
    low, middle, high = value(-ones, area), value(zero, area), value(ones, area)
    return np.abs(middle - low) + np.abs(high - middle)


def _first_zero(y: np.ndarray, f: np.ndarray) -> float | None:
    """The first y at which f (steps, looks) > 0 falls to 0, between two looks on a straight line."""
    flat, at = f.ravel(), y.ravel()
    below = np.flatnonzero(flat <= 0.0)
    if below.size == 0:
        return None
    i = int(below[0])
    if i == 0:
        return float(at[0])
    part = flat[i - 1] / (flat[i - 1] - flat[i])
    return float(at[i - 1] + part * (at[i] - at[i - 1]))
