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
    values = np.split(
        np.stack(_load(there, np.concatenate(before))), np.cumsum(counts[:-1]) + np.arange(1, len(counts)), axis=1
    )
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


def _turned(there: Any, kept: Any, through: Callable[[Any, Stretch, float, np.ndarray], np.ndarray]) -> Channels:
    """One turn from join to join of the motion, closed by secants. through: (kept, stretch, e at its beginning, angles) -> e at
    these and at its end."""
    mean, size, stretches, at_angles = kept[2:]
    theta = there.theta
    where = np.searchsorted([stretch[0] for stretch in stretches], theta, side="right") - 1
    inside = [where == i for i in range(len(stretches))]
    at = [theta[rows] for rows in inside]
    found = np.empty(theta.size)

    def once(e: float) -> float:
        for stretch, rows, here in zip(stretches, inside, at, strict=True):
            told = through(kept, stretch, e, here)
            found[rows] = told[:-1]
            e = float(told[-1])
        return e

    closed(once, 3.0 * kept[1] * size)
    return (mean - SLOPE * _above(found, at_angles),)


def adaptive(there: Any, kept: Any) -> Channels:
    """scipy's solve_ivp with its own dense output."""
    from scipy.integrate import solve_ivp

    def through(kept: Any, stretch: Stretch, e: float, at: np.ndarray) -> np.ndarray:
        method, tolerance, _, size = kept[:4]
        span = stretch[:2]
        told = solve_ivp(_rate(stretch), span, [e], method, rtol=tolerance, atol=tolerance * size, dense_output=True)
        inside = told.sol(at)[0] if at.size else at
        return np.append(inside, told.y[0, -1])

    return _turned(there, kept, through)


def compiled(there: Any, kept: Any) -> Channels:
    """scipy's odeint, which calls Python for the slope alone."""
    from scipy.integrate import odeint

    def through(kept: Any, stretch: Stretch, e: float, at: np.ndarray) -> np.ndarray:
        _, tolerance, _, size = kept[:4]
        times = np.concatenate((stretch[:1], at, stretch[1:2]))
        told = odeint(_rate(stretch), [e], times, tfirst=True, rtol=tolerance, atol=tolerance * size, mxstep=100_000)
        return np.asarray(told[1:, 0])

    return _turned(there, kept, through)


# -- polynomials from join to join ------------------------------------------------------------------------


def collocated(there: Any, nodes: int) -> Any:
    """Torque and inertia at so many of Gauss's nodes between two joins of the motion, integrals to the nodes and values at the
    given cam angles of the polynomial through values at them."""
    from numpy.polynomial.legendre import leggauss, legvander

    ends = np.append(np.asarray(there.program.starts, dtype=float), TURN)
    half, middle = np.diff(ends) / 2.0, (ends[1:] + ends[:-1]) / 2.0
    x, weights = leggauss(nodes)
    number = np.arange(nodes)
    values = legvander(x, nodes)
    to_nodes = np.concatenate((x[:, None] + 1.0, (values[:, 2:] - values[:, :-2]) / (2 * number[1:] + 1)), axis=1)
    coefficients = (values[:, :nodes] * weights[:, None]).T * (number[:, None] + 0.5)
    theta = middle[:, None] + half[:, None] * x
    torque, worth = (row.reshape(theta.shape) for row in _load(there, theta.ravel()))
    mean = float((half[:, None] * weights * torque).sum()) / TURN
    within, whole = half[:, None, None] * (to_nodes @ coefficients), half[:, None] * weights
    where = np.searchsorted(ends, there.theta, side="right") - 1
    at = [(there.theta[where == i] - middle[i]) / half[i] for i in range(half.size)]
    between = [legvander(row, nodes - 1) @ coefficients for row in at]
    return mean, torque - mean, worth, within, whole, between, _load(there, there.theta)[1]


def collocation(there: Any, kept: Any) -> Channels:
    """e' = -(T - T̄) - k (ω - ω̄) at the nodes by Newton's method, the stretches joined and the turn closed in every step."""
    mean, drive, worth, within, whole, between, at_angles = kept
    e, identity = np.zeros(drive.shape), np.eye(drive.shape[1])
    for _ in range(12):
        above = _above(e, worth)
        slope = -SLOPE / (worth * (MEAN + above))
        rest = -drive - SLOPE * above - slope * e
        sides = np.stack((np.ones(e.shape), (within @ rest[:, :, None])[:, :, 0]), axis=-1)
        solved = np.linalg.solve(
            identity - within * slope[:, None, :], sides
        )  # e is the first of its begin, and the second
        gains = np.stack(
            (1.0 + (whole * slope * solved[:, :, 0]).sum(1), (whole * (rest + slope * solved[:, :, 1])).sum(1)), axis=1
        )
        kept_share, gained = 1.0, 0.0
        for share, gain in gains.tolist():
            kept_share, gained = kept_share * share, gained * share + gain
        begins = [gained / (1.0 - kept_share)]
        for share, gain in gains[:-1].tolist():
            begins.append(begins[-1] * share + gain)
        after = np.array(begins)[:, None] * solved[:, :, 0] + solved[:, :, 1]
        moved, e = float(np.abs(after - e).max()), after
        if moved <= 1e-8 * float(np.abs(e).max()):  # and the square of it is left
            break
    told = np.concatenate([rows @ row for rows, row in zip(between, e, strict=True)])
    return (mean - SLOPE * _above(told, at_angles),)


TOLERANCES = (1e-8, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13)

SAMPLES = ((1e-6, 720), (1e-8, 1440), (1e-9, 3600), (1e-10, 7200), (0.0, 14_400))
"""As few as a tolerance needs: the splines' error is below it."""


def _by(name: str, solve: Any, tolerances: tuple[float, ...] = TOLERANCES) -> Method:
    pairs = [(t, next(count for below, count in SAMPLES if t >= below)) for t in tolerances]
    settings = tuple((name.split()[-1], *pair) for pair in pairs)
    return Method(name, solve, settings, "rtol, samples", keeps=splines, one_by_one=True)


TRANSFORMS = ((1, 9), (0.05, 4), (0.1, 4), (0.25, 6), (0.5, 7), (1, 7), (2, 10), (4, 11), (10, 12), (16, 13))
NODES = (16, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 18, 20)
POINTS = (3600, 180, 360, 720, 1440, 2880, 5760)


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
        Method(
            "harmonics (FFT)",
            harmonics,
            TRANSFORMS,
            "samples by angles, digits",
            keeps=samples,
            on_grid=True,
            scaled=of_as_many,
        ),
        Method("RK4, fixed steps", fixed_steps, POINTS, "points", keeps=steps, one_by_one=True),
        _by("solve_ivp DOP853", adaptive, TOLERANCES[::2]),
        _by("odeint", compiled),
        Method("collocation from join to join", collocation, NODES, "nodes", keeps=collocated),
    ),
    # the motor's torque is a mean of the cam's; between ten values and their polynomial stand two sums of ten and
    # Lebesgue's constant of 2.5, from panel to panel some 240 roundings
    roundings=34 + 22 + 30 + 24 + 2 * 10 * 2.5 + 240,
    digits=1.2e-14,
    handed="a function that gives the cam's torque and inertia at any cam angles, and the joins of the motion",
    sizes=(360, 3600, 36_000, 1),
    warm="torque and inertia: samples, splines, polynomials, matrices of integrals",
)
