"""Numbers that show which of Kim1990's printed equations are misprints: the errors as printed and as corrected.

Each equation is compared with an independent result: energies, Newton-Euler's contact force, the edges of the tongues.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi
from typing import Any

import numpy as np

from core.papers.claim import Examples, relative_error
from core.papers.kim1990_chart import EXAMPLE, FACTOR, Q, row, run_of, shaft_of
from core.stability.coefficients import (
    APPROXIMATE,
    CENTRIPETAL,
    CURVATURE,
    INERTIA,
    KIM_ORDER,
    LOAD,
    LOAD_SLOPE,
    fourier,
    kim_matrix,
)

SMALL = 1e-9  # relative to the largest value: above rounding
NUMERICAL = 1e-4  # the same for derivatives by differences
STEP = 1e-5  # step of these differences in y or cam angle
SAMPLES = 720

Numbers = Mapping[str, Any]


def _turn() -> np.ndarray:
    """Cam angles (n,) [rad] of one turn, none at a join."""
    return np.asarray(2.0 * pi * (np.arange(SAMPLES) + 0.5) / SAMPLES)


def profile(examples: Examples) -> Numbers:
    """(33) as printed against the example's motion, each relative to its largest.

    References
    ----------
    Kim (1990), eq. (33) and Fig. 4.
    """
    study = examples.study(EXAMPLE)
    theta = _turn()
    y = study.at_theta(theta).motion.displacement
    is_moving = theta < pi
    printed = (0.5 * (1.0 - np.cos(2.0 * theta)), np.sin(2.0 * theta), 2.0 * np.cos(2.0 * theta))
    stroke = shaft_of(examples).coefficients.sizes.stroke
    return {
        "off": max(relative_error(np.where(is_moving, curve, 0.0), y[k] / stroke) for k, curve in enumerate(printed)),
        "bound": SMALL,
    }


def load_slope(examples: Examples) -> Numbers:
    """ψ of (23) from X, X', X'' against the slope of the mechanism's torque.

    References
    ----------
    Kim (1990), eq. (23) and Fig. 5.
    """
    coefficients = shaft_of(examples).coefficients
    sizes, theta = coefficients.sizes, _turn()
    x, v, a = (examples.study(EXAMPLE).at_theta(theta).motion.displacement[k] for k in range(3))
    psi = FACTOR * sizes.curvature * (a * (x - sizes.lowest) + v * v) / (sizes.slope**2 * sizes.stroke)
    computed = coefficients.panels.at(theta, 5)[LOAD_SLOPE]
    mean = float((coefficients.panels.weights * coefficients.panels.values[LOAD_SLOPE]).sum())
    return {"off": relative_error(psi, computed), "bound": SMALL, "largest": float(computed.max()), "mean": abs(mean)}


def forces(examples: Examples) -> dict[str, np.ndarray]:
    """Contact force along the follower and torque on the cam at the example's speed, with a rigid shaft.

    By Newton-Euler and by the energies, and by (3), (4) as printed and corrected.

    Returns
    -------
    dict of ndarray (n,) [rad], [N] or [N m]
        `theta`, the three values of `force` and of `torque`.

    References
    ----------
    Kim (1990), eqs. (3), (4) and Fig. 2.
    """
    shaft, theta = shaft_of(examples), _turn()
    sizes, omega = shaft.coefficients.sizes, shaft.machine.omega
    mass = sizes.inertia / sizes.slope**2
    rate = FACTOR * mass * sizes.curvature * omega**2 / sizes.stroke
    study = examples.study(EXAMPLE).at_theta(theta)
    x, v, a = (study.motion.displacement[k] for k in range(3))
    x = x - sizes.lowest
    spring = rate * x
    along = np.cos(study.cam.flank.pressure_angle)  # the paper's F_c is the component along the follower
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


def print_errors(name: str) -> Callable[[Examples], Numbers]:
    """Function that returns the errors of (3), `force`, or (4), `torque`, as printed and corrected.

    References
    ----------
    Kim (1990), eqs. (3), (4).
    """

    def numbers(examples: Examples) -> Numbers:
        f = forces(examples)
        return {
            "printed": relative_error(f[f"{name} printed"], f[name]),
            "corrected": relative_error(f[f"{name} corrected"], f[name]),
            "bound": SMALL,
            "largest": float(np.abs(f[name]).max()),
            "printed_largest": float(np.abs(f[f"{name} printed"]).max()),
        }

    return numbers


def spring_mass(examples: Examples) -> Numbers:
    """Mass M = K_v X_m/Ẍ_m [kg] of (5) at its limit, with the softest spring that keeps the follower on the cam.

    The shaft is rigid; the contact force is K_v X + M Ẍ ≥ 0 over the turn, by Newton-Euler.

    References
    ----------
    Kim (1990), eq. (5).
    """
    shaft = shaft_of(examples)
    sizes, contact = shaft.coefficients.sizes, shaft.contact
    assert contact is not None, "Kim's cam could be lifted off"
    angles = np.append(_turn(), 0.5 * pi)  # X is largest at a quarter of the turn
    spring, inertial, _ = contact.panels.at(angles, 3)  # over ω²
    has_force = spring > SMALL * spring.max()
    softest = float((-inertial[has_force] / spring[has_force]).max())
    needed = softest * float(spring.max()) * contact.unit / sizes.curvature
    return {
        "symbol": "Mm",
        "needed": needed,
        "known": {"Mv": sizes.inertia / sizes.slope**2},
        "bound": SMALL,
        "factor": FACTOR * softest,
    }


def _solution(examples: Examples) -> dict[str, np.ndarray]:
    """The nonlinear motion of Fig. 9 over three turns (n,), in the terms of (17) over I_c ω².

    I_e θ̈, C_e θ̇², K_s (θ_c - θ_i), and the load Q U; C_e θ̇_i² and the part of C_e θ̇² with β̇; X [m], I_e, β, β',
    and the
    rates of these two by differences.
    """
    return examples.once("solution of Fig. 9", lambda: _integrated(examples))


def _integrated(examples: Examples) -> dict[str, np.ndarray]:
    run = run_of(examples, 9)
    y = (np.arange(900) + 0.37) / 300.0
    beta, slope = run.at(y)
    second_difference = (run.at(y + STEP)[1] - run.at(y - STEP)[1]) / (2.0 * STEP)
    theta = np.mod(2.0 * pi * (y - beta), 2.0 * pi)
    rows = run.coefficients.panels.at(theta, 5)
    return {
        "turning": (1.0 + run.q * rows[INERTIA]) * -second_difference / (2.0 * pi),
        "centripetal": run.q * rows[CENTRIPETAL] * (1.0 - slope) ** 2,
        "spring": -2.0 * pi * run.eta**2 * beta,
        "load": run.q * rows[LOAD],
        "at the input": run.q * rows[CENTRIPETAL],
        "with rate": -2.0 * run.q * rows[CENTRIPETAL] * slope,
        "x": examples.study(EXAMPLE).at_theta(theta).motion.displacement[0] - run.coefficients.sizes.lowest,
        "inertia": 1.0 + run.q * rows[INERTIA],
        "wind-up": beta,
        "rate": slope,
        "first": (run.at(y + STEP)[0] - run.at(y - STEP)[0]) / (2.0 * STEP),
        "second": second_difference,
    }


def shaft_spring(examples: Examples) -> Numbers:
    """Stiffness K of I_c θ̈_c + K (θ_c - θ_i) = T_c along the solution by least squares, over I_c ω²; by (12) it is η².

    References
    ----------
    Kim (1990), eqs. (1), (12).
    """
    s, stiffness = _solution(examples), run_of(examples, 9).eta ** 2
    rest, twist = s["turning"] + s["centripetal"] + s["load"], s["spring"] / stiffness
    return {
        "symbol": "Kc",
        "needed": -float(rest @ twist / (twist @ twist)),
        "known": {"Ks": stiffness},
        "bound": NUMERICAL,
    }


def _residual(s: Mapping[str, np.ndarray], load: np.ndarray) -> float:
    """Residual of I_e θ̈ + C_e θ̇² + K_s (θ_c - θ_i) + load, relative to the spring's largest torque."""
    residual = s["turning"] + s["centripetal"] + s["spring"] + load
    return float(np.abs(residual).max() / np.abs(s["spring"]).max())


def load_without_x(examples: Examples) -> Numbers:
    """Residuals of (8) with the right side as printed, a M_v X''m ω² X'/X_m [N], and times X [N m]; in SI units.

    References
    ----------
    Kim (1990), eq. (8).
    """
    s = _solution(examples)
    printed = np.divide(s["load"], s["x"], out=np.zeros_like(s["x"]), where=s["x"] > 0.0)
    return {"printed": _residual(s, printed), "corrected": _residual(s, s["load"]), "bound": NUMERICAL}


def load_without_slope(examples: Examples) -> Numbers:
    """Residuals of (13) without X'm² in the denominator, as printed, and with it, as in (21) and (22).

    References
    ----------
    Kim (1990), eqs. (13), (21), (22).
    """
    s, square = _solution(examples), shaft_of(examples).coefficients.sizes.slope ** 2
    return {
        "printed": _residual(s, square * s["load"]),
        "corrected": _residual(s, s["load"]),
        "bound": NUMERICAL,
        "times": 1.0 / square,
    }


def rates(examples: Examples) -> Numbers:
    """Errors of (15), (16), (20) as printed and with the dots of β, β and θ_i; least printed and largest corrected one.

    By y along the solution: the rate of β by differences against β, as printed, and β'; that of β' against β', as
    printed, and
    β'' of the equation of motion. By the cam angle: the slope of ln √I_e by differences against C_e θ_i/I_e, as
    printed, and
    C_e θ̇_i/I_e, ω = 1.

    References
    ----------
    Kim (1990), eqs. (15), (16), (20).
    """
    s, q, theta = _solution(examples), run_of(examples, 9).q, _turn()
    panels = shaft_of(examples).coefficients.panels
    before, at, after = (panels.at(theta + k * STEP, 5) for k in (-1.0, 0.0, 1.0))
    slope = np.log((1.0 + q * after[INERTIA]) / (1.0 + q * before[INERTIA])) / (4.0 * STEP)
    share = q * at[CENTRIPETAL] / (1.0 + q * at[INERTIA])
    second = 2.0 * pi * (s["centripetal"] + s["spring"] + s["load"]) / s["inertia"]
    pairs = ((s["wind-up"], s["rate"], s["first"]), (s["rate"], second, s["second"]), (share * theta, share, slope))
    return {
        "printed": min(relative_error(printed, true) for printed, _, true in pairs),
        "corrected": max(relative_error(corrected, true) for _, corrected, true in pairs),
        "bound": NUMERICAL,
    }


def rigid_turn(examples: Examples) -> Numbers:
    """Residuals of I_e θ̈ + C_e θ̇² as printed, and with θ_c = θ_i - 2πβ in its place.

    References
    ----------
    Kim (1990), eq. (14).
    """
    s = _solution(examples)
    return {"printed": _residual(s, -s["spring"]), "corrected": _residual(s, s["load"]), "bound": NUMERICAL}


def load_sign(examples: Examples) -> Numbers:
    """Residuals of (17) with -M_e on the right, M_e = -a M_v X''m ω² X X'/X_m as printed, and with +M_e.

    References
    ----------
    Kim (1990), eq. (17).
    """
    s = _solution(examples)
    return {"printed": _residual(s, -s["load"]), "corrected": _residual(s, s["load"]), "bound": NUMERICAL}


def linear_load(examples: Examples) -> Numbers:
    """Residuals of (18), times -2π, with M_e + C_e θ̇_i² on the right as printed, and with M_e - C_e θ̇_i².

    The latter is (17) without C_e (2πβ̇)², which (18) drops and which is added here.

    References
    ----------
    Kim (1990), eq. (18).
    """
    s = _solution(examples)
    size = float(np.abs(s["spring"]).max())
    linear = s["turning"] + s["with rate"] + s["spring"] + s["load"]
    dropped = s["centripetal"] - s["with rate"] - s["at the input"]
    return {
        "printed": float(np.abs(linear + dropped - s["at the input"]).max()) / size,
        "corrected": float(np.abs(linear + dropped + s["at the input"]).max()) / size,
        "bound": NUMERICAL,
    }


def slope_of_c(examples: Examples) -> Numbers:
    """Errors of C_e, as printed in (19), and of its derivative as the slope of C_e by differences.

    The term with β is the slope of the torque C_e θ̇² by the cam angle.

    References
    ----------
    Kim (1990), eq. (19).
    """
    panels, theta = shaft_of(examples).coefficients.panels, _turn()
    slope = (panels.at(theta + STEP, 5)[CENTRIPETAL] - panels.at(theta - STEP, 5)[CENTRIPETAL]) / (2.0 * STEP)
    rows = panels.at(theta, 5)
    return {
        "printed": relative_error(rows[CENTRIPETAL], slope),
        "corrected": relative_error(rows[CURVATURE], slope),
        "bound": NUMERICAL,
    }


def _smallest(matrix: np.ndarray) -> float:
    """Smallest |eigenvalue|: 0 where the determinant vanishes."""
    return float(np.abs(np.linalg.eigvals(matrix)).min())


def _at_edge(examples: Examples) -> tuple[np.ndarray, float]:
    """Matrix of the paper without η² for γ = jπ, and η of the first edge of (22)."""
    return kim_matrix(shaft_of(examples).coefficients, Q, True), float(row(examples, Q, APPROXIMATE).edges[0, 0, 0])


def constant_term(examples: Examples) -> Numbers:
    """Smallest eigenvalue of (27) at the first edge, γ = jπ, with G_0 = γ² + Ψ_0 Q and with η² + Ψ_0 Q; it must vanish.

    References
    ----------
    Kim (1990), eq. (27).
    """
    matrix, eta = _at_edge(examples)
    unit = np.eye(2 * KIM_ORDER + 1)
    return {
        "printed": _smallest(-(pi**2) * unit - matrix),
        "corrected": _smallest(eta**2 * unit - matrix),
        "bound": 1e-4,
        "eta": eta,
    }


def other_terms(examples: Examples) -> Numbers:
    """Smallest eigenvalue of (27) at the first edge with G_k = Ψ_k = Q, and with G_k = Ψ_k Q; it must vanish.

    References
    ----------
    Kim (1990), eq. (27).
    """
    matrix, eta = _at_edge(examples)
    unit = np.eye(2 * KIM_ORDER + 1)
    panels = shaft_of(examples).coefficients.panels
    mean = Q * fourier(panels, panels.values[LOAD_SLOPE], 0)[0].real
    r = np.arange(-KIM_ORDER, KIM_ORDER + 1) + 0.5
    printed = np.diag(eta**2 - r * r + mean) + Q * (1.0 - unit)
    return {"printed": _smallest(printed), "corrected": _smallest(eta**2 * unit - matrix), "bound": 1e-4, "eta": eta}


def _rho(gamma: complex, eta: float) -> np.ndarray:
    r = np.arange(-KIM_ORDER, KIM_ORDER + 1)
    return np.asarray(((gamma + 2j * pi * r) / (2.0 * pi)) ** 2 + eta**2)


def diagonal(examples: Examples) -> Numbers:
    """Errors of (28) at Q = 0, where the determinant is the product of all ρ_r: with π_0 in the middle, and with ρ_0.

    References
    ----------
    Kim (1990), eq. (28).
    """
    run = run_of(examples, 9)
    rho = _rho(0.3j, run.eta)
    true = complex(np.linalg.det(np.diag(rho)))
    printed = complex(np.prod(np.where(np.arange(rho.size) == KIM_ORDER, pi, rho)))
    return {
        "printed": abs(printed / true - 1.0),
        "corrected": abs(complex(np.prod(rho)) / true - 1.0),
        "bound": SMALL,
        "eta": run.eta,
    }


def exponent(examples: Examples) -> Numbers:
    """Values of ρ_r, r = 1, which must vanish, at γ = 2π(η - r) and at 2πj(η - r).

    References
    ----------
    Kim (1990), eq. (29).
    """
    eta, r = run_of(examples, 9).eta, 1
    index = KIM_ORDER + r
    return {
        "printed": float(abs(_rho(2.0 * pi * (eta - r), eta)[index])),
        "corrected": float(abs(_rho(2j * pi * (eta - r), eta)[index])),
        "bound": SMALL,
        "eta": eta,
    }
