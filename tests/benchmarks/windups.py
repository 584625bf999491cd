"""The wind-up of the flexible camshaft of Kim1990 from rest, by its nonlinear equation (13)."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact_shafts import DAMPING, SPEED, TURNS
from benchmarks.hill import A, Q
from benchmarks.table import Channels, Kernel, Method
from shafts import KIM, of

from core.stability import history

OUTPUTS = 24  # values a turn
PI = math.pi


def given(y: np.ndarray) -> SimpleNamespace:
    return SimpleNamespace(y=y, turns=max(1.0, math.ceil(float(y[-1]))), coefficients=of(KIM).coefficients)


def ours(there: Any, setting: None) -> Channels:
    """By collocation, stopped at every join of the cam."""
    return (history(there.coefficients, SPEED, Q, DAMPING, there.turns).at(there.y)[0],)


def slopes(y: float, x: Any) -> tuple[float, float]:
    """β' and β'' of D β'' = 2πQ (C (1-β')² + U) - 4πζη β' - 4π²η² β at θ = 2π (y - β)."""
    beta, rate = x[0], x[1]
    force = -4.0 * PI * SPEED * (DAMPING * rate + PI * SPEED * beta)
    theta = math.fmod(2.0 * PI * (y - beta), 2.0 * PI)
    if not 0.0 <= theta < PI:
        return rate, force
    s, c = math.sin(2.0 * theta), math.cos(2.0 * theta)
    pull = 2.0 * PI * Q * (2.0 * s * c * (1.0 - rate) ** 2 + A * s * (1.0 - c))
    return rate, (force + pull) / (1.0 + Q * s * s)


def fixed_steps(there: Any, steps: int) -> Channels:
    """Runge and Kutta's four slopes a step, a cubic between two steps."""
    from scipy.interpolate import CubicHermiteSpline

    h = 1.0 / steps
    x = (0.0, 0.0)
    found = [x]
    for i in range(round(there.turns) * steps):
        y = i * h
        a = slopes(y, x)
        b = slopes(y + h / 2, (x[0] + h / 2 * a[0], x[1] + h / 2 * a[1]))
        c = slopes(y + h / 2, (x[0] + h / 2 * b[0], x[1] + h / 2 * b[1]))
        d = slopes(y + h, (x[0] + h * c[0], x[1] + h * c[1]))
        x = tuple(x[k] + h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]) for k in (0, 1))  # type: ignore[assignment]
        found.append(x)
    beta, rate = np.array(found).T
    return (CubicHermiteSpline(np.arange(beta.size) * h, beta, rate)(there.y),)


def adaptive(there: Any, setting: tuple[str, float]) -> Channels:
    """scipy's solve_ivp, which is told nothing of the joins."""
    from scipy.integrate import solve_ivp

    method, tolerance = setting
    solved = solve_ivp(
        slopes, (0.0, there.turns), [0.0, 0.0], method, there.y, rtol=tolerance, atol=1e-3 * tolerance, max_step=0.25
    )
    return (solved.y[0],)


KERNEL = Kernel(
    "wind-up",
    "Wind-up from rest",
    given=given,
    grid=lambda n: np.arange(OUTPUTS * n) / OUTPUTS,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("RK4, fixed steps", fixed_steps, (400, 100, 200, 1600, 6400), "steps a turn", one_by_one=True),
        *(
            Method(
                f"solve_ivp {name}",
                adaptive,
                [(name, t) for t in (1e-8, 1e-4, 1e-6, 1e-10, 1e-12)],
                "rtol",
                one_by_one=True,
            )
            for name in ("DOP853", "LSODA")
        ),
    ),
    # four roundings of the state a step of about twenty a turn
    roundings=4 * 20 / (2.0 * PI * SPEED),
    sizes=(1, 5, 20),
    usual=TURNS,
    between=TURNS,
    unit="turns of the shaft",
    digits=2e-14,
)
