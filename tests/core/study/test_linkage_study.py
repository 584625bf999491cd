"""core.study, core.output.channels and core.output.export for linkages: stages, columns, extremes, findings, and the cam that a linkage
asks for."""

import json
import math
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linkages import INSIDE_OUT, four_bar, link, sides, slider_crank
from mechanisms import LIFT
from sampled import spread

from core.design import (
    Design,
    Drive,
    Driver,
    Linkage,
    LinkageCam,
    LinkageLoads,
    LinkForce,
    Motion,
    NamedCurve,
    Roller,
    Segment,
    put,
    with_drive,
)
from core.errors import NoAssembly, NoCam, NoPosition, NoSuchStage
from core.output.channels import channels
from core.output.export import files
from core.output.report import report
from core.output.summary import summary
from core.project import load, loads
from core.study import Study, certificate_of, evaluations, extremes_of, findings_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
LINKAGES = sorted(p.stem for p in EXAMPLES.glob("*.toml") if "\n[linkage]\n" in p.read_text("utf-8"))
TURN = 2.0 * math.pi


def example(name: str) -> Design:
    design = load(EXAMPLES / f"{name}.toml")
    assert design.drive.is_linkage
    return design


def study_of(design: Design, samples: int = 72) -> Study:
    study = Study(design, samples)
    assert study.design.drive.is_linkage
    return study


def table(text: str) -> dict[str, np.ndarray]:
    head, *rows = text.splitlines()
    columns = np.array([[float(v) for v in row.split(",")] for row in rows]).T
    return dict(zip(head.split(","), columns, strict=True))


# -- stages -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "stages"),
    [
        ("lecture_six_bar", ("linkage", "dynamics")),
        ("rear_suspension", ("motion", "linkage", "dynamics")),
        ("four_bar_coupler_cam", ("motion", "linkage", "cam", "dynamics")),
    ],
)
def test_a_linkage_has_the_stages_it_can_have(name: str, stages: tuple[str, ...]) -> None:
    study = study_of(example(name))
    assert study.stages == stages
    for missing in {"motion", "linkage", "cam", "dynamics", "stability"} - set(stages):
        with pytest.raises(NoSuchStage) as caught:
            getattr(study, missing)
        assert ", ".join(stages) in str(caught.value)
        with pytest.raises(NoSuchStage):
            study.require_stage(missing)


def test_stages_are_computed_when_asked_for_and_kept() -> None:
    design = example("four_bar_coupler_cam")
    before = Counter(evaluations)
    study = study_of(design)
    _ = study.linkage
    assert Counter(evaluations) - before == {"motion": 1, "linkage": 1}
    _ = study.dynamics, study.cam, study.dynamics
    assert Counter(evaluations) - before == {"motion": 1, "linkage": 1, "cam": 1, "dynamics": 1}
    heavier = with_drive(design, loads=replace(design.drive.loads, forces=(LinkForce(link=4, point="D", y_n=-200.0),)))
    assert study_of(heavier).linkage is study.linkage, "an edit of the loads solves no linkage"
    assert study_of(heavier).cam is study.cam
    assert study_of(heavier).dynamics is not study.dynamics
    assert study_of(replace(design, name="another")).dynamics is study.dynamics


def test_nobody_can_spoil_what_others_share() -> None:
    study = study_of(example("lecture_six_bar"))
    for array in (study.linkage.bodies["link4"].z, study.centres.centre("frame", "link3").point, study.dynamics.torque):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0


def test_a_crank_that_cannot_turn_is_looked_at_where_it_can() -> None:
    """Rows where it stands, an error that names the ranges, infinite extremes at the dead centres."""
    study = study_of(four_bar(100.0, 80.0, 60.0, 70.0), 360)
    limit = math.degrees(study.driver_ranges.ranges[0].high)
    degrees = study.angle_degrees
    assert degrees.size == 2 * math.floor(limit) + 1
    assert (np.minimum(degrees, 360.0 - degrees) < limit).all()
    (error,) = [f for f in findings_of(study, ("linkage",)) if f.severity == "error"]
    assert error.code == "crank-cannot-turn"
    assert f"0...{limit:.4g}, {360.0 - limit:.4g}...360 deg" in error.message
    assert error.cam_angle_deg == pytest.approx(limit)
    extremes = extremes_of(study, "linkage")
    assert extremes["link.4_velocity"].high.value == math.inf
    assert math.isfinite(extremes["link.4"].high.value)
    assert table(files(study)["linkage.csv"])["driver_angle_deg"].size == degrees.size
    assert json.loads(files(study)["summary.json"])["extremes"]["link4_rad_s"]["max"]["value"] is None


def test_a_linkage_that_stands_nowhere_has_no_answer() -> None:
    with pytest.raises(NoPosition, match="cannot be assembled at any position of the driver"):
        _ = study_of(four_bar(300.0, 30.0, 60.0, 70.0)).linkage


def test_a_motion_that_asks_too_much_names_its_angles() -> None:
    design = example("rear_suspension")
    assert design.drive.motion is not None
    far = Motion(
        182.0, (Segment(180.0, 60.0, NamedCurve("cycloidal")), Segment(180.0, -60.0, NamedCurve("cycloidal"))), "deg"
    )
    with pytest.raises(NoAssembly) as caught:
        _ = study_of(with_drive(design, motion=far)).linkage
    ((low, high),) = caught.value.cam_angles
    assert 0.0 < low < 180.0 < high < 360.0
    assert high == pytest.approx(360.0 - low, abs=1e-9)
    reached = 182.0 + 60.0 * (low / 180.0 - math.sin(math.tau * low / 180.0) / math.tau)
    assert f"at cam angle {low:.4g}...{high:.4g} deg" in str(caught.value)
    assert f"within 182...{reached:.4g} deg, but the motion moves it to {reached:.4g}...242 deg" in str(caught.value)


REFUSED = """
format = 1
name = "four links closed at once, by a slide"
[motion]
start_mm = 1.3
segments = [{ law = "cycloidal", span_deg = 105.0, rise_mm = 37.8 }, { law = "dwell", span_deg = 30.0 },
            { law = "3-4-5", span_deg = 225.0, rise_mm = -37.8 }]
[linkage]
driver = { link = 2, kind = "motion", speed_rpm = 24.0 }
drawn = { A = [-34.1215, 9.678], P3 = [34.966, -61.8009], P4 = [78.5607, -67.0124], P5 = [57.1654, -21.5659] }
links = [
    { number = 1, points = { P1 = [88.8294, -185.5564], P2 = [158.7608, 11.6645] } }, { number = 2, points = { A = [18.1981, 5.0841] } },
    { number = 3, points = { P3 = [0, 0], P4 = [28.7648, 33.2133], P5 = [-19.7034, 43.6256] } },
    { number = 4, points = { A = [2.658, -4.0905], P3 = [-44.3062, 86.8775] } },
    { number = 5, points = { P1 = [0, 0], P4 = [-40.2318, -111.9902] } },
    { number = 6, points = { P2 = [10.5865, -10.6622], P5 = [-86.2781, -53.4921] } },
]
sliders = [{ link = 2, on = 1, through = [-15.6694, 13.4118], angle_deg = 171.14 }]
"""


@pytest.mark.stress
def test_a_refused_group_is_refused_with_few_solutions() -> None:
    """Its ends are found many angles at a time: one at a time took over five hundred solutions."""
    study = study_of(loads(REFUSED))
    evaluations.clear()
    with pytest.raises(NoAssembly) as caught:
        _ = study.linkage
    assert evaluations["linkage"] < 60
    ((low, high),) = caught.value.cam_angles
    for angle, outwards in ((low, -1e-5), (high, 1e-5)):
        with pytest.raises(NoAssembly):
            _ = study.at_theta(np.deg2rad([angle - outwards])).linkage
        _ = study.at_theta(np.deg2rad([angle + outwards])).linkage


# -- columns ----------------------------------------------------------------------------------------------


def test_the_columns_of_the_six_bar_hold_what_their_names_say() -> None:
    design = example("lecture_six_bar")
    study = study_of(design, 360)
    columns = table(files(study)["linkage.csv"])
    assert list(columns)[:4] == ["driver_angle_deg", "link3_deg", "link3_rad_s", "link3_rad_s2"]
    assert not any(name.startswith("link2_") for name in columns), "the crank is the driver angle"
    assert (columns["driver_angle_deg"] == np.arange(360.0)).all()
    at = 45
    assert columns["link4_deg"][at] == pytest.approx(60.0, abs=1e-12)
    assert columns["link4_rad_s"][at] == pytest.approx(20.566558 * math.pi / 30.0, abs=1e-7)
    assert columns["D_x_mm"][at] == pytest.approx(120.0, abs=1e-11)
    assert columns["D_vx_mm_s"][at] == pytest.approx(-223.82166, abs=1e-5)
    assert columns["link6_slide_mm"][at] == pytest.approx(120.0, abs=1e-11)
    assert columns["transmission_D_deg"][at] == pytest.approx(30.0, abs=1e-12)
    assert columns["A_speed_mm_s"] == pytest.approx(20.0 * TURN)
    assert np.abs(columns["D_y_mm"]).max() == 0.0


def test_rates_are_by_time_with_the_cranks_sense() -> None:
    """Derivatives of one column are the next: by spectral differentiation over the turn."""
    for speed in (60.0, -45.0):
        design = four_bar(100.0, 30.0, 90.0, 70.0)
        design = put(design, "linkage.driver.speed_rpm", speed)
        study = study_of(design, 720)
        c = table(files(study)["linkage.csv"])
        omega = speed * math.pi / 30.0
        for value, rate, scale in (
            ("link4_deg", "link4_rad_s", math.pi / 180.0),
            ("link4_rad_s", "link4_rad_s2", 1.0),
            ("B_x_mm", "B_vx_mm_s", 1.0),
            ("B_vy_mm_s", "B_ay_mm_s2", 1.0),
        ):
            waves = np.fft.rfft(c[value] * scale) * 1j * np.arange(361)
            slope = np.fft.irfft(waves) * omega
            assert np.abs(slope - c[rate]).max() <= 1e-9 * np.abs(c[rate]).max(), rate


@pytest.mark.parametrize("name", spread(LINKAGES, 3))
def test_every_channel_of_every_example_has_a_value_at_every_angle(name: str) -> None:
    study = study_of(example(name), 24)
    rows = channels(study.design)
    assert len({row.slug for row in rows}) == len(rows)
    for row in rows:
        values = row.values(study)
        assert values.shape == (24,), row.slug
        assert row.unit.symbol or row.slug.endswith("factor"), row.slug
        assert row.stage in study.stages
    told = files(study)
    expected = {"linkage.csv", "dynamics.csv", "summary.json"}
    expected |= {"kinematics.csv"} if "motion" in study.stages else set()
    expected |= {"profile.csv"} if "cam" in study.stages else set()
    assert set(told) == expected
    for text in told.values():
        assert "nan" not in text
    assert files(study) == told


@pytest.mark.parametrize("name", spread(LINKAGES, 3))
def test_every_example_is_sound(name: str) -> None:
    """No error, every residual within its bound, a report that tells the linkage."""
    study = study_of(example(name))
    assert [f for f in findings_of(study) if f.severity == "error"] == []
    for residual in certificate_of(study).values():
        assert residual.kept
    text = report(study)
    for heading in ("Linkage", "Extremes over one turn", "Findings", "Certificate"):
        assert f"\n{heading}\n{'-' * len(heading)}\n" in text
    assert "NOT KEPT" not in text
    told = summary(study, study.stages)
    assert told["kind"] == "linkage"
    assert told["mobility"] == 1
    json.dumps(told, allow_nan=False)


def test_the_four_bar_is_told_as_grashof_says() -> None:
    told = summary(study_of(example("four_bar")), ("linkage",))
    assert told["four_bar"] == pytest.approx(
        {"ground_mm": 100.0, "crank_mm": 30.0, "coupler_mm": 90.0, "rocker_mm": 70.0, "kind": "crank-rocker"}
    )
    assert "Four-bar: crank-rocker (Grashof)" in report(study_of(example("four_bar")))


def test_extremes_of_the_rocker_are_the_lectures_toggle_positions() -> None:
    """The rocker turns back where crank and coupler lie in line: by the law of cosines."""
    extremes = extremes_of(study_of(four_bar(100.0, 30.0, 90.0, 70.0)), "linkage")
    for reach, side in ((120.0, "low"), (60.0, "high")):
        exact = math.pi - math.acos((100.0**2 + 70.0**2 - reach**2) / (2.0 * 100.0 * 70.0))
        found = getattr(extremes["link.4"], side)
        assert found.value == pytest.approx(exact, abs=1e-13)
        pin = math.acos((100.0**2 + reach**2 - 70.0**2) / (2.0 * 100.0 * reach))
        expected = pin if reach > 100.0 else pin + math.pi
        assert found.theta == pytest.approx(expected, abs=1e-6)


# -- findings ---------------------------------------------------------------------------------------------


def test_a_flat_transmission_angle_is_a_warning_with_its_angle() -> None:
    """μ is lowest where the crank points along the frame: law of cosines."""
    (found,) = findings_of(study_of(four_bar(100.0, 55.0, 80.0, 85.0)), ("linkage",))
    lowest = math.degrees(math.acos((80.0**2 + 85.0**2 - 45.0**2) / (2.0 * 80.0 * 85.0)))
    other = 180.0 - math.degrees(math.acos((80.0**2 + 85.0**2 - 155.0**2) / (2.0 * 80.0 * 85.0)))
    assert (found.code, found.severity) == ("transmission-angle", "warning")
    assert found.values["value"] == pytest.approx(min(lowest, other), abs=1e-9)
    assert found.cam_angle_deg == pytest.approx(180.0 if other < lowest else 0.0, abs=1e-6)


def test_change_points_are_warnings_with_their_angles() -> None:
    found = findings_of(study_of(four_bar(100.0, 40.0, 100.0, 40.0)), ("linkage",))
    assert [(f.code, round(f.cam_angle_deg or 0.0, 5)) for f in found] == [
        ("change-point", 0.0),
        ("change-point", 180.0),
    ]


@pytest.mark.stress
def test_a_group_is_shown_with_its_residual() -> None:
    study = study_of(INSIDE_OUT, 90)
    assert [f.code for f in findings_of(study, ("linkage",))] == ["crank-cannot-turn"]
    residual = certificate_of(study, ("linkage",))["loop_closure"]
    assert residual.kept
    assert residual.value < 1e-13
    assert "group 2-3-4-5" in report(study)
    assert study.dynamics.torque.shape == study.theta.shape


def test_a_group_is_found_at_every_position_up_to_its_dead_centres() -> None:
    study = study_of(INSIDE_OUT, 90)
    (open_range,) = study.driver_ranges.ranges
    near = np.geomspace(1e-8, 1e-1, 3000)
    there = study.at_theta(np.concatenate((open_range.low + near, open_range.high - near)))
    assert there.linkage.residual.max() < 1e-12


# -- the cam that a linkage asks for ----------------------------------------------------------------------


def test_the_lift_seen_as_a_linkage_gets_the_lifts_cam() -> None:
    ours, theirs = study_of(example("cam_slider_linkage"), 720), Study(LIFT, 720)
    assert ours.cam.rotation_sign == theirs.cam.rotation_sign
    for name in (
        "pitch",
        "profile",
        "normal",
        "pressure_angle",
        "pitch_curvature",
        "pitch_curvature_slope",
        "profile_curvature",
    ):
        one, other = getattr(ours.cam.flank, name), getattr(theirs.cam.flank, name)
        assert np.abs(one - other).max() <= 1e-12 * np.abs(other).max(), name
    there = table(files(theirs)["profile.csv"])
    here = table(files(ours)["profile.csv"])
    assert next(iter(here)) == "cam_angle_deg"
    assert np.abs(here["x_mm"] - there["x_mm"]).max() < 1e-9
    assert np.abs(here["y_mm"] - there["y_mm"]).max() < 1e-9


@pytest.mark.parametrize("speed", [60.0, -60.0])
def test_a_cam_under_a_coupler_moves_its_four_bar(speed: float) -> None:
    """Turned back by its angle, the profile touches the roller on the coupler, everywhere and nowhere cuts it; and the
    followed link is where its motion says."""
    design = put(example("four_bar_coupler_cam"), "linkage.driver.speed_rpm", speed)
    study = study_of(design, 1440)
    kinematics, flank = study.linkage, study.cam.flank
    roller = kinematics.bodies["link3"].point("C")[0]
    assert np.abs(roller - kinematics.follower.z[0]).max() == 0.0
    for i in range(0, 1440, 90):
        turned = flank.profile * np.exp(1j * math.copysign(1.0, speed) * study.theta[i])
        assert np.abs(turned - roller[i]).min() == pytest.approx(0.015, rel=1e-6)
    assert np.abs(kinematics.bodies["link4"].angle[0] - study.motion.y[0]).max() < 1e-15
    assert certificate_of(study, ("cam",))["instant_centre"].value < 1e-13
    columns = table(files(study)["profile.csv"])
    assert {"cam_angle_deg", "x_mm", "y_mm", "pitch_x_mm", "pressure_angle_deg", "radius_mm"} <= set(columns)
    assert columns["cam_angle_deg"].size == 1440


def test_the_pressure_angle_is_against_the_rollers_way_also_in_a_dwell() -> None:
    study = study_of(example("four_bar_coupler_cam"), 360)
    kinematics, flank = study.linkage, study.cam.flank
    moving = np.abs(kinematics.follower.z[1]) > 1e-9
    way = kinematics.follower.z[1][moving] / np.abs(kinematics.follower.z[1][moving])
    angle = np.arccos(np.minimum(1.0, np.abs((flank.normal[moving] * way.conjugate()).real)))
    assert np.abs(angle - flank.pressure_angle[moving]).max() < 1e-7
    assert np.isfinite(flank.pressure_angle).all()
    assert not moving.all()


def test_a_roller_beside_its_best_place_is_a_finding_and_over_the_centre_is_no_cam() -> None:
    design = example("four_bar_coupler_cam")
    steep = put(design, "linkage.links[2].points.C", (140.0, -50.0))
    found = {f.code: f for f in findings_of(study_of(steep, 90), ("cam",))}
    assert found["roller-pressure-angle"].field == "cam.point"
    covering = with_drive(design, cam=LinkageCam(link=3, point="C", face=Roller(90.0)))
    with pytest.raises(NoCam, match=r"cam\.point: the roller covers the cam centre"):
        _ = study_of(covering, 90).cam


def test_a_roller_on_a_link_that_slides_and_on_the_followed_link_itself() -> None:
    """The two easy places: a translating and an oscillating follower, as a linkage."""
    motion = Motion(
        0.0, (Segment(180.0, 20.0, NamedCurve("cycloidal")), Segment(180.0, -20.0, NamedCurve("cycloidal"))), "mm"
    )
    links = (link(1, O=(0, 0)), link(2, R=(60, 0)))
    from core.design import Slider

    rail = Slider(link=2, on=1, angle_deg=90.0)
    linkage = Linkage(links, (rail,), Driver(2, "motion", 60.0))
    cam = LinkageCam(link=2, point="R", face=Roller(10.0))
    design = Design("tappet", None, (Drive(motion, linkage, cam, LinkageLoads()),))
    study = study_of(design, 360)
    assert np.abs(study.linkage.follower.z[0] - 1j * (0.06 + study.motion.y[0])).max() < 1e-16
    assert study.cam.flank.pressure_angle[0] == pytest.approx(0.0, abs=1e-12)
    assert certificate_of(study)["instant_centre"].kept
    assert {f.code for f in findings_of(study)} <= {"no-load", "pressure-angle", "roller-pressure-angle", "undercut"}


def test_driving_angles_may_be_any() -> None:
    study = study_of(slider_crank(40.0, 140.0))
    there = study.at_theta(np.array([0.3, 7.0, -1.0]))
    assert np.degrees(there.theta) == pytest.approx(np.degrees(np.remainder([0.3, 7.0, -1.0], TURN)))
    assert there.linkage.bodies["link4"].x.shape == (4, 3)
    assert sides(B=1)[0].side == 1


def test_a_crank_that_can_hardly_move_is_refused_where_no_angle_lies_in_its_range() -> None:
    """Between two samples there is nothing to tabulate or draw: the range is named, and finer samples find it."""
    straight = four_bar(100.0, 50.0, 60.0, 40.0)  # with the frame as long as 150 all links lie in one line
    pivot = 149.9999999 * np.exp(0.01j)
    frame = link(1, O2=(0, 0), O4=(pivot.real, pivot.imag))
    design = with_drive(
        straight, mechanism=replace(straight.drive.mechanism, links=(frame, *straight.drive.mechanism.links[1:]))
    )
    told = r"linkage\.links: .* within 0\.57\.\.\.0\.5759 deg, which contain none of the 90 driver angles"
    with pytest.raises(NoPosition, match=told):
        _ = study_of(design, 90).angles
    assert study_of(design, 36_000).angles.theta.size == 1


@pytest.mark.parametrize(("rod", "offset"), [(60.0, 100.0), (1e-7, 0.0)])
def test_a_linkage_that_stands_at_single_positions_only_has_no_range(rod: float, offset: float) -> None:
    """Rounding alone would decide where such a range ends."""
    with pytest.raises(NoPosition, match="or at single ones only"):
        _ = study_of(slider_crank(40.0, rod, offset), 360).driver_ranges
    assert len(study_of(slider_crank(40.0, 39.0)).driver_ranges.ranges) == 3
