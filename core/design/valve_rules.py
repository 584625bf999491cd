"""Rules of the valve that a drive moves."""

from __future__ import annotations

import math
from collections.abc import Iterator

from core.design.design import Design
from core.design.edits import stroke
from core.design.motions import Motion
from core.errors import MISSING, Fault


def _lift(motion: Motion) -> float:
    """Greatest lift [mm] of a motion; infinite where it is an angle, or incomplete."""
    if motion.lobe is not None:
        return motion.lobe.lift_mm if motion.lobe.lift_mm > 0.0 else math.inf
    return stroke(motion) if motion.unit == "mm" and motion.segments else math.inf


def valve_faults(design: Design) -> Iterator[Fault]:
    """A valve has an engine and a motion in mm; only that of a linkage is one of its sliders."""
    drive, valve = design.drive, design.drive.valve
    if valve is None:
        return
    if design.engine is None:
        yield Fault("valve", "[valve]", "has no engine, on whose crank it opens", "a table [engine]")
    if drive.motion is None:
        yield Fault("valve", "[valve]", "has no motion that opens it", "a design with [motion]")
        return
    if valve.lash_mm > (lift := _lift(drive.motion)):
        yield Fault("valve.lash_mm", valve.lash_mm, "larger than the lift: the valve stays closed", f"<= {lift:g} mm")
    sliders = {slider.link for slider in drive.linkage.sliders} if drive.is_linkage else set()
    names = " | ".join(map(str, sorted(sliders))) or "a linkage with a slider"
    if drive.is_linkage and valve.link not in sliders:
        value = MISSING if valve.link is None else valve.link
        yield Fault("valve.link", value, "is no slider of this linkage", names)
    elif not drive.is_linkage and valve.link is not None:
        yield Fault("valve.link", valve.link, "only in a linkage", "leave it out")
    elif not drive.is_linkage and drive.motion.unit != "mm":
        yield Fault(
            "valve", "[valve]", f"moves in {drive.motion.unit}", "a follower with a motion in mm, or a [linkage]"
        )
