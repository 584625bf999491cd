"""A constant acceleration of a given size over a given span inside a blend, against closed forms and the modified trapezoid."""

import json
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core import project
from core.__main__ import main
from core.blend import BlendError, Request, best, blend, feasible_ranges
from core.design import Motion, NamedCurve, Segment, edited, faults
from core.design.motion_edits import mirrored
from core.errors import DesignError
from core.laws import LAWS
from core.motion import program
from core.output.report.equations import equations_of
from core.study import Study

H, SPAN = 20.0, 120.0


def drd(constant: str = "none", kind: str = "DRD", **settings: float) -> Request:
    return Request(kind, H, 30.0, 30.0 + SPAN, constant, settings)


def sampled(segments: tuple[Segment, ...], degrees: np.ndarray) -> np.ndarray:
    """s, v, a by degrees (3, n) of these curves and a dwell, at angles from their start."""
    rest = 360.0 - sum(s.span_deg for s in segments) - 60.0
    back = Segment(60.0, -sum(s.rise for s in segments), NamedCurve("cycloidal"))
    compiled = program(Motion(0.0, (*segments, back, Segment(rest, 0.0))))
    state = compiled.state(compiled.angles(np.deg2rad(degrees))).displacement
    return np.array([state[k] * 1e3 * (pi / 180.0) ** k for k in range(3)])


# -- closed forms -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("size", "flat"), [(0.008, 20.0), (0.0065, 45.0), (0.01, 1.0)])
def test_size_and_span_determine_a_rise_of_two_curves(size: float, flat: float) -> None:
    """C1-C2 reaches V = 2h/β; A (λ + (β1 - λ) 2/π) = V leaves β1, and h1 = V β1/2."""
    made = blend(drd(flat1=flat, a1=size))
    speed = 2.0 * H / SPAN
    span = flat + (speed / size - flat) * pi / 2.0
    first, second = made.segments
    assert first.span_deg == pytest.approx(span, rel=1e-12)
    assert first.rise == pytest.approx(0.5 * speed * span, rel=1e-12)
    assert (first.span_deg + second.span_deg, first.rise + second.rise) == pytest.approx((SPAN, H), rel=1e-13)
    u = np.linspace(0.5 * (span - flat) + 1e-6, 0.5 * (span + flat) - 1e-6, 7)
    np.testing.assert_allclose(sampled(made.segments, u)[2], size, rtol=1e-12)
    outside = sampled(made.segments, np.array([0.5 * (span - flat) - 0.5, 0.5 * (span + flat) + 0.5]))[2]
    assert (outside < size).all()
    peak = max(size, pi * second.rise / second.span_deg**2)
    assert made.solution.peak_acceleration == pytest.approx(peak, rel=1e-12)


def test_both_halves_constant_over_half_their_span_are_the_modified_trapezoid() -> None:
    """Ramps of an eighth, constant acceleration of a quarter: Neklutin's law, whose peak is 8π/(2 + π) h/β²."""
    quarter, size = SPAN / 4.0, 8.0 * pi / (2.0 + pi) * H / SPAN**2
    degrees = np.linspace(0.0, SPAN, 97)[1:-1]
    law = LAWS["modified-trapezoid"](degrees / SPAN)[:3] * H / SPAN ** np.arange(3)[:, None]
    for given in (
        {"flat1": quarter, "flat3": quarter, "a1": size},
        {"flat1": quarter, "flat3": quarter, "h1": H / 2.0},
    ):
        made = blend(drd(**given))
        assert made.solution.peak_acceleration == pytest.approx(size, rel=1e-12)
        np.testing.assert_allclose(sampled(made.segments, degrees) - law, 0.0, atol=1e-11)


def test_two_sizes_determine_the_speed_between_them() -> None:
    """C1-CV1-C2: both spans follow from V, and Σβ = β, Σh = h from there: V β2 = 2h - V β."""
    made = blend(drd("rise", flat1=20.0, a1=0.01, flat3=10.0, a3=0.009))
    first, middle, last = made.segments
    speed = middle.rise / middle.span_deg
    for segment, flat, size in ((first, 20.0, 0.01), (last, 10.0, 0.009)):
        assert segment.span_deg == pytest.approx(flat + (speed / size - flat) * pi / 2.0, rel=1e-11)
        assert segment.rise == pytest.approx(0.5 * speed * segment.span_deg, rel=1e-11)
    assert speed * middle.span_deg == pytest.approx(2.0 * H - speed * SPAN, rel=1e-11)


def test_the_curves_around_stay_as_they_are_where_only_a_span_is_given() -> None:
    """Half a cycloid keeps h = V β/2 with any constant acceleration in its middle: the card picker's spans stay."""
    made = blend(Request("DRRD", 20.0, 30.0, 330.0, "rise", {"h1": 1.0, "h3": 1.0, "flat1": 10.0}))
    spans = [s.span_deg for s in made.segments]
    np.testing.assert_allclose(spans, (18.8468353936, 169.621518543, 14.8022699040, 96.7293761598), atol=1e-9)
    assert made.segments[0].curve == NamedCurve("c1", flat_fraction=10.0 / spans[0])


def test_a_return_is_the_rise_run_backwards() -> None:
    rise = blend(drd("rise", flat3=20.0, a3=0.01, h1=4.0)).segments
    back = blend(drd("return", "DRD-return", flat1=20.0, a1=0.01, h3=4.0)).segments
    for one, other in zip(rise, reversed(back), strict=True):
        image = mirrored(one)
        assert (image.span_deg, image.rise) == pytest.approx((other.span_deg, other.rise), rel=1e-12)
        assert image.curve.law == other.curve.law
        assert image.curve.flat_fraction == pytest.approx(other.curve.flat_fraction, rel=1e-12)


def test_the_gentlest_beside_a_constant_acceleration() -> None:
    made = best(drd("rise", flat1=20.0, length=30.0), "acceleration")
    for other in (-0.05, 0.05):
        near = blend(drd("rise", flat1=20.0, length=30.0, h1=made.solution.heights[0] + other))
        assert near.solution.peak_acceleration > made.solution.peak_acceleration
    with pytest.raises(BlendError, match="best jerk: cannot be combined with a constant acceleration"):
        best(drd("rise", flat1=20.0, length=30.0), "jerk")


# -- ranges and refusals ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "settings given: none; C1-C2 requires 1 setting; still open: h1"),
        (["--best", "acceleration"], "flat1 = 400 deg is not feasible; feasible: 0 < flat1 < 120 deg"),
    ],
)
def test_a_span_longer_than_all_curves_is_refused_in_one_line(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    request = ["--type", "DRD", "--stroke", "20", "--start", "30", "--end", "150", "--set", "flat1=400"]
    assert main(["blend", *request, *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_ranges() -> None:
    """Shorter than its curve, and no longer than V/A where the size is given; A from a plain half cycloid's to V/λ."""
    speed = 2.0 * H / SPAN
    (flat,) = feasible_ranges(drd(flat1=1.0, a1=0.008), "flat1")
    assert (flat.low, flat.high) == (0.0, pytest.approx(speed / 0.008, rel=1e-9))
    (flat,) = feasible_ranges(drd("rise", h1=4.0, h3=4.0), "flat1")
    assert (flat.high_open, flat.high) == (True, pytest.approx(2.0 * 4.0 / (28.0 / SPAN), rel=1e-12))
    (size,) = feasible_ranges(drd(flat1=20.0), "a1")
    assert (size.high_open, size.high) == (True, pytest.approx(speed / 20.0, rel=1e-9))
    (h3,) = feasible_ranges(drd("rise", flat1=20.0, a1=0.01), "h3")
    assert (h3.low_open, h3.low) == (True, pytest.approx(2.0, rel=1e-9)), (
        "where only the constant acceleration is left of C1"
    )


@pytest.mark.parametrize(
    ("request_", "name", "words"),
    [
        (drd("rise", h1=4, h3=4, flat1=60), "flat1",
         "flat1 = 60 deg is not feasible with h1 = 4, h3 = 4; feasible: 0 < flat1 < 34.2857143 deg"),
        (drd("rise", h3=4, flat1=40, a1=0.01), "flat1", "feasible: 0 < flat1 < 22.0204103 deg"),
        (drd("rise", h3=4, flat1=10, a1=0.1), "a1", "feasible: 0.00514806077 <= a1 < 0.0208695652 mm/deg^2"),
        (drd("rise", h3=4, a1=0.01), "a1", "also give flat1"),
        (drd("rise", h3=4, flat1=0), "flat1", "flat1 = 0: outside its range; allowed: > 0 deg"),
        (drd("rise", "DRRD", h3=4, flat3=10), "flat3", "allowed: flat1 (C1) | flat6 (C4)"),
        (drd("rise", "RRR", h3=4, flat1=10), "flat1", "their curves contain no half cycloid C1 ... C4"),
        (Request("DRD", H, 0, SPAN, "rise", {"flat1": 9}, points=((50, 9),)), "flat1", "cannot be combined with a point"),
    ],
)  # fmt: skip
def test_what_cannot_be(request_: Request, name: str, words: str) -> None:
    with pytest.raises(BlendError) as caught:
        blend(request_)
    assert caught.value.setting == name
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


# -- command and files ------------------------------------------------------------------------------------


def test_the_command_prints_it_and_the_file_keeps_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "design.toml"
    project.save(project.load(Path(__file__).parents[3] / "resources/examples/dwell_rise_dwell.toml"), path)
    words = [
        "blend",
        "--type",
        "DRD",
        "--stroke",
        "20",
        "--start",
        "30",
        "--end",
        "150",
        "--set",
        "flat1=20",
        "--set",
        "a1=0.008",
    ]
    assert main([*words, "--into", str(path)]) == 0 or capsys.readouterr()
    capsys.readouterr()
    assert main(words) == 0
    line = "constant acceleration of C1 0.00800000000 mm/deg^2 over 20.0000000 deg, from 47.0169602 to 67.0169602 deg"
    assert line in capsys.readouterr().out.splitlines()
    assert main([*words, "--json"]) == 0
    rows: list[dict[str, Any]] = json.loads(capsys.readouterr().out)
    assert rows[0]["flat_mm_per_deg2"] == pytest.approx(0.008, rel=1e-12)
    assert "flat_deg" not in rows[1]


def test_a_design_has_it_in_its_file_and_refuses_it_elsewhere(tmp_path: Path) -> None:
    design = project.load(Path(__file__).parents[3] / "resources/examples/dwell_rise_dwell.toml")
    changed = edited(design, "motion.segments[1].flat_fraction", 0.4)
    path = tmp_path / "design.toml"
    project.save(changed, path)
    assert "flat_fraction = 0.4" in path.read_text("utf-8")
    assert project.load(path) == changed
    names = [each.name for each in equations_of(Study(changed))]
    assert "Motion law: half cycloid with constant acceleration" in names
    assert "Motion law: C1 half cycloid" not in names
    wrong = edited(design, "motion.segments[2].flat_fraction", 0.4)
    (fault,) = faults(wrong)
    assert (fault.path, fault.allowed) == ("motion.segments[2].flat_fraction", "0, or c1 ... c4")
    path.write_text(path.read_text("utf-8").replace('law = "cv1"', 'law = "cv1"\nflat_fraction = 0.4'), "utf-8")
    with pytest.raises(DesignError, match="cv1 cannot have a constant acceleration"):
        project.load(path)
