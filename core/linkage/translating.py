"""The follower that slides on a straight guide (physics of the translating roller follower)."""

from __future__ import annotations

import math

import numpy as np

from core.design import Translating, si
from core.errors import NoAssembly, NoCam, angle_ranges
from core.motion import MotionState
from core.train import FRAME, SLIDING, Pair, Pose, Train


def translating_train(follower: Translating, reach: float, motion: MotionState) -> Train:
    """Reference point R = e(S + iε), S = sqrt(reach² - ε²) + s: e the direction, ε the offset to its left.

    reach: distance cam centre to reference point on the base circle, Br + Rr [m].
    Raises NoAssembly where the offset is beyond the base circle, NoCam where the roller crosses the cam centre.
    """
    g, n = si(follower), motion.theta.size
    inside = (reach - g.offset) * (reach + g.offset)
    if inside <= 0.0:
        raise NoAssembly(
            f"the roller cannot reach the base circle: offset {follower.offset_mm:.9g} mm",
            "follower.offset_mm",
            f"must stay within +-{reach * 1e3:.9g} mm, base radius + roller radius",
        )
    base, along = math.sqrt(inside), complex(math.cos(g.direction), math.sin(g.direction))
    place = motion.y.copy()
    place[0] += base
    if (place[0] <= 0.0).any():
        raise NoCam(
            "the roller centre passes the cam centre: no cam radius is left",
            "cam.base_radius_mm",
            f"make it larger by more than {-place[0].min() * 1e3:.9g} mm, or lower the motion",
            angle_ranges(motion.theta, place[0] <= 0.0),
        )
    z = place * along
    z[0] += 1j * g.offset * along
    angle = np.zeros((4, n))
    angle[0] = g.direction
    return Train(
        motion=motion,
        bodies={"follower": Pose.of(z, angle, {"roller": 0j})},
        pairs={"guide": Pair(SLIDING, FRAME, "follower", "roller", along)},
        dyads=(),
        output="follower",
        follower_body="follower",
        ground="guide",
        travel=np.full(n, along),
        coordinates={"follower_position": place},
        base={"follower": (base, "mm")},
        # the guide runs as far as the motion does, which may be long against the base circle
        residual=np.abs(((z[0] - 1j * g.offset * along) / along).imag) / np.maximum(np.abs(z[0]), reach),
        condition=np.full(n, 4.0),
    )
