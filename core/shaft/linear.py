"""The linear answer of flywheel and motor, small changes of speed assumed (Shin1995 Figs. 19, 20), exact on panels."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core.design import Shaft, si
from core.motion import TURN
from core.shaft.curve import NODES, LoadCurve, by_blocks, placed, powers

PARTED = 4.0  # z at which the recurrence of ``phi`` changes its direction


def motor_inertia(shaft: Shaft) -> float:
    """The motor's own inertia as it is felt at the camshaft, I_m times the gear ratio squared [kg m²]."""
    s = si(shaft)
    ratio = 1.0 if s.gear_ratio is None else s.gear_ratio
    return float((s.motor_inertia or 0.0) * ratio * ratio)


def lag(shaft: Shaft) -> float:
    """k/(I ω̄) [per radian], at which the motor follows the torque, I of flywheel and motor; infinite where both have none."""
    s = si(shaft)
    momentum = (s.flywheel_inertia + motor_inertia(shaft)) * s.speed
    return float(s.motor_slope / momentum) if momentum else np.inf


def levels(shaft: Shaft) -> bool:
    """Whether a flywheel is fitted; without one the speed is taken as constant, and the motor gives the cam's torque."""
    return lag(shaft) < np.inf


def phi(z: np.ndarray) -> np.ndarray:
    """k! φ_{k+1}(-z) for k = 0 ... NODES-1 (NODES, n): I_k = ∫_0^1 e^{-z(1-s)} s^k ds, z >= 0.

    By the recurrence z I_k = 1 - k I_{k-1}: downwards it multiplies errors by z/k, upwards by k/z. Where they part, at 4,
    either way makes at most fifteen roundings of one; 22 steps above NODES - 1 let the error of the first guess, (z/k)²,
    vanish.
    """
    small, large = np.minimum(z, PARTED), np.maximum(z, PARTED)
    down, up = np.empty((NODES, z.size)), np.empty((NODES, z.size))
    first = NODES + 21
    value = (1.0 - small / (first + 2.0)) / (first + 1.0)
    for k in range(first, 0, -1):
        value = (1.0 - small * value) / k
        if k <= NODES:
            down[k - 1] = value
    up[0] = -np.expm1(-large) / large
    for k in range(1, NODES):
        up[k] = (1.0 - k * up[k - 1]) / large
    return np.where(z <= PARTED, down, up)


def filtered(curve: LoadCurve, rate: float) -> Callable[[np.ndarray], np.ndarray]:
    """The periodic solution of x' + rate·x = T - T̄, or ∫(T - T̄)dθ from 0 where rate is 0, at any cam angles (n,).

    Panel by panel: x(θ+h) = e^{-rate h} x(θ) + h ∫ e^{-rate h (1-s)} (T - T̄)(s) ds, exact for polynomials.
    """
    power = curve.torque.copy()
    power[0] -= curve.mean
    decay = np.exp(-rate * curve.width)
    gain = curve.width * (power * phi(rate * curve.width)).sum(axis=0)
    end, starts = 0.0, []
    for left, added in zip(decay.tolist(), gain.tolist(), strict=True):
        starts.append(end)
        end = left * end + added
    begins = np.array(starts)
    if rate > 0.0:
        begins += end / -np.expm1(-rate * TURN) * np.exp(-rate * curve.start)

    def solution(theta: np.ndarray) -> np.ndarray:
        return by_blocks(block, theta)

    def block(theta: np.ndarray) -> np.ndarray:
        at, r = placed(curve.start, curve.width, theta)
        h = theta - curve.start[at]
        reach = power[:, at] * powers(r)
        return np.exp(-rate * h) * begins[at] + h * (reach * phi(rate * h)).sum(axis=0)

    return solution
