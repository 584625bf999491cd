"""Lobes of valve trains: typed in files, against quadrature of their acceleration and a root search of their own."""

import math
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import fsolve
from valve_trains import FLAT_TAPPET

from core.__main__ import main
from core.design import ComputedCurve, Motion, NamedCurve, Segment, all_paths, edited, entries, faults, get, put
from core.design.edits import rescaled
from core.design.lobe import lobe_sides
from core.errors import DesignError
from core.laws import Piece, Sine
from core.motion import Angles, CompiledMotion, findings, program
from core.motion.tables import lobe_to_segments
from core.project import dumps, load, loads
from core.study import Study, extremes_of, many

REST = (
    "\n"
    + FLAT_TAPPET
    + """[shaft]
rotation = "ccw"
speed_rpm = 1000.0
[loads]
follower_mass_kg = 0.1
spring_rate_n_per_mm = 30.0
preload_n = 300.0
"""
)
A = "lift_mm = 9.0\nramp_mm = 0.2\nramp_runup_deg = 8.0\n"
ROWS = "duration = [[0.15, 270.0], [1.27, 210.0]]\n"
B = A + "flank_flat = 0.5\nnose_flat = 0.3\n"
CLOSING = "[motion.lobe.closing]\nramp_mm = 0.25\nramp_mm_per_deg = 0.007\nto_nose = [[1.27, 108.0]]\n"


def text(lobe: str, rest: str = REST) -> str:
    return f'format = 1\nname = "Lobe"\n[motion]\nstart_mm = 0.0\n[motion.lobe]\n{lobe}{rest}'


def lobed(lobe: str) -> CompiledMotion:
    return program(loads(text(lobe)).drive.motion)


# -- the same by hand: acceleration in sections, integrated by quadrature ----------------------------------

X, W = np.polynomial.legendre.leggauss(40)


def sections(b: float, c: float, form: dict) -> list:
    """Width and acceleration of each section of an opening side, the last two but for one factor each."""
    a, vr, hr = (form[name] for name in ("ramp_runup_deg", "ramp_mm_per_deg", "ramp_mm"))
    f, g = form["flank_flat"], form["nose_flat"]
    ramp = (hr - vr * a / 2.0) / vr
    q, n = (1.0 - f) * b / 2.0, (1.0 - g) * c
    rows = [
        (a, lambda x: np.pi * vr / (2.0 * a) * np.sin(np.pi * x / a)),
        (ramp, lambda x: 0.0 * x),
        (q, lambda x: np.sin(np.pi / 2.0 * x / q) if q else x),
        (f * b, lambda x: 1.0 + 0.0 * x),
        (q, lambda x: np.cos(np.pi / 2.0 * x / q) if q else x),
        (n, lambda x: -np.sin(np.pi / 2.0 * x / n) if n else x),
        (g * c, lambda x: -1.0 + 0.0 * x),
    ]
    # velocity 0 and the whole lift at the nose give the peaks of flank and nose
    total = sum(width for width, _ in rows)
    moments, ends, at = np.zeros((2, 2)), np.zeros(2), 0.0
    for k, (width, function) in enumerate(rows):
        x = width * (X + 1.0) / 2.0
        values = width / 2.0 * W * function(x)
        pair = np.array([values.sum(), (values * (total - at - x)).sum()])
        if k < 2:
            ends += pair
        else:
            moments[:, 0 if k < 5 else 1] += pair
        at += width
    flank, nose = np.linalg.solve(moments, np.array([0.0, form["lift_mm"]]) - ends)
    peaks = (1.0, 1.0, flank, flank, flank, nose, nose)
    return [(width, peak, function) for (width, function), peak in zip(rows, peaks, strict=True)]


def by_quadrature(rows: list, x: float) -> tuple[float, float, float]:
    """Lift, velocity, acceleration of a side at x from its start."""
    lift = velocity = acceleration = at = 0.0
    for width, peak, function in rows:
        part = min(max(x - at, 0.0), width)
        t = part * (X + 1.0) / 2.0
        values = part / 2.0 * W * peak * function(t)
        velocity += values.sum()
        lift += (values * (x - at - t)).sum()
        if 0.0 <= x - at < width:
            acceleration = float(peak * function(np.array([x - at]))[0])
        at += width
    return lift, velocity, acceleration


def height_error(rows: list, height: float, crank: float) -> float:
    span = sum(width for width, *_ in rows)
    return by_quadrature(rows, span - crank / 4.0)[0] - height


def greatest_velocity(rows: list) -> float:
    return by_quadrature(rows, sum(width for width, *_ in rows[:5]))[1]


def searched(lobe: str) -> list:
    """Sections of the opening side with the typed values, those of least acceleration of the flank."""
    form = {"ramp_mm": 0.1, "ramp_mm_per_deg": 0.01, "ramp_runup_deg": 5.0, "flank_flat": 0.0, "nose_flat": 0.0}
    form |= tomllib.loads(lobe)
    rows = [(h, d) for h, d in form.get("duration", [])] + [(h, 2.0 * d) for h, d in form.get("to_nose", [])]

    def errors(spans: np.ndarray) -> list[float]:
        side = sections(*spans, form)
        result = [height_error(side, *row) for row in rows]
        velocity = greatest_velocity(side)
        for key, value in (
            ("velocity_mm_per_deg", velocity),
            ("acceleration_mm_per_deg2", side[2][1]),
            ("nose_acceleration_mm_per_deg2", side[6][1]),
        ):
            result += [value / form[key] - 1.0] if key in form else []
        return result

    found = []
    for b in (5.0, 10.0, 20.0, 30.0, 45.0):
        for c in (30.0, 50.0, 65.0):
            spans, *_ = fsolve(errors, [b, c], full_output=True, xtol=1e-14)
            if min(spans) > 0.0 and max(map(abs, errors(spans))) < 1e-11:
                found.append(sections(*spans, form))
    return min(found, key=lambda side: side[2][1])


CASES = {
    "both durations above the ramp": "lift_mm = 7.75\nduration = [[0.1524, 268.0], [1.27, 218.0]]\n",
    "one duration on the ramp": A + ROWS,
    "one duration in the run-up": A + "duration = [[0.02, 323.0], [1.27, 210.0]]\n",
    "duration and velocity": B + "duration = [[1.27, 210.0]]\nvelocity_mm_per_deg = 0.24\n",
    "duration and flank": A + "duration = [[1.27, 210.0]]\nacceleration_mm_per_deg2 = 0.03\n",
    "duration and nose": A + "duration = [[1.27, 210.0]]\nnose_acceleration_mm_per_deg2 = 0.007\n",
    "to the nose": A + "to_nose = [[1.27, 105.0], [0.15, 135.0]]\n",
    "velocity and nose": B + "velocity_mm_per_deg = 0.24\nnose_acceleration_mm_per_deg2 = 0.0062\n",
    "flank and nose": A + "acceleration_mm_per_deg2 = 0.03\nnose_acceleration_mm_per_deg2 = 0.007\n",
    "velocity and flank": A + "velocity_mm_per_deg = 0.23\nacceleration_mm_per_deg2 = 0.03\n",
    "flank of constant acceleration": A + ROWS + "flank_flat = 1.0\n",
    "nose of constant acceleration": A + ROWS + "nose_flat = 1.0\n",
}


@pytest.mark.parametrize("lobe", CASES.values(), ids=CASES)
def test_a_lobe_is_the_quadrature_of_its_acceleration(lobe: str) -> None:
    """Lift, velocity and acceleration at any angle, to 1e-12 of their size; the values by an own search."""
    side, motion = searched(lobe), lobed(lobe)
    span = sum(width for width, *_ in side)
    ours = motion.motion.segments[1].span_deg
    assert ours == pytest.approx(span, abs=1e-9)
    rng = np.random.default_rng(5)
    x = np.sort(rng.uniform(0.0, span, 60))
    expected = np.array([by_quadrature(side, float(each)) for each in x])
    for sign in (-1.0, 1.0):  # the closing side is the mirror image
        state = motion.state(motion.angles(np.deg2rad(180.0 + sign * (span - x))))
        got = (state.y[:3] / 1e-3 * np.deg2rad(1.0) ** np.arange(3)[:, None]).T
        got[:, 1] *= -sign
        size = np.abs(expected).max(axis=0)
        assert (np.abs(got - expected).max(axis=0) <= 1e-12 * size).all()


def durations(motion: CompiledMotion, height: float) -> float:
    """Crank degrees over which the lift exceeds a height [mm], by bisection of the compiled motion."""

    def lift(deg: float) -> float:
        return 1e3 * float(motion.state(motion.angles(np.array([math.radians(deg)]))).y[0, 0])

    ends = []
    for low, high in ((0.0, 180.0), (360.0 - 1e-9, 180.0)):
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if lift(middle) > height else (middle, high)
        ends.append(0.5 * (low + high))
    return 2.0 * (ends[1] - ends[0])


def test_the_reference_lobes() -> None:
    """Lobe A, lobe B and the two usual cards, with the figures of an independent calculation."""
    motion = lobed(A + ROWS)
    side, _ = lobe_sides(motion.motion.lobe)
    assert (side.flank, side.nose) == pytest.approx((11.1412733784, 51.3587266216), abs=1e-10)
    assert side.velocity == pytest.approx(0.2285097089, abs=1e-10)
    assert side.acceleration == pytest.approx(0.0308074523, abs=1e-10)
    assert side.nose_acceleration == pytest.approx(0.0069889235, abs=1e-10)
    assert motion.motion.segments[1].span_deg == pytest.approx(86.5, abs=1e-12)
    for height, degrees in {
        0.15: 270.0, 1.27: 210.0, 0.1016: 289.36, 0.1524: 269.04, 0.508: 226.7061947869, 1.0: 215.0307814250, 2.5: 188.3834389258,
    }.items():  # fmt: skip
        assert durations(motion, height) == pytest.approx(degrees, abs=1e-9)
    side, _ = lobe_sides(lobed(B + "duration = [[1.27, 210.0]]\nvelocity_mm_per_deg = 0.24\n").motion.lobe)
    assert (side.flank, side.nose) == pytest.approx((9.9020031413, 51.7967326079), abs=1e-10)
    cards = (
        ("lift_mm = 7.75\nduration = [[0.1524, 268.0], [1.27, 218.0]]\n", 20.773517, 49.897368),
        ("lift_mm = 8.0\nduration = [[0.1016, 276.0], [1.27, 228.0]]\n", 12.345711, 56.813904),
    )
    for lobe, flank, nose in cards:
        side, _ = lobe_sides(lobed(lobe).motion.lobe)
        assert (side.flank, side.nose) == pytest.approx((flank, nose), abs=1e-6)


def test_a_closing_side_of_its_own() -> None:
    """Its ramp, its angle to the nose; the acceleration of the nose is that of the opening side, so nothing jumps."""
    motion = lobed(A + ROWS + CLOSING)
    opening, closing = lobe_sides(motion.motion.lobe)
    assert (closing.flank, closing.nose) == pytest.approx((19.9139423171, 48.0876662762), abs=1e-10)
    assert closing.velocity == pytest.approx(0.2139558230, abs=1e-10)
    assert closing.nose_acceleration == pytest.approx(opening.nose_acceleration, rel=1e-14)
    at = motion.state(motion.angles(np.array([np.deg2rad(180.0 + 54.0)]))).y[0, 0]
    assert 1e3 * at == pytest.approx(1.27, abs=1e-12)
    assert findings(motion) == []
    assert motion.motion.segments[2].span_deg == pytest.approx(closing.span, abs=1e-12)


@pytest.mark.parametrize("flats", ["", "flank_flat = 0.4\nnose_flat = 0.7\n"])
def test_a_closing_side_is_the_quadrature_of_its_acceleration(flats: str) -> None:
    """By an own search of the side that reaches 1.27 mm in 108° with the nose's acceleration of the opening side."""
    motion = lobed(A + ROWS + CLOSING + flats)
    opening, closing = lobe_sides(motion.motion.lobe)
    own = CLOSING.partition("]\n")[2] + flats
    side = searched(
        f"lift_mm = 9.0\nramp_runup_deg = 8.0\nnose_acceleration_mm_per_deg2 = {opening.nose_acceleration!r}\n{own}"
    )
    span = sum(width for width, *_ in side)
    assert closing.span == pytest.approx(span, abs=1e-9)
    x = np.linspace(0.01, span - 0.01, 40)
    expected = np.array([by_quadrature(side, float(each)) for each in x])
    state = motion.state(motion.angles(np.deg2rad(180.0 + span - x)))
    got = (state.y[:3] / 1e-3 * np.deg2rad(1.0) ** np.arange(3)[:, None]).T * [1.0, -1.0, 1.0]
    assert (np.abs(got - expected).max(axis=0) <= 1e-12 * np.abs(expected).max(axis=0)).all()


SMOOTH = {name: lobe for name, lobe in CASES.items() if "constant" not in name} | {"closing": A + ROWS + CLOSING}


@pytest.mark.parametrize("lobe", SMOOTH.values(), ids=SMOOTH)
def test_the_acceleration_is_continuous(lobe: str) -> None:
    """At every end of a piece lift, velocity and acceleration from both sides agree to 1e-12 of their largest values."""
    motion = lobed(lobe)
    pieces = np.arange(motion.starts.size)
    begin = motion.state(Angles(motion.starts, pieces)).y
    end = motion.state(Angles(motion.ends, pieces)).y
    jumps = np.abs(np.roll(begin, -1, axis=1) - end)[:3]
    assert (jumps.max(axis=1) <= 1e-12 * np.abs(begin[:3]).max(axis=1)).all()
    assert findings(motion) == []
    signs = motion.velocity_signs[np.abs(motion.velocity_signs) > 0]
    assert signs.tolist() == sorted(signs.tolist(), reverse=True), "rises up to the nose, and returns from there"


def test_a_computed_curve_is_divided_where_its_sines_turn() -> None:
    """A wave sin(2π u) turns at a quarter and at three quarters; so does one with a slope less than its own."""
    for slope in (0.0, 3.0):
        curve = ComputedCurve((Piece(0.0, (0.0, slope), (Sine(1.0, 2.0 * math.pi),)),))
        motion = program(Motion(0.0, (Segment(180.0, slope, curve), Segment(180.0, -slope, NamedCurve("cycloidal")))))
        turn = math.acos(-slope / (2.0 * math.pi))
        assert motion.starts[:3] == pytest.approx([0.0, turn / 2.0, math.pi - turn / 2.0], abs=1e-12)
        assert motion.velocity_signs[:3].tolist() == [1.0, -1.0, 1.0]


# advertised at 0.006 in, at 0.050 in, lobe lift in inch, as the catalogue of a maker of camshafts prints them
CARDS = [
    (252, 206, 0.283), (260, 212, 0.293), (268, 218, 0.303), (280, 230, 0.320), (292, 244, 0.334),
    (256, 212, 0.298), (262, 218, 0.309), (268, 224, 0.318), (274, 230, 0.325), (284, 240, 0.338),
]  # fmt: skip


@pytest.mark.parametrize(("advertised", "at_050", "lift"), CARDS)
def test_a_printed_card_has_a_lobe_on_the_default_ramp(advertised: float, at_050: float, lift: float) -> None:
    lobe = f"lift_mm = {25.4 * lift}\nduration = [[0.1524, {advertised}.0], [1.27, {at_050}.0]]\n"
    motion = lobed(lobe)
    side, _ = lobe_sides(motion.motion.lobe)
    assert 10.0 < side.flank < 40.0
    assert durations(motion, 0.1524) == pytest.approx(advertised, abs=1e-9)
    assert durations(motion, 1.27) == pytest.approx(at_050, abs=1e-9)


# -- files and fields ---------------------------------------------------------------------------------------


def test_a_file_keeps_what_was_typed() -> None:
    design = loads(text(A + ROWS + CLOSING))
    written = dumps(design)
    table = tomllib.loads(written)["motion"]
    assert table == {
        "start_mm": 0.0,
        "lobe": {
            "lift_mm": 9.0,
            "duration": [[0.15, 270.0], [1.27, 210.0]],
            "ramp_mm": 0.2,
            "ramp_runup_deg": 8.0,
            "closing": {"to_nose": [[1.27, 108.0]], "ramp_mm": 0.25, "ramp_mm_per_deg": 0.007},
        },
    }
    assert loads(written) == design


def test_a_drive_of_several_has_a_lobe() -> None:
    motion = f'[[drives]]\nname = "{{}}"\n[drives.motion]\nstart_mm = 0.0\n[motion.lobe]\n{A + ROWS + CLOSING}'
    follower, _, shaft = REST.partition("[shaft]")
    shaft, _, loads_text = shaft.partition("[loads]")
    drive = f"{motion}{follower}[loads]{loads_text}"
    tables = re.sub(r"(?m)^\[(motion|follower|cam|loads)", r"[drives.\1", drive.format("in") + drive.format("out"))
    listed = loads(f'format = 1\nname = "Two"\n[shaft]{shaft}{tables}')
    assert loads(dumps(listed)) == listed
    assert listed.drives[1].motion == loads(text(A + ROWS + CLOSING)).drive.motion
    assert "drives[1].motion.lobe.ramp_mm" in list(all_paths(listed))


def test_its_values_are_fields() -> None:
    """Paths that are varied, that have tolerances and that edits name; those of its segments are none."""
    design = loads(text(A + ROWS + CLOSING))
    paths = [entry.path for entry in entries(design, "motion")]
    for path in (
        "lift_mm", "duration[1].crank_deg", "ramp_mm", "ramp_mm_per_deg", "ramp_runup_deg", "flank_flat", "nose_flat",
        "nose_at_deg", "closing.ramp_mm", "closing.to_nose[0].crank_deg", "velocity_mm_per_deg",
    ):  # fmt: skip
        assert f"motion.lobe.{path}" in paths
    assert not any("segments" in path for path in all_paths(design))
    tolerance = '[[tolerances]]\nfield = "motion.lobe.lift_mm"\nplus = 0.02\nminus = 0.02\n'
    assert loads(text(A + ROWS) + tolerance).tolerances[0].field == "motion.lobe.lift_mm"
    changed = edited(design, "motion.lobe.duration[1].crank_deg", 212.0)
    assert faults(changed) == []
    assert durations(
        program(edited(loads(text(A + ROWS)), "motion.lobe.duration[1].crank_deg", 212.0).drive.motion), 1.27
    ) == (pytest.approx(212.0, abs=1e-9))
    assert put(changed, "motion.lobe.duration[1].crank_deg", 210.0) == design
    assert get(edited(design, "motion.stroke_mm", 9.5), "motion.lobe.lift_mm") == 9.5
    inch = rescaled(design, 2.0)
    assert get(inch, "motion.lobe.lift_mm") == 18.0
    assert get(inch, "motion.lobe.duration[0].at_mm") == 0.3
    y = [program(d.drive.motion).state(program(d.drive.motion).angles(np.array([2.5]))).y[:, 0] for d in (design, inch)]
    assert y[1] == pytest.approx(2.0 * y[0], rel=1e-12)


def test_many_lobes_are_those_one_by_one() -> None:
    design, path = loads(text(A + ROWS)), "motion.lobe.duration[1].crank_deg"
    values = np.array([208.0, 210.0, 213.0, 100.0])
    result = many(design, {path: values}, ["velocity_mm_s:max", "contact_force_n:max"])
    sides = [lobe_sides(put(design, path, value).drive.motion.lobe)[0] for value in values[:3].tolist()]
    assert result.value["velocity_mm_s:max"][:3] == pytest.approx([6000.0 * side.velocity for side in sides], rel=1e-12)
    assert result.reason.tolist()[:3] == ["", "", ""]
    assert result.reason[3], "no lobe has this duration"


@pytest.mark.parametrize("nose", [0.0, 40.0, 86.5, 273.5, 350.0, 360.0])
def test_a_lobe_may_extend_beyond_cam_angle_0(nose: float) -> None:
    """It is the lobe at 180 degrees, shifted; the start is the position off the lobe."""
    shifted, lobe = lobed(A + ROWS + f"nose_at_deg = {nose}\n"), lobed(A + ROWS)
    theta = np.linspace(0.0, 2.0 * np.pi, 1001)
    y, z = (each.state(each.angles(t)).y for each, t in ((shifted, theta), (lobe, theta - np.deg2rad(nose - 180.0))))
    assert (np.abs(y - z).max(axis=1)[:3] <= 1e-12 * np.abs(z).max(axis=1)[:3]).all()
    assert findings(shifted) == []
    assert faults(loads(text(A + ROWS + f"nose_at_deg = {nose}\n"))) == []
    assert sum(segment.span_deg for segment in shifted.motion.segments) == pytest.approx(360.0, abs=1e-12)


def test_a_lobe_becomes_ordinary_segments() -> None:
    for lobe in (A + ROWS, B + ROWS + CLOSING, A + ROWS + "nose_at_deg = 0.0\n", A + ROWS + "nose_at_deg = 40.0\n"):
        design = loads(text(lobe))
        plain = loads(dumps(lobe_to_segments(design)))
        assert plain.drive.motion.lobe is None
        ours, theirs = program(design.drive.motion), program(plain.drive.motion)
        theta = np.linspace(0.0, 2.0 * np.pi, 4001)
        y, z = (each.state(each.angles(theta)).y for each in (ours, theirs))
        assert np.abs(y[0] - z[0]).max() <= 1e-9 * 9e-3
        assert findings(theirs) == []
    with pytest.raises(DesignError, match="typed"):
        lobe_to_segments(plain)


def test_the_command_motion_shifts_a_lobe_and_writes_its_segments(tmp_path: Path) -> None:
    path, out = tmp_path / "lobe.toml", tmp_path / "motion.toml"
    path.write_text(text(A + ROWS), "utf-8")
    assert main(["motion", str(path), "--shift", "200", "--out", str(out)]) == 0
    assert get(load(out), "motion.lobe.nose_at_deg") == 20.0
    assert main(["motion", str(path), "--segments", "--into", str(path)]) == 0
    motion = load(path).drive.motion
    assert [segment.curve.law for segment in motion.segments][4:8] == ["table", "h2", "h3", "table"]
    assert main(["motion", str(path), "--segments", "--out", str(out)]) == 2, "there is no lobe left"


@pytest.mark.parametrize(
    ("lobe", "field", "words"),
    [
        (A + "duration = [[1.27, 210.0]]\n", "motion.lobe", "1 value besides"),
        (A + ROWS + "velocity_mm_per_deg = 0.2\n", "motion.lobe", "3 values besides"),
        (A + "duration = [[0.15, 270.0], [9.0, 210.0]]\n", "motion.lobe.duration[1]", "at or above the lift"),
        (A + "duration = [[0.15, 210.0], [1.27, 270.0]]\n", "motion.lobe.duration[1]", "not less than at 0.15 mm"),
        (A + "duration = [[0.05, 270.0], [0.15, 250.0]]\n", "motion.lobe.duration[1]", "on the ramp"),
        (A + ROWS + "ramp_mm_per_deg = 0.06\n", "motion.lobe.ramp_runup_deg", "higher than the ramp"),
        (A + "duration = [[0.15, 690.0], [1.27, 600.0]]\n", "motion.lobe", "longer than the turn"),
        (A + ROWS + "nose_at_deg = 400.0\n", "motion.lobe.nose_at_deg", "0 ... 360"),
        (A + ROWS + '[[motion.segments]]\nlaw = "dwell"\nspan_deg = 360.0\n', "motion.segments", "motion.lobe"),
        (A.replace("0.2", "9.5") + ROWS, "motion.lobe.ramp_mm", "lower than the lift"),
        (A + ROWS + CLOSING.replace("]]", "], [0.2, 130.0]]"), "motion.lobe.closing.to_nose", "one row"),
        (A + ROWS + "lifts = 3.0\n", "motion.lobe.lifts", "unknown key"),
    ],
)
def test_bad_values_are_one_line_with_the_field(
    lobe: str, field: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text(lobe), "utf-8")
    assert main(["check", str(path)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1, lines
    assert f"{field}:" in lines[0] or f"{field} =" in lines[0]
    assert words in lines[0]


def ends(line: str) -> tuple[float, float]:
    low, _, high = line.partition("; allowed: ")[2].rpartition(" ")[0].partition(" ... ")
    return float(low), float(high)


@pytest.mark.parametrize(
    ("lobe", "path"),
    [
        (
            "lift_mm = 7.75\nramp_mm = 0.25\nduration = [[0.1524, 268.0], [1.27, 218.0]]\n",
            "motion.lobe.duration[1].crank_deg",
        ),
        (A + "duration = [[1.27, 210.0]]\nvelocity_mm_per_deg = 0.6\n", "motion.lobe.velocity_mm_per_deg"),
        (
            A + "duration = [[1.27, 210.0]]\nnose_acceleration_mm_per_deg2 = 0.001\n",
            "motion.lobe.nose_acceleration_mm_per_deg2",
        ),
        (A + ROWS + CLOSING.replace("108.0", "30.0"), "motion.lobe.closing.to_nose[0].crank_deg"),
    ],
)
def test_a_value_that_no_lobe_has_names_the_range_that_serves(lobe: str, path: str) -> None:
    """Both ends of the range have a lobe, and a little beyond there is none."""
    with pytest.raises(DesignError) as refused:
        loads(text(lobe))
    (fault,) = refused.value.faults
    assert path.startswith(fault.path)
    low, high = ends(str(fault))
    broken = loads(text(lobe), unfinished=True)
    for end, beyond in ((low, -1.0), (high, 1.0)):
        assert faults(put(broken, path, end)) == []
        assert [f.path for f in faults(put(broken, path, end + beyond * 2e-3 * (high - low)))]


def test_a_ramp_that_serves_is_named_where_no_other_value_does() -> None:
    """A duration shorter than the ramp's own span."""
    with pytest.raises(DesignError) as refused:
        loads(text("lift_mm = 9.0\nramp_mm = 3.0\nduration = [[0.15, 270.0], [3.5, 165.0]]\n"))
    (fault,) = refused.value.faults
    assert fault.path == "motion.lobe.ramp_mm"
    low, high = ends(str(fault))
    for ramp in (low, high):
        loads(text(f"lift_mm = 9.0\nramp_mm = {ramp}\nduration = [[0.15, 270.0], [3.5, 165.0]]\n"))


@pytest.mark.parametrize("follower", ["flat", "roller"])
def test_every_command_works_on_a_lobe(follower: str, tmp_path: Path) -> None:
    rest = (
        REST
        if follower == "flat"
        else REST.replace('"flat"', '"roller"').replace("18.0", "18.0\nroller_radius_mm = 9.0")
    )
    path = tmp_path / "lobe.toml"
    path.write_text(text(A + ROWS, rest), "utf-8")
    for command in (
        ["check", str(path)],
        ["export", str(path), "--out", str(tmp_path / "out"), "--samples", "720"],
        ["profile", str(path), "--out", str(tmp_path / "cam.dxf")],
        ["report", str(path), "--out", str(tmp_path / "report.html")],
        ["contact", str(path)],
    ):
        assert main(command) == 0, command
    curvature = extremes_of(Study(load(path)), "cam")["profile_curvature"]
    if follower == "flat":  # the radius of the profile is Br + s + s'': least at the nose
        assert 1e3 / curvature.high.value == pytest.approx(4.0567173, abs=1e-6)
    else:
        assert -1e3 / curvature.low.value == pytest.approx(20.482739, abs=1e-6)
        assert 1e3 / curvature.high.value == pytest.approx(12.9872, abs=1e-4)
        assert abs(math.degrees(curvature.low.theta) - 180.0) == pytest.approx(57.5213, abs=1e-4)


def test_the_report_lists_what_was_typed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "lobe.toml"
    path.write_text(text(A + ROWS), "utf-8")
    assert main(["report", str(path), "--out", str(tmp_path / "out")]) == 0
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    for line in ("Lobe lift 9 mm", "Crank angle 270 °", "Ramp's velocity 0.01 mm/°"):
        assert line in lines
