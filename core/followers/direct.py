"""Followers without a linkage: an oscillating arm with a round or flat face, a translating follower, and the output of a motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from core.design import (
    FRAME_LINK,
    Driver,
    Knife,
    Link,
    Linkage,
    LinkPoint,
    Oscillating,
    OscillatingFlat,
    Output,
    Pushrod,
    Rolling,
    Shoe,
    Slider,
    TiltedFlat,
    Translating,
    si,
)
from core.design.parts import SIDES
from core.design.spatial import GloboidalCam
from core.errors import NoAssembly, NoCam, angle_ranges
from core.followers.dimensions import SECOND, angle_at_pivot, rounded, second_on_arm
from core.mechanism.mechanism import Mechanism, Names, ReferencePoint
from core.motion import TURN, MotionState
from core.number_text import input_text, result_text
from core.numerics.derivatives import vector

# -- arm on a fixed pivot ---------------------------------------------------------------------------------------


ARM = 2
ARM_NAMES = Names({ARM: "arm"}, ReferencePoint(ARM, "roller"))


def oscillating(follower: Oscillating, reach: float) -> Mechanism:
    """Mechanism of an oscillating arm with a round face, R = P + Zl e^{iα}, α = θz ± (θb + y).

    R is the centre of the face, θz the direction from the pivot P to the cam centre, and θb the angle at the pivot of the triangle
    Zl, |P|, reach. The sign is + where R is left of that direction; a positive motion turns the arm away from the cam centre. The
    mechanism's frame is at the pivot, with its x axis towards the cam centre.

    Parameters
    ----------
    follower : Oscillating
    reach : float
        Distance Br + Rr [m] from cam centre to R on the base circle.

    Returns
    -------
    Mechanism

    Raises
    ------
    NoAssembly
        The face does not reach the base circle.

    References
    ----------
    Shin 1995 §3.
    """
    g, sign = si(follower), SIDES[follower.side]
    theta_b = angle_at_pivot(g.arm, np.hypot(g.pivot_x, g.pivot_y), reach, follower.face, "arm", "follower.arm_mm")
    theta_z = np.arctan2(-g.pivot_y, -g.pivot_x)
    points = LinkPoint("roller", follower.arm_mm, 0.0), *second_on_arm(follower.second)
    return _arm(vector(g.pivot_x, g.pivot_y), theta_z, sign * theta_b, sign, "alpha", *points)


def oscillating_flat(follower: OscillatingFlat, reach: float) -> Mechanism:
    """Mechanism of an oscillating flat face, (x - P)·m = f, m = e^{i(μ0 ± y)}, μ0 = arg P ∓ acos((Br - f)/|P|).

    Upper signs apply where the contact is left of the ray from the pivot P to the cam centre; a positive motion turns the face
    away from the cam centre. The arm's frame is at the pivot with its x axis along m; the reference point is the perpendicular
    projection of the pivot on the face.

    Parameters
    ----------
    follower : OscillatingFlat
    reach : float
        Base radius Br [m].

    Returns
    -------
    Mechanism

    Raises
    ------
    NoAssembly
        The face cannot touch the base circle.
    """
    g, sign, f = si(follower), SIDES[follower.side], si(follower.face).face_offset
    pivot = np.hypot(g.pivot_x, g.pivot_y)
    NoAssembly.raise_where(
        ~(abs(reach - f) < pivot),
        lambda: NoAssembly(
            f"the flat face cannot lie on the base circle: base radius less face offset {result_text(1e3 * (reach - f), 6)} mm, pivot "
            f"{result_text(1e3 * pivot, 6)} mm from the cam centre",
            "follower.pivot_x_mm",
            f"put the pivot farther than {rounded(1e3 * abs(reach - f), math.ceil)} mm from the cam centre, or change "
            "base_radius_mm or face_offset_mm",
        ),
    )
    theta_z = np.arctan2(-g.pivot_y, -g.pivot_x)
    start = sign * (np.pi - np.arccos((reach - f) / pivot))
    point = LinkPoint("roller", follower.face.face_offset_mm, 0.0)
    return _arm(vector(g.pivot_x, g.pivot_y), theta_z, start, sign, "mu", point)


def _arm(pivot: complex, theta_z: float, start: float, sign: float, base: str, *points: LinkPoint) -> Mechanism:
    """One link on a pivot [m], which the motion turns from `start` [rad] relative to the direction to the cam centre.

    Its angle in the base position is within -π ... π, as the free angle of a torsion spring.
    """
    first = theta_z + start
    first = first - TURN * np.rint(first / TURN)
    linkage = Linkage(
        (Link(FRAME_LINK, (LinkPoint("pivot", 0.0, 0.0),)), Link(ARM, (LinkPoint("pivot", 0.0, 0.0), *points))),
        (),
        Driver(ARM, "motion"),
    )
    return Mechanism(
        linkage,
        ARM_NAMES,
        pivot,
        first - start,
        start,
        sign,
        base={base: (first, "deg")},
    )


# -- output of a motion without a cam ---------------------------------------------------------------------------


OUTPUT = 2
OUTPUT_NAMES = Names({OUTPUT: "output"}, pairs={str(OUTPUT): "guide"})
POINTER_MM = 50.0
"""Distance from the pivot to the point that shows the rotation in a drawing."""


def pointer_mm(cam: Any) -> float:
    """Length of the output's arm in a drawing [mm]: of a cam in space up to its roller."""
    if isinstance(cam, GloboidalCam):
        return cam.roller_inner_mm
    return getattr(cam, "arm_mm", None) or POINTER_MM


def output(part: Output, pointer_mm: float) -> Mechanism:
    """Mechanism of a motion alone: a link that slides by y in x direction, or turns by the angle y."""
    pivot = () if part.unit == "mm" else (LinkPoint("pivot", 0.0, 0.0),)
    sliders = (Slider(link=OUTPUT, on=FRAME_LINK),) if part.unit == "mm" else ()
    pointer = tuple(LinkPoint("pointer", pointer_mm, 0.0) for _ in pivot)
    links = Link(FRAME_LINK, pivot), Link(OUTPUT, (*pivot, *pointer))
    linkage = Linkage(links, sliders, Driver(OUTPUT, "motion"))
    return Mechanism(linkage, OUTPUT_NAMES)


# -- translating follower ---------------------------------------------------------------------------------------


FOLLOWER = 2
GUIDE = str(FOLLOWER)
FOLLOWER_NAMES = Names(
    {FOLLOWER: "follower"},
    ReferencePoint(FOLLOWER, "roller", "follower"),
    pairs={GUIDE: "guide"},
    points={GUIDE: "roller"},
    coordinates={"follower_position": GUIDE},
)


def translating(follower: Translating, reach: float) -> Mechanism:
    """Mechanism of a translating follower, R = e(S + iε), S = S0 + y.

    R is the reference point, e the direction of the guide, ε the offset to its left, and S0 the position on the base circle. The
    mechanism's frame has its origin at the cam centre and its x axis along e.

    Parameters
    ----------
    follower : Translating
    reach : float
        Distance Br + Rr [m]; Br of a flat face.

    Returns
    -------
    Mechanism

    Raises
    ------
    NoAssembly
        The offset exceeds the reach.
    """
    g = si(follower)
    base = guided_start(follower, reach)
    linkage = Linkage(
        (Link(FRAME_LINK, ()), Link(FOLLOWER, (LinkPoint("roller", 0.0, 0.0), *second_behind(follower)))),
        (Slider(link=FOLLOWER, on=FRAME_LINK, through_y_mm=follower.offset_mm),),
        Driver(FOLLOWER, "motion"),
    )
    return Mechanism(
        linkage,
        FOLLOWER_NAMES,
        turn=g.direction,
        start=base,
        base={"follower": (base, "mm")},
        require=radius_requirement(follower),
    )


def second_behind(follower: Translating | Pushrod) -> tuple[LinkPoint, ...]:
    """Centre of the second roller of a conjugate pair, behind the first."""
    return () if follower.second is None else (LinkPoint(SECOND, -follower.second.distance_mm, 0.0),)


def guided_start(follower: Translating | Pushrod, reach: float) -> float:
    """Position S0 [m] on its guide of a follower whose face touches the base circle; ``reach`` as for `translating`.

    Raises NoAssembly where the offset exceeds the reach.
    """
    return STARTS[type(follower.face)](follower, reach)


def radius_requirement(follower: Translating | Pushrod) -> Callable[[float, MotionState], None] | None:
    """Function that raises NoCam where the centre of a round face passes the cam centre; None for a flat face."""
    return None if isinstance(follower.face, TiltedFlat) else partial(_require_radius, follower.face.noun)


def _round_start(follower: Translating | Pushrod, reach: float) -> float:
    """S0 = √(reach² - ε²)."""
    offset = si(follower).offset
    square = (reach - offset) * (reach + offset)
    face: Any = follower.face
    NoAssembly.raise_where(
        square <= 0.0,
        lambda: NoAssembly(
            f"the {face.noun} cannot reach the base circle: offset {input_text(follower.offset_mm)} mm",
            "follower.offset_mm",
            f"must stay within +-{result_text(reach * 1e3, 6)} mm, {face.reach}",
        ),
    )
    return np.sqrt(square)


def _flat_start(follower: Translating | Pushrod, reach: float) -> float:
    """S0 = (Br - ε sin η)/cos η, where the guide's line meets the face, which is tilted by η and touches the base circle."""
    tilt = si(follower.face).face_tilt
    return (reach - si(follower).offset * np.sin(tilt)) / np.cos(tilt)


STARTS: Mapping[type, Callable[[Translating | Pushrod, float], float]] = MappingProxyType(
    {Rolling: _round_start, Knife: _round_start, Shoe: _round_start, TiltedFlat: _flat_start}
)


def _require_radius(noun: str, base: float, motion: MotionState) -> None:
    """Raise NoCam where the centre of a round face passes the cam centre."""
    position = base + motion.displacement[0]
    NoCam.raise_where(
        position <= 0.0,
        lambda: NoCam(
            f"the {noun} centre passes the cam centre: no cam radius is left",
            "cam.base_radius_mm",
            f"make it larger by more than {result_text(-np.min(position) * 1e3, 6)} mm, or lower the motion",
            angle_ranges(motion.theta, position <= 0.0),
        ),
    )
