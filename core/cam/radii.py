"""The smallest radii of curvature of profile and pitch curve, from the refined extremes of what the envelope gives."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from core.cam.faces import row_of
from core.cam.forms import faces_of
from core.cam.shape import INNER, OUTER, SECOND
from core.frozen import frozen
from core.motion.extremes import Extreme, Range

STRAIGHT = 1e6  # [m] from such a radius on
PITCH, FLAT = "pitch_curvature", "profile_radius"
_PITCH_OF: Mapping[str, str] = {INNER: PITCH, OUTER: PITCH, SECOND: f"{SECOND}_{PITCH}"}


@frozen
class Radius:
    """A smallest radius of curvature [m] with its cam angle.

    curve   ``profile`` of the first cam, ``pitch``, ``outer`` flank of a groove, ``second`` profile, ``second_pitch``
    hollow  where the cam's material is concave, so that a cutter must fit in; else where it is convex
    """

    curve: str
    hollow: bool
    smallest: Extreme

    @property
    def name(self) -> str:
        """``convex_radius``, ``pitch_concave_radius``: the profile's goes without its name."""
        shape = "concave_radius" if self.hollow else "convex_radius"
        return shape if self.curve == "profile" else f"{self.curve}_{shape}"

    @property
    def of_profile(self) -> bool:
        """Whether it is the profile's, not the pitch curve's."""
        return "pitch" not in self.curve


def smallest_radii(extremes: Mapping[str, Range], face: Any, cam: Any) -> tuple[Radius, ...]:
    """Of each curve the smallest radius where it is convex and where it is hollow, as far as it is so anywhere.

    Beside a pitch curve of radius ρ_p lies a profile of ρ_p - Rr where that is convex, ρ_p + Rr where it is hollow, so that its
    smallest radii stand where the pitch curve's do. The material of a groove's outer flank lies on the other side: it is hollow,
    with ρ_p + Rr + play, where the pitch curve is convex. 0 where there is a cusp.
    """
    if FLAT in row_of(face).limits:
        return (Radius("profile", False, _at_least_zero(extremes[FLAT].low)),)
    found: list[Radius] = []
    for name, touching in faces_of(face, cam).items():
        bends, radius = extremes[_PITCH_OF[name]], 1e-3 * touching.radius_mm
        curve = {INNER: "profile"}.get(name, name)
        side = -1.0 if name == OUTER else 1.0
        for convex, end, sign in ((True, bends.high, 1.0), (False, bends.low, -1.0)):
            if sign * end.value * STRAIGHT <= 1.0:
                continue
            own = sign / end.value
            if name != OUTER:
                found.append(Radius("pitch" if name == INNER else f"{name}_pitch", not convex, Extreme(own, end.theta)))
            beside = _at_least_zero(Extreme(own - side * sign * radius, end.theta))
            found.append(Radius(curve, convex == (name == OUTER), beside))
    return tuple(sorted(found, key=lambda each: ("pitch" in each.curve, each.curve != "profile")))


def _at_least_zero(extreme: Extreme) -> Extreme:
    return Extreme(max(extreme.value, 0.0), extreme.theta)


def hollowest(radii: tuple[Radius, ...]) -> Radius | None:
    """The smallest hollow of all profiles; None where none is hollow."""
    return min(
        (each for each in radii if each.of_profile and each.hollow), key=lambda each: each.smallest.value, default=None
    )
