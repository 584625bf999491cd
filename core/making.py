"""What the commands of motion making print: the table of laws, and a blended motion as Yang's Fig. 4 does."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import accumulate
from typing import Any

from core.blend import Blended
from core.design import Motion, Segment, SingleCam
from core.design.paths import with_section
from core.errors import DesignError, Fault
from core.laws import LAWS, peaks
from core.report import columns, digits


def laws_data() -> list[dict[str, Any]]:
    """Every law's peak coefficients for unit rise and span; infinite = None."""
    told = []
    for slug, law in LAWS.items():
        found = peaks(law)
        numbers = {"cv": found.cv, "ca": found.ca, "cj": found.cj, "cm": found.cm}
        told.append({"law": slug, **{k: v if math.isfinite(v) else None for k, v in numbers.items()}})
    return told


def laws_text() -> str:
    """The same to read."""
    rows: list[tuple[str, ...]] = [("law", "velocity", "acceleration", "jerk", "torque", "")]
    for slug, law in LAWS.items():
        found = peaks(law)
        numbers = [digits(v if math.isfinite(v) else None) for v in (found.cv, found.ca, found.cj, found.cm)]
        rows.append((slug, *numbers, "acceleration jumps at an end" if found.jumps_at_an_end else ""))
    return "\n".join(columns(rows)) + "\n"


def curves_data(blended: Blended) -> list[dict[str, Any]]:
    """The curves in order, with their angles and levels; the motion starts at level 0, or falls to it."""
    request = blended.request
    angle, level = request.start, _first_level(blended)
    told = []
    for name, segment in zip(_names(blended), blended.segments, strict=True):
        told.append(
            {
                "curve": name,
                "start_deg": angle,
                "span_deg": segment.span_deg,
                f"start_{request.unit}": level,
                f"rise_{request.unit}": segment.rise,
            }
        )
        angle, level = angle + segment.span_deg, level + segment.rise
    return told


def _names(blended: Blended) -> list[str]:
    return [segment.curve.law.upper() for segment in blended.segments]


def _first_level(blended: Blended) -> float:
    levels = list(accumulate((s.rise for s in blended.segments), initial=0.0))
    return -min(levels)


def blend_text(blended: Blended) -> str:
    """Sequence, spans and the table of starts and ends."""
    unit = blended.request.unit
    rows = [("curve", "height " + unit, "span deg", "from deg", "to deg", "from " + unit, "to " + unit)]
    for curve in curves_data(blended):
        start, rise = curve[f"start_{unit}"], curve[f"rise_{unit}"]
        a, span = curve["start_deg"], curve["span_deg"]
        numbers = (abs(rise), span, a, a + span, start, start + rise)
        rows.append((curve["curve"], *(digits(round(v, 12), 9) for v in numbers)))
    solution = blended.solution
    lines = [f"sequence {'-'.join(blended.curves)}", "", *columns(rows), ""]
    for label, speed in (("rise", solution.speed), ("return", solution.back_speed)):
        if speed:
            lines.append(f"peak velocity of the {label} {digits(speed, 9)} {unit}/deg")
    lines.append(f"peak acceleration {digits(solution.peak_acceleration, 9)} {unit}/deg^2")
    return "\n".join(lines) + "\n"


def into_design(design: SingleCam, blended: Blended) -> SingleCam:
    """The design with its motion replaced by dwell - blended curves - dwell. Raises DesignError where the blended
    motion does not come back to where it starts."""
    request = blended.request
    total = math.fsum(s.rise for s in blended.segments)
    if abs(total) > 1e-9:
        raise DesignError(
            [
                Fault(
                    "motion.segments",
                    f"rises add up to {total:.9g}",
                    "a rise or a return alone is no whole motion",
                    "DRRD | RRR",
                )
            ]
        )
    before, after = request.start, 360.0 - request.end
    segments = [
        *([Segment(before, 0.0)] if before > 0.0 else []),
        *blended.segments,
        *([Segment(after, 0.0)] if after > 0.0 else []),
    ]
    motion = Motion(_first_level(blended), tuple(segments), request.unit)
    assumed = tuple(p for p in design.assumed if not p.startswith("motion."))
    return replace(with_section(design, "motion", motion), assumed=assumed)
