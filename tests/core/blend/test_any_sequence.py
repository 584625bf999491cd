"""Blends of any length: a random sequence, a motion drawn from Yang's equations alone, and its own figures as the request."""

from __future__ import annotations

import json
import random
from itertools import groupby, pairwise
from math import inf, sqrt
from pathlib import Path

import numpy as np
import pytest
from blends import CURVES, NEXT, PEAKS, Motion, same
from sampled import spread

from core.__main__ import main
from core.blend import (
    BlendError,
    Request,
    best,
    blend,
    feasible_ranges,
)
from core.process import resources
from core.project import load

RISING = ("C1", "C2", "C5", "H1", "H2", "H5", "P1", "CV1")
WHOLE = 1e-12


def walk(chance: random.Random) -> tuple[str, ...]:
    """2 ... 8 curves that join, by the table written down in ``blends``."""
    curves = [chance.choice(list(NEXT))]
    for _ in range(chance.randint(1, 7)):
        curves.append(chance.choice(NEXT[curves[-1]].split()))
    return tuple(curves)


def request(curves: tuple[str, ...], start: float, end: float, told: dict[str, float]) -> Request:
    return Request("", 0.0, start, end, settings=told, sequence="-".join(curves))


def speed(curve: str) -> float:
    return max(abs(CURVES[curve](u)[1]) for u in (0.0, 1.0))


def peak(curve: str) -> float:
    return max((abs(CURVES[curve](u)[2]) for u in (0.0, 0.25, 0.5, 0.75, 1.0)), default=0.0)


def motion(curves: tuple[str, ...], numbers: np.ndarray, start: float, span: float) -> Motion:
    """From a height for each curve and a span for each that follows a dwell: the others from speed or acceleration at the join."""
    heights, more = numbers[: len(curves)], numbers[len(curves) :]
    spans: list[float] = []
    for i, (curve, h) in enumerate(zip(curves, heights, strict=True)):
        _, v, a = CURVES[curve](0.0)
        if i and abs(v) > 1e-9:
            before = heights[i - 1] / spans[-1] * speed(curves[i - 1])
            spans.append(speed(curve) * h / before)
        elif i and abs(a) > 1e-9:
            before = heights[i - 1] / spans[-1] ** 2 * abs(CURVES[curves[i - 1]](1.0)[2])
            spans.append(sqrt(abs(a) * h / before))
        else:
            spans.append(more[i])
    scale = span / sum(spans)
    return Motion(curves, tuple(heights), tuple(b * scale for b in spans), start)


def figures(made: Motion) -> dict[str, float]:
    """All that can be set of it."""
    result: dict[str, float] = {}
    counts = {"rise": 0, "return": 0}
    angle = made.start
    for name, run in groupby(range(len(made.curves)), key=lambda i: "rise" if made.curves[i] in RISING else "return"):
        counts[name] += 1
        result[f"{name}{counts[name]}"] = sum(made.heights[i] for i in run)
    for i, (curve, h, b) in enumerate(zip(made.curves, made.heights, made.spans, strict=True), 1):
        angle += b
        result |= {f"h{i}": h, f"span{i}": b}
        result |= {f"v{i}": speed(curve) * h / b} if speed(curve) > 1e-9 else {}
        result |= {f"a{i}": peak(curve) * h / b**2} if peak(curve) > 1e-9 else {}
        result |= {f"end{i}": angle} if i < len(made.curves) else {}
    return result


def drawn(seed: int) -> tuple[Motion, dict[str, float]]:
    """A motion and as many of its figures as determine it hereabouts."""
    chance = random.Random(seed)
    curves, start, span = walk(chance), chance.uniform(0.0, 100.0), chance.uniform(20.0, 260.0)
    numbers = np.array([chance.uniform(0.3, 3.0) for _ in range(2 * len(curves))])
    made = motion(curves, numbers, start, span)
    told = figures(made)
    shaken = [numbers * (1.0 + 1e-6 * np.eye(numbers.size)[i]) for i in range(numbers.size)]
    names = chance.sample(sorted(told), k=len(told))
    if seed % 2:  # sums, which are not linear in the logarithms
        names.sort(key=lambda name: not name.startswith(("rise", "return", "end")))
    others = [figures(motion(curves, each, start, span)) for each in shaken]
    rows = {n: np.array([(each[n] / told[n] - 1.0) / 1e-6 for each in others]) for n in names}
    kept: list[str] = []
    for name in names:
        rank = np.array([rows[n] / max(np.linalg.norm(rows[n]), 1e-3) for n in [*kept, name]])
        if np.linalg.svd(rank, compute_uv=False)[-1] > 1e-3:
            kept.append(name)
    return made, {name: told[name] for name in kept}


def check(seed: int) -> None:
    made, told = drawn(seed)
    end = made.start + sum(made.spans)
    answer = blend(request(made.curves, made.start, end, told))
    parts = answer.segments
    got = Motion(
        tuple(s.curve.law.upper() for s in parts),
        tuple(abs(s.rise) for s in parts),
        tuple(s.span_deg for s in parts),
        made.start,
    )
    assert got.curves == made.curves
    assert [s.rise > 0.0 for s in parts] == [c in RISING for c in got.curves]
    assert abs(sum(got.spans) - sum(made.spans)) <= WHOLE * sum(made.spans)
    reached = figures(got)
    for name, value in told.items():
        assert same(reached[name], value, 1e-11), (seed, name)
    for k in (1, 2):
        ends = [(got.at(i, 0.0)[k], got.at(i, 1.0)[k]) for i in range(len(parts))]
        largest = max(abs(got.at(i, u / 16)[k]) for i in range(len(parts)) for u in range(17))
        for (_, before), (after, _) in pairwise(ends):
            assert abs(before - after) <= WHOLE * largest, (seed, k)
    like = {"C2": "C1", "C3": "C1", "C4": "C1", "C6": "C5", "H6": "H5", "P2": "P1", "CV1": "", "CV2": ""}
    like |= {"H2": "H1", "H3": "H1", "H4": "H1"}
    rows = zip(made.curves, made.heights, made.spans, strict=True)
    gentle = max((PEAKS.get(like.get(c, c), 0.0) * h / b**2 for c, h, b in rows), default=inf)
    assert answer.solution.peak_acceleration <= gentle * (1.0 + 1e-9), (seed, "another motion is gentler")


@pytest.mark.parametrize("seed", spread(range(12), 3))
def test_any_sequence_is_solved_from_its_own_figures(seed: int) -> None:
    check(seed)


@pytest.mark.fuzz
def test_five_hundred_sequences() -> None:
    for seed in range(1000, 1500):
        check(seed)


# -- against the sequences of the four types --------------------------------------------------------------

PICKER = ("C1", "CV1", "H2", "P2")
STROKES = {"rise1": 20.0, "return1": 20.0}


def test_a_sequence_of_a_type_gives_what_the_type_gives() -> None:
    got = blend(request(PICKER, 30.0, 330.0, {**STROKES, "h1": 1.5, "h3": 4.0}))
    other = blend(Request("DRRD", 20.0, 30.0, 330.0, "rise", {"h1": 1.5, "h3": 4.0}, sequence="-".join(PICKER)))
    assert got.solution.spans == pytest.approx(other.solution.spans, rel=1e-12)
    gentlest = best(request(PICKER, 30.0, 330.0, {**STROKES, "span2": 60.0}), "acceleration")
    other = best(
        Request("DRRD", 20.0, 30.0, 330.0, "rise", {"length": 60.0}, sequence="-".join(PICKER)), "acceleration"
    )
    assert gentlest.solution.peak_acceleration == pytest.approx(other.solution.peak_acceleration, rel=1e-9)


@pytest.mark.stress
@pytest.mark.parametrize(("name", "of_the_type"), [("h3", "h3"), ("v1", "vcv")])
def test_ranges_are_those_of_the_type(name: str, of_the_type: str) -> None:
    (got,) = feasible_ranges(request(PICKER, 30.0, 330.0, {**STROKES, "h1": 1.5}), name)
    (known,) = feasible_ranges(
        Request("DRRD", 20.0, 30.0, 330.0, "rise", {"h1": 1.5}, sequence="-".join(PICKER)), of_the_type
    )
    assert (got.low, got.high) == pytest.approx((known.low, known.high), rel=1e-9, abs=1e-12)


def test_over_the_whole_turn_the_last_curve_joins_the_first() -> None:
    curves = ("H1", "H2", "H3", "H4", "H1", "H2", "H3", "H4")
    told = {"rise1": 20.0, "return1": 12.0, "rise2": 10.0, "return2": 18.0}
    b = best(request(curves, 0.0, 360.0, told), "acceleration").solution
    a = [np.pi**2 / 4.0 * h / s**2 for h, s in zip(b.heights, b.spans, strict=True)]
    assert a[0] == pytest.approx(a[-1], rel=1e-12)


# -- by command -------------------------------------------------------------------------------------------

ANGLES = ("--start", "30", "--end", "330")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (
            ["C5-C6"],
            "C5-C6 requires 3 settings (4 heights and spans, 0 joins and the total span): 3 missing; still open:",
        ),
        (["C5-C6", "--stroke", "20", "--return-stroke", "9"], "1 missing; still open: span1, span2, a1, a2, end1"),
        (
            ["C5-C6", "--stroke", "20", "--set", "return1=9", "--set", "h2=8"],
            "h2 = 8 mm: already determined by return1: h2 = 9; instead set",
        ),
        (["C5-C6", "--set", "v1=2"], "v1: no setting of C5-C6; allowed: rise1 | return1 | h1"),
        (["C5-C6", "--set", "h1=-2"], "h1 = -2: outside its range; allowed: h1 > 0 mm"),
        (["C5-C6", "--point", "60=2"], "--point: only of the four types"),
    ],
)
def test_what_is_missing_or_too_much_is_said_in_one_line(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["blend", "--sequence", *words, *ANGLES]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1


def test_an_infeasible_setting_says_its_range() -> None:
    told = {"rise1": 20.0, "return1": 9.0, "span1": 350.0}
    words = r"^span1 = 350 deg is not feasible with rise1 = 20 mm, return1 = 9 mm; feasible: 0 < span1 < 300 deg$"
    with pytest.raises(BlendError, match=words) as caught:
        blend(request(("C5", "C6"), 30.0, 330.0, told))
    assert caught.value.allowed == pytest.approx((0.0, 300.0), rel=1e-9)


@pytest.mark.stress
def test_a_longer_blend_goes_into_a_design_and_is_ranked_there(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "design.toml"
    path.write_bytes((resources() / "examples" / "card_picker.toml").read_bytes())
    words = ["blend", "--sequence", "C1-H2-H3-C4-P1-P2", *ANGLES, "--stroke", "20", "--return-stroke", "20"]
    words += ["--set", "rise2=8", "--set", "return1=20", "--set", "return2=8", "--best", "acceleration"]
    assert main([*words, "--rank", str(path)]) == 0
    assert "C1-H2-H3-C4-P1-P2" in capsys.readouterr().out
    assert main([*words, "--into", str(path)]) == 0
    laws = [segment.curve.law for segment in load(path).drive.motion.segments]
    assert [law for law in laws if law != "dwell"] == ["c1", "h2", "h3", "c4", "p1", "p2"]


@pytest.mark.parametrize(("curve", "start_mm"), [("CV1", 0.0), ("CV2", 10.0)])
@pytest.mark.parametrize("goal", [(), ("--best", "acceleration")])
def test_a_constant_velocity_alone_has_no_acceleration(
    curve: str, start_mm: float, goal: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["blend", "--sequence", curve, "--stroke", "10", "--start", "20", "--end", "90", *goal]
    assert main(words) == 0
    assert "peak acceleration 0 mm/deg^2" in capsys.readouterr().out.splitlines()
    assert main([*words, "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)
    assert row["start_mm"] == pytest.approx(start_mm, rel=WHOLE)
    assert (abs(row["rise_mm"]), row["span_deg"]) == pytest.approx((10.0, 70.0), rel=WHOLE)
