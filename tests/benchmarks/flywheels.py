"""Flywheel: the motor's torque of the lift with a fitted flywheel, from the cam's torque and inertia at any angle."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact import FITTED
from benchmarks.plain import knots, turn
from benchmarks.table import Channels, Kernel, Method

from core.design import si
from core.motion import TURN, Angles
from core.shaft import load_curve, steady_speed
from core.study import Study

SHAFT = si(FITTED.shaft)
SLOPE, MEAN, FLYWHEEL = SHAFT.motor_slope, SHAFT.speed, SHAFT.flywheel_inertia
SHOTS = 40  # turns until one ends as it began


def given(theta: np.ndarray) -> SimpleNamespace:
    study = Study(FITTED)

    def load(angles: Angles) -> np.ndarray:
        there = study.at(angles)
        return np.array([there.dynamics.torque, there.loading.inertia(there.linkage)[0]])

    return SimpleNamespace(theta=theta, program=study.program, load=load)


def our_load(there: Any, setting: None) -> Any:
    """Torque and inertia as polynomials on panels."""
    return load_curve(there.load, there.program)


def ours(there: Any, curve: Any) -> Channels:
    """The speed by collocation."""
    speed = steady_speed(curve, FLYWHEEL, SLOPE, MEAN)
    assert speed is not None
    return (curve.mean - SLOPE * speed.deviation(there.theta),)


def _above(energy: Any, inertia: Any) -> Any:
    """ω - ω̄ at e = ½(I + J)(ω² - ω̄²)."""
    return 2.0 * energy / inertia / (MEAN + np.sqrt(np.maximum(MEAN**2 + 2.0 * energy / inertia, 0.0)))


# -- harmonics --------------------------------------------------------------------------------------------


def _load(there: Any, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Torque and I + J."""
    torque, inertia = there.load(there.program.angles(theta))
    return torque, inertia + FLYWHEEL


def samples(there: Any, setting: tuple[float, float]) -> Any:
    """On the given cam angles, on finer grids that hold them, or on every so manieth of them."""
    times, digits = setting
    theta, n = there.theta, there.theta.size
    if times < 1:
        theta = theta[:: round(1.0 / times)]
    else:
        steps = (TURN / (n * times)) * np.arange(times)
        theta = (theta[:, None] + steps).ravel()
    return theta, *_load(there, theta), times, digits


def harmonics(there: Any, kept: Any) -> Channels:
    """e' + c e = c e - k (ω - ω̄) - (T - T̄) by repeated transforms, c the mean of what k (ω - ω̄) gains with e."""
    theta, torque, worth, times, digits = kept
    mean = torque.mean()
    drive, rate = torque - mean, SLOPE / (MEAN * worth.mean())
    order = np.arange(theta.size // 2 + 1)
    answer = 1.0 / (1j * order + rate)
    e, within = np.zeros(theta.size), 10.0**-digits * float(np.abs(drive).max())
    for _ in range(60):
        after = np.fft.irfft(np.fft.rfft(rate * e - SLOPE * _above(e, worth) - drive) * answer, theta.size)
        moved = float(np.abs(after - e).max())
        e = after
        if moved <= within:
            break
    motor = mean - SLOPE * _above(e, worth)
    if times >= 1:
        return (motor[:: int(times)],)
    from scipy.interpolate import CubicSpline

    ends = np.append(theta, theta[0] + TURN), np.append(motor, motor[0])
    return (CubicSpline(*ends, bc_type="periodic")(there.theta),)


# -- one step after the other -----------------------------------------------------------------------------


def closed(over_a_turn: Callable[[float], float], enough: float) -> float:
    """What a turn begins and ends with, by secants."""
    a, b = 0.0, over_a_turn(0.0)
    fa, fb = b - a, over_a_turn(b) - b
    for _ in range(SHOTS):
        if fa == fb or abs(fb) <= enough:
            break
        a, b, fa = b, b - fb * (b - a) / (fb - fa), fb
        fb = over_a_turn(b) - b
    return b


def steps(there: Any, points: int) -> Any:
    """Torque and inertia at the steps' ends and middles, inertia at the given cam angles; lists, which Python reads fastest."""
    torque, worth = _load(there, turn(2 * points))
    mean = float(torque.mean())
    drive, whole = ([*row.tolist(), float(row[0])] for row in (torque - mean, worth))
    return points, mean, drive, whole, _load(there, there.theta)[1]


def fixed_steps(there: Any, kept: Any) -> Channels:
    """Runge and Kutta's four slopes a step, the turn closed by secants, cubics between the steps."""
    from scipy.interpolate import CubicHermiteSpline

    points, mean, drive, worth, at_angles = kept
    step = TURN / points
    found = [0.0] * (points + 1)

    def rate(e: float, i: int) -> float:
        above = 2.0 * e / worth[i]
        return -drive[i] - SLOPE * above / (MEAN + sqrt(MEAN * MEAN + above))

    def once(e: float) -> float:
        for i in range(points):
            found[i] = e
            k1 = rate(e, 2 * i)
            k2 = rate(e + 0.5 * step * k1, 2 * i + 1)
            k3 = rate(e + 0.5 * step * k2, 2 * i + 1)
            e += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + rate(e + step * k3, 2 * i + 2))
        found[points] = e
        return e

    closed(once, 1e-13 * max(map(abs, drive)))
    e = np.array(found)
    slopes = -np.array(drive[::2]) - SLOPE * _above(e, np.array(worth[::2]))
    curve = CubicHermiteSpline(knots(points), e, slopes)
    return (mean - SLOPE * _above(curve(there.theta), at_angles),)


def splines(there: Any, setting: tuple[str, float, int]) -> Any:
    """Torque and inertia as cubic splines, their coefficients as lists."""
    from scipy.interpolate import CubicSpline

    points = setting[2]
    torque, worth = _load(there, turn(points))
    mean = float(torque.mean())
    rows = np.stack((torque - mean, worth))
    curve = CubicSpline(knots(points), np.column_stack((rows, rows[:, :1])), axis=1, bc_type="periodic")
    pieces = curve.c.transpose(1, 2, 0).reshape(points, 8).tolist()
    return (*setting, mean, float(np.abs(torque).max()), pieces, _load(there, there.theta)[1])


def adaptive(there: Any, kept: Any) -> Channels:
    """scipy's solve_ivp over one turn, the turn closed by secants, its own dense output."""
    from scipy.integrate import solve_ivp

    method, tolerance, points, mean, size, pieces, at_angles = kept
    width, last = TURN / points, points - 1

    def rate(t: float, x: Any) -> tuple[float]:
        i = min(int(t / width), last)
        r = t - i * width
        a, b, c, d, p, q, s, w = pieces[i]
        above = 2.0 * float(x[0]) / (((p * r + q) * r + s) * r + w)
        return (-(((a * r + b) * r + c) * r + d) - SLOPE * above / (MEAN + sqrt(max(MEAN * MEAN + above, 0.0))),)

    solved: list[Any] = []

    def once(e: float) -> float:
        told = solve_ivp(rate, (0.0, TURN), [e], method, rtol=tolerance, atol=tolerance * size, dense_output=True)
        solved[:] = [told.sol]
        return float(told.y[0, -1])

    closed(once, 3.0 * tolerance * size)
    return (mean - SLOPE * _above(solved[0](there.theta)[0], at_angles),)


TOLERANCES = (1e-8, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13)


def _by(method: str, least: float = 1e-13) -> Method:
    samples = {1e-3: 720, 1e-4: 720, 1e-5: 3600, 1e-6: 3600}
    pairs = [(t, samples.get(t, 36_000)) for t in TOLERANCES]
    settings = tuple((method, *pair) for pair in pairs if pair[0] >= least)
    return Method(f"solve_ivp {method}", adaptive, settings, "rtol, samples", keeps=splines, one_by_one=True)


TRANSFORMS = ((1, 9), (0.05, 4), (0.1, 4), (0.25, 6), (0.5, 7), (1, 7), (2, 10), (4, 11), (10, 12))

KERNEL = Kernel(
    "flywheel",
    "Motor torque with a flywheel",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True, keeps=our_load),
        Method("harmonics (FFT)", harmonics, TRANSFORMS, "samples by angles, digits", keeps=samples, on_grid=True),
        Method("RK4, fixed steps", fixed_steps, (3600, 180, 360, 720, 1800, 7200, 14_400, 36_000), "points", keeps=steps, one_by_one=True),
        *(_by(method) for method in ("RK45", "DOP853", "LSODA")),
        _by("Radau", 1e-10),
    ),
    # the motor's torque is a mean of the cam's; between ten values and their polynomial stand two sums of ten and
    # Lebesgue's constant of 2.5, from panel to panel some 240 roundings
    roundings=34 + 22 + 30 + 24 + 2 * 10 * 2.5 + 240,
    digits=1.2e-14,
    handed="a function that gives the cam's torque and inertia at any cam angles",
    warm="torque and inertia: samples, splines, polynomials",
)
