"""Linkages in closed form: one row per follower turns it and a motion into a Train."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from core.design import CamSlider, Follower, Translating
from core.linkage.base import LAYOUT_TABLE, BasePosition, Layout, base_position
from core.linkage.cam_slider import cam_slider_train
from core.linkage.limits import findings
from core.linkage.rod_and_arm import RodAndArm, rod_and_arm
from core.linkage.translating import translating_train
from core.linkage.triangle import area4, area4_of, opposite_angle
from core.motion import MotionState
from core.train import Train

TRAINS: Mapping[type, Callable[[Any, float, MotionState], Train]] = MappingProxyType(
    {CamSlider: cam_slider_train, Translating: translating_train}
)


def train_of(follower: Follower, reach: float, motion: MotionState) -> Train:
    """The solved mechanism; reach [m] is the reference point's distance from the cam centre on the base circle."""
    return TRAINS[type(follower)](follower, reach, motion)


__all__ = [
    "LAYOUT_TABLE", "TRAINS", "BasePosition", "Layout", "RodAndArm", "area4", "area4_of", "base_position", "cam_slider_train",
    "findings", "opposite_angle", "rod_and_arm", "train_of", "translating_train",
]  # fmt: skip
