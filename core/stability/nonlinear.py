"""The nonlinear wind-up, equation (13) of Kim1990 with the sign of its η² term corrected.

D β'' - 2πQ C (1-β')² + 4πζη β' + 4π²η² β = 2πQ U at θ = 2π(y - β), ' by y. With the cam's momentum Π = D (1-β') it is

    β' = 1 - Π/D,    Π' = 2πQ C (Π/D)² - 2πQ U + 4π²η² β + 4πζη β',

in which no derivative occurs of what jumps where X'' does. Arrays (m, ...) hold m points of the chart in parallel.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from core.motion import TURN
from core.stability.hill.coefficients import Coefficients
from core.stability.panels import NODES, powers

FAR = 3.0  # [half widths of a panel] limit of extrapolation: an attempt that goes so far fails, and must not overflow


@dataclass(frozen=True, eq=False)
class Points:
    """m points of the chart: η and Q (m,), one damping ratio."""

    eta: np.ndarray
    q: np.ndarray
    damping: float = 0.0


class Equation:
    """Equation (13) at m points of the chart.

    begins, ends  (pieces,) cam angles of the motion's pieces [rad]
    """

    def __init__(self, coefficients: Coefficients, points: Points) -> None:
        self.coefficients = coefficients
        panels = coefficients.panels
        self._panels, self._powers, self._per_width = panels, panels.powers, 2.0 / panels.width
        # the panels of a piece stand side by side
        self.first = np.flatnonzero(np.diff(panels.piece, prepend=-1))
        self.last = np.append(self.first[1:], panels.count) - 1
        self.begins = panels.start[self.first]
        self.ends = np.append(self.begins[1:], TURN)
        self.eta, self.q = np.broadcast_arrays(np.asarray(points.eta, dtype=float), np.asarray(points.q, dtype=float))
        self.damping = points.damping
        self.stiff = 4.0 * pi * pi * self.eta**2
        self.damp = 4.0 * pi * self.damping * self.eta
        self._load = 2.0 * pi * self.q * (self.eta**2 if coefficients.fixed else np.ones_like(self.eta))

    def resting(self) -> np.ndarray:
        """States (m, 2) of β = β' = 0 at y = 0, where Π = D."""
        d = self._panels.at(np.zeros(1), 1)[0, 0]
        return np.stack((np.zeros(self.eta.size), 1.0 + self.q * d), axis=1)

    def local(self, rows: int, piece: np.ndarray, turn: np.ndarray, theta: np.ndarray) -> np.ndarray:
        """The first ``rows`` of d, C, U, κ, ψ (rows, n, s) at cam angles (n, s) [rad] by the polynomials of the given
        pieces, extrapolated beyond their ends."""
        rest = theta - TURN * turn[:, None]
        at = np.searchsorted(self._panels.start, rest, side="right") - 1
        at = np.minimum(np.maximum(at, self.first[piece, None]), self.last[piece, None])
        t = (rest - self._panels.start[at]) * self._per_width[at] - 1.0
        t = np.minimum(np.maximum(t, -FAR), FAR)
        return np.einsum("nsrk,nsk->rns", self._powers[at, :rows], powers(t, NODES))

    def rate(self, index: np.ndarray, piece: np.ndarray, turn: np.ndarray, y: np.ndarray, x: np.ndarray) -> np.ndarray:
        """β' and Π' (n, s, 2) of states x (n, s, 2) at y (n, s)."""
        beta, momentum = x[..., 0], x[..., 1]
        d, c, u = self.local(3, piece, turn, TURN * (y - beta))
        q = self.q[index, None]
        speed = momentum / (1.0 + q * d)
        out = np.empty_like(x)
        out[..., 0] = 1.0 - speed
        force = (2.0 * pi * q) * c * speed * speed - self._load[index, None] * u + self.stiff[index, None] * beta
        out[..., 1] = force + self.damp[index, None] * out[..., 0] if self.damping else force
        return out

    def velocities(
        self, index: np.ndarray, piece: np.ndarray, turn: np.ndarray, y: np.ndarray, x: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """β' and, by (13), β'' (n, s) of states x (n, s, 2) at y (n, s)."""
        d, c, u = self.local(3, piece, turn, TURN * (y - x[..., 0]))
        q = self.q[index, None]
        inertia = 1.0 + q * d
        speed = x[..., 1] / inertia
        force = (TURN * q) * c * speed * speed + self._load[index, None] * u - self.stiff[index, None] * x[..., 0]
        return 1.0 - speed, (force - self.damp[index, None] * (1.0 - speed)) / inertia

    def jacobian(
        self, index: np.ndarray, piece: np.ndarray, turn: np.ndarray, y: np.ndarray, x: np.ndarray
    ) -> np.ndarray:
        """Derivatives (n, s, 2, 3) of β' and Π' by β, Π and η."""
        beta, momentum = x[..., 0], x[..., 1]
        d, c, u, k, u1 = self.local(5, piece, turn, TURN * (y - beta))
        q, damp, load = self.q[index, None], self.damp[index, None], self._load[index, None]
        whole = 1.0 + q * d
        speed = momentum / whole
        by_theta = -2.0 * q * c * speed / whole  # of the speed
        out = np.zeros((*x.shape[:2], 2, 3))
        out[..., 0, 0] = TURN * by_theta
        out[..., 0, 1] = -1.0 / whole
        force = TURN * q * (k * speed * speed + 2.0 * c * speed * by_theta) - load * u1 - damp * by_theta
        out[..., 1, 0] = -TURN * force + self.stiff[index, None]
        out[..., 1, 1] = (2.0 * TURN * q * c * speed - damp) / whole
        eta = self.eta[index, None]
        out[..., 1, 2] = 2.0 * TURN * TURN * eta * beta + 2.0 * TURN * self.damping * (1.0 - speed)
        if self.coefficients.fixed:
            out[..., 1, 2] -= 2.0 * TURN * q * eta * u
        return out
