"""Flexible camshafts for tests: Kim1990's cam as a design and as plain formulas, and others that are harder."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import mpmath
import numpy as np
from mechanisms import LAYOUT_DESIGNS, LIFT, levels, with_drive

from core.design import (
    Design,
    Drive,
    ElasticShaft,
    Motion,
    NamedCurve,
    RollerCam,
    Segment,
    Shaft,
    Translating,
    TranslatingLoads,
)
from core.stability import Coefficients, Stability
from core.study import Study

A = 1.5  # Kim1990's safety factor
KIM_SHAFT = ElasticShaft(0.000324, 85.0, spring="retuned", spring_factor=A)

KIM = Design(
    "Kim1990",
    Shaft("ccw", 1500.0, elastic=KIM_SHAFT),
    (
        Drive(
            Motion(
                0.0,
                (
                    Segment(90.0, 9.0, NamedCurve("simple-harmonic")),
                    Segment(90.0, -9.0, NamedCurve("simple-harmonic")),
                    Segment(180.0, 0.0),
                ),
            ),
            Translating(),
            RollerCam(30.0, 10.0),
            TranslatingLoads(follower_mass_kg=0.2, spring_rate_n_per_mm=15.0, preload_n=20.0),
        ),
    ),
)


def with_elastic(design: Design, **values: Any) -> Design:
    """The design with some numbers of its flexible shaft changed; Kim's shaft where it has none."""
    elastic = replace(design.shaft.elastic or KIM_SHAFT, **values)
    return replace(design, shaft=replace(design.shaft, elastic=elastic))


def of(design: Design) -> Stability:
    return Study(design).flexible_shaft()


def coefficients(design: Design) -> Coefficients:
    return of(design).coefficients


def moved(*steps: tuple[float, float, str], spring: str = "retuned") -> Design:
    """Kim's machine with another motion, by (span, level at its end, law)."""
    return with_elastic(with_drive(KIM, motion=levels(0.0, *steps)), spring=spring)


# Jumps of acceleration at rest, in the middle of a rise and at the top; no dwell, one, two.
HARD = {
    "kim": KIM,
    "fixed": with_elastic(KIM, spring="fixed"),
    "no dwell": moved((180.0, 9.0, "simple-harmonic"), (180.0, 0.0, "cycloidal")),
    "parabolic": moved((120.0, 9.0, "parabolic"), (120.0, 0.0, "parabolic"), (120.0, 0.0, "dwell")),
    "high dwell": moved(
        (90.0, 9.0, "simple-harmonic"), (60.0, 9.0, "dwell"), (120.0, 0.0, "simple-harmonic"), (90.0, 0.0, "dwell"),
        spring="fixed",
    ),
    "layout c": with_elastic(LAYOUT_DESIGNS["c"], camshaft_inertia_kg_m2=0.5, stiffness_nm_per_rad=900.0, spring="fixed"),
    "lift": with_elastic(LIFT, camshaft_inertia_kg_m2=60.0, stiffness_nm_per_rad=1.6e6, spring="retuned"),
}  # fmt: skip


# -- Kim's cam in formulas --------------------------------------------------------------------------------


def kim(theta: Any) -> tuple[Any, Any, Any, Any, Any]:
    """d, C, U, κ, ψ of X = (X_m/2)(1 - cos 2θ) on 0 ... π and rest on π ... 2π, by the calculus of plain functions."""
    theta = theta % (2 * mpmath.mp.pi) if isinstance(theta, mpmath.mpf) else math.fmod(theta, 2.0 * math.pi)
    m: Any = mpmath if isinstance(theta, mpmath.mpf) else math
    if theta >= m.pi:
        return (theta * 0,) * 5
    x, x1, x2 = (1 - m.cos(2 * theta)) / 2, m.sin(2 * theta), 2 * m.cos(2 * theta)
    x3 = -4 * m.sin(2 * theta)
    return x1 * x1, x1 * x2, 2 * A * x * x1, x2 * x2 + x1 * x3, 2 * A * (x1 * x1 + x * x2)


def kim_table(theta: np.ndarray) -> np.ndarray:
    """The same (5, ...) at many cam angles."""
    return np.array([kim(float(t)) for t in theta.ravel()]).T.reshape(5, *theta.shape)


# -- (13) by another integrator ---------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Run:
    """y, β, β' (n,) at the steps of the integrator, and of the moving cam its angle θ in 0 ... π, nan in the dwell."""

    y: np.ndarray
    beta: np.ndarray
    rate: np.ndarray
    theta: np.ndarray


def push(eta: float, q: float, damping: float, theta: float, beta: float, rate: float) -> float:
    """β'' of Kim's cam at 0 < θ < π by (13), the sign of its spring corrected; in the dwell θ is nan."""
    d, c, u = (0.0, 0.0, 0.0) if math.isnan(theta) else kim(theta)[:3]
    tau = 2.0 * math.pi
    right = tau * q * c * (1.0 - rate) ** 2 - 2.0 * tau * damping * eta * rate - (tau * eta) ** 2 * beta + tau * q * u
    return right / (1.0 + q * d)


@cache
def by_runge_kutta(eta: float, q: float, damping: float, periods: float) -> Run:
    """From rest by scipy's eighth-order Runge-Kutta, stopped at every join the cam passes, either way."""
    from scipy.integrate import solve_ivp

    tau = 2.0 * math.pi
    state, y, half, parts = [0.0, 0.0], 0.0, 0, []
    while y < periods:

        def angle(t: float, s: list[float], half: int = half) -> float:
            return tau * (t - s[0]) - math.pi * half

        def rates(t: float, s: list[float], half: int = half) -> list[float]:
            theta = min(max(angle(t, s, half), 0.0), math.pi * (1.0 - 1e-16)) if half % 2 == 0 else math.nan
            return [s[1], push(eta, q, damping, theta, s[0], s[1])]

        def above(t: float, s: list[float], half: int = half) -> float:
            return angle(t, s, half) - math.pi

        def below(t: float, s: list[float], half: int = half) -> float:
            return angle(t, s, half)

        above.terminal = below.terminal = True
        above.direction, below.direction = 1.0, -1.0
        run = solve_ivp(
            rates, (y, periods), state, "DOP853", events=[above, below], rtol=1e-11, atol=1e-13, max_step=0.02
        )
        theta = tau * (run.t - run.y[0]) - math.pi * half if half % 2 == 0 else np.full(run.t.size, np.nan)
        parts.append([each[:-1] for each in (run.t, run.y[0], run.y[1], theta)])
        y, state = float(run.t[-1]), run.y[:, -1].tolist()
        half += int(run.t_events[0].size) - int(run.t_events[1].size)
    return Run(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def plain_force(eta: float, q: float, theta: float, beta: float, rate: float) -> float:
    """(3) for the moving cam, M Ẍ + K_v X with K_v = a M X''m ω²/X_m, by M X''m ω²; no line of the program in it."""
    x, x1, x2 = (1.0 - np.cos(2.0 * theta)) / 2.0, np.sin(2.0 * theta), 2.0 * np.cos(2.0 * theta)
    acceleration = -push(eta, q, 0.0, theta, beta, rate) / (2.0 * np.pi)
    return (x2 * (1.0 - rate) ** 2 + x1 * acceleration) / 2.0 + 1.5 * x


@cache
def leaves_cam(eta: float, q: float, until: float) -> float | None:
    """The first y at which that force falls through zero while the cam moves the follower, by another integrator."""
    from scipy.integrate import solve_ivp

    run = by_runge_kutta(eta, q, 0.0, until)
    moving = np.flatnonzero(np.isfinite(run.theta) & (run.theta > 0.0))
    force = np.array([plain_force(eta, q, run.theta[i], run.beta[i], run.rate[i]) for i in moving])
    bad = np.flatnonzero(force < 0.0)
    if bad.size == 0:
        return None
    last = moving[bad[0]] - 1
    offset = 2.0 * np.pi * (run.y[last] - run.beta[last]) - run.theta[last]

    def angle(y: float, s: np.ndarray) -> float:
        return float(2.0 * np.pi * (y - s[0]) - offset)

    def crossing(y: float, s: np.ndarray) -> float:
        return plain_force(eta, q, angle(y, s), s[0], s[1])

    def rates(y: float, s: np.ndarray) -> list[float]:
        return [s[1], push(eta, q, 0.0, angle(y, s), s[0], s[1])]

    crossing.terminal = True  # type: ignore[attr-defined]
    start = [run.beta[last], run.rate[last]]
    found = solve_ivp(rates, (run.y[last], run.y[last] + 0.1), start, "DOP853", events=crossing, rtol=1e-12, atol=1e-14)
    return float(found.t_events[0][0])
