"""Cam followers: each builds a linkage from its lengths, in a frame of its own, and says what its parts are called."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Any

from core.design import CamSlider, Follower, Translating
from core.followers.base import LAYOUT_TABLE, BasePosition, Layout, base_position
from core.followers.cam_slider import cam_slider
from core.followers.limits import findings
from core.followers.translating import translating
from core.mechanism.mechanism import Mechanism

BUILDERS: Mapping[type, Callable[[Any, float], Mechanism]] = MappingProxyType(
    {CamSlider: cam_slider, Translating: translating}
)


@lru_cache(maxsize=64)
def built(follower: Follower, reach: float) -> Mechanism:
    """The mechanism of a follower; reach [m] is the distance of its reference point from the cam centre on the base circle,
    base radius + roller radius. Raises NoAssembly where it does not come to the base position."""
    return BUILDERS[type(follower)](follower, reach)


__all__ = ["BUILDERS", "LAYOUT_TABLE", "BasePosition", "Layout", "base_position", "built", "findings"]
