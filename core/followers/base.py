"""The base position of the cam-driven slider: roller on the base circle, motion at 0 (Shin1995 §2.2)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from core.design import CamSlider, si
from core.errors import NoAssembly
from core.mechanism.triangle import opposite_angle


@dataclass(frozen=True)
class Layout:
    """One of Shin1995 Fig. 1 (a)-(h): cam left of the pivot, roller above the line to the pivot, slider right of
    the arm's tip."""

    cam_left: bool
    roller_above: bool
    slider_right: bool


LAYOUT_TABLE = {
    letter: Layout(cam_left=letter in "abef", roller_above=letter in "abcd", slider_right=letter in "aceg")
    for letter in "abcdefgh"
}


@dataclass(frozen=True)
class BasePosition:
    """Roller on the base circle, y = 0 [m, rad]: slider L0, arm φ0, roller arm α0 (global), rod β0; and the sign σ
    of the triangle arm-rod, kept over the whole cycle."""

    slider: float
    phi: float
    alpha: float
    beta: float
    sigma: float


def _rounded(length: float, way: Callable[[float], int], digits: int = 6) -> str:
    """A length to so many digits, by ``ceil`` or ``floor``: what a reader then types in must not be refused again."""
    if length <= 0.0:
        return "0"
    places = math.floor(math.log10(length)) - digits + 1
    return f"{way(length / 10.0**places) * 10.0**places:.12g}"


def triangle_range(one: float, other: float) -> str:
    """The range of the third side of a triangle of two sides [m], in mm."""
    return f"{_rounded(abs(one - other) * 1e3, math.ceil)} ... {_rounded((one + other) * 1e3, math.floor)}"


def base_position(follower: CamSlider, reach: float) -> BasePosition:
    """Shin1995 eqs. (1)-(7), for all eight layouts.

    reach: distance cam centre to roller centre on the base circle, Br + Rr [m]. β0 by atan2 instead of (7), whose
    tangent substitution divides by zero at β = 180 deg; (5) with the guide angle: φ0 = α0 - γ - δ.
    Raises NoAssembly where the roller does not reach the base circle or the rod not the guide.
    """
    g, layout = si(follower), LAYOUT_TABLE[follower.layout]
    pivot_distance = math.hypot(g.pivot_x, g.pivot_y)
    theta_b = opposite_angle(g.roller_arm, pivot_distance, reach)
    if math.isnan(theta_b):
        raise NoAssembly(
            f"the roller cannot reach the base circle: roller arm {follower.roller_arm_mm:.9g} mm, pivot "
            f"{pivot_distance * 1e3:.9g} mm from the cam centre, base radius + roller radius {reach * 1e3:.9g} mm make no triangle",
            "follower.roller_arm_mm",
            f"make the roller arm {triangle_range(pivot_distance, reach)} mm long, or base radius + roller radius "
            f"{triangle_range(pivot_distance, g.roller_arm)} mm",
        )
    theta_z = math.atan2(-g.pivot_y, -g.pivot_x)
    alpha = theta_z - theta_b if layout.cam_left == layout.roller_above else theta_z + theta_b
    phi = alpha - g.fixed_angle - g.guide_angle
    rise = g.guide_height - g.slider_arm * math.sin(phi)
    inside = (g.rod - rise) * (g.rod + rise)
    if inside < 0.0:
        raise NoAssembly(
            f"the rod does not reach the guide in the base position: {follower.rod_mm:.9g} mm long, the arm's pin is "
            f"{abs(rise) * 1e3:.9g} mm from the guide",
            "follower.rod_mm",
            f"make it longer than {_rounded(abs(rise) * 1e3, math.ceil)} mm, or change guide_height_mm or fixed_angle_deg",
        )
    run = math.copysign(math.sqrt(inside), 1.0 if layout.slider_right else -1.0)
    slider = g.slider_arm * math.cos(phi) + run
    side = slider * math.sin(phi) - g.guide_height * math.cos(phi)
    if side == 0.0:
        raise NoAssembly(
            "rod and slider arm lie in line in the base position (dead centre)",
            "follower.rod_mm",
            "change a length or the fixed angle",
        )
    return BasePosition(slider, phi, alpha, math.atan2(rise, run), math.copysign(1.0, side))
