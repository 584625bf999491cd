"""Blending: Yang's card picker, dwell - rise with constant velocity - return - dwell over 300 degrees."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import count
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.table import Channels, Kernel, Method

from core.blend import Request, blend

HEIGHT, SPAN = 20.0, 300.0
REQUEST = Request(type="DRRD", stroke=HEIGHT, start=30.0, end=330.0, constant="rise", settings={"h1": 1.0, "h3": 1.0})
_OTHER = count(1)


def given(at: np.ndarray) -> SimpleNamespace:
    return SimpleNamespace(request=REQUEST, h1=1.0, h3=1.0)


def again(there: SimpleNamespace) -> SimpleNamespace:
    """Another request of the kind, which nobody has had before."""
    h1 = 1.0 + 1e-7 * next(_OTHER)
    return SimpleNamespace(request=replace(REQUEST, settings={"h1": h1, "h3": 1.0}), h1=h1, h3=1.0)


def ours(there: Any, setting: None) -> Channels:
    found = blend(there.request).solution
    return [np.array([v]) for v in (*found.spans, found.speed)]


def joins(x: Any, h1: float, h3: float) -> list[float]:
    """What must vanish: the spans' sum, velocities at two joins, the acceleration at the top."""
    b1, b2, b3, b4, speed = x.tolist()
    return [
        (b1 + b2 + b3 + b4 - SPAN) / SPAN,
        2.0 * h1 / b1 - speed,
        (HEIGHT - h1 - h3) / b2 - speed,
        math.pi / 2 * h3 / b3 - speed,
        math.pi**2 / 4 * h3 / b3**2 - 216.0 / 41.0 * HEIGHT / b4**2,
    ]


def slopes(x: Any, h1: float, h3: float) -> list[list[float]]:
    """Their derivatives by spans and speed."""
    b1, b2, b3, b4, _ = x.tolist()
    return [
        [1.0 / SPAN, 1.0 / SPAN, 1.0 / SPAN, 1.0 / SPAN, 0.0],
        [-2.0 * h1 / b1**2, 0.0, 0.0, 0.0, -1.0],
        [0.0, -(HEIGHT - h1 - h3) / b2**2, 0.0, 0.0, -1.0],
        [0.0, 0.0, -math.pi / 2 * h3 / b3**2, 0.0, -1.0],
        [0.0, 0.0, -(math.pi**2) / 2 * h3 / b3**3, 432.0 / 41.0 * HEIGHT / b4**3, 0.0],
    ]


START = np.array([20.0, 160.0, 16.0, 100.0, 0.1])


def newton(there: Any, steps: int) -> Channels:
    x = START
    for _ in range(steps):
        x = x - np.linalg.solve(slopes(x, there.h1, there.h3), joins(x, there.h1, there.h3))
    return [np.array([v]) for v in x]


def on_paper(there: Any, setting: None) -> Channels:
    """With V the slope of the constant velocity, spans are 2h1/V, h2/V, (π/2)h3/V and √(216/41 h h3)/V."""
    h1, h3 = there.h1, there.h3
    widths = (2.0 * h1, HEIGHT - h1 - h3, math.pi / 2 * h3, math.sqrt(216.0 / 41.0 * HEIGHT * h3))
    speed = sum(widths) / SPAN
    return [np.array([v]) for v in (*(w / speed for w in widths), speed)]


KERNEL = Kernel(
    "blending",
    "Blending: spans and speed",
    given=given,
    again=again,
    grid=lambda n: np.zeros(n),
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("numpy by hand", newton, (6, 2, 3, 4, 5), "Newton steps"),
        Method("solved on paper", on_paper, special=True),
    ),
    handed="type, stroke, span and two heights of a new request; for Newton's method also the"
    " sequence of curves, its equations with their derivatives and a start near the solution",
    warm="KINDYNA's data on the sequences of a type",
    usual=1,
    between=1,
    rival=("numpy by hand", 6),
)
