"""Yang and Shon, blended cam curves: their statements in the order of the paper."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from core.blend import MOTION_TYPES, BlendResult, Request, blend, sequences
from core.blend.solver import candidates
from core.design import require_motion
from core.laws import LAWS
from core.papers import yang_curves as curves
from core.papers import yang_curves as tables
from core.papers.claim import (
    CAM_ANGLE,
    CONTRADICTION,
    MISPRINT,
    Examples,
    FigureTable,
    Lines,
    PaperFigure,
    PlotLine,
    Row,
    by_angle,
    corrected_print,
    plot_figure,
    table_by_column,
    within_bound,
)
from core.papers.yang_curves import (
    DRD,
    MOTION_PARTS,
    PEAK,
    PICKER,
    PRINTED,
    PRINTED_CURVES,
    fitting,
    moving,
    picker,
    signs,
    states,
    usable_next,
)
from core.plot import Plot, PlotCurve

# -- tables and figures -----------------------------------------------------------------------------------------

PER_DEGREE = np.pi / 180.0
MM = 1e3
COLUMNS = ("displacement_mm", "velocity_mm_per_deg", "acceleration_mm_per_deg2")
PLOTS = (
    Lines("Displacement, mm", (PlotLine(COLUMNS[0], family="displacement"),), quiet=True),
    Lines("Velocity, mm/°", (PlotLine(COLUMNS[1], family="velocity"),), quiet=True),
    Lines("Acceleration, mm/°²", (PlotLine(COLUMNS[2], family="acceleration"),), quiet=True),
)


# -- tables ------------------------------------------------------------------------------------------------


def _ends(pair: str) -> str:
    return f"{pair[0]}, {pair[1]}"


def _elements(examples: Examples) -> FigureTable:
    names = tuple(PRINTED)
    rows = tuple(tuple(_ends(signs(name)[k]) for name in names) for k in range(3))
    columns = (names, *rows, tuple(usable_next(name).replace(" ", ", ") for name in names))
    return FigureTable(("curve", "s", "v", "a", "usable_next"), columns, "Signs at start and end, and what may follow")


def _places(examples: Examples) -> FigureTable:
    ends = tuple(f"{part[3]} → {part[4]}" for part in MOTION_PARTS)
    compatible = tuple(", ".join(curves) for curves in fitting())
    motion, where = tuple(part[0] for part in MOTION_PARTS), tuple(part[1] for part in MOTION_PARTS)
    return FigureTable(
        ("motion", "place", "ends", "fits", "printed"),
        (motion, where, ends, compatible, PRINTED_CURVES),
        "The curve of each place",
    )


# -- Fig. 1 ------------------------------------------------------------------------------------------------

SHOWN = {
    "DRD": ("rise", {"h1": 0.25, "h3": 0.25}),
    "DRRD": ("both", {"h1": 0.2, "h3": 0.2}),
    "RRR": ("both", {"h1": 0.25, "h3": 0.25}),
}
"""Motion -> part of constant velocity, and settings of its curves, over a stroke of 1."""


def _shown(kind: str) -> BlendResult:
    constant, settings = SHOWN[kind]
    span = 180.0 if MOTION_TYPES[kind].back is None else 360.0
    return blend(Request(kind, 1.0, 0.0, span, constant, settings))


def _sampled(result: BlendResult) -> tuple[np.ndarray, np.ndarray, list[tuple[float, str]]]:
    """Angle [deg] and displacement (n,), and the joins of curves with the signs of velocity and acceleration."""
    angles, levels, marks = [], [], []
    angle, level, u = 0.0, result.first_level, np.linspace(0.0, 1.0, 61)
    for name, segment in zip(result.curves, result.segments, strict=True):
        marks.append((angle, _state(states(name)[0])))
        angles.append(angle + u * segment.span_deg)
        levels.append(level + segment.rise * LAWS[name.lower()](u)[0])
        angle, level = angle + segment.span_deg, level + segment.rise
    marks.append((angle, _state(states(result.curves[-1])[1])))
    return np.concatenate(angles), np.concatenate(levels), marks


def _state(state: str) -> str:
    return f"v {state[0]}, a {state[1]}"


def _dynamic(examples: Examples) -> tuple[Plot, ...]:
    plots = []
    for kind in SHOWN:
        result = _shown(kind)
        x, y, marks = _sampled(result)
        title = f"{kind}: {'-'.join(result.curves)}"
        plots.append(Plot(CAM_ANGLE, "Displacement", (PlotCurve(x, y, title),), tuple(marks), quiet=True))
    return tuple(plots)


def _dynamic_table(examples: Examples) -> FigureTable:
    rows: list[tuple[str, str, str, str]] = []
    for kind in SHOWN:
        result = _shown(kind)
        for name in result.curves:
            start, end = states(name)
            rows.append((kind, name, _state(start), _state(end)))
    return FigureTable(
        ("motion", "curve", "start", "end"),
        tuple(zip(*rows, strict=True)),
        "Dynamic characteristics for the various motions",
    )


# -- Figs. 2 to 4 ------------------------------------------------------------------------------------------


def _motion(examples: Examples, name: str) -> dict[str, np.ndarray]:
    study = examples.study(name)
    y = study.motion.displacement
    return {"cam_angle_deg": study.angle_degrees} | {
        column: y[k] * MM * PER_DEGREE**k for k, column in enumerate(COLUMNS)
    }


def _curves(name: str) -> Callable[[Examples], tuple[Plot, ...]]:
    """Function that returns the plots of an example, with marks at the joins of its curves."""

    def plots(examples: Examples) -> tuple[Plot, ...]:
        marks, angle = [], 0.0
        for segment in require_motion(examples.design(name)).segments:
            if segment.rise:
                marks.append((angle, segment.curve.law.upper()))
            angle += segment.span_deg
        return by_angle(_motion(examples, name), PLOTS, marks=tuple(marks))

    return plots


def _steps(examples: Examples) -> FigureTable:
    """The algorithm of Fig. 3 applied to the card picker."""
    heights, spans = picker(examples)
    settings = {"h1": float(heights[0]), "h3": float(heights[2])}
    request = Request("DRRD", float(heights[:3].sum()), 30.0, 330.0, "rise", settings)
    admitted = sequences("DRRD", "rise")
    free = candidates(request)[0].freedom
    result = blend(request)
    ends = ", ".join(f"{curve} {span:.6f}°" for curve, span in zip(result.curves, result.solution.spans, strict=True))
    difference = float(np.abs(np.array(result.solution.spans) - spans).max())
    rows = (
        ("1", "type of motion", "DRRD"),
        ("2", "constant velocity requested", "in the rise"),
        ("3", "sequences that the tables admit", ", ".join(str(admitted_sequence) for admitted_sequence in admitted)),
        ("4", "fewest curves", f"{len(admitted[0].curves)}: {admitted[0]}"),
        ("5", "stroke and angles", f"{request.stroke:g} mm, {request.start:g}° to {request.end:g}°"),
        ("6", "values still free", str(free)),
        ("7", "constraints given", f"h1 = {heights[0]:g} mm, h3 = {heights[2]:g} mm"),
        ("8", "equations solved", ends),
        ("9", "difference from the example", f"at most {difference:.1e}°"),
    )
    title = "Algorithm for the curve blending, applied to the card picker"
    return FigureTable(("step", "what", "card_picker"), tuple(zip(*rows, strict=True)), title)


def _picker_table(examples: Examples) -> FigureTable:
    """Table of Fig. 4."""
    angle, level, rows = 30.0, 0.0, []
    for segment in moving(examples.design(PICKER)):
        ends = angle + segment.span_deg, level + segment.rise
        rows.append((segment.curve.law.upper(), abs(segment.rise), segment.span_deg, angle, level, *ends))
        angle, level = ends
    names, *columns = zip(*rows, strict=True)
    heads = ("curve", "height_mm", "span_deg", "from_deg", "from_mm", "to_deg", "to_mm")
    return FigureTable(heads, (names, *(np.array(column) for column in columns)), "Curve blending of the card picker")


TABLE_1 = PaperFigure("table_1", "Yang Table 1: characteristics of the elementary curves", _elements)
TABLE_2 = PaperFigure("table_2", "Yang Table 2: selection of the elementary curve", _places)
FIG_1 = plot_figure(
    "figure_1", "Yang Fig. 1: dynamic characteristics for the various motions", _dynamic_table, _dynamic
)
FIG_2 = plot_figure(
    "figure_2", "Yang Fig. 2: C1-CV1-C2 in DRD motion", lambda e: table_by_column(_motion(e, DRD)), _curves(DRD)
)
FIG_3 = PaperFigure("figure_3", "Yang Fig. 3: algorithm for the curve blending", _steps)
FIG_4 = plot_figure("figure_4", "Yang Fig. 4: curve blending of the card picker", _picker_table, _curves(PICKER))


# -- rows of claims ---------------------------------------------------------------------------------------------

_BOTH = within_bound("{left:.10g} and {right:.10g}")

ROWS = (
    Row("§1, 1-4", "heights add up to the stroke, spans to the angle, velocity and acceleration meet at every join", curves.conditions,
        within_bound("the card picker leaves {off:.1g} of either; jumps of velocity {velocity_jump:.1g}, of acceleration "
            "{acceleration_jump:.1g}"), PICKER),
    Row("§1", "where the size and the span of a constant acceleration are limited, curves are blended; the common example is the modified "
        "trapezoid", curves.constant_acceleration,
        within_bound("C1-C2 with {span:.6g}° at {constant:.6g} mm/°² each is the modified trapezoid but for {off:.1g}"), DRD),
    Row("Table 1", "signs of v and a at the ends of 16 curves, and what is usable next", tables.table_1, tables.as_table_1, PICKER,
        TABLE_1),
    Row("Table 1, CV2", "S of CV2 is 0, -", tables.returning, corrected_print(MISPRINT,
        "it falls as C3, C4, C6 do, which are printed +, 0: {printed:.0f} signs are not those of its formula, with +, 0 {corrected:.0f}"),
        PICKER, TABLE_1),
    Row("Fig. 1", "PQ, the first part of DRD: s, v and a are 0, then s and v above 0: only C1", tables.first_curve, tables.only_c1, DRD,
        FIG_1),
    Row("Table 2", "at each place of DRD, DRRD and RRR there is only one curve", tables.table_2, tables.as_table_2, PICKER, TABLE_2),
    Row("Fig. 2", "C1, CV1 and C2 join smoothly in velocity and acceleration", curves.smooth, within_bound(
        "the largest jump at a join of the rise is {off:.1g} of the largest value; peaks {velocity:.4g} mm/° and {acceleration:.4g} mm/°²"),
        DRD, FIG_2),
    Row("(1)", "2h1/β1 = h2/β2", curves.join(0, 1), _BOTH, DRD, FIG_2),
    Row("(2)", "2h3/β3 = h2/β2", curves.join(2, 1), _BOTH, DRD, FIG_2),
    Row("(3)", "β1 + β2 + β3 = β", curves.total(1), _BOTH, DRD, FIG_2),
    Row("(4)", "h1 + h2 + h3 = h", curves.total(0), _BOTH, DRD, FIG_2),
    Row("§3.1", "four equations, six unknowns: two values determine C1-CV1-C2", curves.freedom, curves.two_free, DRD, FIG_2),
    Row("(5)", "h2/β2 = Cv", curves.constant_velocity, _BOTH, DRD, FIG_2),
    Row("§3.1, Cv", "with Cv given one of h1, h2, h3 determines C1-CV1-C2", curves.determining, curves.any_height, DRD, FIG_2),
    Row("(6)", "(2h1/h2 + 1 + 2h3/h2) β2 = β", curves.spans, _BOTH, DRD, FIG_2),
    Row("(7)", "β2 = 2h/Cv - β", curves.middle_span, _BOTH, DRD, FIG_2),
    Row("(8)", "h/β ≤ Cv ≤ 2h/β", curves.speed_range, curves.as_range, DRD),
    Row("Fig. 3", "DRRD with a constant velocity needs at least 4 curves", curves.least_curves, curves.four_curves, PICKER, FIG_3),
    Row("Fig. 4", "18.846 / 169.613 / 14.801 / 96.740°", curves.card_picker, curves.spans_words, PICKER, FIG_4),
    Row("Fig. 4, table", "where each curve starts and ends", curves.picker_table, curves.as_tabled, PICKER, FIG_4),
    Row("§3.2, 3)", "rise from 30° to 250°; Fig. 4 has its top at 233.26°", curves.top, corrected_print(CONTRADICTION,
        "both cannot be: with Fig. 4's h1 = h3 = 1 mm the top is at {here:.4f}°, {printed:.2f}° before that of the text; "
        "with the peak at 250° h3 is {h3:.4f} mm and the spans are {spans}°, top {peak:.6g}°"), PEAK, FIG_4),
    Row("§3.2, 4)", "constant velocity over at least 150°", curves.constant_length, curves.long_enough, PICKER, FIG_4),
    Row("Concl.", "design, machining and verification of the cam", curves.conclusion, curves.judge_conclusion, PICKER),
)  # fmt: skip
"""Every row of the paper."""
