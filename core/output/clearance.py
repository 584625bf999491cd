"""Clearances of a design as data and in lines."""

from __future__ import annotations

from math import degrees
from typing import Any

from core.errors import angle_list
from core.number_text import result_text
from core.output.export import MM
from core.study.clearances import LeastClearance


def clearance_data(result: LeastClearance) -> dict[str, Any]:
    """A least clearance as in JSON: lengths in mm, angles of cam, driver or machine in degrees."""
    return {
        "pair": list(result.names),
        "least_mm": result.value * MM,
        "at_least_mm": result.at_least * MM,
        "cam_angle_deg": degrees(result.theta),
        "points": [[z.real * MM + 0.0, z.imag * MM + 0.0] for z in result.points],
        "collides": [[degrees(begin), degrees(end)] for begin, end in result.meets],
    }


def is_kept(result: LeastClearance, least_mm: float) -> bool:
    """Whether two bodies keep a clearance [mm], and do not meet."""
    return not result.meets and result.value * MM >= least_mm


def clearance_line(result: LeastClearance, least_mm: float) -> str:
    """A least clearance in a line, with the clearance that must be kept [mm]."""
    first, second = result.names
    at = f"at {result_text(degrees(result.theta))} deg"
    if result.meets:
        ranges = [(degrees(begin), degrees(end)) for begin, end in result.meets]
        return f"{first} and {second}: MEET at {angle_list(ranges)}"
    line = (
        f"{first} and {second}: {result_text(result.value * MM, 6)} mm {at}, proven at least "
        f"{result_text(result.at_least * MM, 6)} mm"
    )
    return line if is_kept(result, least_mm) else f"{line}; LESS than {result_text(least_mm)} mm"
