"""Blended motions and motions from drawings as text, data and figures."""

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
from core.design.curves import segment_shape
from core.frozen import frozen
from core.laws import LAWS, PieceTable
from core.motion.extremes import true_stroke
from core.number_text import result_text
from core.output.lines import columns, digits
from core.plot import Figure, Plot, PlotCurve

# -- blended motion as text and data ----------------------------------------------------------------------------


@frozen
class BlendCurveRow:
    """One blended curve: its cam angle and span [deg], its level and rise [unit]."""

    curve: str
    angle: float
    span: float
    level: float
    rise: float


def curve_rows(blended: BlendResult) -> list[BlendCurveRow]:
    """Curves of a blended motion in order, which starts at level 0 or falls to it."""
    angle, level = blended.request.start, blended.first_level
    rows = []
    for segment in blended.segments:
        rows.append(BlendCurveRow(segment.curve.law.upper(), angle, segment.span_deg, level, segment.rise))
        angle, level = angle + segment.span_deg, level + segment.rise
    return rows


@frozen
class FlatRow:
    """A constant acceleration inside a curve: its cam angle and span [deg], its value [unit/deg²]."""

    curve: str
    angle: float
    span: float
    acceleration: float


def flat_rows(blended: BlendResult) -> list[FlatRow]:
    """Constant accelerations in order; each is in the middle of its curve."""
    rows = []
    for row, segment in zip(curve_rows(blended), blended.segments, strict=True):
        flat = segment.curve.flat_fraction if isinstance(segment.curve, NamedCurve) else 0.0
        if flat:
            size = peak_of(row.curve, flat) * abs(row.rise) / row.span**2
            sign = ELEMENTS[row.curve].end[0] - ELEMENTS[row.curve].start[0]
            rows.append(FlatRow(row.curve, row.angle + 0.5 * row.span * (1.0 - flat), flat * row.span, sign * size))
    return rows


def curves_data(blended: BlendResult) -> list[dict[str, Any]]:
    """Curves of a blended motion with their angles and levels, as data.

    The level is ``start_mm`` in mm, and ``level_deg`` in degrees, where ``start_deg`` is the cam angle. A constant acceleration
    inside a curve adds three entries.
    """
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
    """Sequence, spans and the table of starts and ends, as text."""
    unit = blended.request.unit
    rows: list[tuple[str, ...]] = [
        ("curve", f"height {unit}", "span deg", "cam from deg", "cam to deg", f"from {unit}", f"to {unit}")
    ]
    for r in curve_rows(blended):
        numbers = (abs(r.rise), r.span, r.angle, r.angle + r.span, r.level, r.level + r.rise)
        rows.append((r.curve, *(digits(round(v, 12), 9) for v in numbers)))
    solution = blended.solution
    lines = [f"sequence {'-'.join(blended.curves)}", "", *columns(rows), ""]
    lines.extend(
        f"peak velocity of the {label} {digits(speed, 9)} {unit}/deg"
        for label, speed in (("rise", solution.speed), ("return", solution.back_speed))
        if speed
    )
    for flat in flat_rows(blended):
        position = (
            f"over {digits(flat.span, 9)} deg, from {digits(flat.angle, 9)} to {digits(flat.angle + flat.span, 9)} deg"
        )
        lines.append(f"constant acceleration of {flat.curve} {digits(flat.acceleration, 9)} {unit}/deg^2 {position}")
    lines.append(f"peak acceleration {digits(solution.peak_acceleration, 9)} {unit}/deg^2")
    return "\n".join(lines) + "\n"


def changed_segment(before: Motion, after: Motion, blended: BlendResult) -> tuple[int, Segment] | None:
    """First segment outside of the blended curves that changes so that the follower returns to its start, and its number from 1.

    None where the other segments are unchanged.
    """
    unchanged = {(s.curve, s.rise) for s in before.segments}
    remaining = ((n, s) for n, s in enumerate(after.segments, 1) if s.rise and s not in blended.segments)
    return next(((n, s) for n, s in remaining if (s.curve, s.rise) not in unchanged), None)


def changed_segment_text(before: Design, after: Design, blended: BlendResult) -> str:
    """Line on a changed segment of the design outside of the blended curves; empty where none changes."""
    changed = changed_segment(require_motion(before), require_motion(after), blended)
    if changed is None:
        return ""
    n, segment = changed
    moves = f"{result_text(segment.rise, 9)} {blended.request.unit} over {result_text(segment.span_deg, 9)} deg"
    return f"in the design segment {n}, {segment.curve.law}, changes to close the turn: {moves}\n"


# -- possible sequences of curves -------------------------------------------------------------------------


def _ends(signs: tuple[int, int]) -> str:
    return ", ".join(SIGNS[sign] for sign in signs)


def table_data(curve: str = "", motion_type: str = "") -> dict[str, Any]:
    """Yang's Table 1 as data.

    With a curve: whether each other curve may follow it. With a type of motion: its sequences, and the signs of velocity and
    acceleration at their curves.
    """
    result: dict[str, Any] = {
        "curves": [
            {"curve": r.curve, "displacement": _ends(r.displacement), "velocity": _ends(r.velocity),
             "acceleration": _ends(r.acceleration), "usable_next": list(r.usable_next)}
            for r in TABLE
        ]
    }  # fmt: skip
    if curve:
        result["after"] = curve
        result["may_follow"] = {name: join_error(curve, name) or "yes" for name in ELEMENTS}
    if motion_type:
        result["sequences"] = {
            str(sequence): [state_text(s) for s in states(sequence)] for sequence in all_sequences(motion_type)
        }
    return result


def table_text(curve: str = "", motion_type: str = "") -> str:
    """Yang's Table 1 as text, with the same options as `table_data`."""
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
        lines += ["", f"positions of {motion_type}:"]
        for sequence in all_sequences(motion_type):
            first, *following = (f"({state_text(signs)})" for signs in states(sequence))
            lines.append(
                f"  {first} "
                + " ".join(f"{name} {state}" for name, state in zip(sequence.curves, following, strict=True))
            )
    return "\n".join(lines) + "\n"


@frozen
class SuccessionVerdict:
    """Whether a curve may follow another by the signs at their ends, whether also at this position of the motion, and why."""

    may_follow: bool
    is_possible: bool
    reason: str


def succession_verdict(curves: tuple[str, ...], name: str, motion_type: str) -> SuccessionVerdict:
    """Verdict on a curve after the first curves of a motion; without a type of motion, after this curve anywhere."""
    reason = join_error(curves[-1], name)
    if reason:
        return SuccessionVerdict(False, False, reason)
    if not motion_type or name in next_curves(motion_type, curves):
        return SuccessionVerdict(True, True, f"may follow {curves[-1]}")
    return SuccessionVerdict(True, False, f"may follow {curves[-1]}, but not at this position of {motion_type}")


# -- blended motion as a figure ---------------------------------------------------------------------------------


SAMPLES = 181
"""Number of cam angles of each curve, ends included."""
_QUANTITIES = (("Displacement", ""), ("Velocity", "/°"), ("Acceleration", "/°²"))


def blend_figure(blended: BlendResult, name: str = "blend") -> Figure:
    """Displacement, velocity and acceleration of a blended motion by degrees of cam angle, from the formula of each curve.

    Marks at the joins name the curve that begins.
    """
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
    """An elementary curve over 0 ... 1, with its displacement above its lowest level.

    Returns
    -------
    ndarray (4, n), dimensionless
        u, s, v, a.
    """
    u = np.linspace(0.0, 1.0, SAMPLES)
    s, v, a = ELEMENTS[curve].velocity_sign * LAWS[curve.lower()](u)[:3]
    return np.array([u, s - s.min(), v, a])


def type_shape(motion_type: str) -> np.ndarray:
    """A type of motion with the fewest curves and stroke 1, with its dwells.

    Returns
    -------
    ndarray (4, n) [deg], dimensionless
        Cam angle; displacement, velocity and acceleration per degree.
    """
    row = MOTION_TYPES[motion_type]
    has_dwells = (0, 0) in (row.rise or row.back or ())
    request = Request(motion_type, 1.0, *((60.0, 300.0) if has_dwells else (0.0, 360.0)))
    plots = blend_figure(blend(request)).plots
    shape = np.array([plots[0].curves[0].x, *(plot.curves[0].y for plot in plots)])
    if not has_dwells:  # two turns
        return np.hstack([shape, shape + np.array([[360.0], [0.0], [0.0], [0.0]])])
    (low, high), (start, end) = shape[0, [0, -1]], shape[1, [0, -1]]
    dwells = [
        np.array([angles, [level] * 2, [0.0] * 2, [0.0] * 2])
        for angles, level in (((0.0, low), start), ((high, 360.0), end))
    ]
    return np.hstack([dwells[0], shape, dwells[1]])


# -- motion from a drawing --------------------------------------------------------------------------------------


_NAMES = {1: "velocity", 2: "acceleration"}
_PER = {1: "/deg", 2: "/deg²"}


def jump_text(jump: Jump, unit: str) -> str:
    """A jump in words: ``acceleration jumps at 34.21 deg, from 0 to 0.0113 mm/deg²``."""
    before, after = (digits(value) for value in (jump.before, jump.after))
    return f"{_NAMES[jump.order]} jumps at {digits(jump.angle)} deg, from {before} to {after} {unit}{_PER[jump.order]}"


def traced_figures(traced: TracedMotion) -> list[tuple[str, str]]:
    """Figures of a motion from a drawing: name, value with unit."""
    motion, contour = require_motion(traced.design), traced.contour
    straight = sum(element.is_line for element in contour.elements)
    curve = f"{straight} lines, {len(contour.elements) - straight} arcs on layer {contour.layer}, in {contour.unit}"
    rows = [("curve", curve), ("base radius", f"{traced.base_radius_mm:.9g} mm")]
    rows.append(("stroke", f"{_stroke(traced):.9g} {motion.unit}"))
    if traced.fit is None:
        return [*rows, ("motion", f"{len(motion.segments)} segments, exact for lines and arcs")]
    fit = traced.fit
    points = f"fitted to {len(fit.residuals)} points: short lines with small corners count as points of a smooth curve"
    rows.append(("motion", points))
    rows.append(("measuring error", f"{digits(fit.error, 3)} {motion.unit}, from the points"))
    largest = abs(float(fit.residuals[fit.largest]))
    rows.append(
        (
            "largest residual",
            f"{digits(largest, 3)} {motion.unit} at {digits(float(fit.table.angles[fit.largest]))} deg",
        )
    )
    return [
        *rows,
        *([("omitted", f"{len(fit.left_out)} points that contradict their neighbours")] if fit.left_out else []),
    ]


def _stroke(traced: TracedMotion) -> float:
    """Highest less lowest position, in the motion's unit."""
    return true_stroke(require_motion(traced.design))


def contour_text(traced: TracedMotion) -> str:
    """Curve and motion from a drawing, in lines."""
    unit = require_motion(traced.design).unit
    lines = [f"{name}: {value}" for name, value in traced_figures(traced)]
    jumps = [jump_text(jump, unit) for jump in traced.jumps]
    return "\n".join([traced.contour.name, *lines, *(jumps or ["neither velocity nor acceleration jumps"])]) + "\n"


def contour_data(traced: TracedMotion) -> dict[str, Any]:
    """Curve and motion from a drawing, as data."""
    motion, contour = require_motion(traced.design), traced.contour
    return {
        "curve": {
            "file": contour.name,
            "layer": contour.layer,
            "unit": contour.unit,
            "lines": sum(element.is_line for element in contour.elements),
            "arcs": sum(not element.is_line for element in contour.elements),
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
