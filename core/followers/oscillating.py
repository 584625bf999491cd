"""The arm on a fixed pivot with a roller on the cam."""

from __future__ import annotations

import math

from core.design import FRAME_LINK, Driver, Link, Linkage, Oscillating, Place, si
from core.design.parts import SIDES
from core.followers.reach import angle_at_pivot
from core.mechanism.mechanism import Mechanism, Reference

ARM = 2


def oscillating(follower: Oscillating, reach: float) -> Mechanism:
    """Roller centre R = P + Zl e^{iα}, α = θz ± (θb + y): θz the direction from the pivot P to the cam centre, θb the angle
    of the triangle Zl, |P|, reach at the pivot, + where the roller lies left of that direction. Motion > 0 turns the arm
    away from the cam centre.

    In a frame at the pivot whose x axis points at the cam centre. reach [m]: Br + Rr. Raises NoAssembly where the roller
    does not reach the base circle.
    """
    g, sense = si(follower), SIDES[follower.side]
    theta_b = angle_at_pivot(g.arm, math.hypot(g.pivot_x, g.pivot_y), reach, "arm", "follower.arm_mm")
    theta_z = math.atan2(-g.pivot_y, -g.pivot_x)
    linkage = Linkage(
        (
            Link(FRAME_LINK, (Place("pivot", 0.0, 0.0),)),
            Link(ARM, (Place("pivot", 0.0, 0.0), Place("roller", follower.arm_mm, 0.0))),
        ),
        (),
        Driver(ARM, "motion"),
    )
    return Mechanism(
        linkage,
        {ARM: "arm"},
        Reference(ARM, "roller"),
        complex(g.pivot_x, g.pivot_y),
        theta_z,
        sense * theta_b,
        sense,
        base={"alpha": (theta_z + sense * theta_b, "deg")},
    )
