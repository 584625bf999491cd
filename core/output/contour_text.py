"""A motion that was rolled off a drawing, as text and as data."""

from __future__ import annotations

from typing import Any

from core.contour import Jump, TracedMotion
from core.design import require_motion
from core.motion.extremes import true_stroke
from core.output.lines import digits

_NAMES = {1: "velocity", 2: "acceleration"}
_PER = {1: "/deg", 2: "/deg²"}


def jump_text(jump: Jump, unit: str) -> str:
    """``acceleration jumps at 34.21 deg, from 0 to 0.0113 mm/deg²``."""
    before, after = (digits(value) for value in (jump.before, jump.after))
    return f"{_NAMES[jump.order]} jumps at {digits(jump.angle)} deg, from {before} to {after} {unit}{_PER[jump.order]}"


def figures(traced: TracedMotion) -> list[tuple[str, str]]:
    """The figures of the result: name, value with unit."""
    motion, contour = require_motion(traced.design), traced.contour
    straight = sum(each.is_line for each in contour.elements)
    curve = f"{straight} lines, {len(contour.elements) - straight} arcs on layer {contour.layer}, in {contour.unit}"
    rows = [("curve", curve), ("base radius", f"{traced.base_radius_mm:.9g} mm")]
    rows.append(("stroke", f"{_stroke(traced):.9g} {motion.unit}"))
    if traced.fit is None:
        return [*rows, ("motion", f"{len(motion.segments)} segments, exact for lines and arcs")]
    fit = traced.fit
    points = f"fitted to {len(fit.residuals)} points: lines so short, with corners so small, count as points of a smooth curve"
    rows.append(("motion", points))
    rows.append(("measuring error", f"{digits(fit.error, 3)} {motion.unit}, as the points tell"))
    largest = abs(float(fit.residuals[fit.largest]))
    rows.append(
        (
            "largest residual",
            f"{digits(largest, 3)} {motion.unit} at {digits(float(fit.table.angles[fit.largest]))} deg",
        )
    )
    return [
        *rows,
        *([("left out", f"{len(fit.left_out)} points that contradict those beside them")] if fit.left_out else []),
    ]


def _stroke(traced: TracedMotion) -> float:
    """Highest minus lowest position, in the motion's unit."""
    return true_stroke(require_motion(traced.design))


def contour_text(traced: TracedMotion) -> str:
    """What was read and what came of it, in lines."""
    unit = require_motion(traced.design).unit
    lines = [f"{name}: {value}" for name, value in figures(traced)]
    jumps = [jump_text(jump, unit) for jump in traced.jumps]
    return "\n".join([traced.contour.name, *lines, *(jumps or ["neither velocity nor acceleration jumps"])]) + "\n"


def contour_data(traced: TracedMotion) -> dict[str, Any]:
    """The same as data."""
    motion, contour = require_motion(traced.design), traced.contour
    return {
        "curve": {
            "file": contour.name,
            "layer": contour.layer,
            "unit": contour.unit,
            "lines": sum(each.is_line for each in contour.elements),
            "arcs": sum(not each.is_line for each in contour.elements),
        },
        "base_radius_mm": traced.base_radius_mm,
        f"stroke_{motion.unit}": _stroke(traced),
        f"start_{motion.unit}": motion.start,
        "segments": len(motion.segments),
        "exact": traced.fit is None,
        "fit": None
        if traced.fit is None
        else {
            "points": len(traced.fit.residuals),
            "error": traced.fit.error,
            "rms_residual": traced.fit.rms,
            "largest_residual": abs(float(traced.fit.residuals[traced.fit.largest])),
            "left_out": len(traced.fit.left_out),
        },
        "jumps": [
            {"quantity": _NAMES[jump.order], "cam_angle_deg": jump.angle, "before": jump.before, "after": jump.after}
            for jump in traced.jumps
        ],
    }


__all__ = ["contour_data", "contour_text", "figures", "jump_text"]
