"""Mechanisms of cam followers, and of the output of a motion without a cam, each with its frame and the names of its parts."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any, NamedTuple

from core.design import CamSlider, Follower, Linkage, Oscillating, OscillatingFlat, Output, Pushrod, Rocker, Translating
from core.followers.cam_slider import LAYOUT_TABLE, BasePosition, Layout, base_position, cam_slider
from core.followers.dimensions import FACE as FACE_PLACE
from core.followers.dimensions import SECOND as SECOND_ROLLER
from core.followers.dimensions import reach_of
from core.followers.direct import oscillating, oscillating_flat, output, pointer_mm, translating
from core.mechanism.mechanism import Mechanism, ReferencePoint, mechanism_of


def _reach(part: Follower, cam: Any) -> tuple[Follower, float]:
    """The follower, and its distance `reach_of` [m] from the cam centre."""
    return part, reach_of(part, cam)


def _at_unit_speed(part: Linkage, cam: Any) -> tuple[Linkage, ReferencePoint | None]:
    """The linkage at a speed of 1, since no position depends on the speed, and the roller's centre."""
    unit_speed = replace(part, driver=replace(part.driver, speed_rpm=1.0))
    return unit_speed, None if cam is None else ReferencePoint(cam.link, cam.point)


def _rocker(part: Rocker, reach: float) -> Mechanism:
    from core.followers.trains import rocker  # no other design needs it at the start

    return rocker(part, reach)


def _pushrod(part: Pushrod, reach: float) -> Mechanism:
    from core.followers.trains import pushrod  # no other design needs it at the start

    return pushrod(part, reach)


class Builder(NamedTuple):
    """Builder of a mechanism: `needs` reduces part and cam to the arguments of `build`."""

    needs: Callable[[Any, Any], tuple[Any, Any]]
    build: Callable[[Any, Any], Mechanism]


BUILDERS: Mapping[type, Builder] = MappingProxyType(
    {
        CamSlider: Builder(_reach, cam_slider),
        Translating: Builder(_reach, translating),
        Oscillating: Builder(_reach, oscillating),
        OscillatingFlat: Builder(_reach, oscillating_flat),
        Rocker: Builder(_reach, _rocker),
        Pushrod: Builder(_reach, _pushrod),
        Linkage: Builder(_at_unit_speed, mechanism_of),
        Output: Builder(lambda part, cam: (part, pointer_mm(cam)), output),
    }
)


def built(part: Follower | Linkage | Output, cam: Any) -> Mechanism:
    """Mechanism of a drive; equal arguments return the same object.

    Raises
    ------
    NoAssembly
        A follower does not reach its base position.
    """
    return _built(*BUILDERS[type(part)].needs(part, cam))


@lru_cache(maxsize=64)
def _built(part: Any, needed: Any) -> Mechanism:
    return BUILDERS[type(part)].build(part, needed)


__all__ = [
    "BUILDERS",
    "FACE_PLACE",
    "LAYOUT_TABLE",
    "SECOND_ROLLER",
    "BasePosition",
    "Layout",
    "base_position",
    "built",
    "reach_of",
]
