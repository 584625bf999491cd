"""Numbers of Yang's equations (1)-(8), of the card picker of Fig. 4 and of the tables of elementary curves."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import inf, isfinite
from typing import Any

import numpy as np

from core.blend import ELEMENTS, MOTION_TYPES, BlendError, Request, blend, feasible_ranges, sequences
from core.blend.solver import candidates
from core.design import Design, Motion, NamedCurve, Segment, require_motion
from core.laws import LAWS
from core.motion import program
from core.papers.claim import METHOD, ROUNDED, ComparedNumber, Examples, correction_verdict
from core.study import certificate_of, extremes_of, findings_of

# -- equations (1)-(8) ------------------------------------------------------------------------------------------

DRD, PICKER, PEAK = "dwell_rise_dwell", "card_picker", "card_picker_peak_250"
PRINTED_SPANS = (18.846, 169.613, 14.801, 96.740)
PRINTED_TABLE = (
    ("C1", 30.0, 0.0, 48.85, 1.0), ("CV1", 48.85, 1.0, 218.46, 19.0), ("H2", 218.46, 19.0, 233.26, 20.0), ("P2", 233.26, 20.0, 330.0, 0.0),
)  # fmt: skip
LEAST_CONSTANT = 150.0
PRINTED_PEAK = 250.0
SMALL = 1e-9

Numbers = Mapping[str, Any]


def moving(design: Design) -> list[Any]:
    """Segments that move: curve, span [deg], signed rise."""
    return [segment for segment in require_motion(design).segments if segment.rise]


def rise(examples: Examples) -> tuple[np.ndarray, np.ndarray]:
    """Heights and spans of the rise of the example of Fig. 2.

    Returns
    -------
    heights : ndarray (3,) [mm]
        h1, h2, h3.
    spans : ndarray (3,) [deg]
        β1, β2, β3.
    """
    segments = [s for s in moving(examples.design(DRD)) if s.rise > 0.0]
    return np.array([s.rise for s in segments]), np.array([s.span_deg for s in segments])


def _sides(left: float, right: float, **more: float) -> Numbers:
    return {"off": abs(left - right) / max(abs(right), 1e-300), "bound": SMALL, "left": left, "right": right, **more}


def smooth(examples: Examples) -> Numbers:
    """Largest relative jump of velocity and acceleration at a join, and both peaks [mm, deg] (Fig. 2)."""
    study = examples.study(DRD)
    sizes = [float(np.abs(study.motion.displacement[k]).max()) for k in (1, 2)]
    jumps = [max(abs(float(join.jump[k])) for join in study.program.joins) for k in (1, 2)]
    per_degree = np.pi / 180.0
    y = study.at_theta(np.deg2rad(np.linspace(0.0, 180.0, 721))).motion.displacement
    return {
        "off": max(jump / size for jump, size in zip(jumps, sizes, strict=True)),
        "bound": SMALL,
        "velocity": float(y[1].max()) * 1e3 * per_degree,
        "acceleration": float(np.abs(y[2]).max()) * 1e3 * per_degree**2,
    }


def join(first: int, second: int) -> Callable[[Examples], Numbers]:
    """Function that compares 2h/β of a curve C with h/β of the constant velocity.

    References
    ----------
    Yang and Shon, eqs. (1), (2).
    """

    def numbers(examples: Examples) -> Numbers:
        h, b = rise(examples)
        return _sides(2.0 * h[first] / b[first], h[second] / b[second])

    return numbers


def total(which: int) -> Callable[[Examples], Numbers]:
    """Function that compares the sum of the spans (1) or of the heights (0) with that of the complete rise.

    References
    ----------
    Yang and Shon, eqs. (3), (4).
    """

    def numbers(examples: Examples) -> Numbers:
        study = examples.study(DRD)
        parts = rise(examples)[which]
        joins = study.program.joins
        begins = [j.theta for j in joins]
        segments = require_motion(study.design).segments
        first = next(i for i, s in enumerate(segments) if s.rise > 0.0)
        ends = np.rad2deg(np.array([begins[first - 1], begins[first - 1 + parts.size]]))
        heights = study.at_theta(np.deg2rad(ends)).motion.displacement[0] * 1e3
        expected = float(np.ptp(ends if which else heights))
        return _sides(float(parts.sum()), expected)

    return numbers


def constant_velocity(examples: Examples) -> Numbers:
    """h2/β2 compared with the velocity in the middle of this curve.

    References
    ----------
    Yang and Shon, eq. (5).
    """
    h, b = rise(examples)
    study = examples.study(DRD)
    segments = require_motion(study.design).segments
    before = sum(s.span_deg for s in segments[: [s.curve.law for s in segments].index("cv1")])
    velocity = study.at_theta(np.deg2rad([before + 0.5 * b[1]])).motion.displacement[1]
    return _sides(float(h[1] / b[1]), float(velocity[0]) * 1e3 * np.pi / 180.0)


def spans(examples: Examples) -> Numbers:
    """(2h1/h2 + 1 + 2h3/h2) β2 compared with β.

    References
    ----------
    Yang and Shon, eq. (6).
    """
    h, b = rise(examples)
    return _sides(float((2.0 * h[0] / h[1] + 1.0 + 2.0 * h[2] / h[1]) * b[1]), float(b.sum()))


def middle_span(examples: Examples) -> Numbers:
    """2h/Cv - β compared with β2.

    References
    ----------
    Yang and Shon, eq. (7).
    """
    h, b = rise(examples)
    return _sides(float(2.0 * h.sum() / (h[1] / b[1]) - b.sum()), float(b[1]))


def speed_range(examples: Examples) -> Numbers:
    """Range of the constant velocity [mm/°], and the largest acceleration [mm/°²] a thousandth above its lower end.

    References
    ----------
    Yang and Shon, eq. (8).
    """
    h, b = rise(examples)
    request = Request("DRD", float(h.sum()), 0.0, float(b.sum()), "rise", {})
    (feasible,) = feasible_ranges(request, "vcv")
    near = feasible.low * 1.001
    low = blend(replace(request, settings={"vcv": near, "h1": 0.5 * (near * float(b.sum()) - float(h.sum()))}))
    return {
        "low": ComparedNumber(float(h.sum() / b.sum()), feasible.low, 1e-12, "mm/°"),
        "high": ComparedNumber(2.0 * float(h.sum() / b.sum()), feasible.high, 1e-12, "mm/°"),
        "low_open": feasible.low_open,
        "high_open": feasible.high_open,
        "acceleration": low.solution.peak_acceleration,
    }


def as_range(
    low: ComparedNumber, high: ComparedNumber, low_open: bool, high_open: bool, acceleration: float
) -> tuple[str, str]:
    """Judge (8): whether h/β ≤ Cv ≤ 2h/β, with both ends."""
    words = f"{low.here:.6g} {'<' if low_open else '≤'} Cv {'<' if high_open else '≤'} {high.here:.6g} mm/°"
    if low_open:
        words += f": at the lower end h1 = h3 = 0 and the acceleration has no limit (a thousandth above it {acceleration:.4g} mm/°²)"
    agrees = low.is_equal and high.is_equal and not low_open and not high_open
    return ("agrees" if agrees else "differs"), words


def freedom(examples: Examples) -> Numbers:
    """Number of values that determine C1-CV1-C2 (§3.1)."""
    h, b = rise(examples)
    names = "-".join(s.curve.law.upper() for s in moving(examples.design(DRD)) if s.rise > 0.0)
    rows = candidates(Request("DRD", float(h.sum()), 0.0, float(b.sum()), "rise", {}, sequence=names))
    return {"names": names, "free": tuple(row.freedom for row in rows)}


def two_free(names: str, free: tuple[int, ...]) -> tuple[str, str]:
    """Judge §3.1: whether two values determine the sequence."""
    count = ", ".join(map(str, free)) or "no"
    return ("agrees" if free == (2,) else "differs"), f"{names}: 4 equations, 6 unknowns; {count} values determine it"


def determining(examples: Examples) -> Numbers:
    """Heights that determine C1-CV1-C2 with a given constant velocity (§3.1), and h2 by (7) [mm]."""
    h, b = rise(examples)
    speed = float(h[1] / b[1])
    names = []
    for name, height in zip(("h1", "h2", "h3"), h.tolist(), strict=True):
        try:
            blend(Request("DRD", float(h.sum()), 0.0, float(b.sum()), "rise", {"vcv": speed, name: height}))
        except BlendError:
            continue
        names.append(name)
    return {"determining": tuple(names), "speed": speed, "middle": 2.0 * float(h.sum()) - speed * float(b.sum())}


def any_height(determining: tuple[str, ...], speed: float, middle: float) -> tuple[str, str]:
    """Judge §3.1: whether each of the three heights determines the sequence."""
    others = [name for name in ("h1", "h2", "h3") if name not in determining]
    words = f"{' or '.join(determining) or 'none of them'} does; by (7) Cv = {speed:g} mm/° gives h2 = 2h - Cv β = {middle:g} mm already"
    return correction_verdict(METHOD, bool(others), others != ["h2"]), words


def conditions(examples: Examples) -> Numbers:
    """Residuals of sums and joins of the card picker, each relative to its size (§1, 1-4)."""
    study = examples.study(PICKER)
    segments = require_motion(study.design).segments
    heights = [s.rise for s in segments]
    displacement = extremes_of(study, "motion", ("displacement",))["displacement"]
    stroke = (displacement.high.value - displacement.low.value) * 1e3
    risen, total_span = sum(h for h in heights if h > 0.0), sum(s.span_deg for s in segments)
    residuals = [abs(sum(heights)) / stroke, abs(risen - stroke) / stroke, abs(total_span - 360.0) / 360.0]
    for k in (1, 2):
        size = float(np.abs(study.motion.displacement[k]).max())
        residuals.append(max(abs(float(join.jump[k])) for join in study.program.joins) / size)
    return {"off": max(residuals), "bound": SMALL, "velocity_jump": residuals[3], "acceleration_jump": residuals[4]}


def constant_acceleration(examples: Examples) -> Numbers:
    """Rise with a constant acceleration between two half cycloids compared with the modified trapezoid (§1).

    The constant acceleration has the size and the span of the modified trapezoid, 8π/(2 + π) h/β² over a quarter of the
    rise;
    `off` is the largest difference of s, v and a, each relative to its size.
    """
    h, b = rise(examples)
    stroke, total_span = float(h.sum()), float(b.sum())
    size, span = 8.0 * np.pi / (2.0 + np.pi) * stroke / total_span**2, 0.25 * total_span
    result = blend(Request("DRD", stroke, 0.0, total_span, "none", {"flat1": span, "a1": size, "flat3": span}))
    angles = np.linspace(0.0, total_span, 721)
    back = Segment(360.0 - total_span, -stroke, NamedCurve("cycloidal"))
    compiled = program(Motion(0.0, (*result.segments, back)))
    state = compiled.state(compiled.angles(np.deg2rad(angles))).displacement
    blended = (state[k] * 1e3 * (np.pi / 180.0) ** k for k in range(3))
    law = LAWS["modified-trapezoid"](angles / total_span)[:3] * stroke / total_span ** np.arange(3)[:, None]
    off = max(float(np.abs(row - true).max() / np.abs(true).max()) for row, true in zip(blended, law, strict=True))
    return {"off": off, "bound": SMALL, "constant": size, "span": span}


# -- Fig. 4 ------------------------------------------------------------------------------------------------


def picker(examples: Examples) -> tuple[np.ndarray, np.ndarray]:
    """Heights and spans of the card picker's curves.

    Returns
    -------
    heights : ndarray (n,) [mm]
    spans : ndarray (n,) [deg]
    """
    segments = moving(examples.design(PICKER))
    return np.array([abs(s.rise) for s in segments]), np.array([s.span_deg for s in segments])


P_END = abs(float(LAWS["p1"](np.ones(1))[2, 0]))
"""Acceleration at the end of P1 and the start of P2, 216/41 h/β²."""
P_CARRIED = round(P_END, 2)


def closed_spans(heights: np.ndarray, total: float, end: float) -> np.ndarray:
    """Spans of C1-CV1-H2-P2 from velocities and accelerations that are continuous.

    They are proportional to 2h1, h2, (π/2)h3 and √(c h4 h3), c the acceleration at the start of P2.

    Parameters
    ----------
    heights : ndarray (4,) [mm]
    total : float
        Sum of the spans [deg].
    end : float
        Acceleration c in h/β².

    Returns
    -------
    ndarray (4,) [deg]
    """
    h1, h2, h3, h4 = heights
    lengths = np.array([2.0 * h1, h2, 0.5 * np.pi * h3, np.sqrt(end * h4 * h3)])
    return np.asarray(lengths * total / lengths.sum())


def card_picker(examples: Examples) -> Numbers:
    """Spans of Fig. 4: of the example, their error to the closed form [deg], and by P2's rounded acceleration."""
    heights, spans = picker(examples)
    is_complete = spans.size == len(PRINTED_SPANS)
    total_span = float(spans.sum())
    exact, carried = (
        closed_spans(heights, total_span, end) if is_complete else np.zeros(0) for end in (P_END, P_CARRIED)
    )
    return {
        "off": float(np.abs(spans - exact).max()) if is_complete else inf,
        "bound": SMALL,
        "spans": tuple(spans.tolist()),
        "carried": tuple(carried.tolist()),
        "end": P_END,
        "end_carried": P_CARRIED,
    }


HALF_DIGIT = 0.5e-3  # of the printed spans


def spans_words(
    off: float, bound: float, spans: tuple[float, ...], carried: tuple[float, ...], end: float, end_carried: float
) -> tuple[str, str]:
    """Judge Fig. 4: rounded where the example's spans are exact and the rounded acceleration gives the printed ones."""

    def is_printed(values: tuple[float, ...]) -> bool:
        is_complete = len(values) == len(PRINTED_SPANS)
        return is_complete and bool((np.abs(np.array(values) - PRINTED_SPANS) <= HALF_DIGIT).all())

    verdict = correction_verdict(ROUNDED, not is_printed(spans), not (off <= bound and is_printed(carried)))
    exact, rounded = (
        " / ".join(f"{span:{digits}}" for span in values) for values, digits in ((spans, ".12g"), (carried, ".3f"))
    )
    return (
        verdict,
        f"{exact}; with {end_carried:g} for P2's end acceleration {end:.4f} h/β² {rounded}, all four of the print",
    )


def picker_table(examples: Examples) -> Numbers:
    """Table of Fig. 4: angles [deg] and heights [mm] as printed, of the example, and rounded; half a last digit."""
    heights, spans = picker(examples)
    if spans.size != len(PRINTED_TABLE):
        return {"rows": {}}
    carried = closed_spans(heights, float(spans.sum()), P_CARRIED)
    angles, rounded_angles = (30.0 + np.append(0.0, np.cumsum(values)) for values in (spans, carried))
    levels = np.append(0.0, np.cumsum([s.rise for s in moving(examples.design(PICKER))]))
    rows: dict[str, tuple[float, float, float, float]] = {}
    for i, (curve, *printed) in enumerate(PRINTED_TABLE):
        for end, word in enumerate(("from", "to")):
            at = i + end
            rows[f"{curve} {word}"] = (printed[2 * end], float(angles[at]), float(rounded_angles[at]), 5e-3)
            rows[f"{curve} {word}, height"] = (printed[2 * end + 1], float(levels[at]), float(levels[at]), 5e-4)
    return {"rows": rows}


def as_tabled(rows: Mapping[str, tuple[float, float, float, float]]) -> tuple[str, str]:
    """Judge the table of Fig. 4: rounded where the rounded acceleration gives every printed number."""
    same, carried = ([abs(row[which] - row[0]) <= row[3] for row in rows.values()] for which in (1, 2))
    widest = max((abs(computed - printed) for printed, computed, *_ in rows.values()), default=inf)
    return correction_verdict(ROUNDED, not rows or not all(same), not rows or not all(carried)), (
        f"{sum(same)} of {len(rows)} numbers as printed, angles differ by up to {widest:.4f}°; with {P_CARRIED:g} for P2's end "
        f"acceleration {P_END:.4f} h/β² {sum(carried)} of {len(rows)}"
    )


def least_curves(examples: Examples) -> Numbers:
    """Fewest curves of a DRRD with a constant velocity in its rise (Fig. 3)."""
    admitted = sequences("DRRD", "rise")
    of_example = tuple(s.curve.law.upper() for s in moving(examples.design(PICKER)))
    return {"fewest": len(admitted[0].curves), "names": str(admitted[0]), "here": "-".join(of_example)}


def four_curves(fewest: int, names: str, here: str) -> tuple[str, str]:
    """Judge Fig. 3: whether four curves are necessary, and the example has these."""
    return ("agrees" if fewest == 4 and names == here else "differs"), f"{fewest}: {names}; the example has {here}"


def constant_length(examples: Examples) -> Numbers:
    """Span of the constant velocity of the card picker [deg] (§3.2, 4)."""
    spans = [s.span_deg for s in moving(examples.design(PICKER)) if s.curve.law == "cv1"]
    return {"length": sum(spans), "least": LEAST_CONSTANT}


def long_enough(length: float, least: float) -> tuple[str, str]:
    """Judge §3.2, 4): whether the constant velocity lasts as long as required."""
    return ("agrees" if length >= least else "differs"), f"it lasts {length:.6g}°"


def _top(design: Design) -> float:
    """Cam angle [deg] at which the rise ends."""
    at = 0.0
    for segment in require_motion(design).segments:
        if segment.rise < 0.0:
            return at
        at += segment.span_deg
    return at


def top(examples: Examples) -> Numbers:
    """Cam angle at which the rise ends [deg]: text against Fig. 4, by Fig. 4's heights, and with the peak given."""
    of_text, printed, of_picker = examples.design(PEAK), PRINTED_TABLE[2][3], _top(examples.design(PICKER))
    heights = [abs(s.rise) for s in moving(of_text)]
    return {
        "printed": abs(printed - PRINTED_PEAK),
        "corrected": max(abs(_top(of_text) - PRINTED_PEAK), abs(of_picker - printed)),
        "bound": 0.02,
        "here": of_picker,
        "peak": _top(of_text),
        "h3": heights[2] if len(heights) > 2 else 0.0,
        "spans": " / ".join(f"{s.span_deg:.6f}" for s in moving(of_text)),
    }


def conclusion(examples: Examples) -> Numbers:
    """Errors, cutter, gap and proofs of the card picker's design.

    The number of findings that are errors, the least concave radius of its profile, into which a cutter fits [mm]
    (infinite
    where there is none), the distance of the profile's ends [mm], and the number of satisfied proofs.
    """
    study = examples.study(PICKER)
    curvature = extremes_of(study, "cam", ("profile_curvature",))["profile_curvature"].low.value
    ends = study.at_theta(np.array([0.0, 2.0 * np.pi * (1.0 - 1e-9)])).cam.flank.profile
    proofs = certificate_of(study)
    return {
        "errors": sum(finding.severity == "error" for finding in findings_of(study)),
        "cutter": -1e3 / curvature if curvature < 0.0 else inf,
        "gap": float(abs(ends[1] - ends[0])) * 1e3,
        "passed": sum(proof.kept for proof in proofs.values()),
        "proofs": len(proofs),
    }


def judge_conclusion(errors: int, cutter: float, gap: float, passed: int, proofs: int) -> tuple[str, str]:
    """Judge the conclusion: whether the cam can be designed, machined and verified."""
    size = f"of up to {cutter:.5g} mm" if isfinite(cutter) else "of any size"
    words = (
        f"the card picker is designed with {errors} errors, its profile closes and a cutter {size} can machine it (as DXF "
        f"or G-code with its tolerance stated), and {passed} of {proofs} proofs of motion, profile and forces are satisfied"
    )
    return ("agrees" if not errors and cutter > 0.0 and gap < 1e-3 and passed == proofs else "differs"), words


# -- tables of elementary curves --------------------------------------------------------------------------------

PRINTED = {
    "C1": ("0+", "0+", "00", "C2 H2 CV1"), "C2": ("0+", "+0", "00", "C1 C3 C5 C6 P1"), "C3": ("+0", "0-", "00", "C4 H4 CV2"),
    "C4": ("+0", "-0", "00", "C1 C3 C5 C6 P1"), "C5": ("0+", "00", "00", "C1 C3 C6 P1"), "C6": ("+0", "00", "00", "C1 C3 C5 P1"),
    "H1": ("0+", "0+", "+0", "C2 H2 CV1"), "H2": ("0+", "+0", "0-", "H3 H6 P2"), "H3": ("+0", "0-", "-0", "C4 H4 CV2"),
    "H4": ("+0", "-0", "0+", "H1 H5"), "H5": ("0+", "00", "+-", "H3 H6 P2"), "H6": ("+0", "00", "-+", "H1 H5"),
    "P1": ("0+", "00", "0-", "H3 H6 P2"), "P2": ("+0", "00", "-0", "C1 C3 C5 C6 P1"), "CV1": ("0+", "++", "00", "C2 H2"),
    "CV2": ("0-", "--", "00", "C4 H4"),
}  # fmt: skip
"""Table 1 as printed: signs of displacement, velocity and acceleration at start and end, usable next."""

MOTION_PARTS = (
    ("DRD", "first of the rise", 1, "00", "+"), ("DRD", "last of the rise", 1, "+", "00"), ("DRD", "whole rise", 1, "00", "00"),
    ("DRD", "whole return", -1, "00", "00"), ("DRD", "first of the return", -1, "00", "-"), ("DRD", "last of the return", -1, "-", "00"),
    ("DRRD", "first of the rise", 1, "00", "+"), ("DRRD", "last of the rise", 1, "+", "0-"), ("DRRD", "whole rise", 1, "00", "0-"),
    ("DRRD", "whole return", -1, "0-", "00"), ("DRRD", "first of the return", -1, "0-", "-"), ("DRRD", "last of the return", -1, "-", "00"),
    ("RRR", "first of the rise", 1, "0+", "+"), ("RRR", "last of the rise", 1, "+", "0-"), ("RRR", "whole rise", 1, "0+", "0-"),
    ("RRR", "whole return", -1, "0-", "0+"), ("RRR", "first of the return", -1, "0-", "-"), ("RRR", "last of the return", -1, "-", "0+"),
)  # fmt: skip
"""Motion, part, direction, and its two ends: sign of velocity, or velocity 0 with the sign of acceleration."""
PRINTED_CURVES = (
    "C1",
    "C2",
    "C5",
    "C6",
    "C3",
    "C4",
    "C1",
    "H2",
    "P1",
    "P2",
    "H3",
    "C4",
    "H1",
    "H2",
    "H5",
    "H6",
    "H3",
    "H4",
)
"""Table 2 as printed, for each part."""
ENDS = np.array([0.0, 1.0])
ROUNDING = 1e-9


def _sign(value: float) -> str:
    return "0" if abs(value) < ROUNDING else "+" if value > 0.0 else "-"


def signs(curve: str) -> tuple[str, str, str]:
    """Signs of displacement above its minimum, velocity and acceleration, at start and end, by the formula."""
    law = LAWS[curve.lower()]
    s, v, a = (law.rises * law(ENDS)[k] for k in range(3))
    s = s - s.min()
    first, second, third = ("".join(_sign(float(value)) for value in row) for row in (s, v, a))
    return first, second, third


def states(curve: str) -> tuple[str, str]:
    """Velocity and acceleration at the start, and at the end."""
    _, v, a = signs(curve)
    return v[0] + a[0], v[1] + a[1]


def usable_next(curve: str) -> str:
    """Names of the other curves that start in the state in which this one ends."""
    end = states(curve)[1]
    return " ".join(name for name in PRINTED if name != curve and states(name)[0] == end)


def _state_of(*ends: tuple[int, int]) -> tuple[str, ...]:
    """Printed form of signs given as numbers."""
    return tuple("".join("-0+"[sign + 1] for sign in end) for end in ends)


def table_1(examples: Examples) -> Numbers:
    """Signs and successors of the curves by their formulas (Table 1)."""
    curves = {name: (*signs(name), usable_next(name)) for name in PRINTED}
    blending = all(_state_of(row.start, row.end) == states(name) for name, row in ELEMENTS.items())
    return {"curves": curves, "blending": blending}


def as_table_1(curves: Mapping[str, tuple[str, str, str, str]], blending: bool) -> tuple[str, str]:
    """Judge Table 1: whether velocities, accelerations and usable curves are the printed ones."""

    def is_equal(name: str) -> bool:
        computed, printed = curves[name], PRINTED[name]
        return computed[1:3] == printed[1:3] and set(computed[3].split()) == set(printed[3].split())

    different = [name for name in PRINTED if not is_equal(name)]
    words = (
        f"of {len(PRINTED)} curves {len(PRINTED) - len(different)} have these signs at their ends and these successors, "
        "by their formulas"
    )
    if different:
        words += f"; not {', '.join(different)}"
    return ("agrees" if blending and not different else "differs"), words


def returning(examples: Examples) -> Numbers:
    """Number of wrong signs of CV2's displacement: printed 0, -, and the other returns' +, 0 (Table 1)."""
    sign_pair = signs("CV2")[0]
    return {
        "printed": float(sum(a != b for a, b in zip(PRINTED["CV2"][0], sign_pair, strict=True))),
        "corrected": float(sum(a != b for a, b in zip(PRINTED["C3"][0], sign_pair, strict=True))),
        "bound": 0.0,
        "here": sign_pair,
    }


def _is_compatible(curve: str, direction: int, start: str, end: str) -> bool:
    if curve.startswith("CV") or LAWS[curve.lower()].rises != direction:
        return False
    reached = tuple(state if state[0] == "0" else state[0] for state in states(curve))
    return reached == (start, end)


def fitting() -> tuple[tuple[str, ...], ...]:
    """Curves that are compatible with each of ``MOTION_PARTS``."""
    return tuple(tuple(name for name in PRINTED if _is_compatible(name, *part[2:])) for part in MOTION_PARTS)


def table_2(examples: Examples) -> Numbers:
    """Compatible curves of each part of a motion (Table 2)."""
    return {"compatible": fitting()}


def as_table_2(compatible: tuple[tuple[str, ...], ...]) -> tuple[str, str]:
    """Judge Table 2: whether exactly the printed curve fits each part of a motion."""
    rows = zip(MOTION_PARTS, compatible, PRINTED_CURVES, strict=True)
    different = [
        f"{part[0]}, {part[1]}: {', '.join(curves) or 'none'}" for part, curves, printed in rows if curves != (printed,)
    ]
    words = f"at {len(compatible) - len(different)} of {len(compatible)} places exactly the printed curve fits"
    return ("differs" if different else "agrees"), words + (f"; {'; '.join(different)}" if different else "")


def first_curve(examples: Examples) -> Numbers:
    """Compatible curves of the first part of a DRD rise (Fig. 1, PQ)."""
    (v, a), _ = MOTION_TYPES["DRD"].rise or ((0, 0), (0, 0))
    return {"curves": fitting()[0], "start": (v, a)}


def only_c1(curves: tuple[str, ...], start: tuple[int, int]) -> tuple[str, str]:
    """Judge Fig. 1, PQ: whether only C1 is compatible."""
    words = (
        f"from velocity {start[0]} and acceleration {start[1]}, ending at speed, the only curve is "
        f"{' or '.join(curves) or 'none'}"
    )
    return ("agrees" if curves == ("C1",) and start == (0, 0) else "differs"), words
