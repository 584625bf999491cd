"""``find``: answers against closed forms, against scans by formulas of their own, and by what the design then reaches."""

import contextlib
import io
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sampled import stressed

from core.__main__ import main
from core.design import edited
from core.errors import KindynaError
from core.find import find
from core.project import load
from core.study import Study, extremes_of, findings_of

ROOT = Path(__file__).parents[3]
EXAMPLES = ROOT / "resources/examples"
Rows = tuple[tuple[str, float, float], ...]
DRDR: Rows = (("dwell", 120.0, 0.0), ("3-4-5", 60.0, 20.0), ("dwell", 100.0, 0.0), ("3-4-5", 80.0, -20.0))
ROLLER = {"face": "roller", "offset_mm": 0.0}
CAM = {"base_radius_mm": 50.0, "roller_radius_mm": 10.0}
U = np.linspace(0.0, 1.0, 400_001)
S, V, A = 10 * U**3 - 15 * U**4 + 6 * U**5, 30 * U**2 * (1 - U) ** 2, 60 * U - 180 * U**2 + 120 * U**3  # of 3-4-5
SCAN = 200  # every so manieth of these in scans


def table(name: str, entries: dict[str, Any]) -> str:
    return f"[{name}]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in entries.items())


def file(
    folder: Path,
    rows: Rows = DRDR,
    follower: dict[str, Any] = ROLLER,
    cam: dict[str, Any] = CAM,
    unit: str = "mm",
    kind: str = "translating",
    more: str = "",
) -> Path:
    """A design file."""
    segments = "".join(
        table("[motion.segments]", {"law": law, "span_deg": span, **({f"rise_{unit}": rise} if rise else {})})
        for law, span, rise in rows
    )
    text = f'format = 1\nname = "Sought"\n[motion]\nstart_{unit} = 0.0\n{segments}' + table(
        "follower", {"kind": kind, **follower}
    )
    path = folder / "design.toml"
    path.write_text(text + table("cam", cam) + '[shaft]\nrotation = "ccw"\nspeed_rpm = 60.0\n[loads]\n' + more, "utf-8")
    return path


def run(*words: object) -> tuple[int, str, str]:
    """The command in this process: exit code, what it printed, its faults."""
    printed, faults = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(faults):
        code = main(["find", *map(str, words)])
    return code, printed.getvalue(), faults.getvalue()


def found(path: Path, what: str, *limits: str, code: int = 0) -> dict[str, Any]:
    got, text, faults = run(path, what, *(word for limit in limits for word in ("--limit", limit)), "--json")
    assert got == code, faults
    return json.loads(text)


def stretches(rows: Rows = DRDR, step: int = 1) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """s [mm], s', s'' of each segment of a motion of dwells and 3-4-5, densely."""
    shape = S[::step], V[::step], A[::step]
    made, level = [], 0.0
    for law, span, rise in rows:
        beta, moves = math.radians(span), law != "dwell"
        made.append(
            (level + rise * shape[0] * moves, rise / beta * shape[1] * moves, rise / beta**2 * shape[2] * moves)
        )
        level += rise
    return made


def least(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a function of one hollow is least, by golden section."""
    part = 0.5 * (math.sqrt(5.0) - 1.0)
    for _ in range(60):
        a, b = high - part * (high - low), low + part * (high - low)
        low, high = (low, b) if function(a) < function(b) else (a, high)
    return 0.5 * (low + high)


# -- closed forms ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("limit", [25.0, 30.0, 38.0])
def test_base_radius_for_a_pressure_angle_is_that_of_the_closed_form(tmp_path: Path, limit: float) -> None:
    """tan ψ = s'/(R0 + s) of a centred follower: R0 = max(|s'|/tan ψ - s)."""
    wanted = max(float((np.abs(v) / math.tan(math.radians(limit)) - s).max()) for s, v, _ in stretches()) - 10.0
    data = found(
        file(tmp_path), "base-radius", f"pressure_angle_rise_deg={limit}", f"pressure_angle_return_deg={limit}"
    )
    assert data["answer"]["cam.base_radius_mm"] == pytest.approx(wanted, abs=1e-8)
    assert data["reached"]["pressure_angle_rise_deg"] == pytest.approx(limit, rel=1e-12)
    assert data["reached"]["pressure_angle_return_deg"] < limit - 5.0  # the longer return needs less
    assert data["reached"]["convex_radius_mm"] > 0.0


def test_limits_of_rise_and_return_hold_apart(tmp_path: Path) -> None:
    _, rise, _, back = (np.abs(v) - math.tan(math.radians(20.0)) * s for s, v, _ in stretches())
    wanted = float(back.max()) / math.tan(math.radians(20.0)) - 10.0
    data = found(file(tmp_path), "base-radius", "pressure_angle_return_deg=20")
    assert data["answer"]["cam.base_radius_mm"] == pytest.approx(wanted, abs=1e-8)
    assert rise.max() > back.max()


def test_a_cam_sized_to_30_degrees_gives_30_degrees(tmp_path: Path) -> None:
    """The usual limit of a follower that slides, where none is stated; the file that is written has it, and is not complained of."""
    into = tmp_path / "sized.toml"
    code, text, faults = run(file(tmp_path), "base-radius", "--into", into)
    assert (code, faults) == (0, "")
    assert "pressure_angle_rise_deg = 30, limit 30 (typical where the follower slides)" in text
    study = Study(load(into))
    assert f"{math.degrees(extremes_of(study, 'cam')['pressure_angle'].high.value):.10f}" == "30.0000000000"
    assert findings_of(study, ("cam",)) == ()
    before, after = file(tmp_path).read_text("utf-8").splitlines(), into.read_text("utf-8").splitlines()
    assert "base_radius_mm = 50.0" in before
    assert "base_radius_mm = 50.0" not in after


OPEN = ("pressure_angle_rise_deg=none", "pressure_angle_return_deg=none", "cam.base_radius_mm_min=none")


@pytest.mark.stress
def test_a_limit_that_is_stated_takes_the_place_of_the_same_one_only(tmp_path: Path) -> None:
    """The design's own ones and the usual ones hold besides; one that is taken away does not; that of the whole turn stands for both."""
    path = file(tmp_path, more="[limits]\npressure_angle_rise_deg = 25.0\nconvex_radius_mm = 2.0\n")
    (tmp_path / "plain").mkdir()
    plain = file(tmp_path / "plain")
    own, steeper = found(path, "base-radius"), found(path, "base-radius", "pressure_angle_rise_deg=35")
    assert own["limits"] == {
        "pressure_angle_rise_deg": 25.0,
        "pressure_angle_return_deg": 30.0,
        "convex_radius_mm": 2.0,
    }
    assert own["reasons"] == {"pressure_angle_return_deg": "typical where the follower slides"}
    assert own["answer"] == found(plain, "base-radius", "pressure_angle_rise_deg=25", "convex_radius_mm=2")["answer"]
    assert steeper["limits"] == {**own["limits"], "pressure_angle_rise_deg": 35.0}
    blunt = found(plain, "base-radius", "convex_radius_mm=2")
    assert blunt["limits"] == {
        "pressure_angle_rise_deg": 30.0,
        "pressure_angle_return_deg": 30.0,
        "convex_radius_mm": 2.0,
    }
    assert blunt["answer"] == found(plain, "base-radius")["answer"], "the pressure angle holds it"
    free = found(plain, "base-radius", *OPEN)
    assert free["limits"] == {"convex_radius_mm": 5.0}, "half the roller's radius"
    assert free["reached"]["convex_radius_mm"] == pytest.approx(5.0, rel=1e-9)
    assert found(plain, "base-radius", *OPEN, "convex_radius_mm=none")["limits"] == {"convex_radius_mm": 0.0}, (
        "never undercut"
    )
    both = found(plain, "base-radius", "pressure_angle_deg=36")
    assert both["limits"] == {"pressure_angle_deg": 36.0, "convex_radius_mm": 5.0}
    assert both["reached"]["pressure_angle_deg"] == pytest.approx(36.0, rel=1e-9)
    of_stretches = [both["reached"][f"pressure_angle_{stretch}_deg"] for stretch in ("rise", "return")]
    assert max(of_stretches) == both["reached"]["pressure_angle_deg"] > min(of_stretches)


def test_base_radius_for_a_radius_of_curvature_under_a_flat_face(tmp_path: Path) -> None:
    """ρ = Br + s + s''; without a limit 3 mm are left, with one of 0 there is just no undercut."""
    lowest = min(float((s + a).min()) for s, _, a in stretches())
    path = file(tmp_path, follower={"face": "flat"}, cam={"base_radius_mm": 50.0})
    for stated, radius in ((("convex_radius_mm=0",), 0.0), ((), 3.0), (("convex_radius_mm=7.5",), 7.5)):
        data = found(path, "base-radius", *stated)
        assert data["answer"]["cam.base_radius_mm"] == pytest.approx(radius - lowest, abs=1e-8)
        assert data["reached"]["convex_radius_mm"] == pytest.approx(radius, abs=1e-9)


def test_face_width_is_the_span_of_the_contact(tmp_path: Path) -> None:
    """The contact lies s' beside the line of the follower, on opposite sides at rise and return."""
    into = tmp_path / "wide.toml"
    path = file(tmp_path, follower={"face": "flat", "face_half_width_mm": 3.0}, cam={"base_radius_mm": 120.0})
    data = found(path, "face-width")
    speeds = [20.0 * 1.875 / math.radians(span) for span in (60.0, 80.0)]
    assert data["answer"]["follower.face_half_width_mm"] == pytest.approx(0.5 * sum(speeds), rel=1e-12)
    assert abs(data["answer"]["follower.face_centre_mm"]) == pytest.approx(0.5 * (speeds[0] - speeds[1]), rel=1e-11)
    assert run(path, "face-width", "--into", into)[0] == 0
    assert [finding.code for finding in findings_of(Study(load(into)), ("cam",))] == []
    assert found(path, "face-width", "follower.face_centre_mm_min=0", "follower.face_centre_mm_max=1e-9")["answer"][
        "follower.face_half_width_mm"
    ] == pytest.approx(speeds[0], rel=1e-9)
    found(path, "face-width", "follower.face_half_width_mm_max=20", code=2)


def test_shortest_span_of_a_rise(tmp_path: Path) -> None:
    """β = max h s'(u)/(tan ψ (R0 + h s(u))); the dwell that follows gives what the rise leaves."""
    path = file(tmp_path)
    for limit in (25.0, 40.0):
        wanted = math.degrees(float((20.0 * V / (60.0 + 20.0 * S)).max()) / math.tan(math.radians(limit)))
        data = found(path, "span", f"pressure_angle_rise_deg={limit}")
        assert data["answer"] == {"motion.segments[1].span_deg": pytest.approx(wanted, abs=1e-9)}
    into = tmp_path / "short.toml"
    assert run(path, "span", "--limit", "pressure_angle_rise_deg=25", "--into", into)[0] == 0
    spans = [segment.span_deg for segment in load(into).drive.motion.segments]
    assert sum(spans) == pytest.approx(360.0, abs=1e-9)
    assert spans[0] == 120.0


# -- scans by formulas of their own ------------------------------------------------------------------------


def translating_worst(offset: float, step: int = SCAN, reach: float = 60.0) -> float:
    """Largest pressure angle [deg]: tan ψ = |s' + dε|/S, S = √(R0² - ε²) + s."""
    root = math.sqrt(reach**2 - offset**2)
    return max(float(np.degrees(np.arctan(np.abs(v + offset) / (root + s))).max()) for s, v, _ in stretches(DRDR, step))


def test_offset_of_least_pressure_angle_against_a_scan(tmp_path: Path) -> None:
    data = found(file(tmp_path), "offset")
    scan = min(np.linspace(-50.0, 50.0, 201), key=translating_worst)
    wanted = least(translating_worst, scan - 1.0, scan + 1.0)
    assert data["answer"]["follower.offset_mm"] == pytest.approx(wanted, abs=1e-4)
    assert data["reached"]["pressure_angle_deg"] == pytest.approx(
        translating_worst(data["answer"]["follower.offset_mm"], 1), abs=1e-9
    )
    root = math.sqrt(60.0**2 - data["answer"]["follower.offset_mm"] ** 2)
    for stretch, sign in (("rise", 1.0), ("return", -1.0)):
        tangents = [
            (np.abs(v + data["answer"]["follower.offset_mm"]) / (root + s))[sign * v > 0.0]
            for s, v, _ in stretches(DRDR, 1)
        ]
        worst = max(float(np.degrees(np.arctan(part)).max()) for part in tangents if part.size)
        assert data["reached"][f"pressure_angle_{stretch}_deg"] == pytest.approx(worst, abs=1e-6)
    beside = (translating_worst(data["answer"]["follower.offset_mm"] + by, 1) for by in (-1e-4, 1e-4))
    assert min(beside) > data["reached"]["pressure_angle_deg"]
    assert data["reached"]["pressure_angle_deg"] < translating_worst(0.0) - 1.0
    bounded = found(file(tmp_path), "offset", "follower.offset_mm_min=0")
    assert bounded["answer"]["follower.offset_mm"] == 0.0
    even = found(EXAMPLES / "kim_1990.toml", "offset")  # rise and return alike
    assert even["answer"] == {"follower.offset_mm": 0.0}, "and nothing that rounding leaves of it"
    held = found(file(tmp_path), "offset", "pressure_angle_return_deg=22")  # less than what rise and return would share
    assert held["reached"]["pressure_angle_return_deg"] == pytest.approx(22.0, abs=1e-9)


def least_convex(roller: float, base: float, step: int = SCAN) -> float:
    """Least convex radius of the profile: κ_p = [2s'² + S(S - s'')]/[s'² + S²]^{3/2} of a centred follower."""
    bends = []
    for s, v, a in stretches(DRDR, step):
        place = base + roller + s
        bends.append(float(((2.0 * v * v + place * (place - a)) / (v * v + place * place) ** 1.5).max()))
    return 1.0 / max(bends) - roller


def test_largest_roller_against_a_scan(tmp_path: Path) -> None:
    half = found(file(tmp_path), "roller-radius", "convex_radius_mm=18")
    assert half["answer"]["cam.roller_radius_mm"] == 25.0
    assert half["end"] == "cam.roller_radius_mm = 25 (half the base radius)"
    data = found(file(tmp_path), "roller-radius", "convex_radius_mm=18", "cam.roller_radius_mm_max=50")
    rollers = np.linspace(1.0, 50.0, 99)
    serving = [roller for roller in rollers if least_convex(roller, 50.0) >= 18.0]
    low, high = serving[-1], serving[-1] + 0.5
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if least_convex(middle, 50.0) >= 18.0 else (low, middle)
    assert data["answer"]["cam.roller_radius_mm"] == pytest.approx(low, abs=1e-4)
    assert data["reached"]["convex_radius_mm"] == pytest.approx(18.0, abs=1e-9)
    assert least_convex(data["answer"]["cam.roller_radius_mm"], 50.0, 1) == pytest.approx(18.0, abs=1e-8)


def test_hollow_radius_limits_the_base_radius(tmp_path: Path) -> None:
    """The pitch curve's hollow plus the roller."""
    data = found(file(tmp_path), "base-radius", "concave_radius_mm=60", *OPEN)
    reach = data["answer"]["cam.base_radius_mm"] + 10.0

    def hollowest(reach: float) -> float:
        places = [(reach + s, v, a) for s, v, a in stretches(DRDR, SCAN)]
        return min(float(((2.0 * v * v + p * (p - a)) / (v * v + p * p) ** 1.5).min()) for p, v, a in places)

    assert -1.0 / hollowest(reach) + 10.0 == pytest.approx(60.0, abs=1e-6)
    assert all(hollowest(less * reach) < hollowest(reach) for less in (0.7, 0.9, 0.99))


SWING: Rows = (("dwell", 100.0, 0.0), ("3-4-5", 70.0, 24.0), ("dwell", 90.0, 0.0), ("3-4-5", 100.0, -24.0))


def swinging_worst(x: float, y: float, arm: float, reach: float = 45.0) -> float:
    """Largest pressure angle [deg] of an arm on the left, the cam turning counter-clockwise: tan ψ = |n·E|/|n·iE|, n along R - Q."""
    pivot, worst = complex(x, y), 0.0
    start = np.angle(-pivot) + math.acos((arm**2 + abs(pivot) ** 2 - reach**2) / (2.0 * arm * abs(pivot)))
    for s, v, _ in stretches(SWING, 2 * SCAN):
        phi, rate = start + np.radians(s), np.radians(v)
        lever = arm * np.exp(1j * phi)
        normal = -1j * (1j * rate * lever - 1j * (pivot + lever))
        worst = max(
            worst, float(np.arctan2(np.abs((normal * lever.conj()).real), np.abs((normal * lever.conj()).imag)).max())
        )
    return math.degrees(worst)


def swing(folder: Path) -> Path:
    follower = {"face": "roller", "arm_mm": 70.0, "pivot_x_mm": 80.0, "pivot_y_mm": 20.0, "side": "left"}
    return file(folder, SWING, follower, {"base_radius_mm": 35.0, "roller_radius_mm": 10.0}, "deg", "oscillating")


def test_arm_of_least_pressure_angle_against_a_scan(tmp_path: Path) -> None:
    data = found(swing(tmp_path), "arm", "follower.arm_mm_min=50", "follower.arm_mm_max=100")
    arms = np.linspace(50.0, 100.0, 101)
    scan = min(arms, key=lambda arm: swinging_worst(80.0, 20.0, arm))
    wanted = least(lambda arm: swinging_worst(80.0, 20.0, arm), scan - 0.5, scan + 0.5)
    assert data["reached"]["pressure_angle_deg"] == pytest.approx(swinging_worst(80.0, 20.0, wanted), abs=1e-4)
    assert data["answer"]["follower.arm_mm"] == pytest.approx(wanted, abs=1e-2)


@pytest.mark.stress
def test_pivot_of_least_pressure_angle_in_a_box_against_a_scan(tmp_path: Path) -> None:
    box = [
        f"follower.pivot_{axis}_mm_{end}={value}"
        for axis, low, high in (("x", 70, 95), ("y", -10, 40))
        for end, value in (("min", low), ("max", high))
    ]
    data = found(swing(tmp_path), "pivot", *box)
    x, y = data["answer"]["follower.pivot_x_mm"], data["answer"]["follower.pivot_y_mm"]
    assert 70.0 <= x <= 95.0
    assert -10.0 <= y <= 40.0
    assert data["reached"]["pressure_angle_deg"] == pytest.approx(swinging_worst(x, y, 70.0), abs=1e-4)
    assert y == 20.0  # where it was: only the distance from the cam centre counts
    none = found(swing(tmp_path), "pivot", *box, "pressure_angle_deg=1", code=2)
    assert none["answer"] == pytest.approx(data["answer"], rel=1e-6), (
        "the best where no value serves is the optimum, no place of a grid"
    )
    places = [(a, b) for a in np.linspace(70.0, 95.0, 4) for b in np.linspace(-10.0, 40.0, 4)]
    places += [
        (np.clip(x + a, 70.0, 95.0), np.clip(y + b, -10.0, 40.0)) for a in (-0.1, 0.0, 0.1) for b in (-0.1, 0.0, 0.1)
    ]
    assert min(swinging_worst(a, b, 70.0) for a, b in places) > data["reached"]["pressure_angle_deg"] - 1e-4


@pytest.mark.stress
def test_pivot_of_a_cam_slider_is_better_than_all_around_it() -> None:
    """There both coordinates count: the guide goes with the pivot."""
    path = EXAMPLES / "transfer_lift.toml"
    data = found(path, "pivot", "follower.pivot_x_mm_min=780", "follower.pivot_x_mm_max=960")
    x, y = data["answer"]["follower.pivot_x_mm"], data["answer"]["follower.pivot_y_mm"]

    def worst(a: float, b: float) -> float:
        design = edited(edited(load(path), "follower.pivot_x_mm", a), "follower.pivot_y_mm", b)
        return math.degrees(extremes_of(Study(design), "cam", ("pressure_angle",))["pressure_angle"].high.value)

    least = worst(x, y)
    assert data["reached"]["pressure_angle_deg"] == pytest.approx(least, abs=1e-9)
    assert least < worst(873.746, -65.0)
    steps = (-0.5, 0.0), (0.5, 0.0), (0.0, -0.5), (0.0, 0.5), (-0.5, 0.5), (0.5, -0.5)
    around = [(max(780.0, min(960.0, x + a)), y + b) for a, b in steps]
    assert min(worst(a, b) for a, b in around) >= least - 1e-9


@pytest.mark.parametrize(
    ("name", "what", "limits"),
    [
        ("transfer_lift", "base-radius", ("pressure_angle_return_deg=20",)),
        stressed("transfer_lift", "base-radius", ()),
        ("rocker_shoe", "base-radius", ("convex_radius_mm=12", "pressure_angle_rise_deg=40")),
        stressed("conjugate", "base-radius", ("pressure_angle_deg=35", "cam.base_radius_mm_min=30")),
        stressed("groove", "base-radius", ("pressure_angle_deg=20",)),
        stressed("rocker_flat", "base-radius", ("convex_radius_mm=4",)),
        stressed("four_bar_coupler_cam", "roller-radius", ()),
    ],
)
def test_the_answer_just_keeps_what_the_next_value_does_not(
    tmp_path: Path, name: str, what: str, limits: tuple[str, ...]
) -> None:
    """On every mechanism: one limit is reached to the last digits, and a hair beyond the answer it is exceeded."""
    path = EXAMPLES / f"{name}.toml"
    data = found(path, what, *limits)
    ((field, value),) = data["answer"].items()
    tight = [key for key, limit in data["limits"].items() if abs(data["reached"][key] - limit) < 1e-9]
    assert len(tight) == 1
    beyond = value * (1.0 - 1e-6 if what == "base-radius" else 1.0 + 1e-6)
    others = [each for each in limits if not each.startswith(field)]
    pinned = found(path, what, *others, f"{field}_min={beyond * (1.0 - 1e-9)}", f"{field}_max={beyond}", code=2)
    assert len(pinned["against"]) == 1


@pytest.mark.stress
def test_what_check_would_find_holds_an_answer_as_a_limit_does(tmp_path: Path) -> None:
    """The hub with room beside it; without that limit the hub itself, since a smaller cam is an error; so is the speed's evenness."""
    into = tmp_path / "small.toml"
    assert run(EXAMPLES / "groove.toml", "base-radius", "--into", into)[0] == 0
    assert load(into).drive.cam.base_radius_mm == pytest.approx(37.0, rel=1e-9)
    data = found(EXAMPLES / "groove.toml", "base-radius", "polar_radius_mm=none", "cam.base_radius_mm_min=none")
    assert data["answer"]["cam.base_radius_mm"] == pytest.approx(35.0, rel=1e-8)
    assert data["answer"]["cam.base_radius_mm"] > 35.0
    assert data["held_by"][0].startswith("the profile's least distance from the cam centre")


def test_segments_that_go_on_into_each_other_change_their_spans_together(tmp_path: Path) -> None:
    """One alone would make the velocity jump where it meets the next one: accelerated, at constant velocity, decelerated, back."""
    into = tmp_path / "short.toml"
    before = load(EXAMPLES / "card_picker.toml").drive.motion.segments
    assert run(EXAMPLES / "card_picker.toml", "span", "--into", into)[0] == 0
    after = load(into).drive.motion.segments
    parts = [b.span_deg / a.span_deg for a, b in zip(before, after, strict=True)]
    assert parts[1:5] == pytest.approx([parts[1]] * 4, rel=1e-9)
    assert parts[1] < 0.7
    assert (parts[0], sum(s.span_deg for s in after)) == (1.0, pytest.approx(360.0, abs=1e-9))
    assert findings_of(Study(load(into)), ("motion",)) == ()


@pytest.mark.stress
def test_a_cam_that_must_stay_evenly_driven_gets_its_flywheel() -> None:
    """The load has grown: the flywheel goes along as far as half of it more will do, and holds the answer beyond."""
    design = load(EXAMPLES / "conjugate.toml")
    more = find(design, "span", {})
    (wheel,) = more.applied.values()
    assert 0.5 < wheel <= 0.75
    assert more.machine.shaft is not None
    assert more.machine.shaft.flywheel_inertia_kg_m2 == wheel
    assert "speed-fluctuates" not in [f.code for f in findings_of(Study(more.machine))]
    held = find(load(EXAMPLES / "groove.toml"), "span", {})
    assert "the speed fluctuates" in held.next_findings[0]


def test_the_design_s_example_files_answer_with_a_curve(tmp_path: Path) -> None:
    data = found(EXAMPLES / "transfer_lift.toml", "base-radius")
    values = [x for x, _ in data["curve"]]
    assert values == sorted(values)
    assert data["answer"]["cam.base_radius_mm"] in values
    assert len(values) > 20


# -- nothing serves, bad input -----------------------------------------------------------------------------


def test_where_nothing_serves_the_best_is_given_with_what_stands_against_it(tmp_path: Path) -> None:
    into = tmp_path / "none.toml"
    limits = ("--limit", "pressure_angle_rise_deg=30", "--limit", "cam.base_radius_mm_max=20")
    code, text, faults = run(file(tmp_path), "base-radius", *limits, "--into", into)
    assert code == 2
    assert "the best value, which violates limits:" in text
    assert "cam.base_radius_mm = 20" in text  # the largest is the least steep
    assert faults.startswith("no value satisfies every limit; the best one violates: pressure angle rise 4")
    assert "limit 30 deg" in faults
    assert not into.exists()
    data = found(file(tmp_path), "base-radius", "pressure_angle_rise_deg=30", "cam.base_radius_mm_max=20", code=2)
    assert data["answer"]["cam.base_radius_mm"] == 20.0
    assert data["reached"]["pressure_angle_rise_deg"] > 30.0


def test_what_stands_at_the_end_of_its_values_says_why(tmp_path: Path) -> None:
    """A rise by a table is no shorter than its rows."""
    points = ", ".join(
        f"[{10.0 * i}, {20.0 * (10 * (i / 9) ** 3 - 15 * (i / 9) ** 4 + 6 * (i / 9) ** 5)}]" for i in range(10)
    )
    design = file(tmp_path)
    rise = f'law = "table"\npoints = [{points}]'.join(design.read_text("utf-8").split('law = "3-4-5"', 1))
    design.write_text(
        rise.replace("span_deg = 60.0", "span_deg = 90.0").replace("span_deg = 100.0", "span_deg = 70.0"), "utf-8"
    )
    code, text, _ = run(design, "span")
    assert code == 0
    assert (
        "limited by the search range only: motion.segments[1].span_deg = 90 (beyond it: motion.segments[1].points[9].at_deg"
        in text
    )


@pytest.mark.parametrize(
    ("what", "words", "fault"),
    [
        ("base", (), "find 'base': unknown; allowed: base-radius | offset"),
        (
            "base-radius",
            ("--limit", "steepness=3"),
            "limit 'steepness': base-radius has none of that name; allowed: pressure_angle_deg |",
        ),
        ("base-radius", ("--limit", "pressure_angle_deg"), "must be KEY=VALUE"),
        ("base-radius", ("--limit", "pressure_angle_deg=30,5"), "must be KEY=VALUE"),
        ("base-radius", ("--limit", "pressure_angle_deg=nan"), "must be KEY=VALUE"),
        ("base-radius", ("--limit", "pressure_angle_deg=95"), "limit pressure_angle_deg = 95: outside its range"),
        (
            "base-radius",
            ("--limit", "pressure_angle_rise_deg=91"),
            "limit pressure_angle_rise_deg = 91: outside its range; allowed: above 0 ... 90",
        ),
        ("base-radius", ("--limit", "convex_radius_mm=-1"), "limit convex_radius_mm = -1: outside its range"),
        ("base-radius", ("--limit", "convex_radius_mm=1", "--limit", "convex_radius_mm=2"), "a limit has one value"),
        (
            "base-radius",
            ("--limit", "follower.offset_mm_max=1"),
            "base-radius does not vary it; it varies cam.base_radius_mm",
        ),
        ("offset", ("--limit", "follower.offset_mm_min=2", "--limit", "follower.offset_mm_max=1"), "is not below"),
        ("pivot", (), "this design has no follower.pivot_x_mm, follower.pivot_y_mm"),
        ("face-width", (), "this design has no follower.face_half_width_mm"),
        ("face-width", ("--limit", "pressure_angle_deg=30"), "face-width has none of that name"),
    ],
)
def test_bad_requests_are_named(tmp_path: Path, what: str, words: tuple[str, ...], fault: str) -> None:
    code, text, faults = run(file(tmp_path), what, *words)
    assert (code, text) == (2, "")
    assert fault in faults
    assert "Traceback" not in faults


def test_no_cam_no_effect(tmp_path: Path) -> None:
    assert "has no cam" in run(EXAMPLES / "four_bar.toml", "roller-radius")[2]
    code, _, faults = run(EXAMPLES / "tappet_flat.toml", "offset")
    assert code == 2
    assert faults.startswith("the pressure angle of a flat face does not depend on follower.offset_mm")


@pytest.mark.parametrize(
    "limits", [("pressure_angle_deg=90",), ("pressure_angle_rise_deg=90", "pressure_angle_return_deg=90")]
)
def test_a_pressure_angle_of_90_is_a_limit_as_in_a_design(limits: tuple[str, ...]) -> None:
    """It limits nothing: the convex radius of half the roller's radius is then the limit of the lift."""
    lift = EXAMPLES / "transfer_lift.toml"
    result = found(lift, "base-radius", *limits)
    assert result["limits"][limits[0].partition("=")[0]] == 90.0
    assert result["reached"]["convex_radius_mm"] == pytest.approx(75.0)


def test_contact_force_and_pressure_are_limits_of_a_search() -> None:
    design = load(EXAMPLES / "rocker_cam.toml")
    for path, value in {
        "cam.thickness_mm": 15.0,
        "cam.youngs_modulus_gpa": 206.0,
        "cam.poisson_ratio": 0.3,
        "cam.roller_youngs_modulus_gpa": 206.0,
        "cam.roller_poisson_ratio": 0.3,
    }.items():
        design = edited(design, path, value)
    for what, key, quantity, size, limit in (
        ("base-radius", "contact_pressure_mpa", "contact_pressure", 1e-6, 270.0),
        ("roller-radius", "contact_force_n", "contact_force", 1.0, 300.0),
    ):
        solution = find(design, what, {key: limit, "pressure_angle_deg": 60.0})
        assert solution.is_valid
        greatest = extremes_of(Study(solution.design), "dynamics", (quantity,))[quantity].high.value
        assert size * greatest == pytest.approx(limit, rel=1e-7), "just kept"
        assert solution.reached[key] == pytest.approx(limit, rel=1e-7)
        own = find(edited(design, f"limits.{key}", limit), what, {"pressure_angle_deg": 60.0})
        assert own.answer == pytest.approx(dict(solution.answer), rel=1e-9), (
            "the design's own holds where none is stated"
        )
    with pytest.raises(KindynaError, match="thickness"):
        find(load(EXAMPLES / "rocker_cam.toml"), "base-radius", {"contact_pressure_mpa": 300.0})
    with pytest.raises(KindynaError, match="allowed: > 0 MPa"):
        find(design, "base-radius", {"contact_pressure_mpa": -1.0})


@pytest.mark.stress
def test_a_search_keeps_optimal_laws_of_the_machine() -> None:
    """The result is that of the laws which its own machine has, and they are still typed."""
    design = load(EXAMPLES / "rocker_cam.toml")
    design = edited(edited(design, "motion.segments[1].law", "optimal"), "motion.segments[1].minimise", "torque")
    design = edited(edited(design, "motion.segments[1].intervals", 20), "motion.segments[1].limits.jerk", 200.0)
    solution = find(design, "base-radius", {"pressure_angle_rise_deg": 30.0})
    assert solution.design == edited(design, "cam.base_radius_mm", solution.answer["cam.base_radius_mm"])
    reached = extremes_of(Study(solution.design), "cam", ("pressure_angle",))["pressure_angle"]
    assert solution.is_valid
    assert (
        np.rad2deg(max(-reached.low.value, reached.high.value))
        <= max(30.0, solution.reached["pressure_angle_return_deg"]) + 1e-6
    )
