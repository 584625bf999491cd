"""A blended motion as a figure: displacement, velocity and acceleration by cam angle, below each other on one axis."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.blend import (
    ELEMENTS,
    MOTION_TYPES,
    SIGNS,
    TABLE,
    BlendResult,
    Request,
    all_sequences,
    blend,
    join_error,
    next_curves,
    peak_of,
    state_text,
    state_words,
    states,
)
from core.contour import Jump, TracedMotion
from core.design import UNITS, Design, Motion, NamedCurve, Segment, require_motion
from core.frozen import frozen
from core.laws import LAWS, PieceTable
from core.motion.curves import segment_shape
from core.motion.extremes import true_stroke
from core.output.lines import columns, digits
from core.plot import Figure, Plot, PlotCurve

# -- A blended motion as text and data --------------------------------------------------------------------------


@frozen
class BlendCurveRow:
    """One blended curve: from which cam angle over how many degrees, from which level how much higher."""

    curve: str
    angle: float
    span: float
    level: float
    rise: float


def curve_rows(blended: BlendResult) -> list[BlendCurveRow]:
    """The curves in order; the motion starts at level 0, or falls to it."""
    angle, level = blended.request.start, blended.first_level
    rows = []
    for segment in blended.segments:
        rows.append(BlendCurveRow(segment.curve.law.upper(), angle, segment.span_deg, level, segment.rise))
        angle, level = angle + segment.span_deg, level + segment.rise
    return rows


@frozen
class FlatRow:
    """A constant acceleration inside a curve: from which cam angle over how many degrees, and its size [per deg²]."""

    curve: str
    angle: float
    span: float
    acceleration: float


def flat_rows(blended: BlendResult) -> list[FlatRow]:
    """Of the curves that have one, in order; it lies in the middle of its curve."""
    made = []
    for row, segment in zip(curve_rows(blended), blended.segments, strict=True):
        flat = segment.curve.flat_fraction if isinstance(segment.curve, NamedCurve) else 0.0
        if flat:
            size = peak_of(row.curve, flat) * abs(row.rise) / row.span**2
            sign = ELEMENTS[row.curve].end[0] - ELEMENTS[row.curve].start[0]
            made.append(FlatRow(row.curve, row.angle + 0.5 * row.span * (1.0 - flat), flat * row.span, sign * size))
    return made


def curves_data(blended: BlendResult) -> list[dict[str, Any]]:
    """The curves in order, with their angles and levels. A motion in degrees has a ``level_deg`` where one in mm has a
    ``start_mm``: its ``start_deg`` is the cam angle. A constant acceleration inside a curve has three entries more."""
    unit = blended.request.unit
    level = {"mm": "start_mm", "deg": "level_deg"}[unit]
    flats = {
        r.curve: {"flat_start_deg": r.angle, "flat_deg": r.span, f"flat_{unit}_per_deg2": r.acceleration}
        for r in flat_rows(blended)
    }
    return [
        {
            "curve": r.curve,
            "start_deg": r.angle,
            "span_deg": r.span,
            level: r.level,
            f"rise_{unit}": r.rise,
            **flats.get(r.curve, {}),
        }
        for r in curve_rows(blended)
    ]


def blend_text(blended: BlendResult) -> str:
    """Sequence, spans and the table of starts and ends."""
    unit = blended.request.unit
    rows: list[tuple[str, ...]] = [
        ("curve", f"height {unit}", "span deg", "cam from deg", "cam to deg", f"from {unit}", f"to {unit}")
    ]
    for r in curve_rows(blended):
        numbers = (abs(r.rise), r.span, r.angle, r.angle + r.span, r.level, r.level + r.rise)
        rows.append((r.curve, *(digits(round(v, 12), 9) for v in numbers)))
    solution = blended.solution
    lines = [f"sequence {'-'.join(blended.curves)}", "", *columns(rows), ""]
    for label, speed in (("rise", solution.speed), ("return", solution.back_speed)):
        if speed:
            lines.append(f"peak velocity of the {label} {digits(speed, 9)} {unit}/deg")
    for flat in flat_rows(blended):
        place = (
            f"over {digits(flat.span, 9)} deg, from {digits(flat.angle, 9)} to {digits(flat.angle + flat.span, 9)} deg"
        )
        lines.append(f"constant acceleration of {flat.curve} {digits(flat.acceleration, 9)} {unit}/deg^2 {place}")
    lines.append(f"peak acceleration {digits(solution.peak_acceleration, 9)} {unit}/deg^2")
    return "\n".join(lines) + "\n"


def changed_beside(before: Motion, after: Motion, blended: BlendResult) -> tuple[int, Segment] | None:
    """What moves otherwise beside the blended curves, so that the follower comes back to where it starts: the first such
    segment and its number, counted from 1; None where the rest stays as it was."""
    was = {(s.curve, s.rise) for s in before.segments}
    others = ((n, s) for n, s in enumerate(after.segments, 1) if s.rise and s not in blended.segments)
    return next(((n, s) for n, s in others if (s.curve, s.rise) not in was), None)


def beside_text(before: Design, after: Design, blended: BlendResult) -> str:
    """The same in a line, for a design into which the curves came; nothing where the rest stays."""
    changed = changed_beside(require_motion(before), require_motion(after), blended)
    if changed is None:
        return ""
    n, segment = changed
    moves = f"{digits(segment.rise, 9)} {blended.request.unit} over {digits(segment.span_deg, 9)} deg"
    return f"in the design segment {n}, {segment.curve.law}, moves otherwise, to come back: {moves}\n"


# -- which curve may follow which -------------------------------------------------------------------------


def _ends(signs: tuple[int, int]) -> str:
    return ", ".join(SIGNS[sign] for sign in signs)


def table_data(curve: str = "", motion_type: str = "") -> dict[str, Any]:
    """Yang's Table 1; with a curve whether each other may follow it; with a type of motion its sequences and the signs of
    velocity and acceleration at each place of them."""
    made: dict[str, Any] = {
        "curves": [
            {"curve": r.curve, "displacement": _ends(r.displacement), "velocity": _ends(r.velocity),
             "acceleration": _ends(r.acceleration), "usable_next": list(r.usable_next)}
            for r in TABLE
        ]
    }  # fmt: skip
    if curve:
        made["after"] = curve
        made["may_follow"] = {name: join_error(curve, name) or "yes" for name in ELEMENTS}
    if motion_type:
        made["sequences"] = {str(each): [state_text(s) for s in states(each)] for each in all_sequences(motion_type)}
    return made


def table_text(curve: str = "", motion_type: str = "") -> str:
    """The same as text."""
    rows = [("curve", "s", "v", "a", "usable next")]
    rows += [
        (r.curve, _ends(r.displacement), _ends(r.velocity), _ends(r.acceleration), ", ".join(r.usable_next))
        for r in TABLE
    ]
    lines = columns(rows, left=5)
    if curve:
        end = ELEMENTS[curve].end
        lines += ["", f"after {curve}, which ends {state_words(end)} ({state_text(end)}):"]
        lines += columns([(f"  {name}", join_error(curve, name) or "may follow") for name in ELEMENTS], left=2)
    if motion_type:
        lines += ["", f"places of {motion_type}:"]
        for each in all_sequences(motion_type):
            first, *others = (f"({state_text(state)})" for state in states(each))
            lines.append(
                f"  {first} " + " ".join(f"{name} {there}" for name, there in zip(each.curves, others, strict=True))
            )
    return "\n".join(lines) + "\n"


@frozen
class SuccessionVerdict:
    """Whether a curve may follow another by the signs at their ends; whether it does so at this place of the motion; in words."""

    may_follow: bool
    here: bool
    words: str


def verdict_after(curves: tuple[str, ...], name: str, motion_type: str) -> SuccessionVerdict:
    """Of a curve after the last of these, with which the motion begins; without a type of motion after this one curve anywhere."""
    reason = join_error(curves[-1], name)
    if reason:
        return SuccessionVerdict(False, False, reason)
    if not motion_type or name in next_curves(motion_type, curves):
        return SuccessionVerdict(True, True, f"may follow {curves[-1]}")
    return SuccessionVerdict(True, False, f"may follow {curves[-1]}, but not at this place of {motion_type}")


# -- A blended motion as a figure -------------------------------------------------------------------------------


SAMPLES = 181
"""Cam angles of each curve, its ends among them."""
_QUANTITIES = (("Displacement", ""), ("Velocity", "/°"), ("Acceleration", "/°²"))


def blend_figure(blended: BlendResult, name: str = "blend") -> Figure:
    """Every curve from its own formula, velocity and acceleration by degrees of cam angle; where curves meet stands the name
    of the one that begins."""
    u = np.linspace(0.0, 1.0, SAMPLES)
    angles, values, marks = [], [], []
    for row, segment in zip(curve_rows(blended), blended.segments, strict=True):
        shape = segment_shape(segment, False, "motion.segments")
        y = shape.gain * PieceTable(shape.pieces).at(u).all[:3] / segment.span_deg ** np.arange(3)[:, None]
        y[0] += row.level
        angles.append(row.angle + segment.span_deg * u)
        values.append(y)
        marks.append((row.angle, row.curve))
    x, y = np.concatenate(angles), np.concatenate(values, axis=1)
    symbol = UNITS[blended.request.unit].symbol
    plots = tuple(
        Plot(
            "Cam angle, °",
            f"{title}, {symbol}{per}",
            (PlotCurve(x, y[k], family=title.lower()),),
            () if k else tuple(marks),
            quiet=True,
        )
        for k, (title, per) in enumerate(_QUANTITIES)
    )
    return Figure(name, ", ".join(filter(None, ("-".join(blended.curves), blended.request.type))), plots)


def curve_shape(curve: str) -> np.ndarray:
    """An elementary curve alone over 0 ... 1, its displacement above its lowest level: u, s, v, a (4, n)."""
    u = np.linspace(0.0, 1.0, SAMPLES)
    s, v, a = ELEMENTS[curve].velocity_sign * LAWS[curve.lower()](u)[:3]
    return np.array([u, s - s.min(), v, a])


def type_shape(motion_type: str) -> np.ndarray:
    """A type of motion of fewest curves, stroke 1, with the dwells it has: cam angle [deg], s, v, a (4, n)."""
    row = MOTION_TYPES[motion_type]
    rests = (0, 0) in (row.rise or row.back or ())
    request = Request(motion_type, 1.0, *((60.0, 300.0) if rests else (0.0, 360.0)))
    plots = blend_figure(blend(request)).plots
    made = np.array([plots[0].curves[0].x, *(plot.curves[0].y for plot in plots)])
    if not rests:  # one turn after another
        return np.hstack([made, made + np.array([[360.0], [0.0], [0.0], [0.0]])])
    (low, high), (start, end) = made[0, [0, -1]], made[1, [0, -1]]
    still = [
        np.array([angles, [level] * 2, [0.0] * 2, [0.0] * 2])
        for angles, level in (((0.0, low), start), ((high, 360.0), end))
    ]
    return np.hstack([still[0], made, still[1]])


# -- A motion that was rolled off a drawing, as text and as data ------------------------------------------------


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
