"""The wind-up of the flexible camshaft of Kim1990 from rest, by its nonlinear equation (13): at one speed, and at many."""

from __future__ import annotations

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
from benchmarks.exact import DAMPING, SPEED, SPEEDS, TURNS
from benchmarks.hill import A, Q
from benchmarks.table import Channels, Kernel, Method
from shafts import KIM, of

from core.stability import histories, history

OUTPUTS = 24  # values a turn
PI = math.pi


def given(y: np.ndarray) -> SimpleNamespace:
    return SimpleNamespace(y=y, turns=max(1.0, math.ceil(float(y[-1]))), coefficients=of(KIM).coefficients)


# -- at one speed -----------------------------------------------------------------------------------------


def ours(there: Any, setting: None) -> Channels:
    """By collocation, stopped at every join of the cam."""
    return (history(there.coefficients, SPEED, Q, DAMPING, there.turns).at(there.y)[0],)


Slopes = Callable[[float, Any], tuple[float, float]]


def equation(eta: float) -> tuple[Slopes, Slopes]:
    """β' and β'' while the cam rests, β'' = -4πζη β' - 4π²η² β, and while it moves, D β'' = 2πQ (C (1-β')² + U) - 4πζη β' -
    4π²η² β at θ = 2π (y - β)."""
    drag, pull_back = 4.0 * PI * eta * DAMPING, 4.0 * PI * PI * eta * eta

    def resting(y: float, x: Any) -> tuple[float, float]:
        return x[1], -drag * x[1] - pull_back * x[0]

    def moving(y: float, x: Any) -> tuple[float, float]:
        beta, rate = x[0], x[1]
        turned = 4.0 * PI * (y - beta)
        s, c = math.sin(turned), math.cos(turned)
        pull = 2.0 * PI * Q * s * (2.0 * c * (1.0 - rate) * (1.0 - rate) + A * (1.0 - c))
        return rate, (pull - drag * rate - pull_back * beta) / (1.0 + Q * s * s)

    return resting, moving


def either(eta: float) -> Slopes:
    """One or the other, as the cam stands."""
    resting, moving = equation(eta)

    def slopes(y: float, x: Any) -> tuple[float, float]:
        return moving(y, x) if (y - x[0]) % 1.0 < 0.5 else resting(y, x)

    return slopes


def fixed_steps(there: Any, steps: int) -> Channels:
    """Runge and Kutta's four slopes a step, a cubic between two steps."""
    from scipy.interpolate import CubicHermiteSpline

    slopes, h = either(SPEED), 1.0 / steps
    x = (0.0, 0.0)
    found = [x]
    for i in range(round(there.turns) * steps):
        y = i * h
        a = slopes(y, x)
        b = slopes(y + h / 2, (x[0] + h / 2 * a[0], x[1] + h / 2 * a[1]))
        c = slopes(y + h / 2, (x[0] + h / 2 * b[0], x[1] + h / 2 * b[1]))
        d = slopes(y + h, (x[0] + h * c[0], x[1] + h * c[1]))
        x = (x[0] + h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0]), x[1] + h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1]))
        found.append(x)
    beta, rate = np.array(found).T
    return (CubicHermiteSpline(np.arange(beta.size) * h, beta, rate)(there.y),)


def _compiled(there: Any, setting: tuple[str, float], eta: float) -> np.ndarray:
    from scipy.integrate import odeint

    tolerance = setting[1]
    given = {"rtol": tolerance, "atol": 1e-3 * tolerance, "hmax": 0.25, "mxstep": 100_000}
    return np.asarray(odeint(either(eta), [0.0, 0.0], there.y, tfirst=True, **given)[:, 0])


def compiled(there: Any, setting: tuple[str, float]) -> Channels:
    """scipy's odeint, which calls Python for the slopes alone and finds the values between its steps itself."""
    return (_compiled(there, setting, SPEED),)


def _compiled_stopped(there: Any, setting: tuple[str, float], eta: float) -> np.ndarray:
    """scipy's compiled dop853, which steps to every value that is wanted and to the joins, found by Newton's method."""
    from scipy.integrate import ode

    pieces, wanted, last = equation(eta), there.y, there.turns
    out = np.zeros(wanted.size)
    y, x, half = 0.0, np.zeros(2), 0
    while y < last:
        solver, end = ode(pieces[1 - half % 2]), 0.5 * (half + 1)
        solver.set_integrator("dop853", rtol=setting[1], atol=1e-3 * setting[1], nsteps=100_000)
        solver.set_initial_value(x, y)
        at = end + float(x[0])
        for _ in range(6):
            inside = np.flatnonzero((wanted > min(y, at)) & (wanted <= max(y, at)))
            times = np.concatenate(([y], wanted[inside] if at > y else wanted[inside][::-1], [at]))
            for i, time in zip(inside if at > y else inside[::-1], times[1:-1], strict=True):
                out[i] = solver.integrate(time)[0]
            y, x = at, solver.integrate(at)
            missed = end - (y - x[0])
            if abs(missed) <= 1e-15 * end:
                break
            at = y + missed / (1.0 - x[1])
            if at == y:
                break
        half += 1
    return out


def compiled_stopped(there: Any, setting: tuple[str, float]) -> Channels:
    return (_compiled_stopped(there, setting, SPEED),)


# -- at many ----------------------------------------------------------------------------------------------

ETA = np.array(SPEEDS)


def ours_of_many(there: Any, setting: None) -> Channels:
    """Side by side, each with steps of its own."""
    return [
        told.at(there.y)[0] for told in histories(there.coefficients, ETA, np.full(ETA.size, Q), DAMPING, there.turns)
    ]


def slopes_of_many(y: float, beta: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """β'' of all speeds."""
    part = y - beta
    turned = (4.0 * PI) * part
    s, c = np.sin(turned), np.cos(turned)
    s *= part - np.floor(part) < 0.5  # nothing pulls while the cam rests
    pull = (2.0 * PI * Q) * s * (2.0 * c * (1.0 - rate) ** 2 + A * (1.0 - c))
    return np.asarray((pull - (4.0 * PI) * ETA * (DAMPING * rate + PI * ETA * beta)) / (1.0 + Q * s * s))


def fixed_steps_of_many(there: Any, steps: int) -> Channels:
    """Runge and Kutta's four slopes a step, all speeds at once; cubics between the steps."""
    from scipy.interpolate import CubicHermiteSpline

    h, count = 1.0 / steps, round(there.turns) * steps
    found = np.zeros((count + 1, 2, ETA.size))
    for i in range(count):
        y, (b, v) = i * h, found[i]
        k1 = slopes_of_many(y, b, v)
        v2 = v + h / 2 * k1
        k2 = slopes_of_many(y + h / 2, b + h / 2 * v, v2)
        v3 = v + h / 2 * k2
        k3 = slopes_of_many(y + h / 2, b + h / 2 * v2, v3)
        v4 = v + h * k3
        k4 = slopes_of_many(y + h, b + h * v3, v4)
        found[i + 1, 0] = b + h / 6 * (v + 2 * v2 + 2 * v3 + v4)
        found[i + 1, 1] = v + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return list(CubicHermiteSpline(np.arange(count + 1) * h, found[:, 0], found[:, 1])(there.y).T)


def one_after_the_other(there: Any, setting: tuple[str, float]) -> Channels:
    """Each speed for itself by odeint."""
    return [_compiled(there, setting, eta) for eta in SPEEDS]


def one_compiled_stopped_after_the_other(there: Any, setting: tuple[str, float]) -> Channels:
    """Each speed for itself, stopped at every join of the cam, as ours are."""
    return [_compiled_stopped(there, setting, eta) for eta in SPEEDS]


# -- rows -------------------------------------------------------------------------------------------------

TOLERANCES = (1e-8, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 3e-14)

FINE = (1e-8, 1e-10, 1e-12, 1e-13)

STEPS = (400, 50, 100, 200, 800, 1600, 3200)


def _by(name: str, solve: Any, what: str = "", tolerances: tuple[float, ...] = TOLERANCES) -> Method:
    settings = tuple((name.split()[-1], t) for t in tolerances)
    return Method(f"{name}{what}", solve, settings, "rtol", one_by_one=True, special=True)


HANDED = "the cam, Q, damping and speed; where β is wanted, 24 times a turn"

KERNEL = Kernel(
    "wind-up",
    "Wind-up from rest, five turns",
    given=given,
    grid=lambda n: np.arange(OUTPUTS * n) / OUTPUTS,
    methods=(
        Method("KINDYNA", ours, ours=True),
        Method("RK4, fixed steps", fixed_steps, STEPS, "steps a turn", one_by_one=True, special=True),
        _by("odeint", compiled),
        _by("ode dop853", compiled_stopped, ", stopped at the joins"),
    ),
    handed=HANDED,
    warm="what KINDYNA knows of its series",
    sizes=(TURNS,),
    usual=TURNS,
    between=TURNS,
    unit="turns of the shaft",
)

MANY = Kernel(
    "wind-ups",
    f"Wind-up from rest, five turns, {ETA.size} speeds at once",
    given=given,
    grid=lambda n: np.arange(OUTPUTS * n) / OUTPUTS,
    methods=(
        Method("KINDYNA", ours_of_many, ours=True),
        Method(
            "RK4, fixed steps, numpy", fixed_steps_of_many, STEPS[:5], "steps a turn", one_by_one=True, special=True
        ),
        _by("odeint", one_after_the_other, ", one after the other"),
        _by("ode dop853", one_compiled_stopped_after_the_other, ", one after the other, stopped at the joins", FINE),
    ),
    handed=HANDED,
    warm="what KINDYNA knows of its series",
    sizes=(TURNS,),
    usual=TURNS,
    between=TURNS,
    unit="turns of the shaft",
)
