"""Tables as they come from a bench: laws, blends and the lobes of engines, with noise, rounded, some rows spoiled; each made from a seed.
And what a fit of one has wrong."""

import random
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import hypot, sqrt

import numpy as np
from blends import SEQUENCES, free_motion
from measured_tables import APART, WrongTable, position, spoiled
from mechanisms import levels

from core.design import Motion, NamedCurve, Segment, SplinePoint, TableCurve
from core.measured import Contradiction, MeasuredTable, MotionFit, fit, layout, read_sheet, read_table

NAMED = (
    "constant-velocity", "parabolic", "simple-harmonic", "double-harmonic", "cycloidal", "modified-sine", "modified-trapezoid",
    "mcv20", "mcv33", "mcv50", "mcv66", "2-3", "3-4-5", "4-5-6-7", "5-6-7-8-9", "freudenstein-1-3", "freudenstein-1-3-5", "gutman-1-3",
)  # fmt: skip
BLENDS = [
    name for names in SEQUENCES.values() for name in names if name not in ("H1-H2-H6", "H5-H3-H4")
]  # they are H5-H6
SAME = {"c5": "cycloidal", "c6": "cycloidal", "h5": "simple-harmonic", "h6": "simple-harmonic"}
STEPS = {"lift [mm]": 1e-3, "lift (1e-4 in)": 25.4e-4}
NOISE, FINE, LONGEST = 0.005, 1e-4, 13  # mm; of the stroke, below which laws are recognised; rows of a run


@dataclass(frozen=True)
class MixedTable(WrongTable):
    """kind: laws, blend or lobe; step: that of the rounding [mm]; stated: whether the error is."""

    kind: str = "laws"
    step: float = 1e-3
    stated: bool = True

    @cached_property
    def table(self) -> MeasuredTable:
        header = next(words for words, step in STEPS.items() if step == self.step)
        unit = 1.0 if self.step == 1e-3 else self.step
        digits = 3 if unit == 1.0 else 0
        rows = zip(self.angles.tolist(), (self.values / unit).tolist(), strict=True)
        text = "\n".join([f"angle [deg],{header}", *(f"{a!r},{v:.{digits}f}" for a, v in rows)])
        sheet = read_sheet(text.encode(), "t.csv")
        return read_table(sheet, layout(sheet))

    @property
    def joins(self) -> list[tuple[float, float, str]]:
        """Of each segment from, to [deg of the table, counted on] and law."""
        ends = np.cumsum([0.0, *(s.span_deg for s in self.motion.segments)]) - self.turn
        return [
            (a, b, SAME.get(s.curve.law, s.curve.law)) for (a, b), s in zip(pairwise(ends), self.motion.segments, strict=True)
        ]  # fmt: skip


def mixed_table(seed: int) -> MixedTable:
    """A motion of 5 ... 60 mm over decimal spans, 360, 720 or 3600 rows that begin anywhere in it, noise of 0 ... 5 µm, steps of 1 µm or
    1e-4 in."""
    chance = np.random.default_rng(seed)
    kind = ("laws", "blend", "lobe")[seed % 3]
    motion = {"laws": _laws, "blend": _blend, "lobe": _lobe}[kind](chance)
    count, step = int(chance.choice([360, 720])), float(chance.choice(list(STEPS.values())))
    count = 3600 if seed % 10 == 9 else count
    turn = round(float(chance.uniform(0.0, 360.0)), int(chance.integers(0, 4)))
    noise = float(chance.uniform(0.0, NOISE)) * float(chance.random() < 0.8)
    right = position(motion, turn + 360.0 * np.arange(count) / count) + noise * chance.normal(size=count)
    right = np.round(right / step) * step
    error = hypot(noise, step / sqrt(12.0))
    made = MixedTable(motion, turn, right, right.copy(), error, (), (), kind, step, bool(chance.random() < 0.5))
    single, run = (1, 2), (2, LONGEST + 1)
    lengths = ([], [single], [single] * 3, [run], [run, single])[int(chance.integers(0, 5))]
    values, runs, shapes = spoiled(chance, made, lengths)
    values = np.round(values / step) * step
    return replace(made, values=values, shapes=tuple(shapes), runs=tuple(runs))


def _spans(chance: np.random.Generator, count: int) -> list[float]:
    return [round(float(chance.uniform(30.0, 75.0)), int(chance.integers(0, 4))) for _ in range(count)]


def _laws(chance: np.random.Generator) -> Motion:
    """Dwells between strokes up and down, of one or two steps."""
    stroke = round(float(chance.uniform(5.0, 60.0)), 2)
    between = round(stroke * float(chance.uniform(0.3, 0.7)), 2) if chance.random() < 0.3 else 0.0
    steps, level = [], [stroke, *([between] if between else []), 0.0]
    spans = _spans(chance, len(level))
    rest = 360.0 - sum(spans)
    dwells = chance.uniform(0.3, 1.0, len(level))
    dwells = [round(float(d), 2) for d in rest * dwells / dwells.sum()]
    dwells[-1] = round(rest - sum(dwells[:-1]), 6)
    for span, to, dwell in zip(spans, level, dwells, strict=True):
        steps += [(span, to, str(chance.choice(NAMED))), (dwell, to, "dwell")]
    return levels(0.0, *steps)


def _blend(chance: np.random.Generator) -> Motion:
    """A rise and a return, joined at the top or both ways, or two of them with a dwell between."""
    name = str(chance.choice(BLENDS))
    curves, stroke = name.split("-"), round(float(chance.uniform(5.0, 60.0)), 2)
    whole = curves[0][0] == "H"
    span = 360.0 if whole else round(float(chance.uniform(120.0, 260.0)), int(chance.integers(0, 4)))
    chosen = random.Random(int(chance.integers(2**31)))
    up = [name]
    if all(c in ("C5", "C1", "CV1", "C2") for c in curves):
        up, span = [name, str(chance.choice(["C6", "C3-C4", "C3-CV2-C4"]))], round(0.4 * span, 2)
    elif curves[0] in ("C6", "C3"):
        up, span = [str(chance.choice(["C5", "C1-C2", "C1-CV1-C2"])), name], round(0.4 * span, 2)
    segments: list[Segment] = []
    dwell = round((360.0 - len(up) * span) / len(up), 6)
    for each in up:
        made = free_motion(each, chosen, stroke=stroke, back=stroke, start=0.0, span=span)
        signs = (1.0 if rise else -1.0 for rise in made.rises)
        segments += [
            Segment(b, sign * h, NamedCurve(c.lower()))
            for b, h, c, sign in zip(made.spans, made.heights, made.curves, signs, strict=True)
        ]
        segments += [] if whole else [Segment(dwell, 0.0)]
    return Motion(0.0, tuple(segments))


def _lobe(chance: np.random.Generator) -> Motion:
    """Of an engine: a polydyne 2-p-q-r over half the event on either side, which no law of the table is, with ramps or without."""
    half, lift = round(float(chance.uniform(45.0, 75.0)), 2), round(float(chance.uniform(5.0, 14.0)), 3)
    ramps = bool(chance.random() < 0.5)
    ramp, height = (
        round(float(chance.uniform(8.0, 20.0)), 2),
        round(float(chance.uniform(0.1, 0.3)), 3) if ramps else 0.0,
    )
    powers = np.array([[2, 6, 8, 10], [2, 10, 12, 14], [2, 8, 14, 20], [2, 10, 18, 26]][int(chance.integers(0, 4))])
    speed = 2.0 * height / ramp  # of half a cycloid where it ends
    ends = np.array([powers**0, powers, powers * (powers - 1), powers * (powers - 1) * (powers - 2)], dtype=float)
    c = np.linalg.solve(ends, [height - lift, -speed * half, 0.0, 0.0])
    x = np.linspace(-1.0, 1.0, 241)
    s = lift + (c * x[:, None] ** powers).sum(axis=1)
    v = (c * powers * x[:, None] ** (powers - 1)).sum(axis=1) / half
    a = (c * powers * (powers - 1) * x[:, None] ** (powers - 2)).sum(axis=1) / half**2
    rows = zip((half * (x + 1.0)).tolist(), (s - height).tolist(), v.tolist(), a.tolist(), strict=True)
    event = Segment(2.0 * half, 0.0, TableCurve(tuple(SplinePoint(*row) for row in rows)))
    sides = (Segment(ramp, height, NamedCurve("c1")), Segment(ramp, -height, NamedCurve("c4"))) if ramps else ()
    around = [*sides[:1], event, *sides[1:]]
    return Motion(0.0, (*around, Segment(round(360.0 - sum(each.span_deg for each in around), 6), 0.0)))


# -- judging ----------------------------------------------------------------------------------------------

MET, STILL = 6.0, 6.0  # errors that stroke and level may be off, and that the motion may be off a dwell that was found
SAID = 5.0  # errors from which on the notes name a row that the motion is off


@dataclass(frozen=True)
class Verdict:
    """refused: it was said that rows contradict each other; faults: what is wrong with the answer; recognised: whether all laws are found,
    None where they need not be."""

    refused: bool
    faults: tuple[str, ...] = ()
    recognised: bool | None = None


def verdict(case: MixedTable) -> Verdict:
    """Of a fit of the table."""
    try:
        found = fit(case.table, case.error / case.table.size if case.stated else None)
    except Contradiction:
        return Verdict(True)
    stroke = float(np.ptp(position(case.motion, np.arange(0.0, 360.0, 0.05))))
    fine = case.kind != "lobe" and case.error < FINE * stroke
    told = [*_rows(case, found), *_stroke(case, found, stroke), *_laws_named(case, found)]
    return Verdict(False, tuple(told), _recognised(case, found) if fine else None)


def _recognised(case: MixedTable, found: MotionFit) -> bool | None:
    """Whether all laws are named; None where the right one is among several that fit as well. Curves between two rows need not be seen."""
    least = 360.0 / case.right.size
    wanted = [law for start, end, law in case.joins if end - start > least]
    names = [SAME.get(each.law, each.law) for each in found.segments if each.span_deg > least]
    if any(wanted[k:] + wanted[:k] == names for k in range(len(wanted))):
        return True
    around = [" ".join(2 * laws) for laws in (wanted, [law for *_, law in case.joins])]
    tables = [each.ambiguous for each in found.segments if each.law == "table"]
    told = [any(name in text for name in names for text in around) for names in tables]
    return None if told and all(told) else False


def _rows(case: MixedTable, found: MotionFit) -> list[str]:
    named, open_rows = set(found.outliers.wrong), set(found.outliers.possible)
    right = {row for row in named if not case.wrong[row] and not _beside_a_kink(case, row)}
    clear = set(np.flatnonzero(case.beyond_doubt()).tolist())
    told = [f"right rows named: {sorted(right)}"] if right else []
    if missed := clear - named - open_rows:
        told.append(f"rows missed: {sorted(missed)}")
    told += [
        f"run missed: {rows}" for rows in case.runs if clear & set(rows.tolist()) and not named & set(rows.tolist())
    ]
    return told


def _beside_a_kink(case: MixedTable, row: int) -> bool:
    """Whether a right row stands between wrong rows and a jump of the velocity close by, which may be their end as well."""
    count, near = case.right.size, np.arange(-2 * APART, 2 * APART + 1)
    kinks = [
        0.5 * (a + b) * count / 360.0 for a, b, law in case.joins if (b - a) * count / 360.0 < 2.0 and law != "dwell"
    ]
    far = [abs((row - kink + 0.5 * count) % count - 0.5 * count) for kink in kinks]
    return min(far, default=np.inf) <= 2 * APART and bool(case.wrong[(row + near) % count].any())


def _stroke(case: MixedTable, found: MotionFit, stroke: float) -> list[str]:
    count = case.right.size
    between = max((abs(s.rise) for s in case.motion.segments if s.span_deg < 360.0 / count), default=0.0)
    told, hidden = [], case.wrong & ~case.beyond_doubt()  # rows that nothing tells to be wrong
    allowed = MET * case.error + float(np.abs(case.values - case.right)[hidden].max(initial=0.0))
    left = np.abs(found.residuals[~case.wrong]) * case.table.size  # of a curve shorter than two rows, which notes name
    allowed += float(left[left > SAID * found.error * case.table.size].max(initial=0.0))
    told_by_rows = float(np.ptp(position(case.motion, case.turn + case.angles[~case.wrong])))
    if not told_by_rows - allowed <= found.stroke <= stroke + allowed:
        told.append(f"stroke {found.stroke:.5f} of {stroke:.5f}, {(found.stroke - stroke) / case.error:.1f} errors")
    for each in found.segments:
        if each.law == "dwell":
            x = each.start_deg + np.linspace(0.0, each.span_deg, 101)
            place = np.mod(x * count / 360.0, count)
            off = position(case.motion, case.turn + x) - found.derivative(np.mod(x, 360.0), 0)
            off = np.abs(off)[~(hidden[place.astype(int)] | hidden[np.ceil(place).astype(int) % count])] - between
            if off.max(initial=0.0) > STILL * case.error:
                told.append(f"dwell from {x[0]:.3f} to {x[-1]:.3f} moves by {off.max() / case.error:.1f} errors")
    for start, end, law in case.joins:
        if law == "dwell" and (end - start) * count / 360.0 > 8.0:
            x = np.mod(np.linspace(start + 0.2 * (end - start), end - 0.2 * (end - start), 51), 360.0)
            if found.derivative(x, 1).any():
                told.append(f"no dwell from {start:.3f} to {end:.3f}")
    return told


def _laws_named(case: MixedTable, found: MotionFit) -> list[str]:
    told = []
    for each in found.segments:
        law = SAME.get(each.law, each.law)
        if law in ("dwell", "table"):
            continue
        x = each.start_deg + np.linspace(0.0, each.span_deg, 101)
        middle = (x[50] + case.turn) % 360.0 - case.turn
        true = next((name for a, b, name in case.joins if a <= middle < b), "?")
        hidden = max((abs(s.rise) for s in case.motion.segments if s.span_deg < 360.0 / case.right.size), default=0.0)
        off = np.abs(position(case.motion, case.turn + x) - found.derivative(np.mod(x, 360.0), 0)).max()
        off = (off - hidden) / case.error  # a curve between two rows is not seen
        if law != true:
            told.append(f"{law} named from {x[0]:.2f} to {x[-1]:.2f}, where it is {true}, off by {off:.1f} errors")
        elif off > MET:
            told.append(f"{law} from {x[0]:.2f} to {x[-1]:.2f} is off by {off:.1f} errors")
    return told
