"""The arm on a fixed pivot: with a round at its end on the cam, or with a flat face."""

from __future__ import annotations

import math

import numpy as np

from core.design import FRAME_LINK, Driver, Link, Linkage, LinkPoint, Oscillating, OscillatingFlat, si
from core.design.parts import SIDES
from core.errors import NoAssembly
from core.followers.reach import angle_at_pivot, rounded, second_on_arm
from core.mechanism.mechanism import Mechanism, ReferencePoint
from core.motion import TURN
from core.numerics.vectors import vector

ARM = 2


def oscillating(follower: Oscillating, reach: float) -> Mechanism:
    """Roller centre R = P + Zl e^{iα}, α = θz ± (θb + y): θz the direction from the pivot P to the cam centre, θb the angle
    of the triangle Zl, |P|, reach at the pivot, + where the roller lies left of that direction. Motion > 0 turns the arm
    away from the cam centre.

    In a frame at the pivot whose x axis points at the cam centre. reach [m]: Br + Rr. Raises NoAssembly where the roller
    does not reach the base circle.
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
    NoAssembly.where(
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
