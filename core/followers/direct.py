"""The arm on a fixed pivot: with a round at its end on the cam, or with a flat face."""

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
    Rolling,
    Shoe,
    Slider,
    TiltedFlat,
    Translating,
    si,
)
from core.design.parts import SIDES
from core.errors import NoAssembly, NoCam, angle_ranges
from core.followers.dimensions import SECOND, angle_at_pivot, rounded, second_on_arm
from core.mechanism.mechanism import Mechanism, ReferencePoint
from core.motion import TURN, MotionState
from core.numerics.derivatives import vector

# -- the arm on a fixed pivot -----------------------------------------------------------------------------------


ARM = 2


def oscillating(follower: Oscillating, reach: float) -> Mechanism:
    """Roller centre R = P + Zl e^{iα}, α = θz ± (θb + y): θz the direction from the pivot P to the cam centre, θb the angle
    of the triangle Zl, |P|, reach at the pivot, + where the roller lies left of that direction. Motion > 0 turns the arm
    away from the cam centre.

    In a frame at the pivot whose x axis points at the cam centre. reach [m]: Br + Rr. Raises NoAssembly where the roller
    does not reach the base circle.

    References
    ----------
    Shin1995 §3.
    """
    g, sense = si(follower), SIDES[follower.side]
    theta_b = angle_at_pivot(g.arm, np.hypot(g.pivot_x, g.pivot_y), reach, follower.face, "arm", "follower.arm_mm")
    theta_z = np.arctan2(-g.pivot_y, -g.pivot_x)
    places = LinkPoint("roller", follower.arm_mm, 0.0), *second_on_arm(follower.second)
    return _arm(vector(g.pivot_x, g.pivot_y), theta_z, sense * theta_b, sense, "alpha", *places)


def oscillating_flat(follower: OscillatingFlat, reach: float) -> Mechanism:
    """The face's line (x - P)·m = f, m = e^{i(μ0 ± y)}, μ0 = arg P ∓ acos((Br - f)/|P|): upper signs where the contact lies left
    of the ray from the pivot P to the cam centre. Motion > 0 turns the face away from the cam centre.

    The arm's frame stands at the pivot, its x axis along m; the reference point is the foot of the pivot on the face. reach
    [m]: Br. Raises NoAssembly where no turn of the face brings it onto the base circle.
    """
    g, sense, f = si(follower), SIDES[follower.side], si(follower.face).face_offset
    pivot = np.hypot(g.pivot_x, g.pivot_y)
    NoAssembly.raise_where(
        ~(abs(reach - f) < pivot),
        lambda: NoAssembly(
            f"the flat face cannot lie on the base circle: base radius less face offset {1e3 * (reach - f):.9g} mm, pivot "
            f"{1e3 * pivot:.9g} mm from the cam centre",
            "follower.pivot_x_mm",
            f"put the pivot farther than {rounded(1e3 * abs(reach - f), math.ceil)} mm from the cam centre, or change "
            "base_radius_mm or face_offset_mm",
        ),
    )
    theta_z = np.arctan2(-g.pivot_y, -g.pivot_x)
    start = sense * (np.pi - np.arccos((reach - f) / pivot))
    return _arm(
        vector(g.pivot_x, g.pivot_y),
        theta_z,
        start,
        sense,
        "mu",
        LinkPoint("roller", follower.face.face_offset_mm, 0.0),
    )


def _arm(pivot: complex, theta_z: float, start: float, sense: float, base: str, *places: LinkPoint) -> Mechanism:
    """One link on a pivot [m] of the frame, which the motion turns from ``start`` [rad] against the direction to the cam centre. Its
    angle in the base position is counted from -π to π, as a torsion spring's free angle is."""
    first = theta_z + start
    first = first - TURN * np.rint(first / TURN)
    linkage = Linkage(
        (Link(FRAME_LINK, (LinkPoint("pivot", 0.0, 0.0),)), Link(ARM, (LinkPoint("pivot", 0.0, 0.0), *places))),
        (),
        Driver(ARM, "motion"),
    )
    return Mechanism(
        linkage,
        {ARM: "arm"},
        ReferencePoint(ARM, "roller"),
        pivot,
        first - start,
        start,
        sense,
        base={base: (first, "deg")},
    )


# -- what a motion alone moves ----------------------------------------------------------------------------------


OUTPUT = 2
POINTER_MM = 50.0
"""From the pivot to the point by which its turn is seen."""


def output(part: Output, _: Any) -> Mechanism:
    """x = y, the motion in mm; or the angle of the link's x axis is y, in deg."""
    pivot = () if part.unit == "mm" else (LinkPoint("pivot", 0.0, 0.0),)
    sliders = (Slider(link=OUTPUT, on=FRAME_LINK),) if part.unit == "mm" else ()
    pointer = tuple(LinkPoint("pointer", POINTER_MM, 0.0) for _ in pivot)
    links = Link(FRAME_LINK, pivot), Link(OUTPUT, (*pivot, *pointer))
    linkage = Linkage(links, sliders, Driver(OUTPUT, "motion"))
    return Mechanism(linkage, {OUTPUT: "output"}, pairs={str(OUTPUT): "guide"})


# -- the follower that slides on a straight guide ---------------------------------------------------------------


FOLLOWER = 2


def translating(follower: Translating, reach: float) -> Mechanism:
    """Reference point R = e(S + iε), S = S0 + s: e the direction, ε the offset to its left; S0 where the face stands on the
    base circle.

    In the frame of e, origin at the cam centre. reach [m]: Br + Rr, Br of a flat face. Raises NoAssembly where the offset is
    beyond the base circle.

    References
    ----------
    Geometry of the guide.
    """
    g, guide = si(follower), str(FOLLOWER)
    base = STARTS[type(follower.face)](follower, reach)
    require = None if isinstance(follower.face, TiltedFlat) else partial(_require_radius, follower.face.noun)
    linkage = Linkage(
        (Link(FRAME_LINK, ()), Link(FOLLOWER, (LinkPoint("roller", 0.0, 0.0), *_second(follower)))),
        (Slider(link=FOLLOWER, on=FRAME_LINK, through_y_mm=follower.offset_mm),),
        Driver(FOLLOWER, "motion"),
    )
    return Mechanism(
        linkage,
        {FOLLOWER: "follower"},
        ReferencePoint(FOLLOWER, "roller", "follower"),
        turn=g.direction,
        start=base,
        pairs={guide: "guide"},
        points={guide: "roller"},
        coordinates={"follower_position": guide},
        base={"follower": (base, "mm")},
        require=require,
    )


def _second(follower: Translating) -> tuple[LinkPoint, ...]:
    """The second roller of a conjugate pair, behind the first."""
    return () if follower.second is None else (LinkPoint(SECOND, -follower.second.distance_mm, 0.0),)


def _round_start(follower: Translating, reach: float) -> float:
    """S0 = √(reach² - ε²)."""
    offset = si(follower).offset
    inside = (reach - offset) * (reach + offset)
    face: Any = follower.face
    NoAssembly.raise_where(
        inside <= 0.0,
        lambda: NoAssembly(
            f"the {face.noun} cannot reach the base circle: offset {follower.offset_mm:.9g} mm",
            "follower.offset_mm",
            f"must stay within +-{reach * 1e3:.9g} mm, {face.reach}",
        ),
    )
    return np.sqrt(inside)


def _flat_start(follower: Translating, reach: float) -> float:
    """S0 = (Br - ε sin η)/cos η: the face, tilted by η, is a tangent of the base circle; the line at the offset meets it."""
    tilt = si(follower.face).face_tilt
    return (reach - si(follower).offset * np.sin(tilt)) / np.cos(tilt)


STARTS: Mapping[type, Callable[[Translating, float], float]] = MappingProxyType(
    {Rolling: _round_start, Knife: _round_start, Shoe: _round_start, TiltedFlat: _flat_start}
)


def _require_radius(noun: str, base: float, motion: MotionState) -> None:
    """Raises NoCam where the round's centre crosses the cam centre."""
    place = base + motion.displacement[0]
    NoCam.raise_where(
        place <= 0.0,
        lambda: NoCam(
            f"the {noun} centre passes the cam centre: no cam radius is left",
            "cam.base_radius_mm",
            f"make it larger by more than {-np.min(place) * 1e3:.9g} mm, or lower the motion",
            angle_ranges(motion.theta, place <= 0.0),
        ),
    )
