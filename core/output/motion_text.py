"""What a motion comes to, in a few lines."""

from __future__ import annotations

from core.design import UNITS, Design, motion_of, stroke
from core.output.channels import channels
from core.output.lines import digits
from core.study import Study, extremes_of
from core.study.cycle import stops_of


def begun_text(design: Design) -> str:
    """Advance, or stroke, and the peaks of a design that begins with its motion: largest velocity, acceleration and jerk."""
    motion, study = motion_of(design), Study(design)
    assert motion is not None, "a design without a motion"
    unit = UNITS[motion.unit].symbol
    way = f"advance {digits(motion.gain)} {unit} a turn" if motion.gain else f"stroke {digits(stroke(motion))} {unit}"
    lines = [f"{design.name}, {digits(design.speed_rpm)} rpm: {way}"]
    found = extremes_of(study, "motion")
    for row in channels(design, ("motion",)):
        if row.name in ("velocity", "acceleration", "jerk"):
            ends = (found[row.name].low.value, found[row.name].high.value)
            largest = max(ends, key=abs) / row.unit.factor
            lines.append(f"largest {row.label.lower()} {digits(largest)} {row.unit.symbol}")
    if stops := stops_of(motion):
        error = max(abs(each.error) for each in stops)
        lines.append(f"index error at the stops {digits(error)} {unit}")
    return "\n".join(lines)


__all__ = ["begun_text"]
