"""The wind-up of the shaft in time, from rest or from any state, by the nonlinear equation (13) of Kim1990."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np

from core.motion import TURN
from core.stability.coefficients import Coefficients
from core.stability.contact import Contact
from core.stability.following import follow
from core.stability.legs import FULL
from core.stability.looks import LOOKED_AT, Looks, look
from core.stability.march import OUTSIDE
from core.stability.nonlinear import Points
from core.stability.swing import Steps, Swing

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
    def _looks(self) -> Looks:
        return look(self.steps, self._swing)

    # -- accuracy ---------------------------------------------------------------------------------------

    @cached_property
    def error(self) -> float:
        """What β may be wrong by, relative to the largest |β|, see ``errors``. It is computed when it is asked for."""
        return float(errors([self])[0])

    # -- figures ----------------------------------------------------------------------------------------

    @cached_property
    def largest(self) -> tuple[float, float]:
        """max |β| and the y where it stands, refined."""
        looks = self._looks
        y, rate, size = looks.y, looks.rate, np.abs(looks.beta)
        i, j = np.unravel_index(int(size.argmax()), size.shape)
        best = (float(size[i, j]), float(y[i, j]))
        # every cell whose β' changes sign may hide the top, the highest ones first
        tops = np.where(rate[:, :-1] * rate[:, 1:] <= 0.0, np.maximum(size[:, :-1], size[:, 1:]), -1.0)
        for at in np.argsort(-tops, axis=None)[:CELLS]:
            i, j = np.unravel_index(int(at), tops.shape)
            if tops[i, j] < 0.0:
                break
            part = self._zero(int(i), *(float(looks.part[i, k]) for k in (j, j + 1)))
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
        wind_up, slope = self._looks.sizes().sum(axis=1) / self.ended
        return float(wind_up), float(slope)

    @property
    def spread(self) -> float:
        """max |β| in the last third over that in the first: above 1 where the wind-up still grows."""
        y, beta = self._looks.y, self._looks.beta
        third = self.ended / 3.0
        last, first = np.abs(beta[y >= 2.0 * third]).max(), np.abs(beta[y <= third]).max()
        return float(last / first) if first > 0.0 else 1.0

    @cached_property
    def turned_back(self) -> float | None:
        """The first y at which the cam stands still and turns back (β' = 1), None where it never does."""
        return _first_zero(self._looks.y, 1.0 - self._looks.rate)

    # -- contact ----------------------------------------------------------------------------------------

    def force(self, y: np.ndarray) -> np.ndarray:
        """Contact force (n,) at y (n,) as a multiple of M X''m ω²; nan without a ``contact``."""
        if self.contact is None:
            return np.full(np.shape(y), np.nan)
        beta, rate = self.at(y)
        theta = np.mod(TURN * (y - beta) + OUTSIDE, TURN) - OUTSIDE
        d, c, u = self.coefficients.panels.at(theta, 3, OUTSIDE)  # on a join: right of it
        whole = 1.0 + self.q * d
        load = self.q * u * (self.eta**2 if self.coefficients.fixed else 1.0)
        # (13); θ̈/ω² = -β''/2π
        push = self.q * c * (1.0 - rate) ** 2 + load - 2.0 * pi * self.eta**2 * beta
        acceleration = -(push - 2.0 * self.damping * self.eta * rate) / whole
        return self.contact.force(self.contact.panels.at(theta, 3, OUTSIDE), self.eta, 1.0 - rate, acceleration)

    @cached_property
    def _first_loss(self) -> tuple[float, float] | None:
        """Two y between which the contact force first falls below zero while the follower moves; they are one where it
        begins to move so; None where it never does."""
        if self.contact is None:
            return None
        moves, losing = (each.ravel() for each in self._looks.losing(self.contact, np.array([self.eta])))
        bad, y = np.flatnonzero(losing), self._looks.y.ravel()
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


def errors(gone: Sequence[History]) -> np.ndarray:
    """What histories (L,) of one equation and damping may be wrong by: β relative to the largest |β|, the pointer (see
    ``swing``) to ω times that.

    It is what the steps may be wrong by at their ends, one after the other, as much larger as two histories from close by
    grow apart, and within the worst step. Those from close by go side by side for all.
    """
    coefficients, damping = gone[0].coefficients, gone[0].damping
    eta, q = (np.array([getattr(each, name) for each in gone]) for name in ("eta", "q"))
    swing = Swing.of(eta, damping)
    scale = swing.omega * np.array([each.largest[0] for each in gone])
    start = np.array([each.steps.amplitude[0] for each in gone])
    near = start[:, None] + NEARBY * scale[:, None] * np.array([0.0, 1.0, 1j])
    beta, rate = swing.only(np.arange(eta.size), 1).read(near)
    inertia = 1.0 + q[:, None] * coefficients.panels.at(TURN * np.mod(-beta.ravel(), 1.0), 1)[0].reshape(beta.shape)
    states = np.stack((beta, inertia * (1.0 - rate)), axis=-1).reshape(-1, 2)
    longest = max(each.ended for each in gone)
    close = histories(coefficients, np.repeat(eta, 3), np.repeat(q, 3), damping, longest, states, error=NEARBY * SURE)
    return np.array([_error(each, close[3 * i : 3 * i + 3], scale[i]) for i, each in enumerate(gone)])


def _error(gone: History, close: Sequence[History], scale: float) -> float:
    """Of one history, from three whose first is itself; ``scale`` is ω max |β|."""
    if scale == 0.0:
        return 0.0
    y = np.linspace(0.0, min(gone.ended, *(each.ended for each in close)), max(2, int(LOOKED_AT.size * gone.ended)))
    own, *others = (gone._swing.pointer(*each.at(y)) for each in close)
    apart = sum(float(np.abs(other - own).max()) for other in others) / (NEARBY * scale)
    inner, outer = gone.steps.wrong.T / scale
    return float(outer.sum() * max(1.0, apart) + inner.max())


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
