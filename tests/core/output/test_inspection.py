"""Inspection tables: against closed forms, the cam's own motion and brute force; measured tables with known faults read back."""

import contextlib
import io
import json
from pathlib import Path

import numpy as np
import pytest
from face_cases import random_design
from mechanisms import PUSHER, levels, with_cam, with_drive, with_follower, with_shaft
from sampled import spread

from core import project
from core.__main__ import main
from core.design import Design
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
RADIUS, ECCENTRIC = 50.0, 10.0
HOLLOW = with_cam(with_drive(PUSHER, motion=levels(0.0, (40.0, 0.0, "dwell"), (80.0, 40.0, "cycloidal"), (130.0, 40.0, "dwell"),
                                                   (110.0, 0.0, "3-4-5"))), base_radius_mm=30.0)  # fmt: skip


def run(*words: object) -> tuple[int, str, str]:
    """The command in this process: exit code, what it printed, its faults."""
    said, faults = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(faults):
        code = main(["inspection", *map(str, words)])
    return code, said.getvalue(), faults.getvalue()


def inspected(design: Path, out: Path, *words: object) -> tuple[np.ndarray, dict]:
    """The table that the command writes, and what it says of it."""
    code, said, _ = run(design, "--out", out, "--json", *words)
    assert code == 0
    assert json.loads((out.parent / "summary.json").read_text("utf-8")) == {"file": out.name, **json.loads(said)}
    return np.genfromtxt(out, delimiter=",", names=True), json.loads(said)


def disk(folder: Path, rotation: str) -> Path:
    """An eccentric disk, its centre above the cam's at 180 deg: the profile of a harmonic motion under a flat face."""
    path = folder / f"disk_{rotation}.toml"
    rises = "".join(
        f'[[motion.segments]]\nlaw = "simple-harmonic"\nspan_deg = 180.0\nrise_mm = {rise}\n'
        for rise in (2.0 * ECCENTRIC, -2.0 * ECCENTRIC)
    )
    path.write_text(
        f'format = 1\nname = "Disk"\n[motion]\nstart_mm = 0.0\n{rises}[follower]\nkind = "translating"\nface = "flat"\n'
        f'[cam]\nbase_radius_mm = {RADIUS - ECCENTRIC}\n[shaft]\nrotation = "{rotation}"\nspeed_rpm = 60.0\n[loads]\n',
        "utf-8",
    )
    return path


def saved(folder: Path, design: Design) -> Path:
    path = folder / "design.toml"
    project.save(design, path)
    return path


def disk_lift(degrees: np.ndarray, probe: str, radius: float, disk_radius: float, phase: float) -> np.ndarray:
    """Of an eccentric disk, above the base of the nominal one; phase [deg]: from disk centre to line of measurement at cam angle 0."""
    angle = np.deg2rad(phase + degrees)
    if probe == "flat":
        return disk_radius - RADIUS + ECCENTRIC * (1.0 + np.cos(angle))
    reach = ECCENTRIC * np.cos(angle) + np.sqrt((disk_radius + radius) ** 2 - (ECCENTRIC * np.sin(angle)) ** 2)
    return reach - (RADIUS - ECCENTRIC + radius)


@pytest.mark.parametrize(
    ("probe", "radius", "rotation"),
    [("roller", 12.5, "ccw"), ("roller", 12.5, "cw"), ("flat", 0.0, "cw"), ("point", 0.0, "ccw")],
)
def test_an_eccentric_disk_is_measured_as_its_closed_form(
    tmp_path: Path, probe: str, radius: float, rotation: str
) -> None:
    words = (
        "--probe",
        probe,
        "--tolerance",
        0.3,
        "--samples",
        100,
        "--direction",
        67.0,
        *(("--radius", radius) if radius else ()),
    )
    rows, said = inspected(disk(tmp_path, rotation), tmp_path / "table.csv", *words)
    sense = 1.0 if rotation == "ccw" else -1.0
    at, phase = -sense * rows["cam_angle_deg"], 67.0 - (90.0 - sense * 180.0)
    assert rows["cam_angle_deg"].tolist() == [360 * k / 100 for k in range(100)]
    for column, by in (("lower_mm", -0.3), ("lift_mm", 0.0), ("upper_mm", 0.3)):
        assert rows[column] == pytest.approx(disk_lift(at, probe, radius, RADIUS + by, phase), abs=1e-11)
    assert said["base_mm"] == pytest.approx(RADIUS - ECCENTRIC + radius, abs=1e-12)
    assert (said["tolerance_mm"], said["rotation"], said["findings"]) == (0.3, rotation, [])


@pytest.mark.parametrize("rotation", ["ccw", "cw"])
def test_a_cam_under_its_own_roller_gives_its_own_motion(tmp_path: Path, rotation: str) -> None:
    design = with_shaft(with_follower(HOLLOW, offset_mm=0.0), rotation=rotation)
    rows, said = inspected(saved(tmp_path, design), tmp_path / "table.csv")
    assert rows["lift_mm"] == pytest.approx(1e3 * Study(design, 360).motion.y[0], abs=1e-10)
    assert (said["probe_radius_mm"], said["direction_deg"], said["points"]) == (12.0, pytest.approx(70.0), 360)
    steep = Study(design, 360).cam.flank.pressure_angle
    assert (rows["upper_mm"] - rows["lift_mm"]) == pytest.approx(0.02 / np.cos(steep), rel=2e-3)


def brute(profile: np.ndarray, directions: np.ndarray, radius: float) -> np.ndarray:
    """Largest distance along each direction at which a circle, or a line across for an infinite radius, touches any point."""
    best = []
    for line in np.exp(1j * directions):
        seen = profile * line.conjugate()
        if np.isfinite(radius):
            seen = seen[np.abs(seen.imag) < radius]
            best.append((seen.real + np.sqrt(radius**2 - seen.imag**2)).max())
        else:
            best.append(seen.real.max())
    return np.array(best)


@pytest.mark.parametrize(
    ("design", "words", "radius"),
    [
        (random_design(np.random.default_rng(5), "oscillating", "roller", "cw"), ("roller", "--radius", 9), 9.0),
        (HOLLOW, ("roller", "--radius", 400), 400.0),
        (with_shaft(HOLLOW, rotation="cw"), ("flat",), np.inf),
    ],
    ids=["random", "bridged", "flat"],
)
def test_no_dense_point_of_the_profile_is_entered(tmp_path: Path, design: Design, words: tuple, radius: float) -> None:
    """Hollows that the probe bridges included: the lift is that of the first touch."""
    rows, said = inspected(saved(tmp_path, design), tmp_path / "table.csv", "--samples", 60, "--probe", *words)
    fine = Study(design, 36_000)
    directions = np.deg2rad(said["direction_deg"]) - fine.sense * np.deg2rad(rows["cam_angle_deg"])
    beyond = rows["lift_mm"] + said["base_mm"] - brute(1e3 * fine.cam.flank.profile, directions, radius)
    assert beyond.min() > -1e-9
    assert beyond.max() < 1e-5


def test_a_probe_that_does_not_reach_a_hollow_says_where(tmp_path: Path) -> None:
    design = saved(tmp_path, HOLLOW)
    words = (design, "--out", tmp_path / "a.csv", "--samples", 8, "--probe", "roller", "--json", "--radius")
    code, said, faults = run(*words, 80)
    (found,) = json.loads(said)["findings"]
    fine = Study(HOLLOW, 36_000)
    least = 1e-3 / -fine.cam.flank.profile_curvature.min() * 1e6
    assert (code, found["code"], found["severity"]) == (0, "probe-hollow", "note")
    assert f"of radius {least:.4g} mm, at {found['cam_angle_deg']:.4g} deg" in found["message"]
    assert faults.startswith("note: the probe (roller or ball, radius 80 mm) does not reach into a hollow")
    # just there two stretches of the profile are touched at once
    line = np.exp(1j * (np.deg2rad(70.0 - found["cam_angle_deg"])))
    centre = line * brute(1e3 * fine.cam.flank.profile, np.angle([line]), 80.0)[0]
    near = np.flatnonzero(np.abs(1e3 * fine.cam.flank.profile - centre) < 80.0 + 2e-4)
    assert near.max() - near.min() > 500
    assert np.abs(1e3 * fine.cam.flank.profile[near.min() : near.max()] - centre).max() > 80.05
    assert run(*words, 60)[2] == ""


def test_flanks_of_a_groove_and_of_a_second_cam(tmp_path: Path) -> None:
    """Held against the outer flank, the roller of a groove stands its play of 0.05 mm, normal to the flanks, farther out."""
    inner, said = inspected(EXAMPLES / "groove.toml", tmp_path / "a.csv", "--samples", 24)
    outer, there = inspected(EXAMPLES / "groove.toml", tmp_path / "b.csv", "--samples", 24, "--flank", "outer")
    farther = outer["lift_mm"] + there["base_mm"] - inner["lift_mm"] - said["base_mm"]
    steep = Study(project.load(EXAMPLES / "groove.toml"), 24).cam.flank.pressure_angle
    assert farther == pytest.approx(0.05 / np.cos(steep), abs=3e-6)
    assert (outer["upper_mm"] - outer["lift_mm"]).min() > 0.0199
    refused = run(EXAMPLES / "groove.toml", "--out", tmp_path / "c.csv", "--radius", 40, "--flank", "outer")
    assert "does not go into the groove" in refused[2]
    inspected(EXAMPLES / "conjugate.toml", tmp_path / "d.csv", "--flank", "second", "--samples", 8)


# -- measured tables ----------------------------------------------------------------------------------------


def table(path: Path, degrees: np.ndarray, lift: np.ndarray, head: str = "angle [deg],lift [mm]") -> Path:
    rows = "".join(f"{a!r},{y!r}\n" for a, y in zip(degrees.tolist(), lift.tolist(), strict=True))
    path.write_text(f"{head}\n{rows}", "utf-8")
    return path


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a design."""
    folder = tmp_path_factory.mktemp("inspection")
    saved(folder, with_follower(HOLLOW, offset_mm=0.0))
    return folder


def own_lift(folder: Path, degrees: np.ndarray) -> np.ndarray:
    return 1e3 * Study(project.load(folder / "design.toml")).at_theta(np.deg2rad(np.mod(degrees, 360.0))).motion.y[0]


def test_a_bump_is_found_at_its_place_and_out_of_tolerance(bench: Path) -> None:
    degrees = np.sort(np.random.default_rng(3).uniform(0.0, 360.0, 700))
    bump = -0.05 * np.exp(-(((degrees - 200.0 / 3.0 - 10.0) / 9.0) ** 2))
    measured = table(bench / "cut.csv", degrees, own_lift(bench, degrees) + bump)
    words = (bench / "design.toml", "--out", bench / "table.csv", "--measured", measured, "--json")
    code, said, faults = run(*words)
    found = json.loads(said)["measured"]
    normal = bump * np.cos(
        Study(project.load(bench / "design.toml")).at_theta(np.deg2rad(degrees)).cam.flank.pressure_angle
    )
    worst = int(np.argmin(normal))
    assert (code, found["in_tolerance"], found["rows"], found["fitted"]) == (1, False, 700, False)
    assert found["cam_angle_deg"] == pytest.approx(degrees[worst], abs=1e-12)
    assert found["line"] == worst + 2
    assert found["largest_normal_deviation_mm"] == pytest.approx(normal[worst], abs=1e-10)
    most = int(np.argmin(bump))
    assert most != worst, "the cam is steep there: a row of more lift, less normal to the profile"
    assert found["largest_deviation_mm"] == pytest.approx(bump[most], abs=1e-10)
    assert (found["largest_deviation_at_deg"], found["largest_deviation_line"]) == (
        pytest.approx(degrees[most], abs=1e-12),
        most + 2,
    )
    assert found["rows_out"] == pytest.approx((normal < -0.02).sum(), abs=1)
    assert faults.startswith("error: the measured lift deviates by \u22120.0")
    assert "tolerance 0.02 mm" in faults
    rows = np.genfromtxt(bench / "table_deviation.csv", delimiter=",", names=True)
    assert rows["deviation_mm"] == pytest.approx(bump, abs=1e-10)
    assert rows["normal_deviation_mm"] == pytest.approx(normal, abs=1e-10)
    code, said, faults = run(*words, "--tolerance", 0.06, "--samples", 8)
    assert (code, json.loads(said)["measured"]["rows_out"], faults) == (0, 0, "")


def test_unknown_zero_marks_are_fitted(bench: Path) -> None:
    degrees = np.linspace(0.0, 359.0, 241)
    inches = (own_lift(bench, degrees + 237.4321) + 3.125) / 25.4
    measured = table(bench / "shifted.csv", degrees, inches, "Angle [deg],Lift [in]")
    code, said, _ = run(
        bench / "design.toml", "--out", bench / "fit.csv", "--measured", measured, "--samples", 8, "--fit", "--json"
    )
    found = json.loads(said)["measured"]
    assert (code, found["fitted"]) == (0, True)
    assert found["angle_offset_deg"] == pytest.approx(237.4321 - 360.0, abs=1e-9)
    assert found["lift_offset_mm"] == pytest.approx(3.125, abs=1e-10)
    assert abs(found["largest_deviation_mm"]) < 1e-9
    assert run(bench / "design.toml", "--out", bench / "fit.csv", "--measured", measured, "--samples", 8)[0] == 1


def test_tables_that_cover_a_part_or_have_few_rows(bench: Path) -> None:
    """Angles are degrees where nothing else is said; what was not measured is named."""
    degrees = np.array([1.0, 2.0, 3.5, 4.0, 6.0])
    measured = table(bench / "few.csv", degrees, own_lift(bench, degrees), "a,lift")
    code, said, faults = run(bench / "design.toml", "--out", bench / "few_out.csv", "--measured", measured)
    assert code == 0
    assert "5 rows; largest deviation" in said
    assert "in tolerance, ± 0.02 mm" in said
    assert faults == "note: no measured rows from 6 to 1 deg: the cam is not assessed there [inspection.measured]\n"


BAD = {
    "empty.csv": ("", "no row contains two numbers"),
    "words.csv": ("angle,lift\n0,1\n10,soft\n20,3\n30,4\n", "line 3: 'soft' in column 2"),
    "speed.csv": ("angle [deg],velocity [mm/deg]\n0,1\n10,2\n20,3\n30,4\n", "holds a velocity; required: the lift"),
    "angles.csv": ("angle [deg],swing [deg]\n0,1\n10,2\n20,3\n30,4\n", "is measured in deg, but the follower slides"),
    "unit.csv": ("angle [deg],lift [furlong]\n0,1\n10,2\n20,3\n30,4\n", "unknown unit 'furlong'"),
    "time.csv": ("time [s],lift [mm]\n0,1\n1,2\n2,3\n3,4\n", "is a time"),
    "three.csv": ("angle [deg],lift [mm]\n0,1\n1,2\n2,3\n", "3 different cam angles; at least 4"),
    "gone.csv": (None, "gone.csv"),
}


@pytest.mark.parametrize("name", spread(BAD, 3))
def test_a_table_that_cannot_be_read_is_named_and_nothing_written(tmp_path: Path, bench: Path, name: str) -> None:
    text, message = BAD[name]
    if text is not None:
        (tmp_path / name).write_text(text, "utf-8")
    code, said, faults = run(bench / "design.toml", "--out", tmp_path / "out.csv", "--measured", tmp_path / name)
    assert (code, said, faults.count("\n")) == (2, "", 1)
    assert message in faults
    assert not (tmp_path / "out.csv").exists()


WRONG = [
    (("--probe", "flat", "--radius", 3), "a flat face has none"),
    (("--tolerance", 45), "tolerance 45 mm"),
    (("--samples", 3), "cam angles; allowed: 4 ..."),
    (("--flank", "outer"), "flank 'outer': this cam has none"),
    (("--out", "table.txt"), "allowed: .csv"),
]


@pytest.mark.parametrize(("words", "message"), WRONG, ids=str)
def test_what_cannot_be_inspected_is_refused(tmp_path: Path, bench: Path, words: tuple, message: str) -> None:
    with contextlib.suppress(SystemExit):
        code, _, faults = run(bench / "design.toml", "--out", tmp_path / "out.csv", *words)
        assert code == 2
        assert message in faults
    assert list(tmp_path.iterdir()) == []


def test_neither_the_measured_table_nor_anothers_summary_is_written_over(tmp_path: Path, bench: Path) -> None:
    degrees = np.arange(0.0, 360.0, 5.0)
    measured = table(tmp_path / "cut.csv", degrees, own_lift(bench, degrees))
    before = measured.read_bytes()
    code, _, faults = run(bench / "design.toml", "--out", measured, "--measured", measured)
    assert (code, measured.read_bytes()) == (2, before)
    assert "cut.csv: cannot be written: this command reads it; choose another name" in faults
    (tmp_path / "summary.json").write_text("{}", "utf-8")
    code, _, faults = run(bench / "design.toml", "--out", tmp_path / "out.csv")
    assert code == 2
    assert "belongs to another program" in faults


def test_only_a_table_of_deviations_is_replaced_by_one(tmp_path: Path, bench: Path) -> None:
    degrees = np.arange(0.0, 360.0, 5.0)
    measured = table(tmp_path / "cut.csv", degrees, own_lift(bench, degrees))
    deviations = tmp_path / "out_deviation.csv"
    deviations.write_text("day,deviation\n1,0.02\n", "utf-8")
    code, _, faults = run(bench / "design.toml", "--out", tmp_path / "out.csv", "--measured", measured)
    assert (code, deviations.read_text("utf-8")) == (2, "day,deviation\n1,0.02\n")
    assert "out_deviation.csv: cannot be written: it belongs to another program" in faults
    assert {path.name for path in tmp_path.iterdir()} == {"cut.csv", "out_deviation.csv"}
    deviations.unlink()
    for _ in range(2):
        code, _, faults = run(bench / "design.toml", "--out", tmp_path / "out.csv", "--measured", measured)
        assert (code, faults) == (0, "")
