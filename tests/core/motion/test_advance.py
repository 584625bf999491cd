"""Motions that do not come back: position, joins at 360 degrees, edits and files, against numbers worked out by hand."""

import csv
import json
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from feeds import DEFAULT_CAM, FEED, FOUR_BAR
from large_designs import EXAMPLES

from core.__main__ import main
from core.design import Motion, NamedCurve, Segment, SplineCurve, SplinePoint, edited, faults, turns_on
from core.errors import DesignError, NoSuchStage
from core.motion import findings, program
from core.motion.new_motions import Indexer, indexer
from core.output.channels import motion_stops
from core.project import dumps, load, loads
from core.study import Study

INDEXED = """
format = 1
name = "Indexed"

[motion]
start_deg = 0.0
advance_deg = 45.0

[[motion.segments]]
law = "cycloidal"
span_deg = 360.0
rise_deg = 45.0
"""


def quintic(u: float) -> float:
    """From rest at 0 to the slope 1 at 1, both without acceleration: Hermite's conditions solved by hand."""
    return 6.0 * u**3 - 8.0 * u**4 + 3.0 * u**5


def table(path: Path) -> dict[str, np.ndarray]:
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def test_a_crank_that_goes_on_drives_its_linkage_round(tmp_path: Path) -> None:
    file = tmp_path / "cam.toml"
    file.write_text(DEFAULT_CAM + FOUR_BAR, encoding="utf-8")
    assert main(["export", str(file), "--out", str(tmp_path), "--samples", "36"]) == 0
    rows = table(tmp_path / "kinematics.csv")
    assert rows["displacement_deg"][6] == pytest.approx(120.0 * quintic(0.5), abs=1e-11)
    assert rows["displacement_deg"][30] == pytest.approx(360.0 - 120.0 * quintic(0.5), abs=1e-11)
    # the four-bar of a crank at the same angles
    angle = np.deg2rad(rows["displacement_deg"])
    b = table(tmp_path / "linkage.csv")
    loop = np.hypot(b["B_x_mm"] - 20.0 * np.cos(angle), b["B_y_mm"] - 20.0 * np.sin(angle))
    assert np.abs(loop - 90.0).max() < 1e-11
    assert main(["ecam", str(file), "--controller", "codesys-xyva", "--out", str(tmp_path / "cam.txt")]) == 0
    text = (tmp_path / "cam.txt").read_text(encoding="utf-8")
    assert text.count("dX :=") == 4
    assert "dX := 360.0, dY := 360.0, dV := 0.0" in text


@pytest.mark.parametrize("assembled", ["", "[linkage.drawn]\nA = [20.0, 0.0]\nB = [60.0, 45.0]\n"])
def test_a_linkage_stands_an_advance_further_on_in_each_turn(assembled: str) -> None:
    design = loads(INDEXED + FOUR_BAR + assembled)
    first, third, before = (Study(turns_on(design, turns), 36).linkage for turns in (0, 2, -1))
    for later, on in ((third, 90.0), (before, -45.0)):
        turned = np.exp(1j * (later.bodies["link2"].turn[0] - first.bodies["link2"].turn[0]))
        assert np.abs(turned - np.exp(1j * np.deg2rad(on))).max() < 1e-12
        a, b = (later.bodies[body].points[name] for body, name in (("link2", "A"), ("link4", "B")))
        a, b = (later.bodies[body].fixed_point(at)[0] for body, at in (("link2", a), ("link4", b)))
        assert np.abs(np.abs(b - a) - 0.090).max() < 1e-12
        assert ((b - a).conj() * (0.1 - a)).imag.max() < 0.0  # on the side where it was assembled
    assert turns_on(loads(DEFAULT_CAM + FOUR_BAR), 5) == loads(DEFAULT_CAM + FOUR_BAR)


def test_the_default_cam_of_controllers_is_a_design(tmp_path: Path) -> None:
    file = tmp_path / "cam.toml"
    file.write_text(DEFAULT_CAM, encoding="utf-8")
    for command in (["check"], ["export", "--out", str(tmp_path)], ["report", "--out", str(tmp_path / "report.html")]):
        assert main([command[0], str(file), *command[1:]]) == 0
    rows = table(tmp_path / "kinematics.csv")
    assert list(rows)[:6] == [
        "cam_angle_deg", "displacement_deg", "velocity_deg_s", "acceleration_deg_s2", "jerk_deg_s3", "position_modulo_deg",
    ]  # fmt: skip
    quarter = rows["displacement_deg"][[600, 1800, 3000]]
    assert np.abs(quarter - [120.0 * quintic(0.5), 180.0, 360.0 - 120.0 * quintic(0.5)]).max() < 1e-11
    facts = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert facts["kind"] == "motion"
    assert facts["findings"] == []
    assert not (tmp_path / "dynamics.csv").exists()
    assert Study(load(file)).stages == ("motion",)
    with pytest.raises(NoSuchStage):
        Study(load(file)).cam  # noqa: B018
    assert loads(dumps(load(file))) == load(file)


def test_force_torque_and_power_of_what_a_motion_alone_moves(tmp_path: Path) -> None:
    file = tmp_path / "feed.toml"
    file.write_text(FEED, encoding="utf-8")
    assert main(["export", str(file), "--out", str(tmp_path), "--samples", "36"]) == 0
    there, rows = table(tmp_path / "dynamics.csv"), table(tmp_path / "kinematics.csv")
    assert list(there)[:3] == ["cam_angle_deg", "force_n", "power_w"]
    u, seconds = 3.0 / 12.0, 1.0 / 3.0
    a = 0.150 / seconds**2 * (60.0 * u - 180.0 * u**2 + 120.0 * u**3)
    v = 0.150 / seconds * (30.0 * u**2 - 60.0 * u**3 + 30.0 * u**4)
    assert there["force_n"][3] == pytest.approx(12.0 * a + 20.0 + 15.0, rel=1e-12)
    assert there["power_w"][3] == pytest.approx((12.0 * a + 20.0 + 15.0) * v, rel=1e-12)
    assert there["force_n"][15] == 20.0  # at rest nothing rubs
    assert rows["position_modulo_mm"][33] == pytest.approx(10.0, abs=1e-9)
    assert rows["displacement_mm"][33] == pytest.approx(310.0, abs=1e-9)
    turned = (
        FEED.replace("_mm", "_deg")
        .replace("mass_kg", "inertia_kg_m2")
        .replace("_n =", "_nm =")
        .replace("force", "torque")
    )
    file.write_text(turned, encoding="utf-8")
    assert main(["export", str(file), "--out", str(tmp_path), "--samples", "36"]) == 0
    torque = table(tmp_path / "dynamics.csv")["torque_nm"]
    assert torque[3] == pytest.approx(12.0 * np.deg2rad(1e3 * a) + 20.0 + 15.0, rel=1e-12)
    # a clockwise shaft runs the same motion the same way
    file.write_text(turned.replace('"ccw"', '"cw"'), encoding="utf-8")
    assert main(["export", str(file), "--out", str(tmp_path), "--samples", "36"]) == 0
    assert table(tmp_path / "dynamics.csv")["torque_nm"] == pytest.approx(torque, rel=1e-12)


def test_what_a_motion_alone_cannot_have_is_named(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match=r"loads.inertia_kg_m2 .*unknown key"):
        loads(FEED.replace("mass_kg", "inertia_kg_m2"))
    with pytest.raises(DesignError, match=r"exactly one of .*or \[motion\] alone"):
        loads(FEED + "[cam]\nbase_radius_mm = 30.0\nroller_radius_mm = 8.0\n")
    file = tmp_path / "feed.toml"
    file.write_text(FEED, encoding="utf-8")
    assert main(["profile", str(file), "--out", str(tmp_path / "cam.csv")]) == 2


def test_joins_at_the_end_of_the_turn_are_judged_beyond_the_advance() -> None:
    feed = Motion(5.0, (Segment(200.0, 40.0, NamedCurve("cycloidal")), Segment(160.0, 0.0)), advance=40.0)
    assert findings(program(feed)) == []
    uneven = Motion(5.0, (Segment(360.0, 40.0, NamedCurve("3-4-5")),), advance=40.0)
    assert findings(program(uneven)) == []
    steady = Motion(0.0, (Segment(360.0, 7.0, NamedCurve("constant-velocity")),), advance=7.0)
    assert findings(program(steady)) == []
    ramp = Motion(0.0, (Segment(180.0, 7.0, NamedCurve("constant-velocity")), Segment(180.0, 0.0)), advance=7.0)
    assert [f.code for f in findings(program(ramp))] == ["jump-velocity", "jump-velocity"]


def test_a_spline_over_the_turn_goes_on_smoothly() -> None:
    at = (SplinePoint(90.0, 30.0), SplinePoint(200.0, 30.0), SplinePoint(300.0, 100.0))
    motion = Motion(2.0, (Segment(360.0, 120.0, SplineCurve(at)),), advance=120.0)
    assert findings(program(motion)) == []
    compiled = program(motion)
    y = compiled.state(compiled.angles(np.deg2rad([0.0, 90.0, 200.0, 300.0, 359.999999]))).y
    assert np.abs(1e3 * y[0] - [2.0, 32.0, 32.0, 102.0, 122.0]).max() < 1e-6
    assert np.abs(y[1:3, 0] - y[1:3, 4]).max() < 1e-6 * np.abs(y[1:3]).max()


def test_an_edit_of_one_rise_keeps_the_advance() -> None:
    design = loads(DEFAULT_CAM + FOUR_BAR)
    changed = edited(design, "motion.segments[0].rise_deg", 100.0)
    assert [s.rise for s in changed.drive.motion.segments] == [100.0, 140.0, 120.0]
    assert not faults(changed)
    assert edited(design, "motion.stroke_deg", 180.0).drive.motion.advance == 180.0
    assert tomllib.loads(dumps(design))["motion"]["advance_deg"] == 360.0
    with pytest.raises(DesignError, match="are not advance_deg; allowed: a sum of 300 deg"):
        loads(DEFAULT_CAM.replace("advance_deg = 360.0", "advance_deg = 300.0") + FOUR_BAR)


def test_a_disk_cam_with_an_advance_is_refused_in_one_line(tmp_path: Path) -> None:
    text = (EXAMPLES / "card_picker.toml").read_text(encoding="utf-8")
    head, tail = text.split("[[motion.segments]]", 1)
    file = tmp_path / "cam.toml"
    file.write_text(f"{head}advance_mm = 0.0\n\n[[motion.segments]]{tail}", encoding="utf-8")
    assert main(["check", str(file)]) == 0  # that is none
    segments = '[[motion.segments]]\nspan_deg = 360.0\nrise_mm = 5.0\nlaw = "constant-velocity"\n'
    rest = tail[tail.index("\n[follower]") :]
    file.write_text(f"{head}advance_mm = 5.0\n\n{segments}{rest}", encoding="utf-8")
    command = [sys.executable, "-m", "core", "check", str(file)]
    run = subprocess.run(command, capture_output=True, text=True, check=False, encoding="utf-8")
    assert run.returncode == 2
    assert run.stderr.count("\n") == 1
    assert run.stderr.startswith("motion.advance_mm = 5.0: a disk cam repeats its motion every turn")


# -- figures of a turn ---------------------------------------------------------------------------------------


def test_figures_of_a_turn_in_summary_and_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "feed.toml"
    file.write_text(FEED, encoding="utf-8")
    assert main(["export", str(file), "--out", str(tmp_path)]) == 0
    cycle = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["cycle"]
    assert cycle["mean_speed_mm_s"] == 300.0
    assert [each["error_mm"] for each in cycle["stops"]] == [0.0, 0.0, 0.0]
    # against the tables: what is given and given back, and the mean of the squares
    rows = table(tmp_path / "dynamics.csv")
    power = rows["power_w"]
    assert cycle["energy_j"] == pytest.approx(np.maximum(power, 0.0).mean(), rel=1e-4)
    assert cycle["energy_with_recovery_j"] == pytest.approx((15.0 + 20.0) * 0.300, rel=1e-12)  # friction and force
    assert cycle["rms_n"] == pytest.approx(np.sqrt((rows["force_n"] ** 2).mean()), rel=1e-3)
    capsys.readouterr()
    assert main(["report", str(file), "--out", str(tmp_path / "report.html")]) == 0
    assert "Mean speed" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_stops_that_do_not_divide_the_turn_say_so() -> None:
    steps = tuple(Segment(90.0, rise, NamedCurve(law)) for rise, law in ((60.1, "3-4-5"), (0.0, "dwell")) * 2)
    off = [each.error for each in motion_stops(Motion(0.0, steps, "deg", 120.2))]
    assert off == pytest.approx([0.0, 0.1, 0.2], abs=1e-12)
    whole = Motion(0.0, (Segment(90.0, 0.0), *steps[:1], Segment(180.0, 0.0)), "deg", 60.1)
    assert [each.at_deg for each in motion_stops(whole)] == [180.0, 540.0]  # a rest over 360 degrees is one


def test_an_indexer_and_a_flying_shear_are_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "new.toml"
    assert (
        main(["indexer", "--stops", "8", "--index", "120", "--dwell", "60", "--law", "3-4-5", "--out", str(file)]) == 0
    )
    assert "largest velocity 253.1 °/s" in capsys.readouterr().out  # 1.875 · 45° in a third of a second
    motion = load(file).drive.motion
    assert motion == indexer(Indexer(stops=8, index_deg=120.0, dwell_deg=60.0, law="3-4-5")).drive.motion
    assert (motion.advance, len(motion.segments)) == (90.0, 4)
    assert main(["indexer", "--dwell", "100", "--out", str(file)]) == 2
    assert main(["flying-shear", "--length", "720", "--window", "90", "--return", "150", "--out", str(file)]) == 0
    design = load(file)
    assert [s.rise for s in design.drive.motion.segments] == [60.0, 180.0, 60.0, -300.0]
    assert findings(program(design.drive.motion)) == []
    assert "synchronous" not in capsys.readouterr().err
    assert main(["flying-shear", "--window", "200", "--return", "160", "--out", str(file)]) == 2
    assert "leaves 0 deg to accelerate" in capsys.readouterr().err


def test_the_largest_position_of_a_motion_that_goes_on_stands_at_the_end_of_the_turn(tmp_path: Path) -> None:
    file = tmp_path / "cam.toml"
    file.write_text(DEFAULT_CAM, encoding="utf-8")
    assert main(["export", str(file), "--out", str(tmp_path), "--samples", "36"]) == 0
    found = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["extremes"]["displacement_deg"]
    assert found["max"]["cam_angle_deg"] == 360.0
    assert found["min"] == {"value": 0.0, "cam_angle_deg": 0.0}


def test_an_advance_that_never_comes_to_the_same_stops_is_noted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "cam.toml"
    for advance, told in ((50.0, "nearest valid advance is 51.4285714 deg"), (60.0, ""), (720.0, "")):
        rises = "\n".join(
            f'[[motion.segments]]\nlaw = "{law}"\nspan_deg = 180.0\nrise_deg = {rise}'
            for law, rise in (("3-4-5", advance), ("dwell", 0.0))
        )
        file.write_text(
            f'format = 1\nname = "N"\n[motion]\nstart_deg = 0.0\nadvance_deg = {advance}\n{rises}\n', encoding="utf-8"
        )
        assert main(["check", str(file)]) == 0
        out = capsys.readouterr().out
        assert ("nearest" in out) == bool(told)
        assert told in out
