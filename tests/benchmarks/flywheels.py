"""Flywheel: the motor's torque of the lift with a fitted flywheel, from the cam's torque and inertia at any angle."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
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
    """Torque and inertia as cubic splines from join to join of the motion, their coefficients as lists."""
    from scipy.interpolate import CubicSpline

    ends = [*map(float, there.program.starts), TURN]
    counts = [max(4, round(setting[2] * (b - a) / TURN)) for a, b in pairwise(ends)]
    at = [np.linspace(a, b, count + 1) for (a, b), count in zip(pairwise(ends), counts, strict=True)]
    before = [np.append(row[:-1], np.nextafter(row[-1], 0.0)) for row in at]  # the join's values on this side of it
    values = np.split(np.stack(_load(there, np.concatenate(before))), np.cumsum(counts[:-1]) + np.arange(1, len(counts)), axis=1)
    curves = [CubicSpline(row, rows, axis=1) for row, rows in zip(at, values, strict=True)]
    mean = sum(float(curve.integrate(a, b)[0]) for curve, (a, b) in zip(curves, pairwise(ends), strict=True)) / TURN
    stretches = []
    for curve, (a, b), count in zip(curves, pairwise(ends), counts, strict=True):
        curve.c[-1, :, 0] -= mean
        stretches.append((a, b, (b - a) / count, curve.c.transpose(1, 2, 0).reshape(count, 8).tolist()))
    size = max(float(np.abs(rows[0]).max()) for rows in values)
    return (*setting[:2], mean, size, stretches, _load(there, there.theta)[1])


Stretch = tuple[float, float, float, list[list[float]]]


def _rate(stretch: Stretch) -> Callable[[float, Any], tuple[float]]:
    """e' between two joins."""
    begin, _, width, pieces = stretch
    last = len(pieces) - 1

    def rate(t: float, x: Any) -> tuple[float]:
        i = min(int((t - begin) / width), last)
        r = t - begin - i * width
        a, b, c, d, p, q, s, w = pieces[i]
        above = 2.0 * float(x[0]) / (((p * r + q) * r + s) * r + w)
        return (-(((a * r + b) * r + c) * r + d) - SLOPE * above / (MEAN + sqrt(max(MEAN * MEAN + above, 0.0))),)

    return rate


def adaptive(there: Any, kept: Any) -> Channels:
    """scipy's solve_ivp over one turn, stopped at the joins as ours is; the turn closed by secants, its own dense output."""
    from scipy.integrate import solve_ivp

    method, tolerance, mean, size, stretches, at_angles = kept
    rates = [(stretch[:2], _rate(stretch)) for stretch in stretches]
    solved: list[Any] = []

    def once(e: float) -> float:
        solved.clear()
        for span, rate in rates:
            told = solve_ivp(rate, span, [e], method, rtol=tolerance, atol=tolerance * size, dense_output=True)
            solved.append(told.sol)
            e = float(told.y[0, -1])
        return e

    closed(once, 3.0 * tolerance * size)
    theta, e = there.theta, np.empty(there.theta.size)
    where = np.searchsorted([stretch[0] for stretch in stretches], theta, side="right") - 1
    for i, curve in enumerate(solved):
        inside = where == i
        if inside.any():
            e[inside] = curve(theta[inside])[0]
    return (mean - SLOPE * _above(e, at_angles),)


TOLERANCES = (1e-8, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13)

SAMPLES = ((1e-6, 720), (1e-8, 1440), (1e-9, 3600), (1e-10, 7200), (0.0, 14_400))
"""As few as a tolerance needs: the splines' error is below it."""


def _by(method: str, least: float = 1e-13) -> Method:
    pairs = [(t, next(count for below, count in SAMPLES if t >= below)) for t in TOLERANCES]
    settings = tuple((method, *pair) for pair in pairs if pair[0] >= least)
    return Method(f"solve_ivp {method}", adaptive, settings, "rtol, samples", keeps=splines, one_by_one=True)


TRANSFORMS = ((1, 9), (0.05, 4), (0.1, 4), (0.25, 6), (0.5, 7), (1, 7), (2, 10), (4, 11), (10, 12), (14, 13), (16, 13), (20, 13))
POINTS = (3600, 180, 360, 720, 1440, 1800, 2880, 5760, 7200, 11_520, 14_400, 36_000)


def of_as_many(setting: tuple[float, float], by: float) -> tuple[float, float] | None:
    """As many samples among so many times as many cam angles; None where these do not hold them."""
    times = setting[0] / by
    part = times if times >= 1.0 else 1.0 / times
    return (times, setting[1]) if abs(part - round(part)) < 1e-9 else None


KERNEL = Kernel(
    "flywheel",
    "Motor torque with a flywheel",
    given=given,
    grid=turn,
    methods=(
        Method("KINDYNA", ours, ours=True, keeps=our_load),
        Method("harmonics (FFT)", harmonics, TRANSFORMS, "samples by angles, digits", keeps=samples, on_grid=True, scaled=of_as_many),
        Method("RK4, fixed steps", fixed_steps, POINTS, "points", keeps=steps, one_by_one=True),
        *(_by(method) for method in ("RK45", "DOP853", "LSODA")),
        _by("Radau", 1e-10),
    ),
    # the motor's torque is a mean of the cam's; between ten values and their polynomial stand two sums of ten and
    # Lebesgue's constant of 2.5, from panel to panel some 240 roundings
    roundings=34 + 22 + 30 + 24 + 2 * 10 * 2.5 + 240,
    digits=1.2e-14,
    handed="a function that gives the cam's torque and inertia at any cam angles, and the joins of the motion",
    warm="torque and inertia: samples, splines, polynomials",
)
