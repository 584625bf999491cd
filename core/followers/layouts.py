"""The lift's lengths in each of Shin1995's eight layouts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from core.design import Design, edited, get
from core.followers.cam_slider import LAYOUT_TABLE

LAYOUT_LENGTHS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "a": (1300.0, 43.637), "b": (1300.0, 43.637), "c": (-1300.0, 130.0), "d": (-1300.0, 130.0),
        "e": (1300.0, 110.0), "f": (1300.0, 130.0), "g": (-1300.0, 60.0), "h": (-1300.0, 60.0),
    }
)  # fmt: skip
"""Layout -> guide height [mm] and fixed angle [deg] with which the lift's other lengths make a sound mechanism."""

FORCE = "loads.external_force_n"
"""Of the cylinder on the slider, along the guide."""


def in_layout(design: Design, letter: str) -> Design:
    """A cam slider with a roller above the line from cam to pivot in another layout, its guide moved to where the arm can reach it.

    A roller below that line is pressed on by turning the arm the other way: the cylinder, which pulls the slider in the layouts with the
    roller above, pushes it in those.
    """
    height, angle = LAYOUT_LENGTHS[letter]
    original, force = design, float(get(design, FORCE))
    for path, value in (
        ("follower.layout", letter), ("follower.guide_height_mm", height), ("follower.fixed_angle_deg", angle),
        (FORCE, force if LAYOUT_TABLE[letter].roller_above else -force),
    ):  # fmt: skip
        design = edited(design, path, value)
    return original if design == original else replace(design, name=f"Cam slider, layout {letter}")
