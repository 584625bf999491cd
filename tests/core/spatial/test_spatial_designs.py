"""Cams in space from the file to tables, forces, camshaft, findings and Find, against closed forms."""

from __future__ import annotations

import csv
import json
from math import radians, sin
from pathlib import Path

import numpy as np
import pytest

from core.__main__ import main
from core.design import get, put
from core.errors import DesignError
from core.find import find
from core.output.explain import explained
from core.project import dumps, load, loads
from core.study import Study, certificate_of, extremes_of, findings_of, many
from core.study.quantities import quantity

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
BARREL = (EXAMPLES / "barrel_feeder.toml").read_text("utf-8")
INDEXER = (EXAMPLES / "globoidal_indexer.toml").read_text("utf-8")


def changed(text: str, *pairs: tuple[str, str]) -> str:
    for old, new in pairs:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


ARM = changed(BARREL, ("start_mm", "start_deg"), ('kind = "barrel"', 'kind = "barrel"\narm_mm = 90.0'),
              ("rise_mm = 40.0", "rise_deg = 25.0"), ("rise_mm = -40.0", "rise_deg = -25.0"), ("mass_kg = 6.0", "inertia_kg_m2 = 0.05"),
              ("force_n = -40.0", "torque_nm = -4.0"), ("friction_n = 5.0", "friction_nm = 0.5"))  # fmt: skip
TURRET = changed(INDEXER, ('kind = "globoidal"\ncentre_distance_mm = 120.0', 'kind = "barrel"\narm_mm = 60.0'),
                 ("roller_radius_mm = 16.0", "roller_radius_mm = 14.0"), ("roller_inner_mm = 48.0", "roller_inner_mm = 75.0"),
                 ("length_mm = 100.0", "length_mm = 115.0"))  # fmt: skip
SIDE_BY_SIDE = changed(BARREL, ('form = "groove"\nplay_mm = 0.02', 'form = "rib"\nroller_distance_mm = 32.0'))
ALL = {"barrel": BARREL, "indexer": INDEXER, "arm": ARM, "turret": TURRET, "rib": SIDE_BY_SIDE}


# -- files --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ALL)
def test_a_design_is_written_as_it_was_read(name: str) -> None:
    design = loads(ALL[name], name)
    assert loads(dumps(design), name) == design
    assert design.drive.kind == ("globoidal" if name == "indexer" else "barrel")


@pytest.mark.parametrize(("text", "old", "new", "entry", "allowed"), [
    (BARREL, "roller_radius_mm = 10.0", "roller_radius_mm = 70.0", "cam.roller_radius_mm = 70.0", "< 70 mm"),
    (BARREL, "roller_radius_mm = 10.0", "roller_radius_mm = nan", "cam.roller_radius_mm = nan", "above 0"),
    (BARREL, "roller_inner_mm = 70.0", "roller_inner_mm = 0.0", "cam.roller_inner_mm = 0.0", "above 0"),
    (BARREL, "roller_taper_deg = 0.0", "roller_taper_deg = 36.0", "cam.roller_taper_deg = 36.0", "< 35.5377 deg"),
    (BARREL, "roller_taper_deg = 0.0", "roller_taper_deg = -80.0", "cam.roller_taper_deg = -80.0", "-60 ... 60"),
    (BARREL, 'kind = "barrel"', 'kind = "barel"', "cam.kind = 'barel'", "barrel | globoidal"),
    (BARREL, 'kind = "barrel"\n', "", "cam.kind: missing", "barrel | globoidal"),
    (BARREL, "rollers = 1", "rollers = 2", "cam.rollers = 2", "1"),
    (BARREL, "outer_radius_mm = 82.0", "outer_radius_mm = 70.0", "cam.outer_radius_mm = 70.0", "> 70 mm"),
    (BARREL, "play_mm = 0.02", "play_mm = 75.0", "cam.play_mm = 75.0", "< 70 mm"),
    (BARREL, "bore_mm = 35.0", "bore_mm = 140.0", "cam.bore_mm = 140.0", "< 139.96 mm"),
    (BARREL, "keyway_depth_mm = 3.3", "keyway_depth_mm = 60.0", "cam.keyway_depth_mm = 60.0", "< 52.3011 mm"),
    (BARREL, "bore_mm = 35.0", "bore_mm = 35.0\nbase_radius_mm = 4.0", "cam.base_radius_mm = 4.0", "roller_inner_mm"),
    (BARREL, "bore_mm = 35.0", "bore_mm = 35.0\ncentre_distance_mm = 4.0", "cam.centre_distance_mm = 4.0", "arm_mm"),
    (SIDE_BY_SIDE, "roller_distance_mm = 32.0\n", "", "cam.roller_distance_mm: missing", "> 0 mm"),
    (SIDE_BY_SIDE, "roller_distance_mm = 32.0", "roller_distance_mm = 20.0", "cam.roller_distance_mm = 20.0", "> 20 mm"),
    (SIDE_BY_SIDE, 'form = "rib"', 'form = "rib"\nplay_mm = 0.1', "cam.play_mm = 0.1: only with form = \"groove\";", "arm_mm"),
    (ARM, "arm_mm = 90.0\n", "", "cam.arm_mm: missing", "> 0 mm"),
    (ARM, 'form = "groove"\nplay_mm = 0.02', 'form = "rib"', "cam.rollers = 1", ">= 2"),
    (INDEXER, "centre_distance_mm = 120.0\n", "", "cam.centre_distance_mm: missing", "above 0"),
    (INDEXER, "centre_distance_mm = 120.0", "centre_distance_mm = 1.0", "cam.centre_distance_mm = 1.0", "> 64 mm"),
    (INDEXER, "roller_length_mm = 16.0", "roller_length_mm = 72.0", "cam.roller_length_mm = 72.0", "< 72 mm"),
    (INDEXER, "roller_radius_mm = 16.0", "roller_radius_mm = 56.0", "cam.roller_radius_mm = 56.0", "< 56 mm"),
    (INDEXER, "bore_mm = 30.0", "bore_mm = 112.0", "cam.bore_mm = 112.0", "< 112 mm"),
    (INDEXER, "rollers = 6", "rollers = 12", "cam.rollers = 12", "fewer rollers"),
    (INDEXER, "rollers = 6", "rollers = 2.5", "cam.rollers = 2.5", "1 ... 100"),
    (INDEXER, "rollers = 6", "rollers = 5", "motion.advance_deg = 60.0", "multiples of 72 deg"),
    (INDEXER, "length_mm = 100.0", "length_mm = 0.01", "cam.length_mm: no roller", "enlarge the length"),
])  # fmt: skip
@pytest.mark.parametrize("command", [["check"], ["surface", "--out", "flanks.csv"]])
def test_a_wrong_entry_is_one_line_that_names_its_field(
    command: list[str], text: str, old: str, new: str, entry: str, allowed: str, tmp_path, monkeypatch, capsys
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("cam.toml").write_text(changed(text, (old, new)), "utf-8")
    assert main([*command, "cam.toml"]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert line.startswith(entry)
    assert allowed in line.removeprefix(entry)


def test_surfaces_of_a_design_without_cam_are_refused(tmp_path, capsys) -> None:
    file = tmp_path / "motion.toml"
    file.write_text(BARREL.split("[cam]")[0] + "[shaft]" + BARREL.split("[shaft]")[1], "utf-8")
    assert main(["surface", str(file), "--out", str(tmp_path / "flanks.csv")]) == 2
    assert capsys.readouterr().err == "surface: this design has no cam; allowed: one with [cam]\n"


def test_a_follower_has_no_cam_in_space(tmp_path, capsys) -> None:
    file = tmp_path / "both.toml"
    follower = '\n[follower]\nkind = "translating"\noffset_mm = 0.0\nroller_radius_mm = 5.0\n'
    text = BARREL.split("\n[loads]")[0] + follower + "[loads]\n"
    file.write_text(text, "utf-8")
    assert main(["check", str(file)]) == 2
    assert "cam.kind = 'barrel': a cam in space moves the output of [motion] itself" in capsys.readouterr().err


def test_a_motion_in_mm_has_no_globoidal_cam() -> None:
    with pytest.raises(DesignError, match=r"cam\.kind"):
        loads(changed(BARREL, ('kind = "barrel"', 'kind = "globoidal"\ncentre_distance_mm = 120.0')), "x")


# -- tables -------------------------------------------------------------------------------------------------------


def rows_of(file: Path) -> dict[str, np.ndarray]:
    with file.open(encoding="utf-8") as stream:
        header, *rows = csv.reader(stream)
    return dict(zip(header, np.array(rows, dtype=float).T, strict=True))


def test_tables_of_a_barrel_have_closed_forms(tmp_path) -> None:
    """A sliding roller: tan ψ = |y'|/u at the inner end, T = F y', and F_c = F sqrt(1 + (y'/u)²) in the middle of the roller."""
    assert main(["export", str(EXAMPLES / "barrel_feeder.toml"), "--out", str(tmp_path), "--samples", "720"]) == 0
    profile, forces, motion = (rows_of(tmp_path / f"{name}.csv") for name in ("profile", "dynamics", "kinematics"))
    assert list(profile) == ["cam_angle_deg", "pressure_angle_deg", "sliding_mm_s", "curvature_per_mm"]
    omega = 2.0 * np.pi * 2.0
    slope = motion["velocity_mm_s"] / omega
    assert profile["pressure_angle_deg"] == pytest.approx(np.rad2deg(np.arctan(np.abs(slope) / 70.0)), abs=1e-9)
    moving = motion["velocity_mm_s"] != 0.0
    effort = 6.0 * motion["acceleration_mm_s2"] * 1e-3 + 40.0 + 5.0 * np.sign(motion["velocity_mm_s"])
    assert forces["force_n"][moving] == pytest.approx(effort[moving], abs=1e-9)
    assert forces["drive_torque_nm"] == pytest.approx(effort * slope * 1e-3, abs=1e-9)
    contact = effort * np.hypot(1.0, slope / 77.0)
    assert forces["contact_force_n"][moving] == pytest.approx(contact[moving], abs=1e-9)
    load = np.abs(forces["contact_force_n"]) / (20.0 * 14.0)
    assert forces["roller_pv_mpa_m_s"] == pytest.approx(load * profile["sliding_mm_s"] * 1e-3, abs=1e-12)
    summary = json.loads((tmp_path / "summary.json").read_text("utf-8"))
    worst = summary["extremes"]["pressure_angle_deg"]["max"]
    # cycloidal: greatest slope 2 h/β at the middle of the rise
    assert worst["value"] == pytest.approx(np.rad2deg(np.arctan(2.0 * 40.0 / np.deg2rad(120.0) / 70.0)), abs=1e-9)
    assert worst["cam_angle_deg"] == pytest.approx(60.0, abs=1e-4)


def test_a_turret_transmits_by_the_roller_of_least_pressure_angle() -> None:
    """Globoidal: tan ψ = u |φ'|/(D - u cos φ) at the outer end of the farthest roller whose middle is in the blank."""
    study = Study(loads(INDEXER, "x"), 720)
    y, slope = study.motion.displacement[0], np.abs(study.motion.displacement[1])
    near = np.deg2rad((np.rad2deg(y) + 30.0) % 60.0 - 30.0)
    expected, middle = np.full(y.size, np.inf), np.full(y.size, np.inf)
    for k in (-1, 0, 1):
        phi = near + k * np.pi / 3.0
        inside = np.abs(56.0 * np.sin(phi)) <= 50.0 + 1e-9
        for row, u in ((expected, 64.0), (middle, 56.0)):
            angle = np.arctan(u * slope / (120.0 - u * np.cos(phi)))
            row[:] = np.where(inside, np.fmin(row, angle), row)
    assert quantity("pressure_angle").value(study) == pytest.approx(expected, abs=1e-12)
    effort = quantity("output_torque").value(study)
    contact = quantity("contact_force").value(study)
    assert contact == pytest.approx(effort / (0.056 * np.cos(middle)), rel=1e-9, abs=1e-9)
    assert quantity("drive_torque").value(study) == pytest.approx(effort * study.motion.displacement[1], abs=1e-12)


@pytest.mark.parametrize("name", ALL)
def test_every_kind_has_a_certificate_and_its_extremes_do_not_depend_on_the_sampling(name: str) -> None:
    design = loads(ALL[name], name)
    assert all(residual.kept for residual in certificate_of(Study(design, 720)).values())
    coarse, fine = (extremes_of(Study(design, n), "cam") for n in (72, 3600))
    dense = Study(design, 7200)
    for key, extremes in coarse.items():
        assert extremes.high.value == pytest.approx(fine[key].high.value, rel=1e-9, abs=1e-12), key
        values = quantity(key).value(dense)
        assert np.nanmax(values) <= extremes.high.value * (1.0 + 1e-9) + 1e-12, key


def test_the_torque_is_part_of_the_sum_of_a_camshaft(tmp_path) -> None:
    alone = Study(loads(INDEXER, "x"), 360)
    inside = INDEXER.split("\n[shaft]")[0].split("[motion]", 1)[1], INDEXER.split("[loads]")[1]
    text = "[motion]" + inside[0] + "\n[loads]" + inside[1]
    text = text.replace("[[motion.", "[[drives.motion.").replace("\n[", "\n[drives.").replace("[drives.[", "[[")
    text = text.replace("[motion]", "[drives.motion]", 1)
    lines = ["format = 1", 'name = "Shaft"', "[shaft]", 'rotation = "ccw"', "speed_rpm = 100.0"]
    drives = [
        f'[[drives]]\nname = "{name}"\nphase_deg = {phase}\n{text}'
        for name, phase in (("First", 0.0), ("Second", 90.0))
    ]
    study = Study(loads("\n".join([*lines, *drives]), "x"), 360)
    torque = alone.dynamics.torque
    assert study.camshaft.torque == pytest.approx(torque + np.roll(torque, 90), abs=1e-9)
    assert [f.code for f in findings_of(study)] == []


# -- findings, Find, explain --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("text", "path", "value", "code"), [
    (BARREL, "cam.roller_inner_mm", 60.0, "pressure-angle"),
    (INDEXER, "cam.centre_distance_mm", 92.0, "pressure-angle"),
    (INDEXER, "cam.roller_radius_mm", 24.0, "rib-vanishes"),
    (INDEXER, "cam.length_mm", 90.0, "turret-free"),
    (BARREL, "cam.length_mm", 50.0, "groove-leaves-blank"),
    (BARREL, "limits.convex_radius_mm", 200.0, "convex-radius"),
    (BARREL, "limits.pressure_angle_return_deg", 20.0, "pressure-angle-return"),
    (BARREL, "limits.contact_force_n", 30.0, "contact-force"),
])  # fmt: skip
def test_an_exceeded_limit_is_a_finding(text: str, path: str, value: float, code: str) -> None:
    design = loads(text, "x")
    assert findings_of(Study(design)) == ()
    findings = findings_of(Study(put(design, path, value)))
    assert code in [finding.code for finding in findings]
    assert all(finding.message for finding in findings)


@pytest.mark.parametrize(
    ("name", "length", "reach"), [("barrel", 55.0, 30.02), ("arm", 45.0, 90.0 * sin(radians(25.0)) + 10.0)]
)
def test_a_groove_leaves_a_short_blank_where_the_roller_is_farthest(name: str, length: float, reach: float) -> None:
    """Of the slide half the stroke, the roller's radius and the play below; of the arm its end at 25 degrees."""
    (finding,) = (
        f
        for f in findings_of(Study(put(loads(ALL[name], "x"), "cam.length_mm", length)))
        if f.code == "groove-leaves-blank"
    )
    assert finding.values["reach_mm"] == pytest.approx(reach, rel=1e-12)
    enough = put(loads(ALL[name], "x"), "cam.length_mm", 2.0 * reach + 1e-6)
    assert "groove-leaves-blank" not in [f.code for f in findings_of(Study(enough))]


@pytest.mark.parametrize(("text", "path", "values", "reasons"), [
    (INDEXER, "cam.roller_radius_mm", (16.0, 24.0), ["", "rib-vanishes"]),
    (INDEXER, "cam.length_mm", (100.0, 90.0), ["", "turret-free"]),
    (changed(BARREL, ("span_deg = 120.0", "span_deg = 40.0"), ("span_deg = 60.0", "span_deg = 140.0")), "cam.roller_radius_mm",
     (2.0, 30.0), ["", "undercut"]),
])  # fmt: skip
def test_many_designs_say_which_of_them_cannot_be_made(text: str, path: str, values, reasons: list[str]) -> None:
    design, figures = loads(text, "x"), ["pressure_angle_deg:max", "drive_torque_nm:abs"]
    results = many(design, {path: values}, figures)
    assert results.reason.tolist() == reasons
    for i, value in enumerate(values):
        extremes = extremes_of(Study(put(design, path, value)), "cam")["pressure_angle"]
        assert results.value[figures[0]][i] == pytest.approx(np.rad2deg(extremes.high.value), rel=1e-12)


def test_a_large_roller_undercuts_a_steep_flank() -> None:
    """The pitch curve of a barrel in its plane at u: the flank has an edge where 1 + r y''/u² over (1 + (y'/u)²)^(3/2) vanishes."""
    steep = loads(
        changed(BARREL, ("span_deg = 120.0", "span_deg = 40.0"), ("span_deg = 60.0", "span_deg = 140.0")), "x"
    )
    codes = [finding.code for finding in findings_of(Study(put(steep, "cam.roller_radius_mm", 30.0)))]
    assert "undercut" in codes
    assert "undercut" not in [finding.code for finding in findings_of(Study(put(steep, "cam.roller_radius_mm", 2.0)))]


def test_the_smallest_inner_distance_keeps_the_pressure_angle() -> None:
    """tan ψ = 2 h/(β u) of a cycloidal rise."""
    open_blank = changed(BARREL, ("outer_radius_mm = 82.0\n", ""), ("bore_mm = 35.0", "bore_mm = 12.0"))
    solution = find(
        loads(open_blank, "x"), "inner-distance", {"pressure_angle_rise_deg": 25.0, "pressure_angle_return_deg": 25.0}
    )
    expected = 2.0 * 40.0 / np.deg2rad(120.0) / np.tan(np.deg2rad(25.0))
    assert get(solution.design, "cam.roller_inner_mm") == pytest.approx(expected, rel=1e-8)


def test_a_search_that_the_blank_ends_names_the_blank() -> None:
    solution = find(loads(BARREL, "x"), "inner-distance", {"pressure_angle_rise_deg": 10.0})
    assert not solution.is_valid
    assert solution.answer["cam.roller_inner_mm"] == pytest.approx(82.0, abs=1e-3)
    assert "cam.outer_radius_mm = 82.0: the roller does not reach into the blank" in solution.end


@pytest.mark.stress
def test_the_most_rollers_divide_the_turret_by_the_advance() -> None:
    slender = changed(
        INDEXER, ("roller_radius_mm = 16.0", "roller_radius_mm = 7.0"), ("start_deg = 30.0", "start_deg = 15.0")
    )
    solution = find(loads(slender, "x"), "rollers", {})
    assert get(solution.design, "cam.rollers") % 6 == 0
    assert get(solution.design, "cam.rollers") > 6
    assert not findings_of(Study(solution.design))


def test_a_number_is_explained_by_the_line_of_contact() -> None:
    study = Study(load(EXAMPLES / "globoidal_indexer.toml"))
    result = explained(study, "contact_force_n", 260.0)
    values = {letter.symbol: letter.value for letter in result.letters}
    assert result.value == pytest.approx(values["Q"] / values["g"] * 1e3, rel=1e-9)
