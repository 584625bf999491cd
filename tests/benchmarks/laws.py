"""Law evaluation: displacement, velocity and acceleration of the modified sine."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks.exact import LAW
from benchmarks.plain import FEW, POINTS, STEPS, K, by_table, hermite, knots, law, modified_sine
from benchmarks.table import Channels, Kernel, Method

from core.laws import LAWS

PI = np.pi


def ours(u: np.ndarray, setting: None) -> Channels:
    curve = LAWS[LAW].at(u)
    return [curve[order] for order in range(3)]


def branches(u: np.ndarray, setting: None) -> Channels:
    """The textbook's three formulas for each of s, v, a, every one at every angle."""
    ends, middle = 4 * PI * u, 4 * PI * u / 3 + PI / 3
    where = [u <= 0.125, u <= 0.875]
    first = K * (PI * u - np.sin(ends) / 4)
    speed, bend = PI * K * (1 - np.cos(ends)), 4 * PI * PI * K * np.sin(ends)
    return (
        np.select(where, [first, K * (2 + PI * u - 9 / 4 * np.sin(middle))], 4 * K + first),
        np.select(where, [speed, PI * K * (1 - 3 * np.cos(middle))], speed),
        np.select(where, [bend, 4 * PI * PI * K * np.sin(middle)], bend),
    )


def by_hand(u: np.ndarray, setting: None) -> Channels:
    """The same with one sine and one cosine an angle: what differs between the branches is looked up."""
    return law(u)


def differences(u: np.ndarray, step: float) -> Channels:
    before, here, after = modified_sine(u - step), modified_sine(u), modified_sine(u + step)
    return here, (after - before) / (2 * step), (after - 2 * here + before) / step**2


def cubic(u: np.ndarray, points: int) -> Any:
    from scipy.interpolate import CubicSpline

    at = knots(points, 1.0)
    return CubicSpline(at, modified_sine(at), bc_type="clamped")


def quintic(u: np.ndarray, points: int) -> Any:
    at = knots(points, 1.0)
    return hermite(at, *by_hand(at, None))


def from_curve(u: np.ndarray, curve: Any) -> Channels:
    return curve(u), curve(u, 1), curve(u, 2)


KERNEL = Kernel(
    "law",
    "Law: s, v, a",
    given=lambda u: u,
    grid=lambda n: np.arange(n) / n,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("numpy by hand", by_hand, special=True),
        Method("textbook branches", branches, special=True),
        Method("finite differences", differences, STEPS, "step", special=True),
        *by_table(lambda at: by_hand(at, None), where=lambda u: u, end=1.0),
        Method("cubic spline", from_curve, POINTS, "points", keeps=cubic),
        Method("quintic table", lambda u, table: table.at(u, 0, 1, 2), FEW, "points", keeps=quintic),
    ),
    roundings=16,
    digits=2e-15,
    handed="the parts of the segment",
    warm="tables and splines",
)
