"""The cam-driven slider: roller arm and slider arm on one pivot, rod, slider on a guide (Shin1995 §2)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from core.design import FRAME_LINK, CamSlider, Design, Driver, Link, Linkage, LinkPoint, Side, Slider, edited, get, si
from core.errors import NoAssembly, angle_ranges
from core.followers.dimensions import angle_at_pivot, rounded, second_on_arm
from core.frozen import frozen
from core.mechanism.mechanism import LinkageSolution, Mechanism, ReferencePoint
from core.motion import MotionState
from core.numerics.derivatives import heading, vector

# -- the cam-driven slider --------------------------------------------------------------------------------------


ARM, ROD, SLIDER = 2, 3, 4
EPS_LENGTH = 1e-12  # of a length: beyond reach by less is in line


@frozen
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


@frozen
class BasePosition:
    """Roller on the base circle, y = 0 [m, rad]: slider L0, arm φ0, roller arm α0 (global), rod β0; and the sign σ
    of the triangle arm-rod, kept over the whole cycle."""

    slider: float
    phi: float
    alpha: float
    beta: float
    sigma: float


def base_position(follower: CamSlider, reach: float) -> BasePosition:
    """Shin1995 eqs. (1)-(7), for all eight layouts.

    reach: distance cam centre to roller centre on the base circle, Br + Rr [m]. β0 by atan2 instead of (7), whose
    tangent substitution divides by zero at β = 180 deg; (5) with the guide angle: φ0 = α0 - γ - δ.
    Raises NoAssembly where the roller does not reach the base circle or the rod not the guide.
    """
    g, layout = si(follower), LAYOUT_TABLE[follower.layout]
    theta_b = angle_at_pivot(
        g.roller_arm, np.hypot(g.pivot_x, g.pivot_y), reach, follower.face, "roller arm", "follower.roller_arm_mm"
    )
    theta_z = np.arctan2(-g.pivot_y, -g.pivot_x)
    alpha = theta_z - theta_b if layout.cam_left == layout.roller_above else theta_z + theta_b
    phi = alpha - g.fixed_angle - g.guide_angle
    rise = g.guide_height - g.slider_arm * np.sin(phi)
    inside = (g.rod - rise) * (g.rod + rise)
    NoAssembly.raise_where(
        inside < 0.0,
        lambda: NoAssembly(
            f"the rod does not reach the guide in the base position: {follower.rod_mm:.9g} mm long, the arm's pin is "
            f"{abs(rise) * 1e3:.9g} mm from the guide",
            "follower.rod_mm",
            f"make it longer than {rounded(abs(rise) * 1e3, math.ceil)} mm, or change guide_height_mm or fixed_angle_deg",
        ),
    )
    run = np.copysign(np.sqrt(inside), 1.0 if layout.slider_right else -1.0)
    slider = g.slider_arm * np.cos(phi) + run
    side = slider * np.sin(phi) - g.guide_height * np.cos(phi)
    NoAssembly.raise_where(
        side == 0.0,
        lambda: NoAssembly(
            "rod and slider arm lie in line in the base position (dead centre)",
            "follower.rod_mm",
            "change a length or the fixed angle",
        ),
    )
    return BasePosition(slider, phi, alpha, np.arctan2(rise, run), np.copysign(1.0, side))


def cam_slider(follower: CamSlider, reach: float) -> Mechanism:
    """In the guide's frame, origin at the pivot: the slider leads at L = L0 + y on the line y = H; arm and rod follow as a
    dyad of three pins, whose triangle needs no tangent substitution: Shin1995 (8), (9), (10) for the positions, (11), (12) for
    the velocities, (13), (14) for the accelerations.

    reach [m] is Br + Rr. Raises NoAssembly where the roller does not reach the base circle or the rod not the guide.
    """
    g, base = si(follower), base_position(follower, reach)
    roller = follower.roller_arm_mm * heading(g.fixed_angle)
    linkage = Linkage(
        (
            Link(FRAME_LINK, (LinkPoint("pivot", 0.0, 0.0),)),
            Link(
                ARM,
                (
                    LinkPoint("pivot", 0.0, 0.0),
                    LinkPoint("arm_pin", follower.slider_arm_mm, 0.0),
                    LinkPoint("roller", roller.real, roller.imag),
                    *second_on_arm(follower.second, g.fixed_angle),
                ),
            ),
            Link(ROD, (LinkPoint("arm_pin", 0.0, 0.0), LinkPoint("slider_pin", follower.rod_mm, 0.0))),
            Link(SLIDER, (LinkPoint("slider_pin", 0.0, 0.0),)),
        ),
        (Slider(link=SLIDER, on=FRAME_LINK, through_y_mm=follower.guide_height_mm),),
        Driver(SLIDER, "motion"),
        (Side("arm_pin", base.sigma),),  # type: ignore[arg-type]  # a number, or one of each of many designs
    )
    guide = str(SLIDER)

    def across(solved: LinkageSolution) -> dict[str, np.ndarray]:
        """|cos β|: a rod across the guide cannot move the slider."""
        return {"rod-across-guide": np.abs(solved.poses[ROD].unit.real)}

    def refuse(motion: MotionState, solved: LinkageSolution, lost: np.ndarray) -> NoAssembly:
        return _refusal(follower, base.slider, motion, lost)

    return Mechanism(
        linkage,
        {ARM: "arm", ROD: "rod", SLIDER: "slider"},
        ReferencePoint(ARM, "roller"),
        vector(g.pivot_x, g.pivot_y),
        g.guide_angle,
        base.slider,
        pairs={guide: "guide"},
        force_links={"arm_pin": ROD, "slider_pin": ROD},
        points={guide: "slider_pin"},
        coordinates={"slider_position": guide, "phi": ARM, "beta": ROD},
        angles={ARM: base.phi, ROD: base.beta},
        base={
            "slider": (base.slider, "mm"),
            "phi": (base.phi, "deg"),
            "alpha": (base.alpha, "deg"),
            "beta": (base.beta, "deg"),
        },
        singular={"arm_pin": "dead-centre"},
        more_singular=across,
        refuse=refuse,
    )


def _refusal(follower: CamSlider, start: float, motion: MotionState, lost: np.ndarray) -> NoAssembly:
    """Why arm and rod do not reach the slider, or lie in line, at the angles that are lost (n,)."""
    g, where = si(follower), angle_ranges(motion.theta, lost)
    r = np.hypot(start + motion.displacement[0][lost], g.guide_height) * 1e3
    low, high = abs(g.slider_arm - g.rod) * 1e3, (g.slider_arm + g.rod) * 1e3
    if not ((r > high * (1.0 + EPS_LENGTH)) | (r < low * (1.0 - EPS_LENGTH))).any():
        return NoAssembly(
            "rod and slider arm lie in line (dead centre): the slider cannot drive the arm",
            "follower.rod_mm",
            "change the lengths or the stroke",
            where,
        )
    worst = r.max() if r.max() > high else r.min()
    return NoAssembly(
        f"slider arm and rod cannot reach the slider, which comes to {worst:.9g} mm from the pivot,",
        "follower.rod_mm",
        f"that distance must stay within {low:.9g} ... {high:.9g} mm: change the lengths or the stroke",
        where,
    )


# -- A cam slider in each of Shin1995's eight layouts, with the lengths that go along ---------------------------


LAYOUT_LENGTHS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "a": (1.0, 43.637), "b": (1.0, 43.637), "c": (-1.0, 130.0), "d": (-1.0, 130.0),
        "e": (1.0, 110.0), "f": (1.0, 130.0), "g": (-1.0, 60.0), "h": (-1.0, 60.0),
    }
)  # fmt: skip
"""Layout -> side of the pivot on which the guide lies, and fixed angle [deg], with which the lift's other lengths make a sound
mechanism."""

LAYOUT, HEIGHT, ANGLE = "follower.layout", "follower.guide_height_mm", "follower.fixed_angle_deg"
FORCE = "loads.external_force_n"
"""Of the cylinder on the slider, along the guide."""


def in_layout(design: Design, letter: str) -> Design:
    """A cam slider in another layout, its guide on the side of the pivot, at its own distance, where the arm can reach it.

    A roller below the line from cam to pivot is pressed on by turning the arm the other way: the cylinder, which pulls the slider in the
    layouts with the roller above, pushes it in those.
    """
    side, angle = LAYOUT_LENGTHS[letter]
    turned = LAYOUT_TABLE[letter].roller_above != LAYOUT_TABLE[str(get(design, LAYOUT))].roller_above
    height, force = float(get(design, HEIGHT)), float(get(design, FORCE))
    for path, value in (
        (LAYOUT, letter),
        (HEIGHT, math.copysign(height, side)),
        (ANGLE, angle),
        (FORCE, 0.0 - force if turned else force),
    ):
        design = edited(design, path, value)
    return design
