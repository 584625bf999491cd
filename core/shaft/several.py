"""Loads of several drives on one shaft as one: the phase-shifted sum, on panels that end where any of theirs does."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.motion import TURN
from core.motion.extremes import Extreme, Range
from core.motion.turn import CLOSEST, ShaftPosition, all_ends
from core.numerics.gauss import gauss_legendre
from core.shaft.curve import NODES, LoadCurve, fitted, nodes, placed, polyval


def combined(loads: Sequence[tuple[LoadCurve, ShaftPosition]]) -> LoadCurve:
    """T_c and J_e of all together by machine angle. The panels of each are shifted by its phase and cut where another's end: the
    polynomials of all are the same on them, so that nothing is lost but rounding."""
    ends = all_ends([place.machine(curve.start) for curve, place in loads])
    start, width = ends[:-1], np.diff(ends)
    inside = width[:, None] * (nodes()[0] - 0.5)
    torque, inertia = np.zeros_like(inside), np.zeros_like(inside)
    for curve, place in loads:
        middle = place.own(start + 0.5 * width)
        at, r = placed(curve.start, curve.width, middle)
        r = r[:, None] + place.sense * inside / curve.width[at][:, None]
        torque += polyval(r, curve.torque[:, at, None])
        inertia += polyval(r, curve.inertia[:, at, None])
    return fitted(start, width, torque, inertia)


def value(curve: LoadCurve, theta: np.ndarray) -> np.ndarray:
    """T_c (n,) at machine angles (n,) [rad]; where it jumps the right-hand limit."""
    theta = np.mod(theta, TURN)
    theta = np.where(theta >= TURN - CLOSEST, 0.0, theta)
    at = np.searchsorted(curve.start - CLOSEST, theta, side="right") - 1
    return np.asarray(polyval((theta - curve.start[at]) / curve.width[at], curve.torque[:, at]))


def rms(curve: LoadCurve) -> float:
    """√(mean of T_c²) [N m], exact on each panel by Gauss' rule."""
    x, weight = gauss_legendre(NODES)
    values = polyval(0.5 + 0.5 * x, curve.torque[:, :, None])
    return float(np.sqrt((curve.width[:, None] * 0.5 * weight * values**2).sum() / TURN))


def peaks(curve: LoadCurve) -> Range:
    """Lowest and highest T_c [N m], both sides of its jumps seen; between the panels' ends refined by Newton's method, in every panel:
    a sample may be the highest beside another peak."""
    r = np.linspace(0.0, 1.0, 2 * NODES + 1)
    values = polyval(r, curve.torque[:, :, None])
    slope = np.arange(1, NODES)[:, None] * curve.torque[1:]
    bend = np.arange(1, NODES - 1)[:, None] * slope[1:]

    every = np.arange(curve.start.size)

    def extreme(sign: float) -> Extreme:
        cell = (sign * values).argmax(axis=1)
        low, high, first = r[np.maximum(cell - 1, 0)], r[np.minimum(cell + 1, r.size - 1)], r[cell]
        at = first
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            for _ in range(8):
                curvature = polyval(at, bend)
                step = polyval(at, slope) / curvature
                at = np.where(sign * curvature < 0.0, np.clip(at - step, low, high), at)
        there, sampled = polyval(at, curve.torque), values[every, cell]
        at = np.where(sign * there >= sign * sampled, at, first)
        panel = int((sign * polyval(at, curve.torque)).argmax())
        theta = float(np.mod(curve.start[panel] + at[panel] * curve.width[panel], TURN))
        return Extreme(float(polyval(at[panel], curve.torque[:, panel])), theta)

    return Range(extreme(-1.0), extreme(1.0))
