"""Blending: Yang's card picker, dwell - rise with constant velocity - return - dwell over 300 degrees."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks.table import Channels, Kernel, Method

from core.blend import Request, blend

HEIGHT, SPAN = 20.0, 300.0
REQUEST = Request(
    type="DRRD", stroke=HEIGHT, start=30.0, end=330.0, constant="rise", settings={"h1": 1.0, "h3": 1.0}
)


def ours(given: Any, setting: None) -> Channels:
    found = blend(REQUEST).solution
    return [np.array([v]) for v in (*found.spans, found.speed)]


def joins(x: np.ndarray) -> list[float]:
    """What must vanish: the spans' sum, velocities at two joins, the acceleration at the top."""
    b1, b2, b3, b4, speed = x
    h1, h3 = 1.0, 1.0
    h2 = HEIGHT - h1 - h3
    return [
        (b1 + b2 + b3 + b4 - SPAN) / SPAN,
        2.0 * h1 / b1 - speed,
        h2 / b2 - speed,
        np.pi / 2 * h3 / b3 - speed,
        np.pi**2 / 4 * h3 / b3**2 - 216.0 / 41.0 * HEIGHT / b4**2,
    ]


START = np.array([60.0, 100.0, 60.0, 80.0, 0.1])


def newton(given: Any, tolerance: float) -> Channels:
    from scipy.optimize import fsolve

    return [np.array([v]) for v in fsolve(joins, START, xtol=tolerance)]


def least_squares(given: Any, tolerance: float) -> Channels:
    from scipy.optimize import root

    return [np.array([v]) for v in root(joins, START, method="lm", options={"xtol": tolerance, "ftol": tolerance}).x]


TOLERANCES = (1e-12, 1e-2, 1e-4, 1e-6, 1e-8)

KERNEL = Kernel(
    "blending",
    "Blending: spans and speed",
    given=lambda theta: None,
    grid=lambda n: np.zeros(n),
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("Newton (fsolve)", newton, TOLERANCES, "xtol"),
        Method("least squares (root, lm)", least_squares, TOLERANCES, "xtol"),
    ),
    roundings=8,
    digits=1.5e-15,
    sizes=(1,),
    usual=1,
    between=1,
)
