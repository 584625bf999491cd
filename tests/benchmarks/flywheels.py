"""Flywheel: the motor's torque of the lift with a fitted flywheel, from the cam's torque and inertia at any angle."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact import FITTED
from benchmarks.plain import turn
from benchmarks.table import Channels, Kernel, Method

from core.design import si
from core.motion import TURN, Angles
from core.shaft import load_curve, steady_speed
from core.study import Study

SHAFT = si(FITTED.shaft)
SLOPE, MEAN, FLYWHEEL = SHAFT.motor_slope, SHAFT.speed, SHAFT.flywheel_inertia
SHOTS = 40  # turns until one ends as it began

Rate = Callable[[float, float], float]


def given(theta: np.ndarray) -> SimpleNamespace:
    study = Study(FITTED)

    def load(angles: Angles) -> np.ndarray:
        there = study.at(angles)
        return np.array([there.dynamics.torque, there.loading.inertia(there.linkage)[0]])

    return SimpleNamespace(theta=theta, program=study.program, load=load)


def ours(there: Any, setting: None) -> Channels:
    """Torque and inertia on panels, and the speed by collocation."""
    curve = load_curve(there.load, there.program)
    speed = steady_speed(curve, FLYWHEEL, SLOPE, MEAN)
    assert speed is not None
    return (curve.mean - SLOPE * speed.deviation(there.theta),)


def _closed(over_a_turn: Callable[[float], float]) -> float:
    """What a turn begins and ends with, by secants."""
    a, b = 0.0, over_a_turn(0.0)
    fa, fb = b - a, over_a_turn(b) - b
    for _ in range(SHOTS):
        if fa == fb or abs(fb) <= 1e-15 * abs(b):
            break
        a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
        fb = over_a_turn(b) - b
    return b


def _above(energy: Any, inertia: Any) -> Any:
    """ω - ω̄ at e = ½(I + J)(ω² - ω̄²)."""
    return 2.0 * energy / inertia / (MEAN + np.sqrt(np.maximum(MEAN**2 + 2.0 * energy / inertia, 0.0)))


def fixed_steps(there: Any, points: int) -> Channels:
    """Runge and Kutta's four slopes a step, the turn closed by secants."""
    torque, inertia = there.load(there.program.angles(turn(2 * points)))
    mean, step = float(torque.mean()), TURN / points
    drive, worth = ([*row.tolist(), float(row[0])] for row in (torque - mean, inertia + FLYWHEEL))
    found = [0.0] * (points + 1)

    def rate(e: float, i: int) -> float:
        return -drive[i] - SLOPE * 2.0 * e / worth[i] / (MEAN + sqrt(MEAN**2 + 2.0 * e / worth[i]))

    def once(e: float) -> float:
        for i in range(points):
            found[i] = e
            k1 = rate(e, 2 * i)
            k2 = rate(e + 0.5 * step * k1, 2 * i + 1)
            k3 = rate(e + 0.5 * step * k2, 2 * i + 1)
            e += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + rate(e + step * k3, 2 * i + 2))
        found[points] = e
        return e

    once(_closed(once))
    at = turn(points + 1) * (points + 1) / points
    motor = mean - SLOPE * _above(np.array(found), np.array(worth[::2]))
    return (np.interp(there.theta, at, motor),)


def adaptive(there: Any, setting: tuple[str, float]) -> Channels:
    """scipy's solve_ivp over one turn, torque and inertia from cubic splines of 3600 samples, the turn closed by secants."""
    from scipy.integrate import solve_ivp
    from scipy.interpolate import CubicSpline

    method, tolerance = setting
    torque, inertia = there.load(there.program.angles(turn(3600)))
    mean, at = float(torque.mean()), turn(3601) * 3601 / 3600
    drive = CubicSpline(at, np.append(torque, torque[0]) - mean)
    worth = CubicSpline(at, np.append(inertia, inertia[0]) + FLYWHEEL)
    size = float(np.abs(torque).max())

    def once(e: float, dense: bool = False) -> Any:
        return solve_ivp(
            lambda t, x: -drive(t) - SLOPE * _above(x, worth(t)), (0.0, TURN), [e], method, rtol=tolerance,
            atol=tolerance * size, dense_output=dense,
        )  # fmt: skip

    begin = 0.0
    for _ in range(4):  # what a turn leaves of a deviation is a hundredth
        begin = float(once(begin).y[0, -1])
    return (mean - SLOPE * _above(once(begin, dense=True).sol(there.theta)[0], worth(there.theta)),)


def _by(method: str) -> Method:
    settings = [(method, tolerance) for tolerance in (1e-8, 1e-4, 1e-6, 1e-10)]
    return Method(f"solve_ivp {method}", adaptive, settings, "rtol", one_by_one=True)


KERNEL = Kernel(
    "flywheel",
    "Motor torque with a flywheel",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("RK4, fixed steps", fixed_steps, (3600, 360, 720, 36_000), "points"),
        *(_by(method) for method in ("RK45", "DOP853", "LSODA", "Radau")),
    ),
    # the motor's torque is a mean of the cam's; between ten values and their polynomial stand two sums of ten and
    # Lebesgue's constant of 2.5, from panel to panel some 240 roundings
    roundings=34 + 22 + 30 + 24 + 2 * 10 * 2.5 + 240,
    digits=1.2e-14,
)
