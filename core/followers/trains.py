"""Valve trains with a rocker whose round pad lies on the flat tip of the valve.

The pad touches the tip where its centre is a pad radius from it, so that the centre moves along a line of the valve: a pin on a
slide across the valve. Rolling and sliding of the pad on the tip are one motion of this slide.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from core.design import FRAME_LINK, Driver, Link, Linkage, LinkPoint, Pushrod, Rocker, Side, Slider, si
from core.design.parts import SIDES
from core.errors import NoAssembly, angle_ranges
from core.followers.dimensions import angle_at_pivot, second_on_arm
from core.followers.direct import guided_start, radius_requirement, second_behind
from core.mechanism.dyads import opposite_angle
from core.mechanism.mechanism import LinkageSolution, Mechanism, Names, ReferencePoint
from core.motion import MotionState
from core.number_text import input_text, result_text
from core.numerics.derivatives import dot, heading, vector

# -- rocker -----------------------------------------------------------------------------------------------------


ROCKER, PAD, VALVE = 2, 3, 4
ROCKER_NAMES = Names(
    {ROCKER: "rocker", PAD: "pad", VALVE: "valve"},
    ReferencePoint(ROCKER, "roller"),
    pairs={str(PAD): "pad", str(VALVE): "valve_guide"},
    force_links={"pad_centre": ROCKER},
    points={str(PAD): "pad_centre", str(VALVE): "tip"},
    coordinates={"rocker_angle": ROCKER, "pad_position": str(PAD)},
    singular={"pad_centre": "pad-in-line"},
)


def rocker(follower: Rocker, reach: float) -> Mechanism:
    """Mechanism of a rocker: the valve is the driver, the rocker and the pad on its tip are a dyad RRP.

    With the angle β of the pad's arm from the direction v of the valve, the pad's centre is B = P + p e^{iβ} v, the motion of the
    valve y = p (cos β - cos β_0), and the position of the pad on its tip x_t = p (sin β - sin β_0), to the left of v. The mechanism's
    frame has its origin at the pivot P and its x axis along v.

    Parameters
    ----------
    follower : Rocker
    reach : float
        Distance Br + Rr [m] from cam centre to the centre of roller or shoe on the base circle.

    Returns
    -------
    Mechanism

    Raises
    ------
    NoAssembly
        The roller does not reach the base circle, or the valve would open towards the cam.
    """
    g, sign = si(follower), SIDES[follower.side]
    theta_b = angle_at_pivot(g.arm, np.hypot(g.pivot_x, g.pivot_y), reach, follower.face, "arm", "follower.arm_mm")
    phi = np.arctan2(-g.pivot_y, -g.pivot_x) + sign * theta_b
    pad = heading(phi + g.pad_angle - g.valve_direction)
    _require_opening(-sign * pad.imag > 0.0, follower.face.noun)
    linkage = Linkage(
        (
            Link(FRAME_LINK, (LinkPoint("pivot", 0.0, 0.0),)),
            Link(
                ROCKER,
                (
                    LinkPoint("pivot", 0.0, 0.0),
                    LinkPoint("roller", follower.arm_mm, 0.0),
                    _pad_centre(follower),
                    *second_on_arm(follower.second),
                ),
            ),
            Link(PAD, (LinkPoint("pad_centre", 0.0, 0.0),)),
            Link(VALVE, (LinkPoint("tip", follower.pad_radius_mm, 0.0),)),
        ),
        (
            Slider(link=VALVE, on=FRAME_LINK, through_y_mm=follower.pad_mm * pad.imag),
            Slider(link=PAD, on=VALVE, angle_deg=90.0),
        ),
        Driver(VALVE, "motion"),
        (Side("pad_centre", np.copysign(1.0, pad.imag)),),
    )

    def refuse(motion: MotionState, solution: LinkageSolution, failed: np.ndarray) -> NoAssembly:
        return _pad_beyond_reach(follower.pad_mm, g.pad * pad.real, motion, failed)

    return Mechanism(
        linkage,
        ROCKER_NAMES,
        vector(g.pivot_x, g.pivot_y),
        g.valve_direction,
        g.pad * pad.real,
        angles={ROCKER: phi - g.valve_direction},
        base={"rocker": (phi, "deg")},
        refuse=refuse,
    )


# -- pushrod ----------------------------------------------------------------------------------------------------


TAPPET, PUSHROD, PUSHED_ROCKER, PUSHED_PAD, PUSHED_VALVE = range(2, 7)
PUSHROD_NAMES = Names(
    {TAPPET: "tappet", PUSHROD: "pushrod", PUSHED_ROCKER: "rocker", PUSHED_PAD: "pad", PUSHED_VALVE: "valve"},
    ReferencePoint(TAPPET, "roller", "tappet"),
    pairs={str(TAPPET): "guide", str(PUSHED_PAD): "pad", str(PUSHED_VALVE): "valve_guide"},
    force_links={"lower_ball": PUSHROD, "upper_ball": PUSHED_ROCKER, "pad_centre": PUSHED_ROCKER},
    points={str(TAPPET): "roller", str(PUSHED_PAD): "pad_centre", str(PUSHED_VALVE): "tip"},
    coordinates={"rocker_angle": PUSHED_ROCKER, "valve_guide": str(PUSHED_VALVE), "pad_position": str(PUSHED_PAD)},
    singular={"upper_ball": "pushrod-in-line"},
)


def pushrod(follower: Pushrod, reach: float) -> Mechanism:
    """Mechanism of a pushrod train: the tappet is the driver, pushrod and rocker are a dyad RRR, pad and valve a dyad RPP.

    The upper ball U is at |U - S| = L from the lower ball S and at |U - P| = a from the pivot P, left or right of the ray S → P;
    the pad's centre is B = P + p (U - P) e^{iγ}/a. The valve slides along the line through B of the base position. The mechanism's
    frame has its origin at the cam centre and its x axis along the direction of the tappet.

    Parameters
    ----------
    follower : Pushrod
    reach : float
        Distance Br + Rr [m]; Br of a flat face.

    Returns
    -------
    Mechanism

    Raises
    ------
    NoAssembly
        The tappet does not reach the base circle, the pushrod does not reach the rocker, or the valve would open towards the cam.
    """
    g, sign, start = si(follower), SIDES[follower.side], guided_start(follower, reach)
    along, valve = heading(g.direction), g.valve_direction - g.direction
    pivot = vector(g.pivot_x, g.pivot_y) * np.conj(along)
    ball = vector(start + g.seat_x, g.offset + g.seat_y)
    to_pivot = pivot - ball
    corner = opposite_angle(g.push_arm, np.abs(to_pivot), g.pushrod)
    NoAssembly.raise_where(np.isnan(corner), lambda: _no_triangle(follower, float(np.max(np.abs(to_pivot)))))
    chi = np.angle(-to_pivot) - sign * corner
    arm = g.push_arm * heading(chi)
    rod = pivot + arm - ball
    pad = heading(chi + g.pad_angle - valve)
    turn = rod.real / dot(rod, 1j * arm)  # of the rocker by the tappet's position
    _require_opening(-pad.imag * turn > 0.0, "tappet")
    closed = 1e3 * (pivot + g.pad * pad * heading(valve))
    linkage = Linkage(
        (
            Link(FRAME_LINK, (LinkPoint("pivot", 1e3 * pivot.real, 1e3 * pivot.imag),)),
            Link(
                TAPPET,
                (
                    LinkPoint("roller", 0.0, 0.0),
                    LinkPoint("lower_ball", follower.seat_x_mm, follower.seat_y_mm),
                    *second_behind(follower),
                ),
            ),
            Link(PUSHROD, (LinkPoint("lower_ball", 0.0, 0.0), LinkPoint("upper_ball", follower.pushrod_mm, 0.0))),
            Link(
                PUSHED_ROCKER,
                (
                    LinkPoint("pivot", 0.0, 0.0),
                    LinkPoint("upper_ball", follower.push_arm_mm, 0.0),
                    _pad_centre(follower),
                ),
            ),
            Link(PUSHED_PAD, (LinkPoint("pad_centre", 0.0, 0.0),)),
            Link(PUSHED_VALVE, (LinkPoint("tip", follower.pad_radius_mm, 0.0),)),
        ),
        (
            Slider(link=TAPPET, on=FRAME_LINK, through_y_mm=follower.offset_mm),
            Slider(
                link=PUSHED_VALVE,
                on=FRAME_LINK,
                through_x_mm=closed.real,
                through_y_mm=closed.imag,
                angle_deg=follower.valve_direction_deg - follower.direction_deg,
            ),
            Slider(link=PUSHED_PAD, on=PUSHED_VALVE, angle_deg=90.0),
        ),
        Driver(TAPPET, "motion"),
        (Side("upper_ball", int(sign)),),
    )

    def pad_in_line(solution: LinkageSolution) -> dict[str, np.ndarray]:
        """|sin β|: a pad's arm along the valve cannot open it."""
        return {"pad-in-line": np.abs((solution.poses[PUSHED_ROCKER].unit * heading(g.pad_angle - valve)).imag)}

    def refuse(motion: MotionState, solution: LinkageSolution, failed: np.ndarray) -> NoAssembly:
        distance = np.abs(to_pivot - motion.displacement[0][failed])
        low, high = abs(g.pushrod - g.push_arm), g.pushrod + g.push_arm
        worst = distance[np.argmax(np.maximum(distance - high, low - distance))]
        return _no_triangle(follower, float(worst), angle_ranges(motion.theta, failed))

    return Mechanism(
        linkage,
        PUSHROD_NAMES,
        turn=g.direction,
        start=start,
        angles={PUSHROD: np.angle(rod), PUSHED_ROCKER: chi},
        base={"follower": (start, "mm"), "rocker": (chi + g.direction, "deg")},
        more_singular=pad_in_line,
        refuse=refuse,
        require=radius_requirement(follower),
    )


def _no_triangle(follower: Pushrod, distance: float, where: Sequence[tuple[float, float]] = ()) -> NoAssembly:
    """Error where pushrod and push arm do not meet over the distance [m] of lower ball and pivot."""
    low, high = abs(follower.pushrod_mm - follower.push_arm_mm), follower.pushrod_mm + follower.push_arm_mm
    return NoAssembly(
        f"pushrod and push arm do not meet: lower ball and pivot are {result_text(1e3 * distance, 6)} mm apart",
        "follower.pushrod_mm",
        f"that distance must stay within {result_text(low, 6)} ... {result_text(high, 6)} mm: change a length or the pivot",
        where,
    )


# -- pad and valve ----------------------------------------------------------------------------------------------


def _pad_centre(follower: Rocker | Pushrod) -> LinkPoint:
    """Centre of the pad in the frame of the rocker, whose x axis is along the arm of roller or upper ball."""
    centre = follower.pad_mm * heading(si(follower).pad_angle)
    return LinkPoint("pad_centre", centre.real, centre.imag)


def _require_opening(opens: Any, part: str) -> None:
    """Raise NoAssembly where the motion would open the valve while the part moves towards the cam."""
    NoAssembly.raise_where(
        ~np.asarray(opens),
        lambda: NoAssembly(
            f"the valve would open while the {part} moves towards the cam",
            "follower.valve_direction_deg",
            "turn the valve's direction by 180°, or change pad_angle_deg or side",
        ),
    )


def _pad_beyond_reach(arm_mm: float, start: float, motion: MotionState, failed: np.ndarray) -> NoAssembly:
    """Error where the valve is farther from the pivot than the pad's arm is long, at the failed angles (n,)."""
    position = 1e3 * (start + motion.displacement[0][failed])
    return NoAssembly(
        f"the pad cannot follow the valve: its arm is {input_text(arm_mm)} mm long, and the valve moves the pad's centre to "
        f"{result_text(position[np.argmax(np.abs(position))], 6)} mm from the pivot, along the valve",
        "follower.pad_mm",
        "make it longer, or lower the lift",
        angle_ranges(motion.theta, failed),
    )
