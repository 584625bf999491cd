"""The numbers of Shin1995's lengths, base position and tangent substitution, of the example's lift."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import acos, atan2, cos, degrees, hypot, inf, sin, sqrt
from typing import Any

import numpy as np

from core.design import get, si
from core.mechanism.triangle import opposite_angle
from core.papers.claim import Compared
from core.papers.examples import Examples

LIFT, UNIT = "transfer_lift", "transfer_unit"
TABLE_2 = {
    "L1": ("follower.slider_arm_mm", 1302.162, "mm"),
    "mL": ("loads.arm_mass_kg", 664.0, "kg"),
    "L2": ("follower.rod_mm", 845.0, "mm"),
    "mA": ("loads.rod_mass_kg", 125.0, "kg"),
    "H": ("follower.guide_height_mm", 1300.0, "mm"),
}
TABLE_3 = {
    "Br": ("cam.base_radius_mm", 400.0, "mm"),
    "Zx": ("follower.pivot_x_mm", 873.746, "mm"),
    "Zy": ("follower.pivot_y_mm", -65.0, "mm"),
    "Zl": ("follower.roller_arm_mm", 651.081, "mm"),
    "Rr": ("cam.roller_radius_mm", 150.0, "mm"),
    "mR": ("loads.roller_mass_kg", 50.0, "kg"),
    "γ": ("follower.fixed_angle_deg", 43.637, "°"),
    "speed": ("shaft.speed_rpm", 20.0, "rpm"),
}
"""Symbol -> where it stands in the design, as printed, and its unit."""
PRINTED_INERTIAS = {"arm": 1691.509, "rod": 2274.544, "roller": 2110.577}
"""Tables 2 and 3, "kg·mm²"."""
KGF_MM_S2 = 9.80665e-3  # kg m²
SMALL = 1e-9

Numbers = Mapping[str, Any]


def printed_values(rows: Mapping[str, tuple[str, float, str]]) -> Any:
    """The numbers of a table of dimensions: what is printed, and what the design has."""

    def numbers(examples: Examples) -> Numbers:
        design = examples.design(LIFT)
        return {name: Compared(printed, float(get(design, path)), 0.0, unit) for name, (path, printed, unit) in rows.items()}

    return numbers


# -- base position ------------------------------------------------------------------------------------------

PRINTED_BASE = {
    "L0": ("slider", -919.9947, 5e-5), "φ0": ("phi", 93.30, 5e-3), "α0": ("alpha", 136.94, 5e-3), "β0": ("beta", 180.0, 5e-3),
}  # fmt: skip
"""§6.4: symbol -> of the base position, as printed, and half of its last digit."""


def base(examples: Examples) -> dict[str, float]:
    """L0 [mm] and the angles [deg], β0 as the paper counts it, 0 ... 360."""
    found = examples.study(LIFT).linkage.base
    values = {name: value * 1e3 if unit == "mm" else degrees(value) for name, (value, unit) in found.items()}
    return {**values, "beta": values["beta"] % 360.0}


def base_position(examples: Examples) -> Numbers:
    found = base(examples)
    return {
        name: Compared(printed, found[key], within, "mm" if key == "slider" else "°")
        for name, (key, printed, within) in PRINTED_BASE.items()
    }


def printed_base(examples: Examples) -> Numbers:
    """(1)-(6) as printed against the base position, the largest difference as a part of the value."""
    g = si(examples.design(LIFT).drive.follower)
    cam = si(examples.design(LIFT).drive.cam)
    reach = cam.base_radius + cam.roller_radius
    zxy = hypot(g.pivot_x, g.pivot_y)
    theta_b = acos((g.roller_arm**2 + zxy**2 - reach**2) / (2.0 * g.roller_arm * zxy))
    alpha = atan2(-g.pivot_y, -g.pivot_x) - theta_b
    phi = alpha - g.fixed_angle
    b = -g.slider_arm * cos(phi)
    c = g.slider_arm**2 + g.guide_height**2 - g.rod**2 - 2.0 * g.guide_height * g.slider_arm * sin(phi)
    under = b * b - c
    sliders = [-b + sign * sqrt(max(under, 0.0)) for sign in (1.0, -1.0)]
    found = {name: value for name, (value, _) in examples.study(LIFT).linkage.base.items()}
    slider = min(sliders, key=lambda each: abs(each - found["slider"]))
    pairs = ((alpha, found["alpha"]), (phi, found["phi"]), (slider, found["slider"]))
    return {"off": max(abs(a - b) / abs(b) for a, b in pairs), "bound": SMALL}


def arm_angle(examples: Examples) -> Numbers:
    """§6.4's "ω0 = 136.94": how far it is from each angular velocity there is [deg/s], and from α0 [deg]."""
    study = examples.study(LIFT)
    printed = PRINTED_BASE["α0"][1]
    alpha = base(examples)["alpha"]
    shaft = degrees(study.omega)
    return {
        "printed": min(abs(printed - shaft), abs(printed)), "corrected": abs(printed - alpha), "bound": 5e-3, "shaft": shaft,
        "alpha": alpha,
    }  # fmt: skip


# -- the tangent substitution ------------------------------------------------------------------------------


def _half_angle(p: Fraction, q: Fraction, r: Fraction) -> tuple[float, list[float]]:
    """Denominator and the two numerators of tan of the half angle, -Q ± √(P² + Q² - R²) over R - P, exact to the last step."""
    root = sqrt(p * p + q * q - r * r)
    return float(r - p), [-float(q) + root, -float(q) - root]


def _lengths(examples: Examples) -> dict[str, Fraction]:
    design = examples.design(LIFT)
    paths = {"l1": "follower.slider_arm_mm", "l2": "follower.rod_mm", "h": "follower.guide_height_mm"}
    return {name: Fraction(repr(get(design, path))) for name, path in paths.items()}


def _substituted(p: Fraction, q: Fraction, r: Fraction, ours: float) -> Numbers:
    denominator, numerators = _half_angle(p, q, r)
    return {
        "printed": inf if denominator == 0.0 else 0.0, "corrected": abs(abs(ours) - 180.0), "bound": 1e-9,
        "numerators": tuple(numerators), "denominator": denominator, "ours": ours,
    }  # fmt: skip


def _by_triangle(slider: Fraction, height: Fraction, near: Fraction, far: Fraction, wanted: float) -> float:
    """The angle [deg] of the side ``near`` of the triangle on the line from the pivot to the slider, by Kahan's area."""
    line = atan2(float(height), float(slider))
    inner = opposite_angle(hypot(float(slider), float(height)), float(near), float(far))
    found = [degrees(line + sign * inner) for sign in (1.0, -1.0)]
    return min(found, key=lambda angle: abs((angle - wanted + 180.0) % 360.0 - 180.0))


def _level_rod(l1_squared: Fraction, l2: Fraction, slider: Fraction, height: Fraction) -> tuple[Fraction, Fraction, Fraction]:
    """D, E, F of (7) and (10)."""
    return 2 * slider * l2, 2 * height * l2, l1_squared - slider**2 - l2**2 - height**2


def base_rod(examples: Examples) -> Numbers:
    """(7) at β0 = 180°, which §6.4 prints: the arm's pin then stands at L0 + L2, and L1² is that and H."""
    g = _lengths(examples)
    l0 = Fraction(repr(round(base(examples)["slider"], 4)))
    tip = l0 + g["l2"]
    arm = tip * tip + g["h"] ** 2
    rod = degrees(atan2(0.0, float(l0 - tip)))
    found = base(examples)["beta"]
    d, _, f = _level_rod(g["l1"] ** 2, g["l2"], l0, g["h"])
    digits = np.log10(float(abs(d) + abs(f)) / abs(float(f - d))) if f != d else inf
    made = _substituted(*_level_rod(arm, g["l2"], l0, g["h"]), ours=rod)
    return {**made, "base": found, "digits": float(digits)}


def level_arm(examples: Examples) -> Numbers:
    """(9) where the arm of the lift lies level at 180° and its rod stands as 3 : 4 : 5."""
    g = _lengths(examples)
    slider, height = -g["l1"] + g["l2"] * Fraction(3, 5), g["l2"] * Fraction(4, 5)
    a, b = 2 * slider * g["l1"], 2 * height * g["l1"]
    c = g["l2"] ** 2 - slider**2 - g["l1"] ** 2 - height**2
    return _substituted(a, b, c, ours=_by_triangle(slider, height, g["l1"], g["l2"], 180.0))


def level_rod(examples: Examples) -> Numbers:
    """(10) where the rod of the lift lies level at 180° and its arm stands as 3 : 4 : 5."""
    g = _lengths(examples)
    tip, height = -g["l1"] * Fraction(3, 5), g["l1"] * Fraction(4, 5)
    slider = tip - g["l2"]
    d, e, f = _level_rod(g["l1"] ** 2, g["l2"], slider, height)
    return _substituted(d, e, f, ours=_by_triangle(slider, height, g["l2"], g["l1"], 180.0))


# -- inertias ----------------------------------------------------------------------------------------------


def inertia(link: str, length_path: str) -> Any:
    """Radius of gyration [mm] of a link as printed and as the example takes it, against its length [mm]: below a
    fifteenth of it nearly all the mass would lie in the middle."""

    def numbers(examples: Examples) -> Numbers:
        design = examples.design(LIFT)
        mass, taken = float(get(design, f"loads.{link}_mass_kg")), float(get(design, f"loads.{link}_inertia_kg_m2"))
        length = float(get(design, length_path))
        as_printed, radius = sqrt(PRINTED_INERTIAS[link] / mass), sqrt(taken / mass) * 1e3
        in_kgf = PRINTED_INERTIAS[link] * KGF_MM_S2
        arms = {"rod": float(get(design, "follower.rod_mm")) / 2.0, "roller": float(get(design, "follower.roller_arm_mm"))}
        arm = arms.get(link, 0.0)
        return {
            "printed": length / as_printed, "corrected": length / radius if radius else inf, "bound": 15.0,
            "value": PRINTED_INERTIAS[link], "radius": as_printed, "in_kgf": in_kgf, "taken": taken, "own": radius,
            "parallel": mass * arm * arm * 1e-6, "parallel_kgf": mass * arm * arm / 9810.0,
        }  # fmt: skip

    return numbers
