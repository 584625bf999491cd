"""What a motion alone moves: one link, on a slide along x, or on a pivot at the origin."""

from __future__ import annotations

from typing import Any

from core.design import FRAME_LINK, Driver, Link, Linkage, LinkPoint, Output, Slider
from core.mechanism.mechanism import Mechanism

OUTPUT = 2
POINTER_MM = 50.0
"""From the pivot to the point by which its turn is seen."""


def output(part: Output, _: Any) -> Mechanism:
    """x = y, the motion in mm; or the angle of the link's x axis is y, in deg."""
    pivot = () if part.unit == "mm" else (LinkPoint("pivot", 0.0, 0.0),)
    sliders = (Slider(link=OUTPUT, on=FRAME_LINK),) if part.unit == "mm" else ()
    pointer = tuple(LinkPoint("pointer", POINTER_MM, 0.0) for _ in pivot)
    links = Link(FRAME_LINK, pivot), Link(OUTPUT, (*pivot, *pointer))
    linkage = Linkage(links, sliders, Driver(OUTPUT, "motion"))
    return Mechanism(linkage, {OUTPUT: "output"}, pairs={str(OUTPUT): "guide"})
