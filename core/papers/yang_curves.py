"""The numbers of Yang's equations (1)-(8) and of the card picker of Fig. 4, of the examples' segments."""

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
from core.papers.claim import METHOD, ROUNDED, ComparedNumber, Examples, parted
from core.study import certificate_of, extremes_of, findings_of

# -- the numbers of Yang's equations (1)-(8) and of the card picker of Fig --------------------------------------


DRD, PICKER, PEAK = "dwell_rise_dwell", "card_picker", "card_picker_peak_250"
PRINTED_SPANS = (18.846, 169.613, 14.801, 96.740)
PRINTED_TABLE = (
    ("C1", 30.0, 0.0, 48.85, 1.0), ("CV1", 48.85, 1.0, 218.46, 19.0), ("H2", 218.46, 19.0, 233.26, 20.0), ("P2", 233.26, 20.0, 330.0, 0.0),
)  # fmt: skip
LEAST_CONSTANT = 150.0
WANTED_PEAK = 250.0
SMALL = 1e-9

Numbers = Mapping[str, Any]


def moving(design: Design) -> list[Any]:
    """The segments that move: curve, span [deg], signed rise."""
    return [segment for segment in require_motion(design).segments if segment.rise]


def rise(examples: Examples) -> tuple[np.ndarray, np.ndarray]:
    """Heights h1, h2, h3 [mm] and spans β1, β2, β3 [deg] of the example of Fig. 2."""
    segments = [s for s in moving(examples.design(DRD)) if s.rise > 0.0]
    return np.array([s.rise for s in segments]), np.array([s.span_deg for s in segments])


def _sides(left: float, right: float, **more: float) -> Numbers:
    return {"off": abs(left - right) / max(abs(right), 1e-300), "bound": SMALL, "left": left, "right": right, **more}


def smooth(examples: Examples) -> Numbers:
    """Fig. 2: the largest jump of velocity and of acceleration at a join, as a part of its largest value; both peaks [mm, deg]."""
    study = examples.study(DRD)
    sizes = [float(np.abs(study.motion.displacement[k]).max()) for k in (1, 2)]
    jumps = [max(abs(float(each.jump[k])) for each in study.program.joins) for k in (1, 2)]
    per_degree = np.pi / 180.0
    there = study.at_theta(np.deg2rad(np.linspace(0.0, 180.0, 721))).motion.displacement
    return {
        "off": max(jump / size for jump, size in zip(jumps, sizes, strict=True)),
        "bound": SMALL,
        "velocity": float(there[1].max()) * 1e3 * per_degree,
        "acceleration": float(np.abs(there[2]).max()) * 1e3 * per_degree**2,
    }


def join(first: int, second: int) -> Callable[[Examples], Numbers]:
    """(1), (2): 2h/β of a curve C against h/β of the constant velocity."""

    def numbers(examples: Examples) -> Numbers:
        h, b = rise(examples)
        return _sides(2.0 * h[first] / b[first], h[second] / b[second])

    return numbers


def total(which: int) -> Callable[[Examples], Numbers]:
    """(3), (4): the sum of the spans, of the heights, against those of the whole rise."""

    def numbers(examples: Examples) -> Numbers:
        study = examples.study(DRD)
        parts = rise(examples)[which]
        joins = study.program.joins
        begins = [j.theta for j in joins]
        segments = require_motion(study.design).segments
        first = next(i for i, s in enumerate(segments) if s.rise > 0.0)
        ends = np.rad2deg(np.array([begins[first - 1], begins[first - 1 + parts.size]]))
        heights = study.at_theta(np.deg2rad(ends)).motion.displacement[0] * 1e3
        whole = float(np.ptp(ends if which else heights))
        return _sides(float(parts.sum()), whole)

    return numbers


def constant_velocity(examples: Examples) -> Numbers:
    """(5): h2/β2 against the velocity in the middle of it."""
    h, b = rise(examples)
    study = examples.study(DRD)
    segments = require_motion(study.design).segments
    before = sum(s.span_deg for s in segments[: [s.curve.law for s in segments].index("cv1")])
    there = study.at_theta(np.deg2rad([before + 0.5 * b[1]])).motion.displacement[1]
    return _sides(float(h[1] / b[1]), float(there[0]) * 1e3 * np.pi / 180.0)


def spans(examples: Examples) -> Numbers:
    """(6)."""
    h, b = rise(examples)
    return _sides(float((2.0 * h[0] / h[1] + 1.0 + 2.0 * h[2] / h[1]) * b[1]), float(b.sum()))


def middle_span(examples: Examples) -> Numbers:
    """(7)."""
    h, b = rise(examples)
    return _sides(float(2.0 * h.sum() / (h[1] / b[1]) - b.sum()), float(b[1]))


def speed_range(examples: Examples) -> Numbers:
    """(8): the range of the constant velocity [mm/°], whether its ends belong to it, and the largest acceleration [mm/°²] a
    thousandth above its lower end."""
    h, b = rise(examples)
    request = Request("DRD", float(h.sum()), 0.0, float(b.sum()), "rise", {})
    (found,) = feasible_ranges(request, "vcv")
    near = found.low * 1.001
    low = blend(replace(request, settings={"vcv": near, "h1": 0.5 * (near * float(b.sum()) - float(h.sum()))}))
    return {
        "low": ComparedNumber(float(h.sum() / b.sum()), found.low, 1e-12, "mm/°"),
        "high": ComparedNumber(2.0 * float(h.sum() / b.sum()), found.high, 1e-12, "mm/°"),
        "low_open": found.low_open,
        "high_open": found.high_open,
        "acceleration": low.solution.peak_acceleration,
    }


def as_range(
    low: ComparedNumber, high: ComparedNumber, low_open: bool, high_open: bool, acceleration: float
) -> tuple[str, str]:
    """h/β ≤ Cv ≤ 2h/β."""
    words = f"{low.here:.6g} {'<' if low_open else '≤'} Cv {'<' if high_open else '≤'} {high.here:.6g} mm/°"
    if low_open:
        words += f": at the lower end h1 = h3 = 0 and the acceleration has no limit (a thousandth above it {acceleration:.4g} mm/°²)"
    kept = low.same and high.same and not low_open and not high_open
    return ("agrees" if kept else "differs"), words


def freedom(examples: Examples) -> Numbers:
    """§3.1: how many values determine C1-CV1-C2."""
    h, b = rise(examples)
    names = "-".join(s.curve.law.upper() for s in moving(examples.design(DRD)) if s.rise > 0.0)
    found = candidates(Request("DRD", float(h.sum()), 0.0, float(b.sum()), "rise", {}, sequence=names))
    return {"names": names, "free": tuple(each.freedom for each in found)}


def two_free(names: str, free: tuple[int, ...]) -> tuple[str, str]:
    count = ", ".join(map(str, free)) or "no"
    return ("agrees" if free == (2,) else "differs"), f"{names}: 4 equations, 6 unknowns; {count} values determine it"


def determining(examples: Examples) -> Numbers:
    """§3.1: which of the three heights determine C1-CV1-C2 where the constant velocity is given, each with the value that it has; and the
    height that (7) gives h2 [mm]."""
    h, b = rise(examples)
    speed = float(h[1] / b[1])
    found = []
    for name, height in zip(("h1", "h2", "h3"), h.tolist(), strict=True):
        try:
            blend(Request("DRD", float(h.sum()), 0.0, float(b.sum()), "rise", {"vcv": speed, name: height}))
        except BlendError:
            continue
        found.append(name)
    return {"determining": tuple(found), "speed": speed, "middle": 2.0 * float(h.sum()) - speed * float(b.sum())}


def any_height(determining: tuple[str, ...], speed: float, middle: float) -> tuple[str, str]:
    others = [name for name in ("h1", "h2", "h3") if name not in determining]
    words = f"{' or '.join(determining) or 'none of them'} does; by (7) Cv = {speed:g} mm/° gives h2 = 2h - Cv β = {middle:g} mm already"
    return parted(METHOD, bool(others), others != ["h2"]), words


def conditions(examples: Examples) -> Numbers:
    """§1, 1-4: what is left of sums and joins of the card picker, each as a part of its size."""
    study = examples.study(PICKER)
    segments = require_motion(study.design).segments
    heights = [s.rise for s in segments]
    found = extremes_of(study, "motion", ("displacement",))["displacement"]
    stroke = (found.high.value - found.low.value) * 1e3
    risen, turned = sum(h for h in heights if h > 0.0), sum(s.span_deg for s in segments)
    left = [abs(sum(heights)) / stroke, abs(risen - stroke) / stroke, abs(turned - 360.0) / 360.0]
    for k in (1, 2):
        size = float(np.abs(study.motion.displacement[k]).max())
        left.append(max(abs(float(join.jump[k])) for join in study.program.joins) / size)
    return {"off": max(left), "bound": SMALL, "velocity_jump": left[3], "acceleration_jump": left[4]}


def constant_acceleration(examples: Examples) -> Numbers:
    """§1: a rise of two half cycloids with a constant acceleration of the size and the span that a modified trapezoid has (a quarter
    of the whole at 8π/(2 + π) h/β²), against that law: by how much s, v and a differ, each as a part of its size."""
    h, b = rise(examples)
    stroke, whole = float(h.sum()), float(b.sum())
    size, span = 8.0 * np.pi / (2.0 + np.pi) * stroke / whole**2, 0.25 * whole
    made = blend(Request("DRD", stroke, 0.0, whole, "none", {"flat1": span, "a1": size, "flat3": span}))
    angles = np.linspace(0.0, whole, 721)
    back = Segment(360.0 - whole, -stroke, NamedCurve("cycloidal"))
    compiled = program(Motion(0.0, (*made.segments, back)))
    state = compiled.state(compiled.angles(np.deg2rad(angles))).displacement
    here = (state[k] * 1e3 * (np.pi / 180.0) ** k for k in range(3))
    law = LAWS["modified-trapezoid"](angles / whole)[:3] * stroke / whole ** np.arange(3)[:, None]
    off = max(float(np.abs(one - other).max() / np.abs(other).max()) for one, other in zip(here, law, strict=True))
    return {"off": off, "bound": SMALL, "constant": size, "span": span}


# -- Fig. 4 ------------------------------------------------------------------------------------------------


def picker(examples: Examples) -> tuple[np.ndarray, np.ndarray]:
    """Heights [mm] and spans [deg] of the card picker's curves."""
    segments = moving(examples.design(PICKER))
    return np.array([abs(s.rise) for s in segments]), np.array([s.span_deg for s in segments])


P_END = abs(float(LAWS["p1"](np.ones(1))[2, 0]))
"""Acceleration at the end of P1 and the start of P2, 216/41 h/β²."""
P_CARRIED = round(P_END, 2)


def closed_spans(heights: np.ndarray, whole: float, end: float) -> np.ndarray:
    """Spans [deg] of C1-CV1-H2-P2 of these heights (4,) over ``whole``, from velocities and accelerations that meet: 2h1, h2, (π/2)h3 and
    √(c h4 h3) over the constant velocity, c = ``end`` of P2."""
    h1, h2, h3, h4 = heights
    lengths = np.array([2.0 * h1, h2, 0.5 * np.pi * h3, np.sqrt(end * h4 * h3)])
    return np.asarray(lengths * whole / lengths.sum())


def card_picker(examples: Examples) -> Numbers:
    """Fig. 4's spans: of the example, by how much these are off the closed form [deg], and with P2's end acceleration to two decimals."""
    heights, spans = picker(examples)
    alike = spans.size == len(PRINTED_SPANS)
    whole = float(spans.sum())
    exact, carried = (closed_spans(heights, whole, end) if alike else np.zeros(0) for end in (P_END, P_CARRIED))
    return {
        "off": float(np.abs(spans - exact).max()) if alike else inf,
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
    """Rounded where the example's spans are exact and those with the rounded acceleration are the printed ones, to the last digit."""

    def printed(found: tuple[float, ...]) -> bool:
        return len(found) == len(PRINTED_SPANS) and bool((np.abs(np.array(found) - PRINTED_SPANS) <= HALF_DIGIT).all())

    verdict = parted(ROUNDED, not printed(spans), not (off <= bound and printed(carried)))
    here, there = (
        " / ".join(f"{span:{digits}}" for span in found) for found, digits in ((spans, ".12g"), (carried, ".3f"))
    )
    return (
        verdict,
        f"{here}; with {end_carried:g} for P2's end acceleration {end:.4f} h/β² {there}, all four of the print",
    )


def picker_table(examples: Examples) -> Numbers:
    """The table of Fig. 4, by row and end: angle [deg] or height [mm] as printed, of the example, with the rounded acceleration, and half
    of its last digit."""
    heights, spans = picker(examples)
    if spans.size != len(PRINTED_TABLE):
        return {"rows": {}}
    carried = closed_spans(heights, float(spans.sum()), P_CARRIED)
    angles, others = (30.0 + np.append(0.0, np.cumsum(each)) for each in (spans, carried))
    levels = np.append(0.0, np.cumsum([s.rise for s in moving(examples.design(PICKER))]))
    found: dict[str, tuple[float, float, float, float]] = {}
    for i, (curve, *printed) in enumerate(PRINTED_TABLE):
        for end, word in enumerate(("from", "to")):
            at = i + end
            found[f"{curve} {word}"] = (printed[2 * end], float(angles[at]), float(others[at]), 5e-3)
            found[f"{curve} {word}, height"] = (printed[2 * end + 1], float(levels[at]), float(levels[at]), 5e-4)
    return {"rows": found}


def as_tabled(rows: Mapping[str, tuple[float, float, float, float]]) -> tuple[str, str]:
    same, carried = ([abs(row[which] - row[0]) <= row[3] for row in rows.values()] for which in (1, 2))
    widest = max((abs(here - printed) for printed, here, *_ in rows.values()), default=inf)
    return parted(ROUNDED, not rows or not all(same), not rows or not all(carried)), (
        f"{sum(same)} of {len(rows)} numbers as printed, angles up to {widest:.4f}° apart; with {P_CARRIED:g} for P2's end acceleration "
        f"{P_END:.4f} h/β² {sum(carried)} of {len(rows)}"
    )


def least_curves(examples: Examples) -> Numbers:
    """Fig. 4: the fewest curves of a DRRD with a constant velocity in its rise."""
    found = sequences("DRRD", "rise")
    here = tuple(s.curve.law.upper() for s in moving(examples.design(PICKER)))
    return {"fewest": len(found[0].curves), "names": str(found[0]), "here": "-".join(here)}


def four_curves(fewest: int, names: str, here: str) -> tuple[str, str]:
    return ("agrees" if fewest == 4 and names == here else "differs"), f"{fewest}: {names}; the example has {here}"


def constant_length(examples: Examples) -> Numbers:
    spans = [s.span_deg for s in moving(examples.design(PICKER)) if s.curve.law == "cv1"]
    return {"length": sum(spans), "least": LEAST_CONSTANT}


def long_enough(length: float, least: float) -> tuple[str, str]:
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
    """Where the rise ends [deg]: as the text wants it against Fig. 4; with Fig. 4's heights here, and with the peak given."""
    asked, printed, here = examples.design(PEAK), PRINTED_TABLE[2][3], _top(examples.design(PICKER))
    heights = [abs(s.rise) for s in moving(asked)]
    return {
        "printed": abs(printed - WANTED_PEAK),
        "corrected": max(abs(_top(asked) - WANTED_PEAK), abs(here - printed)),
        "bound": 0.02,
        "here": here,
        "peak": _top(asked),
        "h3": heights[2] if len(heights) > 2 else 0.0,
        "spans": " / ".join(f"{s.span_deg:.6f}" for s in moving(asked)),
    }


def made(examples: Examples) -> Numbers:
    """Conclusion: of the card picker how many findings are errors, the least concave radius of its profile, into which a cutter goes
    [mm] (infinite where there is none), how far the profile is from closing [mm], and how many of its proofs are kept."""
    study = examples.study(PICKER)
    bend = extremes_of(study, "cam", ("profile_curvature",))["profile_curvature"].low.value
    ends = study.at_theta(np.array([0.0, 2.0 * np.pi * (1.0 - 1e-9)])).cam.flank.profile
    proofs = certificate_of(study)
    return {
        "errors": sum(finding.severity == "error" for finding in findings_of(study)),
        "cutter": -1e3 / bend if bend < 0.0 else inf,
        "gap": float(abs(ends[1] - ends[0])) * 1e3,
        "kept": sum(proof.kept for proof in proofs.values()),
        "proofs": len(proofs),
    }


def as_made(errors: int, cutter: float, gap: float, kept: int, proofs: int) -> tuple[str, str]:
    passes = f"a cutter of up to {cutter:.5g} mm goes round" if isfinite(cutter) else "a cutter of any size goes round"
    words = (
        f"the card picker is designed with {errors} errors, its profile closes and {passes} it (as DXF or G-code with its tolerance "
        f"stated), and {kept} of {proofs} proofs of motion, profile and forces are kept"
    )
    return ("agrees" if not errors and cutter > 0.0 and gap < 1e-3 and kept == proofs else "differs"), words


# -- the numbers of Yang's tables of elementary curves ----------------------------------------------------------


PRINTED = {
    "C1": ("0+", "0+", "00", "C2 H2 CV1"), "C2": ("0+", "+0", "00", "C1 C3 C5 C6 P1"), "C3": ("+0", "0-", "00", "C4 H4 CV2"),
    "C4": ("+0", "-0", "00", "C1 C3 C5 C6 P1"), "C5": ("0+", "00", "00", "C1 C3 C6 P1"), "C6": ("+0", "00", "00", "C1 C3 C5 P1"),
    "H1": ("0+", "0+", "+0", "C2 H2 CV1"), "H2": ("0+", "+0", "0-", "H3 H6 P2"), "H3": ("+0", "0-", "-0", "C4 H4 CV2"),
    "H4": ("+0", "-0", "0+", "H1 H5"), "H5": ("0+", "00", "+-", "H3 H6 P2"), "H6": ("+0", "00", "-+", "H1 H5"),
    "P1": ("0+", "00", "0-", "H3 H6 P2"), "P2": ("+0", "00", "-0", "C1 C3 C5 C6 P1"), "CV1": ("0+", "++", "00", "C2 H2"),
    "CV2": ("0-", "--", "00", "C4 H4"),
}  # fmt: skip
"""Table 1 as printed: signs of displacement, velocity and acceleration at start and end, usable next."""

PLACES = (
    ("DRD", "first of the rise", 1, "00", "+"), ("DRD", "last of the rise", 1, "+", "00"), ("DRD", "whole rise", 1, "00", "00"),
    ("DRD", "whole return", -1, "00", "00"), ("DRD", "first of the return", -1, "00", "-"), ("DRD", "last of the return", -1, "-", "00"),
    ("DRRD", "first of the rise", 1, "00", "+"), ("DRRD", "last of the rise", 1, "+", "0-"), ("DRRD", "whole rise", 1, "00", "0-"),
    ("DRRD", "whole return", -1, "0-", "00"), ("DRRD", "first of the return", -1, "0-", "-"), ("DRRD", "last of the return", -1, "-", "00"),
    ("RRR", "first of the rise", 1, "0+", "+"), ("RRR", "last of the rise", 1, "+", "0-"), ("RRR", "whole rise", 1, "0+", "0-"),
    ("RRR", "whole return", -1, "0-", "0+"), ("RRR", "first of the return", -1, "0-", "-"), ("RRR", "last of the return", -1, "-", "0+"),
)  # fmt: skip
"""Motion, place, way, and at its two ends: velocity where it moves, else velocity 0 and the sign of the acceleration."""
PRINTED_PLACES = (
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
"""Table 2 as printed, place by place."""
ENDS = np.array([0.0, 1.0])
ROUNDING = 1e-9


def _sign(value: float) -> str:
    return "0" if abs(value) < ROUNDING else "+" if value > 0.0 else "-"


def signs(curve: str) -> tuple[str, str, str]:
    """Of displacement above the lowest level, velocity and acceleration, at start and end, from the curve's own formula."""
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
    """Every other curve that starts in the state in which this one ends."""
    end = states(curve)[1]
    return " ".join(name for name in PRINTED if name != curve and states(name)[0] == end)


def _state_of(*ends: tuple[int, int]) -> tuple[str, ...]:
    """Signs as numbers, as the blending has them, as they are printed."""
    return tuple("".join("-0+"[sign + 1] for sign in end) for end in ends)


def table_1(examples: Examples) -> Numbers:
    found = {name: (*signs(name), usable_next(name)) for name in PRINTED}
    blending = all(_state_of(row.start, row.end) == states(name) for name, row in ELEMENTS.items())
    return {"found": found, "blending": blending}


def as_table_1(found: Mapping[str, tuple[str, str, str, str]], blending: bool) -> tuple[str, str]:
    """Velocities, accelerations and usable curves against the print."""

    def same(name: str) -> bool:
        here, printed = found[name], PRINTED[name]
        return here[1:3] == printed[1:3] and set(here[3].split()) == set(printed[3].split())

    apart = [name for name in PRINTED if not same(name)]
    words = f"of {len(PRINTED)} curves {len(PRINTED) - len(apart)} have these signs at their ends and these successors, by their formulas"
    if apart:
        words += f"; not {', '.join(apart)}"
    return ("agrees" if blending and not apart else "differs"), words


def returning(examples: Examples) -> Numbers:
    """CV2's displacement, printed 0, -, among returns that are all printed +, 0: how many signs are not those of its formula."""
    here = signs("CV2")[0]
    return {
        "printed": float(sum(a != b for a, b in zip(PRINTED["CV2"][0], here, strict=True))),
        "corrected": float(sum(a != b for a, b in zip(PRINTED["C3"][0], here, strict=True))),
        "bound": 0.0,
        "here": here,
    }


def _fits(curve: str, way: int, start: str, end: str) -> bool:
    if curve.startswith("CV") or LAWS[curve.lower()].rises != way:
        return False
    reached = tuple(state if state[0] == "0" else state[0] for state in states(curve))
    return reached == (start, end)


def fitting() -> tuple[tuple[str, ...], ...]:
    """The curves that fit each of ``PLACES``."""
    return tuple(tuple(name for name in PRINTED if _fits(name, *place[2:])) for place in PLACES)


def table_2(examples: Examples) -> Numbers:
    return {"found": fitting()}


def as_table_2(found: tuple[tuple[str, ...], ...]) -> tuple[str, str]:
    rows = zip(PLACES, found, PRINTED_PLACES, strict=True)
    apart = [
        f"{place[0]}, {place[1]}: {', '.join(curves) or 'none'}"
        for place, curves, printed in rows
        if curves != (printed,)
    ]
    words = f"at {len(found) - len(apart)} of {len(found)} places exactly the printed curve fits"
    return ("differs" if apart else "agrees"), words + (f"; {'; '.join(apart)}" if apart else "")


def first_place(examples: Examples) -> Numbers:
    """Fig. 1, PQ: the first curve of a DRD rise."""
    (v, a), _ = MOTION_TYPES["DRD"].rise or ((0, 0), (0, 0))
    return {"curves": fitting()[0], "start": (v, a)}


def only_c1(curves: tuple[str, ...], start: tuple[int, int]) -> tuple[str, str]:
    words = f"from velocity {start[0]} and acceleration {start[1]}, ending at speed, there is {' or '.join(curves) or 'no curve'}"
    return ("agrees" if curves == ("C1",) and start == (0, 0) else "differs"), words
