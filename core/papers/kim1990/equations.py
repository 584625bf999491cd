"""The numbers that show which of Kim1990's printed equations are misprints: as printed and corrected, by how much they are off.

Each is held against what is computed without it: energies, Newton-Euler's contact force, the edges of the tongues.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import Any

import numpy as np

from core.papers.examples import Examples
from core.papers.kim1990.chart import EXAMPLE, FACTOR, Q, row, run_of, shaft_of
from core.stability.hill.coefficients import APPROXIMATE, CENTRIPETAL, CURVATURE, INERTIA, LOAD, LOAD_SLOPE, fourier
from core.stability.hill.matrices import KIM_ORDER, kim_matrix

SMALL = 1e-9  # of the largest: beyond rounding
NUMERICAL = 1e-4  # likewise, where a derivative was taken by differences
SAMPLES = 720

Numbers = Mapping[str, Any]


def _turn() -> np.ndarray:
    """Cam angles (n,) [rad] of one turn, none at a join."""
    return np.asarray(2.0 * pi * (np.arange(SAMPLES) + 0.5) / SAMPLES)


def _off(value: np.ndarray, true: np.ndarray) -> float:
    """The largest difference as a part of the largest true value."""
    return float(np.abs(value - true).max() / np.abs(true).max())


def profile(examples: Examples) -> Numbers:
    """(33) as printed against the example's motion, each relative to its largest."""
    study = examples.study(EXAMPLE)
    theta = _turn()
    y = study.at_theta(theta).motion.displacement
    moving = theta < pi
    printed = (0.5 * (1.0 - np.cos(2.0 * theta)), np.sin(2.0 * theta), 2.0 * np.cos(2.0 * theta))
    stroke = shaft_of(examples).coefficients.sizes.stroke
    return {"off": max(_off(np.where(moving, each, 0.0), y[k] / stroke) for k, each in enumerate(printed)), "bound": SMALL}


def load_slope(examples: Examples) -> Numbers:
    """ψ of (23) from X, X', X'' against the slope of the torque of the mechanism."""
    coefficients = shaft_of(examples).coefficients
    sizes, theta = coefficients.sizes, _turn()
    x, v, a = (examples.study(EXAMPLE).at_theta(theta).motion.displacement[k] for k in range(3))
    psi = FACTOR * sizes.curvature * (a * (x - sizes.lowest) + v * v) / (sizes.slope**2 * sizes.stroke)
    ours = coefficients.panels.at(theta, 5)[LOAD_SLOPE]
    mean = float((coefficients.panels.weights * coefficients.panels.values[LOAD_SLOPE]).sum())
    return {"off": _off(psi, ours), "bound": SMALL, "largest": float(ours.max()), "mean": abs(mean)}


def forces(examples: Examples) -> dict[str, np.ndarray]:
    """Contact force along the follower [N] and torque on the cam [N m] (n,) by cam angle (n,) [rad] at the example's speed, the
    shaft rigid: of Newton-Euler and of the energies, and (3), (4) as printed and corrected."""
    shaft, theta = shaft_of(examples), _turn()
    sizes, omega = shaft.coefficients.sizes, shaft.machine.omega
    mass = sizes.inertia / sizes.slope**2
    rate = FACTOR * mass * sizes.curvature * omega**2 / sizes.stroke
    there = examples.study(EXAMPLE).at_theta(theta)
    x, v, a = (there.motion.displacement[k] for k in range(3))
    x = x - sizes.lowest
    spring = rate * x
    along = np.cos(there.cam.flank.pressure_angle)  # the paper's F_c is its part along the follower
    contact = shaft.contact
    assert contact is not None, "Kim's cam could be lifted off"
    values = contact.panels.at(theta, 3)
    rows = shaft.coefficients.panels.at(theta, 5)
    inertia = sizes.inertia / shaft.machine.q
    return {
        "theta": theta,
        "force": contact.force(values, 1.0, np.ones(1), np.zeros(1)) * along * contact.unit * omega**2,
        "force printed": mass * v * omega + spring,
        "force corrected": mass * a * omega**2 + spring,
        "torque": -inertia * omega**2 * shaft.machine.q * (rows[CENTRIPETAL] + rows[LOAD]),
        "torque printed": mass * v * v * theta + mass * a * v * theta**2 + spring * v,
        "torque corrected": -(mass * a * omega**2 + spring) * v,
    }


def contact_force(examples: Examples) -> Numbers:
    f = forces(examples)
    return {
        "printed": _off(f["force printed"], f["force"]), "corrected": _off(f["force corrected"], f["force"]), "bound": SMALL,
        "largest": float(f["force"].max()), "printed_largest": float(f["force printed"].max()),
    }  # fmt: skip


def cam_torque(examples: Examples) -> Numbers:
    f = forces(examples)
    return {
        "printed": _off(f["torque printed"], f["torque"]), "corrected": _off(f["torque corrected"], f["torque"]), "bound": SMALL,
        "largest": float(np.abs(f["torque"]).max()), "printed_largest": float(np.abs(f["torque printed"]).max()),
    }  # fmt: skip


NOMENCLATURE = ("a_r", "C_e", "F_c", "G_k", "I_c", "K_s", "K_v", "M_e", "P_n", "R_b", "T", "T_c", "X_v", "X", "M_v")
"""The symbols that the paper explains, in its list or in its text."""


def spring_mass(examples: Examples) -> Numbers:
    """The mass at which (5) stands at its limit for the spring of (7) with a = 1, as a part of M_v."""
    shaft = shaft_of(examples)
    sizes = shaft.coefficients.sizes
    assert shaft.contact is not None, "Kim's cam could be lifted off"
    mass = sizes.inertia / sizes.slope**2
    held = float(shaft.contact.panels.at(_turn(), 3)[0].max()) * shaft.contact.unit  # K_v X_m/ω²
    ratio = held / FACTOR / sizes.curvature / mass
    return {
        "printed": 0.0 if "M_m" in NOMENCLATURE else float("inf"),
        "corrected": abs(ratio - 1.0),
        "bound": 1e-4,  # samples miss the top of X by so much
        "ratio": ratio,
        "mass": mass,
    }


def _solution(examples: Examples) -> dict[str, np.ndarray]:
    """The nonlinear motion of Fig. 9 through three turns, in the terms of (17) over I_c ω²: I_e θ̈, C_e θ̇², K_s (θ_c - θ_i), and
    the load Q U; C_e θ̇_i² and the part of C_e θ̇² with β̇."""
    run = run_of(examples, 9)
    y = (np.arange(900) + 0.37) / 300.0
    step = 1e-5
    beta, slope = run.at(y)
    bend = (run.at(y + step)[1] - run.at(y - step)[1]) / (2.0 * step)
    rows = run.coefficients.panels.at(np.mod(2.0 * pi * (y - beta), 2.0 * pi), 5)
    return {
        "turning": (1.0 + run.q * rows[INERTIA]) * -bend / (2.0 * pi),
        "centripetal": run.q * rows[CENTRIPETAL] * (1.0 - slope) ** 2,
        "spring": -2.0 * pi * run.eta**2 * beta,
        "load": run.q * rows[LOAD],
        "at the input": run.q * rows[CENTRIPETAL],
        "with rate": -2.0 * run.q * rows[CENTRIPETAL] * slope,
    }


def rigid_turn(examples: Examples) -> Numbers:
    """(14) along the solution: what I_e θ̈ + C_e θ̇² leaves, and what is left where θ_c = θ_i - 2πβ stands for it."""
    s = _solution(examples)
    size = float(np.abs(s["spring"]).max())
    left = s["turning"] + s["centripetal"]
    return {
        "printed": float(np.abs(left).max()) / size,
        "corrected": float(np.abs(left + s["spring"] + s["load"]).max()) / size,
        "bound": NUMERICAL,
    }


def load_sign(examples: Examples) -> Numbers:
    """(17) along the solution, with -M_e at the right, M_e = -a M_v X''m ω² X X'/X_m as printed, and with +M_e."""
    s = _solution(examples)
    size, left = float(np.abs(s["spring"]).max()), s["turning"] + s["centripetal"] + s["spring"]
    return {
        "printed": float(np.abs(left - s["load"]).max()) / size,
        "corrected": float(np.abs(left + s["load"]).max()) / size,
        "bound": NUMERICAL,
    }


def linear_load(examples: Examples) -> Numbers:
    """(18) along the solution, times -2π: with M_e + C_e θ̇_i² at the right as printed, and with M_e - C_e θ̇_i², which is (17) but for
    C_e (2πβ̇)², that (18) drops and that is added here."""
    s = _solution(examples)
    size = float(np.abs(s["spring"]).max())
    left = s["turning"] + s["with rate"] + s["spring"] + s["load"]
    dropped = s["centripetal"] - s["with rate"] - s["at the input"]
    return {
        "printed": float(np.abs(left + dropped - s["at the input"]).max()) / size,
        "corrected": float(np.abs(left + dropped + s["at the input"]).max()) / size,
        "bound": NUMERICAL,
    }


def slope_of_c(examples: Examples) -> Numbers:
    """(19): the term with β must be the slope of the torque C_e θ̇² by the cam angle, here by differences: against C_e, as
    printed, and against its derivative."""
    panels, theta, step = shaft_of(examples).coefficients.panels, _turn(), 1e-5
    slope = (panels.at(theta + step, 5)[CENTRIPETAL] - panels.at(theta - step, 5)[CENTRIPETAL]) / (2.0 * step)
    rows = panels.at(theta, 5)
    return {"printed": _off(rows[CENTRIPETAL], slope), "corrected": _off(rows[CURVATURE], slope), "bound": NUMERICAL}


def _left(matrix: np.ndarray) -> float:
    """The smallest |eigenvalue|: 0 where the determinant vanishes."""
    return float(np.abs(np.linalg.eigvals(matrix)).min())


def _at_edge(examples: Examples) -> tuple[np.ndarray, float]:
    """The paper's matrix without η² for γ = jπ, and η of the first edge of (22)."""
    return kim_matrix(shaft_of(examples).coefficients, Q, True), float(row(examples, Q, APPROXIMATE).edges[0, 0, 0])


def constant_term(examples: Examples) -> Numbers:
    """(27) at the first edge, γ = jπ: with G_0 = γ² + Ψ_0 Q and with η² + Ψ_0 Q; its determinant must vanish."""
    matrix, eta = _at_edge(examples)
    unit = np.eye(2 * KIM_ORDER + 1)
    return {"printed": _left(-(pi**2) * unit - matrix), "corrected": _left(eta**2 * unit - matrix), "bound": 1e-4, "eta": eta}


def other_terms(examples: Examples) -> Numbers:
    """(27) at the first edge with G_k = Ψ_k = Q, and with G_k = Ψ_k Q."""
    matrix, eta = _at_edge(examples)
    unit = np.eye(2 * KIM_ORDER + 1)
    mean = Q * fourier(shaft_of(examples).coefficients.panels, shaft_of(examples).coefficients.panels.values[LOAD_SLOPE], 0)[0].real
    r = np.arange(-KIM_ORDER, KIM_ORDER + 1) + 0.5
    as_printed = np.diag(eta**2 - r * r + mean) + Q * (1.0 - unit)
    return {"printed": _left(as_printed), "corrected": _left(eta**2 * unit - matrix), "bound": 1e-4, "eta": eta}


def _rho(gamma: complex, eta: float) -> np.ndarray:
    r = np.arange(-KIM_ORDER, KIM_ORDER + 1)
    return np.asarray(((gamma + 2j * pi * r) / (2.0 * pi)) ** 2 + eta**2)


def diagonal(examples: Examples) -> Numbers:
    """(28) at Q = 0, where the determinant is the product of all ρ_r: with π_0 in the middle, and with ρ_0."""
    run = run_of(examples, 9)
    rho = _rho(0.3j, run.eta)
    true = complex(np.linalg.det(np.diag(rho)))
    as_printed = complex(np.prod(np.where(np.arange(rho.size) == KIM_ORDER, pi, rho)))
    return {
        "printed": abs(as_printed / true - 1.0), "corrected": abs(complex(np.prod(rho)) / true - 1.0), "bound": SMALL, "eta": run.eta,
    }  # fmt: skip


def exponent(examples: Examples) -> Numbers:
    """(29): ρ_r must vanish at γ: at 2π(η - r), and at 2πj(η - r), r = 1."""
    eta, r = run_of(examples, 9).eta, 1
    at = KIM_ORDER + r
    return {
        "printed": float(abs(_rho(2.0 * pi * (eta - r), eta)[at])),
        "corrected": float(abs(_rho(2j * pi * (eta - r), eta)[at])),
        "bound": SMALL,
        "eta": eta,
    }
