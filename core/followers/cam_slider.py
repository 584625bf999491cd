"""The cam-driven slider: roller arm and slider arm on one pivot, rod, slider on a guide.

Source: Shin 1995 §2.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from core.design import FRAME_LINK, CamSlider, Design, Driver, Link, Linkage, LinkPoint, Side, Slider, edited, get, si
from core.errors import NoAssembly, angle_ranges
from core.followers.dimensions import angle_at_pivot, rounded, second_on_arm
from core.frozen import frozen
from core.mechanism.mechanism import LinkageSolution, Mechanism, Names, ReferencePoint
from core.motion import MotionState
from core.number_text import input_text, result_text
from core.numerics.derivatives import heading, vector

# -- the cam-driven slider --------------------------------------------------------------------------------------


ARM, ROD, SLIDER = 2, 3, 4
EPS_LENGTH = 1e-12  # of a length: links that miss each other by less are in line
GUIDE = str(SLIDER)
NAMES = Names(
    {ARM: "arm", ROD: "rod", SLIDER: "slider"},
    ReferencePoint(ARM, "roller"),
    pairs={GUIDE: "guide"},
    force_links={"arm_pin": ROD, "slider_pin": ROD},
    points={GUIDE: "slider_pin"},
    coordinates={"slider_position": GUIDE, "phi": ARM, "beta": ROD},
    singular={"arm_pin": "dead-centre"},
)


@frozen
class Layout:
    """A layout of Shin 1995, Fig. 1 (a)-(h).

    Attributes
    ----------
    cam_left : bool
        The cam is left of the pivot.
    roller_above : bool
        The roller is above the line from cam to pivot.
    slider_right : bool
        The slider is right of the arm's tip.
    """

    cam_left: bool
    roller_above: bool
    slider_right: bool


LAYOUT_TABLE = {
    letter: Layout(cam_left=letter in "abef", roller_above=letter in "abcd", slider_right=letter in "aceg")
    for letter in "abcdefgh"
}


@frozen
class BasePosition:
    """Base position, with the roller on the base circle and y = 0.

    Attributes
    ----------
    slider : float
        Slider position L0 [m].
    phi, alpha, beta : float
        Angles [rad] of the slider arm φ0, of the roller arm α0 in the global frame, and of the rod β0.
    sigma : float
        Sign σ of the triangle of arm and rod, constant over the cycle.
    """

    slider: float
    phi: float
    alpha: float
    beta: float
    sigma: float


def base_position(follower: CamSlider, reach: float) -> BasePosition:
    """Base position of a cam slider, for all eight layouts.

    The rod angle β0 follows by atan2 instead of (7), whose tangent substitution divides by zero at β = 180°. Eq. (5) is used with
    the guide angle, φ0 = α0 - γ - δ.

    Parameters
    ----------
    follower : CamSlider
    reach : float
        Distance Br + Rr [m] from cam centre to roller centre on the base circle.

    Returns
    -------
    BasePosition

    Raises
    ------
    NoAssembly
        The roller does not reach the base circle, the rod does not reach the guide, or rod and arm are in line.

    References
    ----------
    Shin 1995, eqs. (1)-(7).
    """
    g, layout = si(follower), LAYOUT_TABLE[follower.layout]
    theta_b = angle_at_pivot(
        g.roller_arm, np.hypot(g.pivot_x, g.pivot_y), reach, follower.face, "roller arm", "follower.roller_arm_mm"
    )
    theta_z = np.arctan2(-g.pivot_y, -g.pivot_x)
    alpha = theta_z - theta_b if layout.cam_left == layout.roller_above else theta_z + theta_b
    phi = alpha - g.fixed_angle - g.guide_angle
    rise = g.guide_height - g.slider_arm * np.sin(phi)
    run_squared = (g.rod - rise) * (g.rod + rise)
    NoAssembly.raise_where(
        run_squared < 0.0,
        lambda: NoAssembly(
            f"the rod does not reach the guide in the base position: {input_text(follower.rod_mm)} mm long, the arm's pin is "
            f"{result_text(abs(rise) * 1e3, 6)} mm from the guide",
            "follower.rod_mm",
            f"make it longer than {rounded(abs(rise) * 1e3, math.ceil)} mm, or change guide_height_mm or fixed_angle_deg",
        ),
    )
    run = np.copysign(np.sqrt(run_squared), 1.0 if layout.slider_right else -1.0)
    slider = g.slider_arm * np.cos(phi) + run
    side = slider * np.sin(phi) - g.guide_height * np.cos(phi)
    NoAssembly.raise_where(
        side == 0.0,
        lambda: NoAssembly(
            "rod and slider arm are in line in the base position (dead centre)",
            "follower.rod_mm",
            "change a length or the fixed angle",
        ),
    )
    return BasePosition(slider, phi, alpha, np.arctan2(rise, run), np.copysign(1.0, side))


def cam_slider(follower: CamSlider, reach: float) -> Mechanism:
    """Mechanism of a cam slider: the slider is the driver at L = L0 + y on the line y = H, arm and rod are a dyad RRR.

    The mechanism's frame has its origin at the pivot and its x axis along the guide. The closed form of the dyad replaces the
    tangent substitution of the source.

    Parameters
    ----------
    follower : CamSlider
    reach : float
        Distance Br + Rr [m] from cam centre to roller centre on the base circle.

    Returns
    -------
    Mechanism

    Raises
    ------
    NoAssembly
        As of `base_position`.

    References
    ----------
    Shin 1995, eqs. (8)-(10) for positions, (11), (12) for velocities, (13), (14) for accelerations.
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

    def across(solution: LinkageSolution) -> dict[str, np.ndarray]:
        """|cos β|: a rod across the guide cannot move the slider."""
        return {"rod-across-guide": np.abs(solution.poses[ROD].unit.real)}

    def refuse(motion: MotionState, solution: LinkageSolution, failed: np.ndarray) -> NoAssembly:
        return _assembly_error(follower, base.slider, motion, failed)

    return Mechanism(
        linkage,
        NAMES,
        vector(g.pivot_x, g.pivot_y),
        g.guide_angle,
        base.slider,
        angles={ARM: base.phi, ROD: base.beta},
        base={
            "slider": (base.slider, "mm"),
            "phi": (base.phi, "deg"),
            "alpha": (base.alpha, "deg"),
            "beta": (base.beta, "deg"),
        },
        more_singular=across,
        refuse=refuse,
    )


def _assembly_error(follower: CamSlider, start: float, motion: MotionState, failed: np.ndarray) -> NoAssembly:
    """Error where arm and rod do not reach the slider, or are in line, at the failed angles (n,)."""
    g, where = si(follower), angle_ranges(motion.theta, failed)
    r = np.hypot(start + motion.displacement[0][failed], g.guide_height) * 1e3
    low, high = abs(g.slider_arm - g.rod) * 1e3, (g.slider_arm + g.rod) * 1e3
    if not ((r > high * (1.0 + EPS_LENGTH)) | (r < low * (1.0 - EPS_LENGTH))).any():
        return NoAssembly(
            "rod and slider arm are in line (dead centre): the slider cannot drive the arm",
            "follower.rod_mm",
            "change the lengths or the stroke",
            where,
        )
    worst = r.max() if r.max() > high else r.min()
    return NoAssembly(
        f"slider arm and rod cannot reach the slider, which comes to {result_text(worst, 6)} mm from the pivot,",
        "follower.rod_mm",
        f"that distance must stay within {result_text(low, 6)} ... {result_text(high, 6)} mm: change the lengths or the stroke",
        where,
    )


# -- change of layout -------------------------------------------------------------------------------------------


LAYOUT_LENGTHS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "a": (1.0, 43.637), "b": (1.0, 43.637), "c": (-1.0, 130.0), "d": (-1.0, 130.0),
        "e": (1.0, 110.0), "f": (1.0, 130.0), "g": (-1.0, 60.0), "h": (-1.0, 60.0),
    }
)  # fmt: skip
"""Layout -> side of the pivot on which the guide is, and fixed angle [deg], which fit the other lengths of the example lift."""

LAYOUT, HEIGHT, ANGLE = "follower.layout", "follower.guide_height_mm", "follower.fixed_angle_deg"
FORCE = "loads.external_force_n"
"""Path of the force of the cylinder on the slider, along the guide."""


def in_layout(design: Design, letter: str) -> Design:
    """The design with its cam slider in another layout, with the guide on that side of the pivot which the arm can reach.

    The cylinder pulls the slider in the layouts with the roller above the line from cam to pivot, and pushes it in the others, so
    that the roller is pressed on the cam.
    """
    side, angle = LAYOUT_LENGTHS[letter]
    changes_side = LAYOUT_TABLE[letter].roller_above != LAYOUT_TABLE[str(get(design, LAYOUT))].roller_above
    height, force = float(get(design, HEIGHT)), float(get(design, FORCE))
    for path, value in (
        (LAYOUT, letter),
        (HEIGHT, math.copysign(height, side)),
        (ANGLE, angle),
        (FORCE, 0.0 - force if changes_side else force),
    ):
        design = edited(design, path, value)
    return design
