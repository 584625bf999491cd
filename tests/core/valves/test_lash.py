"""Lash of valve trains: where the train is loose, what it loads, and where the valve opens, against closed forms and typed linkages."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from valve_trains import FLAT_TAPPET, LOBE_A

from core.__main__ import main
from core.design import Design, Engine, Valve, get, put, split_unit, with_drive
from core.find import ranking_columns, ranking_row
from core.project import load, loads, save
from core.study import Study, extremes_of, findings_of, many
from core.study.quantities import quantities_of

MM = 1e3
EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
ENGINE = Engine(stroke_mm=84.0, rod_mm=138.0)
DIRECT = (
    'format = 1\nname = "Direct"\n'
    + LOBE_A
    + "{closing}"
    + FLAT_TAPPET
    + """[shaft]
rotation = "ccw"
speed_rpm = {rpm}
[engine]
stroke_mm = 84.0
rod_mm = 138.0
[valve]
centre_deg = 108.0
lash_mm = {lash}
[loads]
follower_mass_kg = 0.14
spring_rate_n_per_mm = 30.0
preload_n = 300.0
gravity_m_s2 = 0.0
"""
)


def direct(lash: float = 0.15, rpm: float = 2000.0, closing: str = "") -> Design:
    return loads(DIRECT.format(lash=lash, rpm=rpm, closing=closing))


def trained(name: str, lash: float, **how: Any) -> Design:
    """Train of an example with an engine and a valve."""
    design = load(EXAMPLES / name)
    valve = Valve(centre_deg=108.0, lash_mm=lash, **how)
    return with_drive(replace(design, engine=ENGINE), valve=valve)


def value(study: Study, name: str) -> np.ndarray:
    return quantities_of(study)[name].value(study)


def codes(design: Design) -> list[tuple[str, str]]:
    return [(finding.code, finding.field) for finding in findings_of(Study(design))]


# -- forces -----------------------------------------------------------------------------------------------------


def test_a_loose_train_has_no_contact_force_and_no_torque() -> None:
    study = Study(direct())
    y, slope, second = (study.motion.displacement[order] for order in range(3))
    omega, is_open = 2000.0 * math.pi / 30.0, y > 0.15e-3
    at_seat = np.abs(y - 0.15e-3) < 1e-9  # where rounding decides
    assert at_seat.sum() <= 2
    force = np.where(is_open, 300.0 + 3e4 * (y - 0.15e-3) + 0.14 * omega**2 * second, 0.0)
    assert 0.3 < is_open.mean() < 0.45
    assert value(study, "contact_force")[~at_seat] == pytest.approx(force[~at_seat], rel=1e-9, abs=1e-7)
    assert value(study, "drive_torque")[~at_seat] == pytest.approx((force * slope)[~at_seat], rel=1e-9, abs=1e-9)
    assert value(study, "valve_lift") == pytest.approx(np.maximum(y - 0.15e-3, 0.0), abs=1e-14)
    assert value(study, "valve_velocity")[~at_seat] == pytest.approx(np.where(is_open, omega * slope, 0.0)[~at_seat])
    assert value(study, "valve_acceleration")[~at_seat] == pytest.approx(
        np.where(is_open, omega**2 * second, 0.0)[~at_seat]
    )
    assert not [code for code, _ in codes(direct()) if code in ("separation", "lash-beyond-ramp")]


def test_the_speed_of_lift_off_is_that_of_the_open_valve() -> None:
    study = Study(direct(), samples=36_000)
    y, second = study.motion.displacement[0], study.motion.displacement[2]
    falls = (y > 0.15e-3) & (second < 0.0)
    reference = np.sqrt((300.0 + 3e4 * (y[falls] - 0.15e-3)) / (-0.14 * second[falls])).min()
    assert study.lift_off.omega == pytest.approx(reference, rel=1e-9)


def test_a_follower_that_flies_leaves_the_open_lobe_and_lands_on_it() -> None:
    study = Study(direct(rpm=4200.0))
    separation = next(finding for finding in findings_of(study) if finding.code == "separation")
    assert separation.values["speed_rpm"] == pytest.approx(study.lift_off.omega * 30.0 / math.pi, rel=1e-9)
    flight = study.flights(2.0).flights[0]
    ends = study.at_theta(np.array([flight.lift, flight.land]) % (2.0 * math.pi)).motion.displacement[0]
    assert (ends > 0.15e-3).all()
    assert flight.height > 0.0


@pytest.mark.parametrize(("rpm", "on_seat"), [(4200.0, False), (9000.0, True)])
def test_a_flight_with_lash_is_that_of_the_spring_and_ends_on_the_lobe_or_on_the_seat(
    rpm: float, on_seat: bool
) -> None:
    """y oscillates about λ - F_0/k with ω_n = √(k/m) until it returns to the lobe, or to λ where the lobe is lower."""
    study, omega = Study(direct(rpm=rpm)), rpm * math.pi / 30.0
    flight = study.flights(2.0).flights[0]
    natural, middle = math.sqrt(3e4 / 0.14), 0.15e-3 - 300.0 / 3e4
    start = study.at_theta(np.array([flight.lift % (2.0 * math.pi)])).motion.displacement
    y0, v0 = float(start[0][0]) - middle, float(start[1][0]) * omega
    turned = natural * (flight.theta - flight.lift) / omega
    y = middle + y0 * np.cos(turned) + v0 / natural * np.sin(turned)
    assert flight.y == pytest.approx(y, abs=1e-9)
    lobe = study.at_theta(np.array([flight.land % (2.0 * math.pi)])).motion.displacement
    falls = y0 * natural * math.sin(turned[-1]) - v0 * math.cos(turned[-1])
    assert (float(lobe[0][0]) < 0.15e-3) == on_seat
    assert y[-1] == pytest.approx(0.15e-3 if on_seat else float(lobe[0][0]), abs=1e-9)
    assert flight.speed == pytest.approx(falls + (0.0 if on_seat else float(lobe[1][0]) * omega), rel=1e-6)


def test_a_pushrod_train_is_loose_below_the_lash_at_its_valve() -> None:
    design = trained("pushrod_train.toml", 0.25)
    loose, tight = Study(design), Study(with_drive(design, valve=Valve(centre_deg=108.0)))
    travel = value(tight, "valve_lift")
    is_open = travel > 0.25e-3
    assert value(loose, "valve_lift") == pytest.approx(np.maximum(travel - 0.25e-3, 0.0), abs=1e-13)
    assert not np.any(value(loose, "contact_force")[~is_open])
    assert not np.any(value(loose, "drive_torque")[~is_open])
    # the spring of the open valve is shorter by the travel less the lash: virtual work at the tappet
    ratio = value(tight, "rocker_ratio")
    expected = value(tight, "contact_force") - 1e3 * get(
        design, "loads.spring_rate_n_per_mm"
    ) * 0.25e-3 * ratio / np.abs(tight.dynamics.lever)
    assert value(loose, "contact_force")[is_open] == pytest.approx(expected[is_open], rel=1e-9)
    assert loose.lash.at_motion == pytest.approx(
        float(np.interp(0.25e-3, travel[:1800], tight.motion.displacement[0][:1800])), rel=1e-3
    )


def test_balances_hold_where_the_train_is_loose() -> None:
    for design in (direct(), trained("pushrod_train.toml", 0.25), trained("finger_follower.toml", 0.1)):
        study = Study(design)
        bodies = study.free_bodies
        for body, rows in bodies.items():
            total = np.abs(np.sum([row.force for row in rows], axis=0)).max()
            assert total < 1e-6, body
        assert study.load_curve is not None
        loose = value(study, "contact_force") == 0.0
        for name in {"power.load", "power.gravity"} & set(quantities_of(study)):
            assert not value(study, name)[loose].any(), name


@pytest.mark.parametrize("name", ["direct", "finger_follower.toml", "pushrod_train.toml"])
@pytest.mark.parametrize(
    ("path", "factors"),
    [
        ("loads.spring_rate_n_per_mm", (0.8, 1.0, 1.2)),
        ("loads.valve_springs[0].wire_mm", (0.95, 1.0, 1.05)),
        ("shaft.speed_rpm", (0.5, 1.0, 1.2)),
        ("cam.base_radius_mm", (0.995, 1.0, 1.005)),
        ("valve.lash_mm", (0.5, 1.0, 1.3)),
    ],
)
def test_many_designs_with_lash_are_those_one_by_one(name: str, path: str, factors: tuple[float, ...]) -> None:
    design = direct() if name == "direct" else trained(name, 0.15)
    if "valve_springs" in path:
        design = put(put(design, "loads.spring_rate_n_per_mm", 0.0), "loads.preload_n", 0.0)
        design = put(design, "loads.valve_springs", load(EXAMPLES / "valve_train.toml").drives[0].loads.valve_springs)
    values = np.array(factors) * get(design, path)
    ends = {"contact_force": "n", "drive_torque": "nm", "valve_lift": "mm"}
    if "valve_springs" in path:
        ends["valve_spring_stress"] = "mpa"
    keys = {key: f"{key}_{unit}:max" for key, unit in ends.items()}
    result = many(design, {path: values}, list(keys.values()))
    for i, number in enumerate(values.tolist()):
        study = Study(put(design, path, number))
        for key, column in keys.items():
            row = quantities_of(study)[key]
            high = extremes_of(study, row.stage, (key,))[key].high.value
            assert result.value[column][i] == pytest.approx(high / split_unit(row.slug)[1].factor, rel=1e-9), column


def test_the_least_contact_force_of_a_study_is_that_of_the_open_valve() -> None:
    design = direct()
    rates = get(design, "loads.spring_rate_n_per_mm") * np.array([0.8, 1.0, 1.2])
    least = many(design, {"loads.spring_rate_n_per_mm": rates}, ["contact_force_n:min"]).value["contact_force_n:min"]
    for rate, force in zip(rates.tolist(), least.tolist(), strict=True):
        study = Study(put(design, "loads.spring_rate_n_per_mm", rate), samples=36_000)
        is_open = value(study, "valve_lift") > 1e-9
        assert force == pytest.approx(value(study, "contact_force")[is_open].min(), rel=1e-4)
        assert force <= 300.0 + 1e-9, "the preload is the force where the valve opens"


@pytest.mark.stress
def test_waves_count_the_contact_force_of_the_open_valve(tmp_path: Path) -> None:
    """Below the lash nothing presses the follower, and nothing leaves the cam."""
    save(direct(), tmp_path / "train.toml")
    waves = "\n[waviness]\namplitude_mm = 0.0005\nlobes = [5, 30]\n"
    (tmp_path / "train.toml").write_text((tmp_path / "train.toml").read_text("utf-8") + waves, encoding="utf-8")
    assert main(["tolerance", str(tmp_path / "train.toml"), "--out", str(tmp_path / "out")]) == 0
    found = json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))["waviness"]
    study = Study(direct())
    is_open = value(study, "valve_lift") > 1e-9
    change = 0.14 * 0.5e-6 * (30.0 * 2000.0 * math.pi / 30.0) ** 2
    least = value(study, "contact_force")[is_open].min() - change
    assert found["least_contact_force_n"] == pytest.approx(least, rel=1e-3)
    assert least > 0.0


def test_laws_are_ranked_by_the_least_force_of_the_open_valve() -> None:
    design = trained("tappet_flat.toml", 0.1)
    columns = ranking_columns(design)
    number = [column.key for column in columns].index("least_contact_force_n")
    row = ranking_row("present", lambda: design, columns)
    least = many(design, {"loads.gravity_m_s2": [get(design, "loads.gravity_m_s2")]}, ["contact_force_n:min"])
    assert row.figures[number] == pytest.approx(least.value["contact_force_n:min"][0], rel=1e-9)
    assert row.figures[number] > 0.0


def test_the_top_speed_of_a_train_with_lash_is_that_of_lift_off(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design = direct()
    save(design, tmp_path / "train.toml")
    assert main(["find", str(tmp_path / "train.toml"), "top-speed", "--json"]) == 0
    top = json.loads(capsys.readouterr().out)["answer"]["shaft.speed_rpm"]
    floats = Study(design).lift_off.omega * 30.0 / math.pi
    assert floats * (1.0 - 1e-5) < top <= floats


def test_many_trains_that_stay_closed_have_a_reason() -> None:
    closed = put(put(trained("pushrod_train.toml", 0.2), "follower.pad_mm", 4.0), "valve.lash_mm", 3.0)
    for path in ("loads.preload_n", "shaft.speed_rpm", "follower.pushrod_mm"):
        result = many(closed, {path: get(closed, path) * np.array([1.0, 1.001])}, ["contact_force_n:max"])
        assert result.reason.tolist() == ["no-assembly"] * 2
        assert np.isnan(result.value["contact_force_n:max"]).all()


# -- opening and seating ----------------------------------------------------------------------------------------


def figures(design: Design, folder: Path, capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    save(design, folder / "train.toml")
    assert main(["valve", str(folder / "train.toml"), "--json"]) == 0
    return json.loads(capsys.readouterr().out)["valves"][0]


def test_opening_velocity_is_that_of_the_ramp_through_the_train(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    omega = 2000.0 * 360.0 / 60.0  # cam degrees per second
    assert figures(direct(), tmp_path, capsys)["opening_velocity_mm_s"] == pytest.approx(0.01 * omega, rel=1e-9)
    design = trained("pushrod_train.toml", 0.25)
    train = figures(design, tmp_path, capsys)
    study = Study(design)
    tappet = study.lash.at_motion
    near = int(np.argmin(np.abs(study.motion.displacement[0][:1800] - tappet)))
    ratio = float(value(study, "rocker_ratio")[near])
    assert train["opening_velocity_mm_s"] == pytest.approx(0.01 * omega * ratio, rel=1e-3)
    assert train["seating_velocity_mm_s"] == pytest.approx(train["opening_velocity_mm_s"], rel=1e-9)
    assert train["valve_lift_mm"] == pytest.approx(
        MM * value(Study(design, samples=36_000), "valve_lift").max(), rel=1e-6
    )
    event = next(event for event in train["events"] if event["of"] == "valve" and event["at_mm"] == 1.0)
    cam = study.design.drive.motion.lobe.nose_at_deg + (event["opens_deg"] - 108.0) / 2.0
    assert MM * value(study.at_theta(np.deg2rad([cam])), "valve_lift")[0] == pytest.approx(1.0, abs=1e-9)


def test_a_valve_by_the_slider_of_a_linkage_opens_with_its_slide() -> None:
    design = trained_linkage(0.2)
    study = Study(design)
    slide = study.linkage.coordinates["slide6"][0]
    travel = slide - slide.min()
    assert value(study, "valve_lift") == pytest.approx(np.maximum(travel - 0.2e-3, 0.0), abs=1e-12)
    loose = travel < 0.2e-3 - 1e-9
    assert not np.any(value(study, "contact_force")[loose])
    assert np.abs(value(study, "contact_force")[~loose]).max() > 1.0


def test_a_valve_that_its_train_does_not_open_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    backwards = put(trained_linkage(0.2), "linkage.sliders[1].angle_deg", 90.0)
    short = put(trained("pushrod_train.toml", 0.2), "follower.pad_mm", 4.0)
    closed = put(short, "valve.lash_mm", 3.0)  # of a tappet that lifts 7 mm, and a valve that would lift 1.1 mm
    upside_down = put(trained("finger_follower.toml", 0.1), "follower.valve_direction_deg", 90.0)
    for design, field, words in (
        (backwards, "valve.link", "slide of link 6"),
        (put(backwards, "valve.lash_mm", 0.0), "valve.link", "turn angle_deg of this slider by 180°"),
        (closed, "valve.lash_mm", "its lash is 3 mm, and the train moves it by 1.1"),
        (upside_down, "follower.valve_direction_deg", "would open while the roller moves towards the cam"),
    ):
        save(design, tmp_path / "train.toml")
        for command in (["check"], ["valve"], ["export", "--out", str(tmp_path / "out")]):
            assert main([command[0], str(tmp_path / "train.toml"), *command[1:]]) == 2
            (line,) = capsys.readouterr().err.splitlines()
            assert field in line
            assert words in line


@pytest.mark.parametrize("nose", [20.0, 71.3, 180.0, 215.8288102991798, 333.0])
def test_a_pushrod_train_without_lash_opens_wherever_its_nose_is(
    nose: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    design = put(trained("pushrod_train.toml", 0.0), "motion.lobe.nose_at_deg", nose)
    for lift in (7.0, 7.3, 11.76018473):
        train = put(design, "motion.lobe.lift_mm", lift)
        top = MM * value(Study(train, samples=36_000), "valve_lift").max()
        assert figures(train, tmp_path, capsys)["valve_lift_mm"] == pytest.approx(top, rel=1e-6)


LEVER = """format = 1
name = "Finger by its angle"
[motion]
start_deg = 0.0
segments = [
  { law = "dwell", span_deg = 120.0 },
  { law = "modified-sine", span_deg = 60.0, rise_deg = 12.0 },
  { law = "modified-sine", span_deg = 60.0, rise_deg = -12.0 },
  { law = "dwell", span_deg = 120.0 },
]
[linkage]
driver = { link = 2, kind = "motion" }
drawn = { B = [22.0, -30.0], driver_deg = 0.0 }
links = [
  { number = 1, points = { P = [-18.0, -35.0] } },
  { number = 2, points = { P = [0.0, 0.0], F = [20.0, 8.0], B = [40.0, 5.0] } },
  { number = 3, points = { B = [0.0, 0.0] } },
  { number = 4, points = { T = [0.0, 0.0] } },
]
sliders = [
  { link = 4, on = 1, through = [22.0, -30.0], angle_deg = 90.0 },
  { link = 3, on = 4, through = [0.0, 0.0], angle_deg = 90.0 },
]
[cam]
link = 2
point = "F"
roller_radius_mm = 8.0
form = "open"
[shaft]
rotation = "ccw"
speed_rpm = 1000.0
[engine]
stroke_mm = 84.0
rod_mm = 138.0
[valve]
centre_deg = 108.0
lash_mm = 0.2
link = 4
"""


def test_a_lever_that_the_motion_turns_has_figures_of_its_valve_only(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A motion in degrees is no lift: the pad of the finger rises by p (sin(β + φ) - sin β)."""
    pad, start = abs(40.0 + 5.0j), math.atan2(5.0, 40.0)
    lift = pad * (math.sin(start + math.radians(12.0)) - math.sin(start)) - 0.2
    valve = figures(loads(LEVER), tmp_path, capsys)
    assert valve["valve_lift_mm"] == pytest.approx(lift, abs=1e-9)
    assert {event["of"] for event in valve["events"]} == {"valve"}
    assert not {"lobe_lift_mm", "intensity_deg", "velocity_mm_per_deg", "acceleration_mm_per_deg2"} & set(valve)
    study, event = Study(loads(LEVER)), valve["events"][1]
    ends = np.deg2rad([180.0 + (event[end] - 108.0) / 2.0 for end in ("opens_deg", "closes_deg")])
    assert MM * value(study.at_theta(ends), "valve_lift") == pytest.approx([1.27, 1.27], abs=1e-9)
    assert main(["valve", str(tmp_path / "train.toml")]) == 0
    assert "lobe" not in capsys.readouterr().out


def trained_linkage(lash: float) -> Design:
    """Pushrod train that was typed as a linkage."""
    text = (
        LINKAGE
        + f"[engine]\nstroke_mm = 84.0\nrod_mm = 138.0\n[valve]\ncentre_deg = 108.0\nlash_mm = {lash}\nlink = 6\n"
    )
    return loads(text)


LINKAGE = """format = 1
name = "Pushrod"
[motion]
start_mm = 0.0
[motion.lobe]
lift_mm = 7.0
duration = [[0.15, 276.0], [1.27, 214.0]]
ramp_mm = 0.2
ramp_runup_deg = 8.0
[linkage]
driver = { link = 2, kind = "motion" }
drawn = { S = [0.0, 238.0], B = [50.0, 238.0], driver_mm = 0.0 }
links = [
  { number = 1, points = { P = [25.0, 240.0] } },
  { number = 2, points = { F = [0.0, 0.0], Q = [8.0, 0.0] } },
  { number = 3, points = { Q = [0.0, 0.0], S = [208.0, 0.0] } },
  { number = 4, points = { P = [0.0, 0.0], S = [-25.0, 0.0], B = [38.0, 0.0] } },
  { number = 5, points = { B = [0.0, 0.0] } },
  { number = 6, points = { T = [0.0, 0.0] } },
]
sliders = [
  { link = 2, on = 1, through = [0.0, 22.0], angle_deg = 90.0 },
  { link = 6, on = 1, through = [62.0, 240.0], angle_deg = -90.0 },
  { link = 5, on = 6, through = [0.0, 0.0], angle_deg = 90.0 },
]
[cam]
link = 2
point = "F"
roller_radius_mm = 8.0
form = "open"
[shaft]
rotation = "ccw"
speed_rpm = 1000.0
[[loads.masses]]
link = 6
mass_kg = 0.1
inertia_kg_m2 = 0.0
centre = [0.0, 0.0]
"""


# -- the ramp ---------------------------------------------------------------------------------------------------


def test_a_lash_above_the_ramp_is_a_warning() -> None:
    assert ("lash-beyond-ramp", "motion.lobe.ramp_mm") in codes(direct(lash=0.25))
    assert "lash-beyond-ramp" not in dict(codes(direct(lash=0.2)))
    closing = "[motion.lobe.closing]\nramp_mm = 0.25\nramp_mm_per_deg = 0.007\nto_nose = [[1.27, 108.0]]\n"
    assert "lash-beyond-ramp" in dict(codes(direct(lash=0.22, closing=closing)))
    low = "[motion.lobe.closing]\nramp_mm = 0.12\n"
    assert ("lash-beyond-ramp", "motion.lobe.closing.ramp_mm") in codes(direct(lash=0.15, closing=low))
