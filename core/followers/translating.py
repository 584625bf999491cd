"""The follower that slides on a straight guide."""

from __future__ import annotations

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
    Rolling,
    Shoe,
    Slider,
    TiltedFlat,
    Translating,
    si,
)
from core.errors import NoAssembly, NoCam, angle_ranges
from core.followers.reach import SECOND
from core.mechanism.mechanism import Mechanism, ReferencePoint
from core.motion import MotionState

FOLLOWER = 2


def translating(follower: Translating, reach: float) -> Mechanism:
    """Reference point R = e(S + iε), S = S0 + s: e the direction, ε the offset to its left; S0 where the face stands on the
    base circle.

    In the frame of e, origin at the cam centre. reach [m]: Br + Rr, Br of a flat face. Raises NoAssembly where the offset is
    beyond the base circle.
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
    NoAssembly.where(
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
    NoCam.where(
        place <= 0.0,
        lambda: NoCam(
            f"the {noun} centre passes the cam centre: no cam radius is left",
            "cam.base_radius_mm",
            f"make it larger by more than {-np.min(place) * 1e3:.9g} mm, or lower the motion",
            angle_ranges(motion.theta, place <= 0.0),
        ),
    )
