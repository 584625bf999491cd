"""The wind-up of the flexible camshaft of Kim1990 from rest, by its nonlinear equation (13)."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact import DAMPING, SPEED, TURNS
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
    """β' and β'': D β'' = 2πQ (C (1-β')² + U) - 4πζη β' - 4π²η² β at θ = 2π (y - β), and D = 1, C = U = 0 while the cam rests."""
    beta, rate = x
    drag = 4.0 * PI * SPEED * (DAMPING * rate + PI * SPEED * beta)
    if (y - beta) % 1.0 >= 0.5:
        return rate, -drag
    turned = 4.0 * PI * (y - beta)
    s, c = math.sin(turned), math.cos(turned)
    pull = 2.0 * PI * Q * s * (2.0 * c * (1.0 - rate) * (1.0 - rate) + A * (1.0 - c))
    return rate, (pull - drag) / (1.0 + Q * s * s)


def compiled(there: Any, tolerance: float) -> Channels:
    """scipy's odeint, which calls Python for the slopes alone and finds the values between its steps itself."""
    from scipy.integrate import odeint

    told = {"rtol": tolerance, "atol": 1e-3 * tolerance, "hmax": 0.25, "mxstep": 100_000}
    return (odeint(slopes, [0.0, 0.0], there.y, tfirst=True, **told)[:, 0],)


TOLERANCES = (1e-8, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 3e-14)

KERNEL = Kernel(
    "wind-up",
    "Wind-up from rest, five turns",
    given=given,
    grid=lambda n: np.arange(OUTPUTS * n) / OUTPUTS,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("odeint", compiled, TOLERANCES, "rtol", special=True),
    ),
    handed="the cam, Q, damping and speed; 24 angles in each turn at which β is computed",
    warm="KINDYNA's data on its series",
    usual=TURNS,
    between=TURNS,
    unit="turns of the shaft",
    rival=("odeint", 1e-10),
)
