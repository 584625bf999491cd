"""The nonlinear wind-up, equation (13) of Kim1990 with the sign of its η² term corrected, and with X'm² below U.

D β'' - 2πQ C (1-β')² + 4πζη β' + 4π²η² β = 2πQ U at θ = 2π(y - β), ' by y. With the cam's momentum Π = D (1-β') it is

    β' = 1 - Π/D,    Π' = 2πQ C (Π/D)² - 2πQ U + 4π²η² β + 4πζη β',

in which no derivative occurs of what jumps where X'' does. Arrays (m, ...) hold m points of the chart in parallel.
"""

from __future__ import annotations

from math import pi

import numpy as np

from core.motion import TURN
from core.stability.hill.coefficients import Coefficients
from core.stability.panels import NODES, powers

FAR = 3.0  # [half widths of a panel] limit of extrapolation: an attempt that goes so far fails, and must not overflow

Numbers = float | np.ndarray


class WindUpEquation:
    """Equation (13) at m points of the chart: η and Q (m,) or numbers, one damping ratio.

    begins, ends  (pieces,) cam angles of the motion's pieces [rad]
    """

    def __init__(self, coefficients: Coefficients, eta: Numbers, q: Numbers, damping: float = 0.0) -> None:
        panels = coefficients.panels
        self.panels, self.fixed, self.damping = panels, coefficients.fixed, damping
        # the panels of a piece stand side by side
        self.first = np.flatnonzero(np.diff(panels.piece, prepend=-1))
        self.last = np.append(self.first[1:], panels.count) - 1
        self.begins = panels.start[self.first]
        self.ends = np.append(self.begins[1:], TURN)
        self.eta, self.q = np.broadcast_arrays(np.atleast_1d(eta).astype(float), np.atleast_1d(q).astype(float))

    def resting(self) -> np.ndarray:
        """States (m, 2) of β = β' = 0 at y = 0, where Π = D."""
        d = self.panels.at(np.zeros(1), 1)[0, 0]
        return np.stack((np.zeros(self.eta.size), 1.0 + self.q * d), axis=1)


class OnPieces:
    """Equation (13) for n trajectories, each on one piece of the motion, whose polynomials are extrapolated beyond its ends.

    index        (n,) the points of the chart
    piece, turn  (n,) piece of the motion and whole turns of the cam
    begin, end   (n, 1) cam angles at which the piece begins and ends [rad]

    Times y are (n, s), states x = (β, Π) (n, s, 2).
    """

    def __init__(self, equation: WindUpEquation, index: np.ndarray, piece: np.ndarray, turn: np.ndarray) -> None:
        self.equation, self.index, self.piece, self.turn = equation, index, piece, turn
        self._panels, self._per_width = equation.panels, 2.0 / equation.panels.width
        self._full = TURN * turn[:, None]
        self.begin, self.end = equation.begins[piece, None] + self._full, equation.ends[piece, None] + self._full
        self._first, self._last = equation.first[piece, None], equation.last[piece, None]
        self._eta, self._q = equation.eta[index, None], equation.q[index, None]
        self._stiff, self._damp = 4.0 * pi * pi * self._eta**2, 4.0 * pi * equation.damping * self._eta
        self._pull, self._load = TURN * self._q, TURN * self._q * (self._eta**2 if equation.fixed else 1.0)

    def _local(self, rows: int, theta: np.ndarray) -> np.ndarray:
        """The first ``rows`` of d, C, U, κ, ψ (rows, n, s) at cam angles (n, s) [rad]."""
        rest = theta - self._full
        at = self._panels.start.searchsorted(rest, side="right") - 1
        at = np.minimum(np.maximum(at, self._first), self._last)
        t = (rest - self._panels.start[at]) * self._per_width[at] - 1.0
        t = np.minimum(np.maximum(t, -FAR), FAR)
        return np.einsum("nsrk,nsk->rns", self._panels.powers[at, :rows], powers(t, NODES))

    def rate(self, y: np.ndarray, x: np.ndarray) -> np.ndarray:
        """β' [turns per turn] and Π' (n, s, 2) at s times of each of n trajectories, of their states x (n, s, 2) by (13)."""
        return self._rate(x, *self._local(3, TURN * (y - x[..., 0])))

    def _rate(self, x: np.ndarray, d: np.ndarray, c: np.ndarray, u: np.ndarray) -> np.ndarray:
        speed = x[..., 1] / (1.0 + self._q * d)
        out = np.empty_like(x)
        out[..., 0] = 1.0 - speed
        out[..., 1] = (
            self._pull * c * speed * speed - self._load * u + self._stiff * x[..., 0] + self._damp * out[..., 0]
        )
        return out

    def velocities(self, y: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """β' and, by (13), β'' (n, s)."""
        d, c, u = self._local(3, TURN * (y - x[..., 0]))
        inertia = 1.0 + self._q * d
        speed = x[..., 1] / inertia
        force = self._pull * c * speed * speed + self._load * u - self._stiff * x[..., 0]
        return 1.0 - speed, (force - self._damp * (1.0 - speed)) / inertia

    def rate_and_jacobian(self, y: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """β' and Π' (n, s, 2), and their derivatives (n, s, 2, 3) by β, Π and η."""
        d, c, u, k, u1 = self._local(5, TURN * (y - x[..., 0]))
        inertia = 1.0 + self._q * d
        speed = x[..., 1] / inertia
        by_theta = -2.0 * self._q * c * speed / inertia  # of the speed
        force = self._pull * (k * speed * speed + 2.0 * c * speed * by_theta) - self._load * u1 - self._damp * by_theta
        out = np.zeros((*x.shape, 3))
        out[..., 0, 0] = TURN * by_theta
        out[..., 0, 1] = -1.0 / inertia
        out[..., 1, 0] = -TURN * force + self._stiff
        out[..., 1, 1] = (2.0 * self._pull * c * speed - self._damp) / inertia
        out[..., 1, 2] = 2.0 * TURN * TURN * self._eta * x[..., 0] + 2.0 * TURN * self.equation.damping * (1.0 - speed)
        if self.equation.fixed:
            out[..., 1, 2] -= 2.0 * self._pull * self._eta * u
        return self._rate(x, d, c, u), out
