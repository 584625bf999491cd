"""Several drives on one shaft: files, one of several alone, edits of the list, torque of all together, timing, what is missing."""

import csv
import json
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from core.__main__ import main
from core.design import (
    Balancer,
    Design,
    ElasticShaft,
    LinkageLoads,
    LinkMass,
    Shaft,
    TimingRow,
    add_drive,
    as_list,
    contradiction,
    copy_drive,
    distances,
    drive_names,
    edited,
    events,
    faults,
    get,
    move_drive,
    only,
    put,
    remove_drive,
    rename_drive,
    slug,
    with_drive,
    with_elastic,
    with_only,
    with_phase,
)
from core.errors import DesignError, NoSolution
from core.output.export import camshaft_columns
from core.project import dumps, load, loads, save, to_table
from core.shaft import torque_at
from core.study import Study, certificate_of, evaluations, findings_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
UNIT = load(EXAMPLES / "transfer_unit.toml")
LIFT = load(EXAMPLES / "transfer_lift.toml")
CRANK = load(EXAMPLES / "slider_crank.toml")
SAMPLES = 720
RIGID = with_elastic(UNIT, None)
SPRING = Balancer(spring_rate_n_per_mm=20.0, preload_n=4000.0, base_radius_mm=250.0, roller_radius_mm=40.0)


@pytest.fixture(scope="module")
def unit() -> Study:
    return Study(UNIT, SAMPLES)


def table(path: Path) -> dict[str, np.ndarray]:
    names, *rows = csv.reader(path.read_text("utf-8").splitlines())
    return dict(zip(names, np.array(rows, dtype=float).T, strict=True))


def exported(design: Design, folder: Path, *options: str, expected: int = 0) -> Path:
    """The folder of an export of the design, 360 angles a turn."""
    folder.mkdir()
    save(design, folder / "design.toml")
    assert (
        main(["export", str(folder / "design.toml"), "--out", str(folder / "out"), "--samples", "360", *options])
        == expected
    )
    return folder / "out"


def with_crank(design: Design) -> Design:
    """With a crank and what it moves as one drive more, as fast as the shaft."""
    return add_drive(design, CRANK, "Crank")


# -- files --------------------------------------------------------------------------------------------------


def test_a_file_of_drives_comes_back_as_it_was() -> None:
    design = replace(with_phase(with_crank(UNIT), 4, 12.5), balancer=SPRING)
    text = dumps(design)
    assert loads(text) == design
    assert dumps(loads(text)) == text
    assert text.count("[[drives]]\n") == 5
    assert get(design, "drives[2].cam.base_radius_mm") == get(LIFT, "cam.base_radius_mm")
    assert get(put(design, "drives[1].mirrored", False), "drives[1].mirrored") is False
    assert get(put(design, "timing[0].least_deg", 1.5), "timing[0].least_deg") == 1.5
    assert get(put(design, "balancer.preload_n", 700.0), "balancer.preload_n") == 700.0
    assert faults(design) == []


def drives(change: Callable[[list[dict[str, Any]]], object]) -> Callable[[dict[str, Any]], object]:
    return lambda file: change(file["drives"])


BAD: dict[str, tuple[Callable[[dict[str, Any]], object], dict[str, str]]] = {
    "one slug": (
        drives(lambda d: d[1].update(name="feed")),
        {"drives[1].name": "has the slug of drives[0].name, feed"},
    ),
    "one slug with a device": (
        drives(lambda d: (d[3].update(name="CON"), d[4].update(name="con_"))),
        {"drives[4].name": "has the slug of drives[3].name, con_"},
    ),
    "empty": (drives(lambda d: d[1].update(name=" - ")), {"drives[1].name": "has no letter and no digit"}),
    "long": (drives(lambda d: d[1].update(name="x" * 201)), {"drives[1].name": "is too long for the name of a folder"}),
    "motor": (
        drives(lambda d: d[1].update(name="Motor")),
        {"drives[1].name": "its slug, motor, is that of another column"},
    ),
    "balancer": (drives(lambda d: d[1].update(name="balancer")), {"drives[1].name": "its slug, balancer,"}),
    "phase": (drives(lambda d: d[2].update(phase_deg="late")), {"drives[2].phase_deg": "must be a number"}),
    "nan": (drives(lambda d: d[2].update(phase_deg=float("nan"))), {"drives[2].phase_deg": "outside its range"}),
    "side": (drives(lambda d: d[2].update(mirrored="yes")), {"drives[2].mirrored": "must be true or false"}),
    "unknown": (drives(lambda d: d[0].update(fase=3)), {"drives[0].fase": "unknown key"}),
    "inside": (
        drives(lambda d: (d[1]["cam"].update(base_radius_mm=-1.0), d[3]["follower"].update(offset_deg=1.0))),
        {"drives[1].cam.base_radius_mm": "outside its range", "drives[3].follower.offset_deg": "wrong unit"},
    ),
    "two kinds": (drives(lambda d: d[0].update(linkage={})), {"drives[0].linkage": "a drive has one mechanism"}),
    "beside": (lambda file: file.update(linkage={}), {"drives": "a design is of one kind"}),
    "none": (lambda file: file.update(drives=[]), {"drives": "must be a list of tables, one at least"}),
    "shaft": (lambda file: file.pop("shaft"), {"shaft": "missing"}),
    "event": (
        lambda file: file["timing"][1].update(second="Lift.return.2.start"),
        {"timing[1].second": "did you mean 'Lift.return.1.start'"},
    ),
    "slug of an event": (
        lambda file: file["timing"][1].update(second="lift.rise.7.start"),
        {"timing[1].second": "did you mean 'Lift.rise.1.start'?); allowed: Lift."},
    ),
    "drive of an event": (
        lambda file: file["timing"][1].update(second="Lfit.return.1.start"),
        {"timing[1].second": "no drive has the name Lfit; allowed: events of Feed | Clamp"},
    ),
    "speed": (
        drives(lambda d: d[4].update(mirrored=True)),
        {"drives[4].linkage.driver.speed_rpm": "differs from the shaft's speed"},
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_in_a_file_of_drives_is_named_by_its_path(name: str) -> None:
    change, expected = BAD[name]
    file = to_table(with_crank(UNIT))
    file.pop("assumed")
    change(file)
    with pytest.raises(DesignError) as caught:
        loads(tomli_w.dumps(file))
    found = {fault.path: str(fault) for fault in caught.value.faults}
    for path, text in expected.items():
        assert text in found.pop(path)
    if name not in ("beside", "shaft"):
        assert found == {}


@pytest.mark.parametrize("name", ["CON", "aux", "Prn", "NUL", "com1", "COM0", "Lpt9", "com¹"])
def test_a_slug_is_no_device_of_windows(name: str) -> None:
    assert slug(name) == f"{name.lower()}_"
    assert [slug(f"{name}{more}") for more in (" 2", "a", "_")] == [
        f"{name.lower()}{more}" for more in ("_2", "a", "_")
    ]


def test_slugs_keep_letters_and_digits_of_any_script() -> None:
    assert [slug(name) for name in ("Feed 2", "Vorschub-Größe", "상승", "A.b")] == [
        "feed_2",
        "vorschub_größe",
        "상승",
        "a_b",
    ]


# -- one of several -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("number", range(5))
def test_a_drive_taken_off_and_put_back_changes_nothing(number: int) -> None:
    design = with_crank(UNIT)
    alone = only(design, number)
    assert with_only(design, number, alone) == design
    assert faults(alone) == []
    assert Study(alone).stages


def test_an_edit_of_one_drive_is_that_of_it_alone() -> None:
    path = "motion.segments[0].span_deg"
    changed = edited(UNIT, f"drives[1].{path}", 30.0)
    assert only(changed, 1) == edited(only(UNIT, 1), path, 30.0)
    assert [only(changed, i) == only(UNIT, i) for i in range(4)] == [True, False, True, True]


def test_a_drive_edited_alone_takes_the_shaft_and_all_on_it_to_its_speed() -> None:
    design = with_crank(UNIT)
    alone = edited(only(design, 1), "shaft.speed_rpm", 25.0)  # the clamp is mirrored
    changed = with_only(design, 1, edited(alone, "shaft.rotation", "ccw"))
    assert changed.camshaft == replace(design.camshaft, speed_rpm=25.0, rotation="cw")
    assert changed.drives[4].linkage.driver.speed_rpm == -25.0
    assert faults(changed) == []
    assert edited(design, "shaft.speed_rpm", 25.0).drives[4].linkage.driver.speed_rpm == 25.0


def test_drives_are_added_copied_removed_moved_and_renamed_with_their_marks_and_timing() -> None:
    design = add_drive(UNIT, LIFT, "Lift")
    assert drive_names(design) == ("Feed", "Clamp", "Lift", "Torque", "Lift 2")
    assert {path for path in design.assumed if path.startswith("drives[4].")} == {
        f"drives[4].{path}" for path in LIFT.assumed if not path.startswith("shaft.")
    }
    again = copy_drive(design, 0)
    assert drive_names(again)[:2] == ("Feed", "Feed 2")
    assert only(again, 1) == replace(only(design, 0), name="Feed 2")
    assert remove_drive(again, 1) == design
    fewer = remove_drive(design, 2)
    assert [t for t in design.timing if "Lift." not in t.first + t.second] == list(fewer.timing)
    assert move_drive(move_drive(design, 3, 0), 0, 3) == design
    named = rename_drive(design, 2, "Heber")
    assert named == edited(design, "drives[2].name", "Heber")
    assert distances(named) == distances(design)
    for each in (design, again, fewer, named):
        assert faults(each) == []
        assert loads(dumps(each)) == each


# -- torque -------------------------------------------------------------------------------------------------


def test_the_shafts_torque_is_the_sum_of_single_exports_turned_by_their_phases(tmp_path: Path) -> None:
    design = with_crank(RIGID)
    mirrored = with_phase(copy_drive(design, 2), 3, 77.0)
    mirrored = put(mirrored, "drives[3].mirrored", True)
    out = exported(mirrored, tmp_path / "all", "--only", "dynamics")
    whole = table(out / "shaft.csv")
    total = np.zeros(360)
    for i, drive in enumerate(mirrored.drives):
        shaft = Shaft("cw" if drive.mirrored else "ccw", 20.0)
        single = Design("One", shaft, (replace(drive, name=None, phase_deg=0.0, mirrored=False),))
        own = table(exported(single, tmp_path / str(i), "--only", "dynamics") / "dynamics.csv")
        name = slug(drive.name or "")
        torque = own["drive_torque_nm" if drive.cam else "motor_torque_nm"]
        turned = np.roll(torque, round(drive.phase_deg))
        assert np.abs(whole[f"{name}_torque_nm"] - turned).max() <= 1e-12 * np.abs(turned).max()
        again = table(out / name / "dynamics.csv")
        figures = json.loads((out / name / "summary.json").read_text("utf-8"))["extremes"]
        assert figures
        assert "motor_torque_nm" not in figures, "the motor turns the whole"
        assert "motor_torque_nm" not in again
        assert all(np.array_equal(again[key], own[key]) for key in again)
        total += turned
    assert np.abs(whole["torque_nm"] - total).max() <= 1e-12 * np.abs(total).max()
    assert list(whole)[:2] == ["machine_angle_deg", "torque_nm"]
    assert list(whole)[-2:] == ["motor_torque_nm", "speed_rpm"]
    summary = json.loads((out / "summary.json").read_text("utf-8"))
    assert [row["slug"] for row in summary["drives"]] == ["feed", "clamp", "lift", "lift_2", "torque", "crank"]
    assert summary["extremes"]["torque_nm"]["max"]["value"] >= whole["torque_nm"].max()
    assert summary["certificate"]["power_balance"]["value"] <= 1e-12


def test_between_samples_too_a_drive_runs_by_the_machine_angle_less_its_phase(unit: Study) -> None:
    study = Study(with_phase(UNIT, 2, 33.337), SAMPLES)
    own = np.deg2rad((study.angle_degrees - 33.337) % 360.0)
    alone = Study(only(UNIT, 2)).at_theta(own).dynamics.torque
    assert np.abs(study.camshaft.drive_torque("Lift") - alone).max() <= 1e-12 * np.abs(alone).max()
    assert (
        np.abs(torque_at(study.camshaft.load, study.camshaft.theta) - study.camshaft.torque).max()
        <= 1e-12 * np.abs(study.camshaft.torque).max()
    )


def test_where_a_torque_jumps_the_sum_has_its_right_hand_limit_whatever_the_phases() -> None:
    design = RIGID
    for i in (0, 2):
        design = edited(design, f"drives[1].motion.segments[{i}].law", "parabolic")
    for phase in (238.0, 33.1, 104.0 / 3.0):
        study = Study(with_phase(design, 1, phase), SAMPLES)
        assert certificate_of(study, ("dynamics",))["power_balance"].kept
        assert (
            np.abs(torque_at(study.camshaft.load, study.camshaft.theta) - study.camshaft.torque).max()
            <= 1e-12 * np.abs(study.camshaft.torque).max()
        )
        own = (study.angle_degrees - phase) % 360.0
        alone = Study(only(design, 1)).at_theta(np.deg2rad(own)).dynamics.torque
        assert (
            np.abs(study.camshaft.drive_torque("Clamp") - alone)[np.abs(own % 1.0) > 1e-6].max()
            <= 1e-12 * np.abs(alone).max()
        )


def test_a_crank_turns_with_a_shaft_that_runs_clockwise() -> None:
    shaft = Shaft("cw", 30.0, flywheel_inertia_kg_m2=5.0)
    design = with_phase(replace(as_list(replace(CRANK, shaft=Shaft("cw", 30.0)), "Crank"), shaft=shaft), 0, 40.0)
    design = edited(design, "shaft.speed_rpm", 40.0)
    study = Study(design, 360)
    there = Study(only(design, 0), 360)
    assert np.array_equal(study.camshaft.torque, there.shaft_torque[(40 - np.arange(360)) % 360])
    assert (
        np.abs(torque_at(study.camshaft.load, study.camshaft.theta) - study.camshaft.torque).max()
        <= 1e-12 * np.abs(study.camshaft.torque).max()
    )
    assert certificate_of(study)["power_balance"].kept
    alone = Study(edited(replace(CRANK, shaft=shaft), "shaft.speed_rpm", 40.0), 360)
    speed = alone.flywheel.speed(alone.angles)
    assert np.abs(study.camshaft.speed - speed[(40 - np.arange(360)) % 360]).max() <= 1e-12 * study.omega


def test_one_drive_in_a_list_has_the_numbers_that_it_has_alone(tmp_path: Path) -> None:
    one, several = exported(LIFT, tmp_path / "one"), exported(as_list(LIFT, "Lift"), tmp_path / "several")
    own, whole = table(one / "dynamics.csv"), table(several / "shaft.csv")
    assert np.array_equal(whole["torque_nm"], own["drive_torque_nm"])
    for name in ("motor_torque_nm", "speed_rpm"):
        assert np.abs(whole[name] - own[name]).max() <= 1e-12 * np.abs(own[name]).max()
    for name in ("profile.csv", "kinematics.csv"):
        assert (several / "lift" / name).read_bytes() == (one / name).read_bytes()


@pytest.mark.stress
def test_a_crank_alone_has_the_flexible_shaft_that_it_has_in_a_list_either_way_round() -> None:
    """The machine turned over: mirrored, a clockwise crank is a counter-clockwise one."""
    masses = (LinkMass(link=2, mass_kg=1.0, inertia_kg_m2=2e-3), LinkMass(link=4, mass_kg=3.0))
    light = with_drive(CRANK, loads=LinkageLoads(masses=masses, gravity_m_s2=0.0))
    bands = []
    for rotation, speed in (("ccw", 300.0), ("cw", -300.0)):
        driver = replace(light.drive.linkage.driver, speed_rpm=speed)
        turned = with_drive(light, mechanism=replace(light.drive.linkage, driver=driver))
        design = replace(turned, shaft=Shaft(rotation, 300.0, elastic=ElasticShaft(0.01, 2000.0)))
        for each in (design, as_list(design, "crank")):
            found = Study(each, 360).flexible_shaft()
            bands.append([(band.n, band.eta_lo, band.eta_hi) for band in found.bands])
            assert all(residual.kept for residual in certificate_of(Study(each, 360), ("stability",)).values())
    assert len(bands[0]) > 2
    for other in bands[1:]:
        assert np.array(other) == pytest.approx(np.array(bands[0]), abs=1e-9)


def test_peak_and_root_mean_square_are_those_of_the_curve(unit: Study) -> None:
    theta = np.linspace(0.0, 2.0 * np.pi, 100_000, endpoint=False)
    dense = torque_at(unit.camshaft.load, theta)
    assert unit.camshaft.rms_torque == pytest.approx(np.sqrt((dense**2).mean()), rel=1e-7)
    assert unit.camshaft.mean_torque == pytest.approx(dense.mean(), abs=1e-6 * unit.camshaft.rms_torque)
    assert 0.0 <= unit.camshaft.peaks.high.value - dense.max() <= 1e-6 * dense.max()
    assert unit.camshaft.at_theta(np.array([unit.camshaft.peaks.low.theta])).torque[0] == pytest.approx(
        unit.camshaft.peaks.low.value, rel=1e-10
    )
    assert unit.camshaft.peak_power == pytest.approx(unit.camshaft.peaks.high.value * 20.0 * np.pi / 30.0)


def test_the_motors_inertia_counts_by_the_square_of_its_gear(unit: Study) -> None:
    shaft = UNIT.camshaft
    bare = replace(shaft, flywheel_inertia_kg_m2=2250.0 + 0.12 * 72.5**2, motor_inertia_kg_m2=None, gear_ratio=None)
    other = Study(replace(UNIT, shaft=bare), SAMPLES)
    assert np.allclose(unit.camshaft.speed, other.camshaft.speed, rtol=1e-12)
    assert unit.flywheel.needed_inertia == pytest.approx(other.flywheel.needed_inertia - 0.12 * 72.5**2)
    lowest, highest = unit.camshaft.motor_range["speed"].low.value, unit.camshaft.motor_range["speed"].high.value
    assert lowest <= unit.camshaft.speed.min() <= unit.camshaft.speed.max() <= highest
    assert (highest - lowest) / unit.omega == pytest.approx(0.02, rel=0.05), (
        "the flywheel of the example is of its own sizing"
    )


def test_an_edit_of_one_drive_computes_that_one_anew_and_a_phase_none(unit: Study) -> None:
    def computed(design: Design) -> Counter[str]:
        before = Counter(evaluations)
        study = Study(design, SAMPLES)
        assert study.camshaft.torque.size + study.camshaft.speed.size == 2 * SAMPLES
        return Counter(evaluations) - before

    computed(UNIT)
    heavier = edited(UNIT, "drives[2].loads.slider_mass_kg", 210.0)
    one_drive = computed(heavier)
    assert one_drive == computed(as_list(edited(LIFT, "loads.slider_mass_kg", 220.0), "Lift")) | one_drive
    assert {"dynamics", "shaft load", "flywheel"} <= one_drive.keys()
    assert computed(with_phase(heavier, 1, 239.0)) == {"shaft load": 1, "flywheel": 1}
    assert computed(rename_drive(heavier, 1, "Grip")) == {}
    assert computed(UNIT) == {}


# -- the flexible shaft -------------------------------------------------------------------------------------


def edges(design: Design) -> np.ndarray:
    found = Study(design).stability
    assert found is not None
    result: np.ndarray = found.exact.edges
    return result


def test_two_drives_that_move_as_one_shake_the_shaft_as_one_of_twice_the_loads() -> None:
    elastic = replace(UNIT.camshaft.elastic, camshaft_inertia_kg_m2=60.0, stiffness_nm_per_rad=1.6e6, damping_ratio=0.0)
    one = as_list(with_elastic(edited(LIFT, "shaft.speed_rpm", 900.0), elastic), "Lift")
    alone = Study(with_elastic(edited(LIFT, "shaft.speed_rpm", 900.0), elastic)).stability
    assert alone is not None
    assert np.array_equal(edges(one), alone.exact.edges)
    two = copy_drive(one, 0)
    twice = one
    for path in (
        "slider_mass_kg",
        "rod_mass_kg",
        "rod_inertia_kg_m2",
        "arm_mass_kg",
        "arm_inertia_kg_m2",
        "roller_mass_kg",
        "roller_inertia_kg_m2",
        "external_force_n",
    ):
        twice = put(twice, f"drives[0].loads.{path}", 2.0 * get(one, f"drives[0].loads.{path}"))
    expected = edges(twice)
    assert np.allclose(edges(two), expected, rtol=0.0, atol=1e-9)
    turned = with_phase(with_phase(two, 0, 123.4), 1, 123.4)
    assert np.allclose(edges(turned), expected, rtol=0.0, atol=1e-9), "no machine angle is the first"
    apart = edges(with_phase(two, 1, 60.0))
    assert not np.allclose(apart, expected, rtol=0.0, atol=1e-3)


# -- what is missing ----------------------------------------------------------------------------------------


def test_a_drive_that_cannot_be_assembled_takes_no_other_with_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = edited(UNIT, "drives[0].follower.arm_mm", 150.0)
    study = Study(broken, 360)
    assert list(study.camshaft.failures) == ["Feed"]
    assert study.camshaft.drive_torque("Lift").size == 360
    with pytest.raises(NoSolution, match=r"^drives\[0\]\.follower.*lacks the drive Feed"):
        assert study.camshaft.torque is None
    out = exported(broken, tmp_path / "broken", expected=1)
    assert set(table(out / "shaft.csv")) == {
        "machine_angle_deg",
        "lift_torque_nm",
        "clamp_torque_nm",
        "torque_torque_nm",
    }
    assert {path.name for path in out.iterdir()} == {"shaft.csv", "summary.json", "lift", "clamp", "torque"}
    (found,) = json.loads((out / "summary.json").read_text("utf-8"))["findings"]
    assert (found["code"], found["values"]["drive"]) == ("no-drive", "Feed")
    assert found["field"].startswith("drives[0].follower.")
    capsys.readouterr()
    assert main(["check", str(tmp_path / "broken" / "design.toml")]) == 1
    assert capsys.readouterr().out.startswith(
        "error: Feed: no solution, the other drives are computed without this one:"
    )
    assert main(["find", str(tmp_path / "broken" / "design.toml"), "flywheel"]) == 2
    assert capsys.readouterr().err.startswith("drives[0].follower.arm_mm: the shaft's torque lacks the drive Feed:")
    assert main(["report", str(tmp_path / "broken" / "design.toml"), "--samples", "360"]) == 1
    assert "Feed: no solution, the other drives are computed without this one:" in capsys.readouterr().out


def test_findings_name_the_drive_and_its_field() -> None:
    small = edited(UNIT, "drives[1].cam.base_radius_mm", 60.0)
    found = [f for f in findings_of(Study(small, 360), ("cam",)) if f.field.startswith("drives[1].cam")]
    assert found
    assert {f.values["drive"] for f in found} == {"Clamp"}


def test_a_motor_that_stalls_is_named_and_leaves_motor_and_speed_out() -> None:
    weak = replace(RIGID.camshaft, flywheel_inertia_kg_m2=1.0, motor_inertia_kg_m2=None, motor_slope_nm_s_per_rad=5.0)
    study = Study(replace(remove_drive(RIGID, 3), shaft=weak), 36)
    names = [name for name, _ in camshaft_columns(study.camshaft)]
    assert names == ["torque_nm", "feed_torque_nm", "clamp_torque_nm", "lift_torque_nm"]
    (stalls,) = [f for f in findings_of(study, ("dynamics",)) if f.code == "motor-stalls"]
    assert stalls.field == "shaft.flywheel_inertia_kg_m2"
    assert stalls.cam_angle_deg is not None
    assert f"over its peak at {stalls.cam_angle_deg:.1f}" in stalls.message


def test_the_balance_cam_stands_as_one_more_drive_and_leaves_the_mean(tmp_path: Path) -> None:
    design = replace(RIGID, balancer=SPRING)
    study = Study(design, 360)
    swing = np.ptp(study.camshaft.cams_torque)
    assert np.abs(study.camshaft.torque - study.camshaft.cams_load.mean).max() <= 1e-10 * swing
    columns = {name: values(study.camshaft) for name, values in camshaft_columns(study.camshaft)}
    assert np.allclose(
        columns["balancer_torque_nm"], columns["torque_nm"] - study.camshaft.cams_torque, rtol=0.0, atol=1e-12 * swing
    )
    out = exported(replace(as_list(LIFT, "Lift"), balancer=SPRING), tmp_path / "balanced", "--only", "dynamics")
    assert "balancer_torque_nm" in table(out / "shaft.csv")
    assert (out / "balancer" / "dynamics.csv").is_file()


# -- timing -------------------------------------------------------------------------------------------------


def test_strokes_of_several_segments_and_over_the_end_of_the_turn_are_one() -> None:
    at = events(UNIT)
    assert at["Feed.rise.1.start"] == 328.0
    assert at["Feed.rise.1.end"] == 32.0
    assert at["Lift.return.1.end"] == 76.5
    split = edited(UNIT, "drives[2].motion.segments[1].span_deg", 41.5)
    motion = split.drives[2].motion
    assert motion is not None
    first = motion.segments[1]
    halves = (replace(first, span_deg=20.0, rise=-70.0), replace(first, span_deg=21.5, rise=-80.0))
    segments = (*motion.segments[:1], *halves, *motion.segments[2:])
    alone = replace(only(UNIT, 2), drives=(replace(only(UNIT, 2).drive, motion=replace(motion, segments=segments)),))
    assert events(with_only(UNIT, 2, alone)) == at


def test_a_broken_distance_and_rows_that_contradict_each_other_are_found() -> None:
    assert all(row.kept for row in distances(UNIT))
    assert contradiction(UNIT) == ()
    late = with_phase(UNIT, 1, 241.0)
    broken = [i for i, row in enumerate(distances(late)) if not row.kept]
    codes = {f.code: f for f in findings_of(Study(late, 36)) if f.code.startswith("timing")}
    assert [f"timing[{i}]" for i in broken] == ["timing[5]"]
    assert codes.keys() == {"timing-broken"}, "other phases keep all"
    assert codes["timing-broken"].field == "timing[5]"
    assert codes["timing-broken"].values["after_deg"] == pytest.approx(4.5)
    ring = (
        TimingRow("Feed.rise.1.start", "Clamp.rise.1.start", 5.0),
        TimingRow("Clamp.rise.1.start", "Feed.rise.1.start", 5.0),
    )
    near = with_phase(with_phase(replace(UNIT, timing=(UNIT.timing[0], *ring)), 0, 328.0), 1, 320.0)
    assert sorted(contradiction(near)) == [1, 2]
    (found,) = (f for f in findings_of(Study(near, 36)) if f.code == "timing-contradicts")
    assert found.values["excess_deg"] == pytest.approx(10.0)
    assert {"timing[1]", "timing[2]"} == set(str(found.values["rows"]).split(", "))
    turned = UNIT
    for i, drive in enumerate(UNIT.drives):
        turned = with_phase(turned, i, drive.phase_deg + 200.0)
    assert np.allclose([d.spare_deg for d in distances(turned)], [d.spare_deg for d in distances(UNIT)])


# -- commands -----------------------------------------------------------------------------------------------


@pytest.mark.stress
def test_commands_on_one_drive_ask_which_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = str(EXAMPLES / "transfer_unit.toml"), tmp_path / "clamp.csv"
    assert main(["profile", file, "--out", str(out)]) == 2
    assert capsys.readouterr().err == "drives: there are 4; choose one with --drive: Feed | Clamp | Lift | Torque\n"
    assert main(["profile", file, "--drive", "Klamp", "--out", str(out)]) == 2
    assert capsys.readouterr().err.startswith("drives = 'Klamp': no drive of that name; allowed: Feed | Clamp")
    assert main(["profile", file, "--drive", "clamp", "--out", str(out), "--samples", "36"]) == 0
    assert table(out)["cam_angle_deg"].size == 36
    stiff = tmp_path / "stiff.toml"
    save(put(UNIT, "drives[2].follower.slider_arm_mm", 300.0), stiff)
    for command in (["profile", "--out", str(out)], ["contact"], ["find", "base-radius"]):
        assert main([command[0], str(stiff), *command[1:], "--drive", "Lift"]) == 2
        said = capsys.readouterr().err
        assert said.startswith("drives[2].follower.rod_mm: "), said
        assert ("the current design cannot be assembled" in said) == (command[0] == "find")
    into = tmp_path / "smaller.toml"
    assert main(["find", file, "base-radius", "--drive", "Clamp", "--into", str(into)]) in (0, 1)
    smaller = load(into)
    assert [only(smaller, i) == only(UNIT, i) for i in range(4)] == [True, False, True, True]
    capsys.readouterr()
    assert main(["stability", file]) == 0
    assert "tongue 1" in capsys.readouterr().out
    save(replace(RIGID, balancer=SPRING), into)
    assert main(["contact", str(into), "--drive", "balancer"]) == 0
    assert capsys.readouterr().out == "The follower stays on the cam at any speed\n", "it has a spring and no mass"
    assert main(["find", str(into), "preload", "--drive", "balancer"]) == 2
    assert "find balancer sizes its spring" in capsys.readouterr().err
    save(RIGID, into)
    assert main(["check", str(into)]) == 0
    assert capsys.readouterr().out == "Transfer unit: 0 findings, 26 of 26 residuals within their bounds\n"
    assert main(["report", str(into), "--samples", "72"]) == 0
    text = capsys.readouterr().out
    assert "Drives, by machine angle" in text
    assert "Timing" in text
    assert re.search(r"Clamp\.return\.1\.end +123\.0 +1025\n", text), "events by machine angle, with their times"


def test_a_wind_up_that_lifts_a_follower_off_its_cam_is_found_for_each_drive() -> None:
    kim = load(EXAMPLES / "kim_1990.toml")
    alone = Study(kim).flexible_shaft().history(3.0, 0.9, 0.3)
    listed = Study(as_list(kim, "Kim")).flexible_shaft().history(3.0, 0.9, 0.3)
    assert alone.contact_lost is not None
    assert listed.contact_lost == pytest.approx(alone.contact_lost, rel=1e-12)

    two = with_phase(copy_drive(as_list(kim, "Kim"), 0), 1, 75.0)
    run = Study(two).flexible_shaft().history(3.0, 0.9, 0.3)
    assert run.contact is not None
    assert run.contact.names == drive_names(two)
    assert run.leaving in run.contact.names
    assert run.contact_lost is not None
    own = run.contact.names.index(run.leaving)
    at = run.contact_lost + np.array([-1e-3, 0.0, 1e-3])
    before, now, after = run.forces(at)[own]
    assert before > 0.0 > after
    assert abs(now) <= 1e-9
    # at the machine's own steady turning each force is that of its drive alone, but for friction
    still = Study(UNIT).flexible_shaft()
    rest = still.history(1.0)
    assert rest.contact is not None
    assert rest.contact.names == ("Clamp", "Lift", "Torque"), "the groove holds the feed"
    y = np.array([0.1, 0.45, 0.7])
    turned = Study(UNIT).camshaft.at_theta(np.mod(2.0 * np.pi * (y - rest.at(y)[0]), 2.0 * np.pi))
    newtons = rest.forces(y) * rest.contact.unit * still.machine.omega_at(rest.eta) ** 2
    for name, force in zip(rest.contact.names, newtons, strict=True):
        assert np.allclose(force, turned.drive_study(name).dynamics.contact, rtol=0.05)
