"""Flywheel: the motor's torque of the lift with a fitted flywheel by the linear equation, from the cam's torque at any angle."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact import FITTED
from benchmarks.plain import turn
from benchmarks.table import Channels, Kernel, Method

from core.design import si
from core.motion import TURN, Angles
from core.shaft import Flywheel, load_curve
from core.study import Study

SHAFT = si(FITTED.shaft)
RATE = SHAFT.motor_slope / (SHAFT.flywheel_inertia * SHAFT.speed)  # k/(I ω̄) [per radian]
NODES = 10  # per panel of our own curve
CLOSING = float(np.exp(-RATE * TURN))  # what a turn leaves of a deviation


def given(theta: np.ndarray) -> SimpleNamespace:
    study = Study(FITTED)

    def torque(angles: Angles) -> np.ndarray:
        return study.at(angles).dynamics.torque

    return SimpleNamespace(theta=theta, angles=study.program.angles(theta), study=study, program=study.program, torque=torque)


def ours(there: Any, setting: None) -> Channels:
    """Torque on panels, mean, energy, sizing and the motor's torque."""
    curve = load_curve(lambda a: np.array([there.torque(a), np.zeros(a.theta.size)]), there.program)
    return (Flywheel(there.torque, curve, FITTED.shaft).linear_motor_torque(there.angles),)


def harmonics(there: Any, points: int) -> Channels:
    """Samples of the torque, their Fourier transform, each harmonic by 1/(1 + i n I ω̄/k), and back."""
    knots = turn(points)
    waves = np.fft.rfft(there.torque(there.program.angles(knots)))
    waves /= 1.0 + 1j * np.arange(waves.size) / RATE
    back = np.fft.irfft(waves, points)
    return (np.interp(there.theta, np.append(knots, TURN), np.append(back, back[0])),)


def _sampled(there: Any, points: int) -> tuple[np.ndarray, float]:
    told = there.torque(there.program.angles(turn(points)))
    return told, float(told.mean())


def fixed_steps(there: Any, points: int) -> Channels:
    """Runge and Kutta's four slopes a step; the steady state by what one turn leaves of a start."""
    told, mean = _sampled(there, 2 * points)
    drive = (np.append(told, told[0]) - mean).tolist()
    step, x, found = TURN / points, 0.0, []
    for i in range(points):
        a, b, c = drive[2 * i : 2 * i + 3]
        found.append(x)
        k1 = a - RATE * x
        k2 = b - RATE * (x + 0.5 * step * k1)
        k3 = b - RATE * (x + 0.5 * step * k2)
        k4 = c - RATE * (x + step * k3)
        x += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return (_steady(there, mean, np.append(found, x), turn(points + 1) * (points + 1) / points),)


def _steady(there: Any, mean: float, x: np.ndarray, at: np.ndarray) -> np.ndarray:
    begin = x[-1] / (1.0 - CLOSING)
    return mean + RATE * np.interp(there.theta, at, x + begin * np.exp(-RATE * at))


def adaptive(there: Any, setting: tuple[str, float]) -> Channels:
    """scipy's solve_ivp over one turn, the torque from a cubic spline of 3600 samples."""
    from scipy.integrate import solve_ivp
    from scipy.interpolate import CubicSpline

    method, tolerance = setting
    told, mean = _sampled(there, 3600)
    drive = CubicSpline(turn(3601) * 3601 / 3600, np.append(told, told[0]) - mean)
    size = float(np.abs(told).max())
    solved = solve_ivp(
        lambda t, x: drive(t) - RATE * x, (0.0, TURN), [0.0], method, rtol=tolerance, atol=tolerance * size,
        dense_output=True,
    )  # fmt: skip
    begin = float(solved.y[0, -1]) / (1.0 - CLOSING)
    return (mean + RATE * (solved.sol(there.theta)[0] + begin * np.exp(-RATE * there.theta)),)


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
        Method("FFT harmonics", harmonics, (3600, 360, 36_000, 360_000), "points"),
        Method("RK4, fixed steps", fixed_steps, (3600, 360, 720, 36_000), "points"),
        *(_by(method) for method in ("RK45", "DOP853", "LSODA", "Radau")),
    ),
    # the motor's torque is a mean of the cam's; between ten values and their polynomial stand two sums of ten and
    # Lebesgue's constant of 2.5, from panel to panel some 240 roundings
    roundings=34 + 22 + 30 + 24 + 2 * 10 * 2.5 + 240,
    digits=4e-16,
)
