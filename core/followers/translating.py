"""The follower that slides on a straight guide."""

from __future__ import annotations

import math

import numpy as np

from core.design import FRAME_LINK, Driver, Link, Linkage, Place, Slider, Translating, si
from core.errors import NoAssembly, NoCam, angle_ranges
from core.mechanism.mechanism import Mechanism, Reference
from core.motion import MotionState

FOLLOWER = 2


def translating(follower: Translating, reach: float) -> Mechanism:
    """Reference point R = e(S + iε), S = √(reach² - ε²) + s: e the direction, ε the offset to its left.

    In the frame of e, origin at the cam centre. reach [m]: Br + Rr. Raises NoAssembly where the offset is beyond the base
    circle.
    """
    g = si(follower)
    inside = (reach - g.offset) * (reach + g.offset)
    if inside <= 0.0:
        raise NoAssembly(
            f"the roller cannot reach the base circle: offset {follower.offset_mm:.9g} mm",
            "follower.offset_mm",
            f"must stay within +-{reach * 1e3:.9g} mm, base radius + roller radius",
        )
    base, guide = math.sqrt(inside), str(FOLLOWER)
    linkage = Linkage(
        (Link(FRAME_LINK, ()), Link(FOLLOWER, (Place("roller", 0.0, 0.0),))),
        (Slider(link=FOLLOWER, on=FRAME_LINK, through_y_mm=follower.offset_mm),),
        Driver(FOLLOWER, "motion"),
    )
    return Mechanism(
        linkage,
        {FOLLOWER: "follower"},
        Reference(FOLLOWER, "roller", "follower"),
        turn=g.direction,
        start=base,
        pairs={guide: "guide"},
        points={guide: "roller"},
        coordinates={"follower_position": guide},
        base={"follower": (base, "mm")},
        require=lambda motion: _require_radius(base, motion),
    )


def _require_radius(base: float, motion: MotionState) -> None:
    """Raises NoCam where the roller crosses the cam centre."""
    place = base + motion.y[0]
    if (place <= 0.0).any():
        raise NoCam(
            "the roller centre passes the cam centre: no cam radius is left",
            "cam.base_radius_mm",
            f"make it larger by more than {-np.min(place) * 1e3:.9g} mm, or lower the motion",
            angle_ranges(motion.theta, place <= 0.0),
        )
