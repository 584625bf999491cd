"""A cam slider in each of Shin1995's eight layouts, with the lengths that go along."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

from core.design import Design, edited, get
from core.followers.cam_slider import LAYOUT_TABLE

LAYOUT_LENGTHS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "a": (1.0, 43.637), "b": (1.0, 43.637), "c": (-1.0, 130.0), "d": (-1.0, 130.0),
        "e": (1.0, 110.0), "f": (1.0, 130.0), "g": (-1.0, 60.0), "h": (-1.0, 60.0),
    }
)  # fmt: skip
"""Layout -> side of the pivot on which the guide lies, and fixed angle [deg], with which the lift's other lengths make a sound
mechanism."""

LAYOUT, HEIGHT, ANGLE = "follower.layout", "follower.guide_height_mm", "follower.fixed_angle_deg"
FORCE = "loads.external_force_n"
"""Of the cylinder on the slider, along the guide."""


def in_layout(design: Design, letter: str) -> Design:
    """A cam slider in another layout, its guide on the side of the pivot, at its own distance, where the arm can reach it.

    A roller below the line from cam to pivot is pressed on by turning the arm the other way: the cylinder, which pulls the slider in the
    layouts with the roller above, pushes it in those.
    """
    side, angle = LAYOUT_LENGTHS[letter]
    turned = LAYOUT_TABLE[letter].roller_above != LAYOUT_TABLE[str(get(design, LAYOUT))].roller_above
    height, force = float(get(design, HEIGHT)), float(get(design, FORCE))
    for path, value in (
        (LAYOUT, letter),
        (HEIGHT, math.copysign(height, side)),
        (ANGLE, angle),
        (FORCE, 0.0 - force if turned else force),
    ):
        design = edited(design, path, value)
    return design
