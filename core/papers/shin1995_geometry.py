"""Numbers of Shin1995's lengths, base position and tangent substitution, computed from the example's lift."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from math import acos, atan2, cos, degrees, hypot, inf, sin, sqrt
from typing import Any

import numpy as np

from core.design import Design, get, si
from core.errors import NoSolution
from core.followers.cam_slider import LAYOUT_LENGTHS, in_layout
from core.papers.claim import (
    MISPRINT,
    ComparedNumber,
    Examples,
    Judge,
    Judgement,
    MechanismPicture,
    PaperFigure,
    agreement,
    correction_verdict,
)
from core.study import Study

# -- lengths ----------------------------------------------------------------------------------------------------

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
"""Symbol -> path in the design, printed value, and unit."""
PRINTED_INERTIAS = {"arm": 1691.509, "rod": 2274.544, "roller": 2110.577}
"""Tables 2 and 3, "kg·mm²"."""
KGF_MM_S2 = 9.80665e-3  # kg m²
SMALL = 1e-9

Numbers = Mapping[str, Any]


def printed_values(rows: Mapping[str, tuple[str, float, str]]) -> Any:
    """Function that compares a table of dimensions with the design."""

    def numbers(examples: Examples) -> Numbers:
        design = examples.design(LIFT)
        return {
            name: ComparedNumber(printed, float(get(design, path)), 0.0, unit)
            for name, (path, printed, unit) in rows.items()
        }

    return numbers


# -- base position ------------------------------------------------------------------------------------------

PRINTED_BASE = {
    "L0": ("slider", -919.9947, 5e-5), "φ0": ("phi", 93.30, 5e-3), "α0": ("alpha", 136.94, 5e-3), "β0": ("beta", 180.0, 5e-3),
}  # fmt: skip
"""§6.4: symbol -> coordinate of the base position, printed value, and half of its last digit."""


def base(examples: Examples) -> dict[str, float]:
    """L0 [mm] and the angles [deg] of the base position, β0 in 0 ... 360 as in the paper."""
    position = examples.study(LIFT).linkage.base
    values = {name: value * 1e3 if unit == "mm" else degrees(value) for name, (value, unit) in position.items()}
    return {**values, "beta": values["beta"] % 360.0}


def base_position(examples: Examples) -> Numbers:
    """Base position as printed and as computed (§6.4, Fig. 2)."""
    position = base(examples)
    return {
        name: ComparedNumber(printed, position[key], within, "mm" if key == "slider" else "°")
        for name, (key, printed, within) in PRINTED_BASE.items()
    }


def printed_base(examples: Examples) -> Numbers:
    """Largest relative error of (1)-(6) as printed against the base position.

    References
    ----------
    Shin, Kim and Ha (1995), eqs. (1)-(6).
    """
    g = si(examples.design(LIFT).drive.follower)
    cam = si(examples.design(LIFT).drive.cam)
    reach = cam.base_radius + cam.roller_radius
    zxy = hypot(g.pivot_x, g.pivot_y)
    theta_b = acos((g.roller_arm**2 + zxy**2 - reach**2) / (2.0 * g.roller_arm * zxy))
    alpha = atan2(-g.pivot_y, -g.pivot_x) - theta_b
    phi = alpha - g.fixed_angle
    b = -g.slider_arm * cos(phi)
    c = g.slider_arm**2 + g.guide_height**2 - g.rod**2 - 2.0 * g.guide_height * g.slider_arm * sin(phi)
    radicand = b * b - c
    sliders = [-b + sign * sqrt(max(radicand, 0.0)) for sign in (1.0, -1.0)]
    position = {name: value for name, (value, _) in examples.study(LIFT).linkage.base.items()}
    slider = min(sliders, key=lambda length: abs(length - position["slider"]))
    pairs = ((alpha, position["alpha"]), (phi, position["phi"]), (slider, position["slider"]))
    return {"off": max(abs(a - b) / abs(b) for a, b in pairs), "bound": SMALL}


def arm_angle(examples: Examples) -> Numbers:
    """Distance of §6.4's "ω0 = 136.94" from the angular velocities [deg/s] and from α0 [deg]."""
    study = examples.study(LIFT)
    printed = PRINTED_BASE["α0"][1]
    alpha = base(examples)["alpha"]
    shaft = degrees(study.omega)
    return {
        "printed": min(abs(printed - shaft), abs(printed)),
        "corrected": abs(printed - alpha),
        "bound": 5e-3,
        "shaft": shaft,
        "alpha": alpha,
    }


# -- the tangent substitution ------------------------------------------------------------------------------


def _lengths(examples: Examples) -> dict[str, Fraction]:
    design = examples.design(LIFT)
    paths = {"l1": "follower.slider_arm_mm", "l2": "follower.rod_mm", "h": "follower.guide_height_mm"}
    return {name: Fraction(repr(get(design, path))) for name, path in paths.items()}


def _sides(slider: Any, height: Any, near: Any, far: Any) -> tuple[Any, Any, Any]:
    """A, B, C of (9), D, E, F of (7) and (10), for the angle of the side ``near`` of the triangle."""
    return 2 * slider * near, 2 * height * near, far**2 - slider**2 - near**2 - height**2


def _substituted(p: Any, q: Any, r: Any, true: np.ndarray) -> np.ndarray:
    """Angle 2 atan((-Q ± √(P² + Q² - R²))/(R - P)) in doubles (n,) [deg], the root nearer to the true angle."""
    with np.errstate(divide="ignore", invalid="ignore"):
        roots = [
            np.degrees(2.0 * np.arctan((-q + sign * np.sqrt(p * p + q * q - r * r)) / (r - p))) for sign in (1.0, -1.0)
        ]
    return np.asarray(min(roots, key=lambda root: float(_angle_difference(root, true).max())))


def _angle_difference(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Absolute difference of two angles [deg]."""
    return np.abs((first - second + 180.0) % 360.0 - 180.0)


def _limit(used: np.ndarray, true: np.ndarray, singular: tuple[Fraction, Fraction, Fraction]) -> dict[str, Any]:
    """Error of the substitution's angles in doubles [deg], and its terms at a pose with a root at 180°.

    These terms are the numerators and the denominator of the tangent of half the angle, exact to the last step.
    """
    p, q, r = singular
    root, denominator = sqrt(p * p + q * q - r * r), float(r - p)
    return {
        "used": float(_angle_difference(used, true).max()),
        "elsewhere": inf if denominator == 0.0 else 0.0,
        "bound": SMALL,
        "numerators": (-float(q) + root, -float(q) - root),
        "denominator": denominator,
    }


def base_rod(examples: Examples) -> Numbers:
    """Error of (7) at the base of the lift, and its terms at β0 = 180°, printed in §6.4.

    The arm's pin is then at L0 + L2, and L1² is the square of that plus H².

    References
    ----------
    Shin, Kim and Ha (1995), eq. (7).
    """
    g, position = _lengths(examples), examples.study(LIFT).linkage.base
    l1, l2, h = (float(g[name]) for name in ("l1", "l2", "h"))
    slider, true = position["slider"][0] * 1e3, np.degrees(np.array([position["beta"][0]]))
    in_doubles = _substituted(*_sides(np.array([slider]), h, l2, l1), true)
    slider_at_180 = Fraction(repr(round(float(slider), 4)))
    p, q, _ = _sides(slider_at_180, g["h"], g["l2"], g["l1"])
    level = p, q, (slider_at_180 + g["l2"]) ** 2 + g["h"] ** 2 - slider_at_180**2 - g["l2"] ** 2 - g["h"] ** 2
    return {**_limit(in_doubles, true, level), "in_doubles": float(in_doubles[0]), "ours": float(true[0])}


def _over_the_turn(
    examples: Examples, name: str, near: str, far: str, level: tuple[Fraction, Fraction, Fraction]
) -> Numbers:
    """Error of the substitution over the turn of the lift, and its terms at the singular pose."""
    study, g = examples.study(LIFT), _lengths(examples)
    slider = study.linkage.coordinates["slider_position"][0] * 1e3
    true = np.degrees(study.linkage.coordinates[name][0])
    in_doubles = _substituted(*_sides(slider, float(g["h"]), float(g[near]), float(g[far])), true)
    return _limit(in_doubles, true, level)


def level_arm(examples: Examples) -> Numbers:
    """Error of (9) over the turn of the lift, and its terms with the arm at 180° and a rod of slope 4 : 3.

    References
    ----------
    Shin, Kim and Ha (1995), eq. (9).
    """
    g = _lengths(examples)
    slider, height = -g["l1"] + g["l2"] * Fraction(3, 5), g["l2"] * Fraction(4, 5)
    return _over_the_turn(examples, "phi", "l1", "l2", _sides(slider, height, g["l1"], g["l2"]))


def level_rod(examples: Examples) -> Numbers:
    """Error of (10) over the turn of the lift, and its terms with the rod at 180° and an arm of slope 4 : 3.

    References
    ----------
    Shin, Kim and Ha (1995), eq. (10).
    """
    g = _lengths(examples)
    slider, height = -g["l1"] * Fraction(3, 5) - g["l2"], g["l1"] * Fraction(4, 5)
    return _over_the_turn(examples, "beta", "l2", "l1", _sides(slider, height, g["l2"], g["l1"]))


# -- inertias ----------------------------------------------------------------------------------------------

THIN = 15.0  # length over radius of gyration: nearly all of the mass would be in the middle
DIGITS = 1  # digits that a misprint may change


def half_rod(design: Design) -> float:
    """Half length of the rod, L2/2 [mm]."""
    return 0.5 * float(get(design, "follower.rod_mm"))


def roller_arm(design: Design) -> float:
    """Length Zl [mm], to a hundredth as the print must have used it."""
    return round(float(get(design, "follower.roller_arm_mm")), 2)


def inertia(link: str, length_path: str, arm: Callable[[Design], float] | None = None) -> Callable[[Examples], Numbers]:
    """Function that interprets a printed inertia: as a radius of gyration [mm], and as m r²/9.81 [kgf mm s²].

    ``arm`` gives r [mm]; without it r follows from the print. `taken` is the inertia of the example.
    """

    def numbers(examples: Examples) -> Numbers:
        design, value = examples.design(LIFT), PRINTED_INERTIAS[link]
        mass, taken = float(get(design, f"loads.{link}_mass_kg")), float(get(design, f"loads.{link}_inertia_kg_m2"))
        length, printed = float(get(design, length_path)), f"{value:.3f}"
        # the paper names L_D without a number: that of its I_L as m r²/9.81
        r = sqrt(PRINTED_INERTIAS["arm"] * 9810.0 / mass) if arm is None else arm(design)
        decoded = f"{mass * r * r / 9810.0:.3f}"
        return {
            "value": value,
            "radius": sqrt(value / mass),
            "length": length,
            "r": r,
            "decoded": float(decoded),
            "digits": sum(a != b for a, b in zip(printed, decoded, strict=False)) + abs(len(printed) - len(decoded)),
            "in_kgf": value * KGF_MM_S2,
            "taken": taken,
            "example_radius": sqrt(taken / mass) * 1e3,
            "centre": float(get(design, "loads.arm_centre_mm")),
        }

    return numbers


def as_decoded(sentence: str) -> Judge:
    """Judge of a printed inertia: a misprint where its radius of gyration is too thin and the print is m r²/9.81.

    The radius of the example must not be too thin, and the print may differ in ``DIGITS`` digits.
    """

    def judge(radius: float, example_radius: float, length: float, digits: int, **more: Any) -> Judgement:
        is_print_thin, is_example_thin = (THIN * value < length for value in (radius, example_radius))
        words = "to all digits" if not digits else f"but for {digits} digit{'s' * (digits > 1)}"
        return correction_verdict(MISPRINT, is_print_thin, is_example_thin or digits > DIGITS), sentence.format(
            radius=radius, example_radius=example_radius, length=length, digits=words, **more
        )

    return judge


# -- Fig. 1, the layouts ----------------------------------------------------------------------------------------

PRINTED = {
    "a": ("left", "above", "right"), "b": ("left", "above", "left"), "c": ("right", "above", "right"), "d": ("right", "above", "left"),
    "e": ("left", "below", "right"), "f": ("left", "below", "left"), "g": ("right", "below", "right"), "h": ("right", "below", "left"),
}  # fmt: skip
"""Layout -> sides of cam, roller and slider, in the words of §2.1."""
SAMPLES = 360

Sides = tuple[str, str, str]


def study_of(examples: Examples, letter: str) -> Study:
    """Study of the lift in one of the layouts."""
    return examples.once(("layout", letter), lambda: Study(in_layout(examples.design(LIFT), letter), SAMPLES))


def sides(study: Study, theta: float) -> Sides:
    """Sides of the cam from the pivot, of the roller from the line pivot-cam, of the slider from the arm's pin."""
    study_at = study.at_theta(np.array([theta]))
    bodies = study_at.linkage.bodies
    pivot, pin, slider = (
        complex(bodies[body].position(point)[0])
        for body, point in (("arm", "pivot"), ("arm", "arm_pin"), ("slider", "slider_pin"))
    )
    side = (pivot.conjugate() * complex(study_at.cam.reference[0])).imag
    is_left = pivot.real > 0.0
    is_above = (side if is_left else -side) > 0.0
    return (
        "left" if is_left else "right",
        "above" if is_above else "below",
        "left" if slider.real < pin.real else "right",
    )


def types(examples: Examples) -> Numbers:
    """Sides at the base position and least contact force [N] of each layout that can be assembled."""
    layouts: dict[str, Sides] = {}
    force: dict[str, float] = {}
    for letter in LAYOUT_LENGTHS:
        study = study_of(examples, letter)
        try:
            layouts[letter] = sides(study, np.pi)
            force[letter] = float(study.dynamics.contact.min())
        except NoSolution:
            continue
    return {"layouts": layouts, "force": force}


def eight(layouts: Mapping[str, Sides], force: Mapping[str, float]) -> tuple[str, str]:
    """Judge Fig. 1: whether all eight layouts are as described, and the roller stays on the cam in each."""
    alike = [letter for letter in PRINTED if layouts.get(letter) == PRINTED[letter]]
    in_contact = [letter for letter in PRINTED if force.get(letter, -1.0) > 0.0]
    words = (
        f"({', '.join(alike) or 'none'}) are as described; the roller stays on the cam in "
        f"({', '.join(in_contact) or 'none'})"
    )
    least = f", with at least {min(force.values()) / 1e3:.3g} kN" if force else ""
    return ("agrees" if len(alike) == len(in_contact) == len(PRINTED) else "differs"), words + least


# -- Fig. 16, the lift itself ------------------------------------------------------------------------------


def lift(examples: Examples) -> Numbers:
    """Sides of the lift at its base position (Fig. 16)."""
    return {"layout": sides(examples.study(LIFT), np.pi)}


def as_b(layout: Sides) -> tuple[str, str]:
    """Judge Fig. 16: whether the lift has layout b."""
    cam, roller, slider = layout
    return agreement(layout == PRINTED["b"]), f"cam {cam} of the pivot, roller {roller}, slider {slider}"


NAMED = 17
"""§6.4's number of the figure with the lift: cam left, roller above, slider left."""


def figure_numbers(figures: Mapping[int, PaperFigure]) -> Callable[[Examples], Numbers]:
    """Function that returns the figures of §6, number -> sheet, with a mechanism of this layout."""

    def numbers(examples: Examples) -> Numbers:
        drawings = {number: sheet.drawing(examples) for number, sheet in figures.items() if sheet.drawing is not None}
        layouts = {
            number: sides(drawing.study, np.deg2rad(drawing.angle_deg))
            for number, drawing in drawings.items()
            if isinstance(drawing, MechanismPicture)
        }
        return {"named": NAMED, "shown": tuple(number for number, layout in layouts.items() if layout == PRINTED["b"])}

    return numbers


def as_numbered(named: int, shown: tuple[int, ...]) -> tuple[str, str]:
    """Judge §6.4: whether the named figure shows the lift."""
    words = f"Fig. {' and '.join(map(str, shown))}" if shown else "no figure"
    return correction_verdict(MISPRINT, named not in shown, not shown), (
        f"of the figures of §6 {words} has the lift as that sentence describes it; the next sentence uses the same number "
        "for the slider's motion"
    )
