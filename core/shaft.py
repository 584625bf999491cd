"""The camshaft as a rigid flywheel with a motor of straight characteristic: speed ripple, sizing, motor torque.

The torque is held as polynomials on short panels, so that its integral, the flywheel's answer and their extremes are
exact to rounding for every flywheel, jumps of the torque included; no harmonics are cut off.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import pi

import numpy as np

from core.crossings import crossings
from core.design import Shaft, si
from core.errors import NoAnswer, angle_ranges
from core.motion import TURN, Angles, Program

NODES = 10  # per panel; the polynomial has this many coefficients
PANEL = np.deg2rad(2.0)  # longest panel
LEAST_PANELS = 16  # of a piece, however short: it may hold a whole sine wave


@dataclass(frozen=True, eq=False)
class TorqueCurve:
    """The camshaft torque over one turn.

    start, width  (m,) of the panels [rad]
    power         (NODES, m) coefficients of r**k, r = (θ - start)/width in 0...1 [N m]
    mean          T̄ [N m]
    """

    start: np.ndarray
    width: np.ndarray
    power: np.ndarray
    mean: float


@dataclass(frozen=True, eq=False)
class Flywheel:
    """What the flywheel does.

    energy_swing      ΔE = max - min of ∫(T_c - T̄)dθ [J]
    needed_inertia    ΔE/(C_s ω̄²) [kg m²] for the wanted fluctuation
    mean_torque       T̄ [N m]
    motor_torque      call with Angles: torque of the motor (n,) [N m]
    """

    energy_swing: float
    needed_inertia: float
    mean_torque: float
    motor_torque: Callable[[Angles], np.ndarray]


@lru_cache(maxsize=1)
def _nodes() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Chebyshev nodes of 0...1, the matrix from values there to Chebyshev coefficients, and the one from those to power
    coefficients.

    Two steps, for the inverse of a Vandermonde matrix costs six digits: the first step has no large entry, the large
    ones of the second (whole numbers) meet coefficients that have died away.
    """
    k = np.arange(NODES)
    angle = pi * (1.0 - (k + 0.5) / NODES)
    to_chebyshev = np.cos(np.outer(k, angle)) * (2.0 / NODES)
    to_chebyshev[0] /= 2.0
    to_powers = np.zeros((NODES, NODES))
    to_powers[0, 0], to_powers[:2, 1] = 1.0, (-1.0, 2.0)
    for n in range(2, NODES):  # T_n(x) = 2x T_{n-1} - T_{n-2}, x = 2r - 1
        to_powers[1:, n] = 4.0 * to_powers[:-1, n - 1]
        to_powers[:, n] -= 2.0 * to_powers[:, n - 1] + to_powers[:, n - 2]
    return 0.5 + 0.5 * np.cos(angle), to_chebyshev, to_powers


def panel_angles(program: Program) -> tuple[np.ndarray, np.ndarray, Angles]:
    """Panels (start, width) that never cross a join of pieces, and the nodes of all of them."""
    start, width, piece = [], [], []
    for i, (a, b) in enumerate(zip(program.starts, program.ends, strict=True)):
        count = max(LEAST_PANELS, int(np.ceil((b - a) / PANEL)))
        cuts = np.linspace(a, b, count + 1)
        start.append(cuts[:-1])
        width.append(np.diff(cuts))
        piece.append(np.full(count, i))
    starts, widths, pieces = np.concatenate(start), np.concatenate(width), np.concatenate(piece)
    x, _, _ = _nodes()
    theta = starts[:, None] + widths[:, None] * x
    return starts, widths, Angles(theta.ravel(), np.repeat(pieces, NODES))


def torque_curve(
    torque: Callable[[Angles], np.ndarray], program: Program, switch: Callable[[Angles], np.ndarray] | None = None
) -> TorqueCurve:
    """The torque fitted on panels; torque gives (n,) [N m] at any cam angles. Raises NoAnswer where it is infinite.

    switch  (n,) at any cam angles: where its sign changes, as that of the guide's force does, friction breaks the
            torque, and so panels end there
    """
    start, width, angles = panel_angles(program)
    values = _finite(torque, angles)
    if switch is not None:
        start, width, values = _cut(torque, (start, width, angles, values), crossings(switch, angles, switch(angles)))
    _, to_chebyshev, to_powers = _nodes()
    power = to_powers @ (to_chebyshev @ values.reshape(-1, NODES).T)
    mean = float((width * (power / np.arange(1, NODES + 1)[:, None]).sum(axis=0)).sum() / TURN)
    return TorqueCurve(start, width, power, mean)


def _finite(torque: Callable[[Angles], np.ndarray], angles: Angles) -> np.ndarray:
    values = torque(angles)
    lost = ~np.isfinite(values)
    if lost.any():
        raise NoAnswer(
            "the torque is infinite, the guide jams", "loads.friction", "lower it", angle_ranges(angles.theta, lost)
        )
    return values


def _cut(
    torque: Callable[[Angles], np.ndarray],
    panels: tuple[np.ndarray, np.ndarray, Angles, np.ndarray],
    at: Angles,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start, width and values at the nodes of panels that are cut at these angles."""
    start, width, angles, values = panels
    if not at.theta.size:
        return start, width, values
    pieces = angles.piece[::NODES]
    whole = np.ones(start.size, dtype=bool)
    starts, widths, of = [], [], []
    inside = np.searchsorted(start, at.theta, side="right") - 1
    for panel in np.unique(inside):
        cuts = at.theta[inside == panel]
        edges = np.unique(np.concatenate(([start[panel]], cuts, [start[panel] + width[panel]])))
        whole[panel] = False
        starts.append(edges[:-1])
        widths.append(np.diff(edges))
        of.append(np.full(edges.size - 1, pieces[panel]))
    new_start, new_width = np.concatenate(starts), np.concatenate(widths)
    x, _, _ = _nodes()
    nodes = (new_start[:, None] + new_width[:, None] * x).ravel()
    new = _finite(torque, Angles(nodes, np.repeat(np.concatenate(of), NODES)))
    all_starts = np.concatenate((start[whole], new_start))
    order = np.argsort(all_starts, kind="stable")
    all_values = np.concatenate((values.reshape(-1, NODES)[whole], new.reshape(-1, NODES)))
    return all_starts[order], np.concatenate((width[whole], new_width))[order], all_values[order].ravel()


def _phi(z: np.ndarray) -> np.ndarray:
    """k! φ_{k+1}(-z) for k = 0 ... NODES-1 (NODES, n): ∫_0^1 e^{-z(1-s)} s^k ds, z >= 0.

    By Gauss-Legendre where e^{-z} is mild (all terms positive: no cancellation), else by the upward recurrence
    I_k = (1 - k I_{k-1})/z, which shrinks errors.
    """
    if not z.any():
        return np.repeat(1.0 / np.arange(1.0, NODES + 1.0)[:, None], z.size, axis=1)
    rest, weights = _gauss()
    by_sum = weights @ np.exp(-np.outer(rest, np.minimum(z, _STIFF)))
    stiff = np.maximum(z, _STIFF)
    by_step = np.empty_like(by_sum)
    by_step[0] = -np.expm1(-stiff) / stiff
    for k in range(1, NODES):
        by_step[k] = (1.0 - k * by_step[k - 1]) / stiff
    return np.where(z <= _STIFF, by_sum, by_step)


_STIFF = 30.0


@lru_cache(maxsize=1)
def _gauss() -> tuple[np.ndarray, np.ndarray]:
    """1 - s (40,) at the nodes s of 0...1, and the weights of s**k there (NODES, 40)."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    s = 0.5 + 0.5 * nodes
    return 1.0 - s, 0.5 * weights * s ** np.arange(NODES)[:, None]


def filtered(curve: TorqueCurve, rate: float) -> Callable[[np.ndarray], np.ndarray]:
    """The periodic solution of x' + rate·x = T - T̄, or ∫(T - T̄)dθ from 0 where rate is 0, at any cam angles (n,).

    Panel by panel: x(θ+h) = e^{-rate h} x(θ) + h ∫ e^{-rate h (1-s)} (T - T̄)(s) ds, exact for polynomials.
    """
    power = curve.power.copy()
    power[0] -= curve.mean
    decay = np.exp(-rate * curve.width)
    gain = curve.width * (power * _phi(rate * curve.width)).sum(axis=0)
    x = np.zeros(curve.start.size + 1)
    for i in range(curve.start.size):
        x[i + 1] = decay[i] * x[i] + gain[i]
    if rate > 0.0:
        x0 = x[-1] / -np.expm1(-rate * TURN)
        for i in range(curve.start.size):
            x[i] += x0 * np.exp(-rate * curve.start[i])
    begins = x[:-1]

    def solution(theta: np.ndarray) -> np.ndarray:
        out = np.empty(theta.size)
        for part in range(0, theta.size, _BLOCK):  # forty exponentials an angle, so few at once
            out[part : part + _BLOCK] = block(theta[part : part + _BLOCK])
        return out

    def block(theta: np.ndarray) -> np.ndarray:
        at = np.clip(np.searchsorted(curve.start, theta, side="right") - 1, 0, None)
        h = theta - curve.start[at]
        r = h / curve.width[at]
        reach = power[:, at] * _powers(r)
        return np.exp(-rate * h) * begins[at] + h * (reach * _phi(rate * h)).sum(axis=0)

    return solution


_BLOCK = 512


def _powers(r: np.ndarray) -> np.ndarray:
    """1, r, r², ... (NODES, n)."""
    out = np.empty((NODES, r.size))
    out[0] = 1.0
    for k in range(1, NODES):
        np.multiply(out[k - 1], r, out=out[k])
    return out


def flywheel(torque: Callable[[Angles], np.ndarray], curve: TorqueCurve, shaft: Shaft) -> Flywheel:
    """Sizing by energy and the motor's torque, the fitted flywheel included.

    Motor of slope k: I ω̄ dω/dθ + k(ω - ω̄) = -(T_c - T̄); the motor gives T̄ - k(ω - ω̄), which is T_c without a
    flywheel. Its harmonics are T_n/(1 + i n I ω̄/k) (Shin1995 Figs. 19, 20).
    """
    s = si(shaft)
    swing = _swing(curve)
    inertia, slope, speed = s.flywheel_inertia, s.motor_slope, s.speed
    needed = swing / s.speed_fluctuation / speed / speed  # one by one: the product of tiny numbers may be 0
    lag = inertia * speed
    rate = slope / lag if lag else np.inf
    if rate == np.inf:  # none, or one too small to matter
        return Flywheel(swing, needed, curve.mean, torque)
    answer = filtered(curve, rate)

    def motor_torque(angles: Angles) -> np.ndarray:
        return curve.mean + rate * answer(angles.theta)

    return Flywheel(swing, needed, curve.mean, motor_torque)


def _swing(curve: TorqueCurve) -> float:
    """max - min of ∫(T - T̄)dθ: at the ends of panels and at the roots of T - T̄ inside them."""
    energy = filtered(curve, 0.0)
    places = [curve.start]
    power = curve.power.copy()
    power[0] -= curve.mean
    r = np.linspace(0.0, 1.0, 4 * NODES + 1)
    values = np.polynomial.polynomial.polyval(r, power)  # (m, points)
    change = (values[:, :-1] * values[:, 1:]) < 0.0
    for panel, cell in zip(*np.nonzero(change), strict=True):
        low, high = r[cell], r[cell + 1]
        at_low, at_high = values[panel, cell], values[panel, cell + 1]
        # one secant step is enough: the energy is flat there, its error is of second order in the root's
        root = low + (high - low) * at_low / (at_low - at_high)
        slope = np.polynomial.polynomial.polyval(root, np.arange(1, NODES) * power[1:, panel])
        rest = np.polynomial.polynomial.polyval(root, power[:, panel])
        root = np.clip(root - (rest / slope if slope else 0.0), low, high)
        places.append(np.array([curve.start[panel] + root * curve.width[panel]]))
    at = energy(np.concatenate(places))
    return float(at.max() - at.min())
