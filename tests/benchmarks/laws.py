"""Law evaluation: displacement, velocity and acceleration of the modified sine."""

from __future__ import annotations

import numpy as np
from benchmarks.exact import LAW
from benchmarks.plain import K, modified_sine
from benchmarks.table import Channels, Kernel, Method

from core.laws import LAWS


def ours(u: np.ndarray, setting: None) -> Channels:
    curve = LAWS[LAW].at(u)
    return [curve[order] for order in range(3)]


def branches(u: np.ndarray, setting: None) -> Channels:
    """The textbook's three formulas for each of s, v, a, every one at every angle."""
    pi = np.pi
    ends, middle = 4 * pi * u, 4 * pi * u / 3 + pi / 3
    where = [u <= 0.125, u <= 0.875]
    speed, bend = pi * K * (1 - np.cos(ends)), 4 * pi * pi * K * np.sin(ends)
    return (
        modified_sine(u),
        np.select(where, [speed, pi * K * (1 - 3 * np.cos(middle))], speed),
        np.select(where, [bend, 4 * pi * pi * K * np.sin(middle)], bend),
    )


def differences(u: np.ndarray, step: float) -> Channels:
    before, here, after = modified_sine(u - step), modified_sine(u), modified_sine(u + step)
    return here, (after - before) / (2 * step), (after - 2 * here + before) / step**2


def table(u: np.ndarray, points: int) -> Channels:
    knots = np.linspace(0.0, 1.0, points + 1)
    return [np.interp(u, knots, column) for column in branches(knots, None)]


def spline(u: np.ndarray, points: int) -> Channels:
    from scipy.interpolate import CubicSpline

    knots = np.linspace(0.0, 1.0, points + 1)
    curve = CubicSpline(knots, modified_sine(knots), bc_type="clamped")
    return curve(u), curve(u, 1), curve(u, 2)


KERNEL = Kernel(
    "law",
    "Law: s, v, a",
    given=lambda u: u,
    grid=lambda n: np.arange(n) / n,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("textbook branches", branches),
        Method("finite differences", differences, (1e-4, 1e-1, 1e-2, 1e-3, 1e-5, 1e-6), "step"),
        Method("linear table", table, (3600, 90, 360, 36_000), "points"),
        Method("cubic spline", spline, (3600, 90, 360, 36_000), "points"),
    ),
    roundings=16,
    digits=2e-15,
)
