"""What tolerances do: against variances in closed form, all corners, and the limit itself."""

import csv
import itertools
import json
import math
from dataclasses import replace

import numpy as np
import pytest

from core.__main__ import main
from core.design import Tolerance, Waviness, only, put
from core.process import resources
from core.project import dumps, load, save
from core.study import Study, many
from core.study.quantities import quantity
from core.varying import Scatter, Share, StudyFile, StudyLimit, study_of, waves_of

LINEAR = "contact_force_n:max"


def tappet():
    """A translating roller, whose contact force is largest in the upper dwell."""
    return load(resources() / "examples" / "dwell_rise_dwell.toml")


def scatter(design, tolerances, *limits):
    made = replace(design, tolerances=tuple(tolerances))
    return Scatter(study_of(StudyFile(design="", limits=limits), made))


def limit(bound=1e9, quantity="contact_force_n", of="max"):
    return StudyLimit(quantity, of, max=bound)


def test_random_machines_have_the_variance_of_the_linear_case():
    """In the upper dwell the force is preload + k h + m g: Var F = σ² + g² (0.05 kg)²/3, and that of a variance by the kurtoses."""
    design, n = tappet(), 4000
    rows = [
        Tolerance("loads.preload_n", 20.0, distribution="normal"),
        Tolerance("loads.follower_mass_kg", 0.05, distribution="uniform"),
    ]
    case = scatter(design, rows, limit())
    forces = case.values(n, seed=3)[0]
    parts = np.array([(20.0 / 3.0) ** 2, (9.80665 * 0.05) ** 2 / 3.0])
    exact = parts.sum()
    excess = -1.2 * (parts[1] / exact) ** 2  # of the uniform one
    assert abs(forces.var(ddof=1) - exact) < 4.0 * exact * math.sqrt((2.0 + excess) / n)
    nominal = many(design, {"loads.preload_n": [design.drive.loads.preload_n]}, [LINEAR]).value[LINEAR][0]
    assert abs(forces.mean() - nominal) < 4.0 * math.sqrt(exact / n)
    assert case.parts(case.slopes())[:, 0] == pytest.approx(parts / exact, rel=1e-6)


def test_the_worst_corner_is_the_worst_of_all():
    design = load(resources() / "examples" / "transfer_lift.toml")
    rows = [
        Tolerance("follower.pivot_x_mm", 0.5, 0.2), Tolerance("follower.pivot_y_mm", 0.4), Tolerance("follower.rod_mm", 0.3, 0.6),
        Tolerance("cam.base_radius_mm", 0.1), Tolerance("follower.fixed_angle_deg", 0.05),
    ]  # fmt: skip
    case = scatter(design, rows, limit(30.0, "pressure_angle_deg"))
    (corner,) = case.corners(case.slopes())
    ends = itertools.product(
        *((value - row.down, value + row.plus) for row, value in zip(rows, case.nominal.values(), strict=True))
    )
    every = np.array(list(ends)).T
    found = many(design, dict(zip(case.nominal, every, strict=True)), ["pressure_angle_deg:max"]).value[
        "pressure_angle_deg:max"
    ]
    assert corner.value == pytest.approx(found.max(), rel=1e-9)
    assert corner.linear == pytest.approx(corner.value, abs=0.01)
    assert list(corner.at.values()) == pytest.approx(every[:, found.argmax()].tolist(), rel=1e-12)


@pytest.mark.parametrize(
    ("within", "n", "low", "high"),
    [
        (1420, 1420, 0.99730, 1.0),
        (81, 263, 0.2553, 0.3662),
        (0, 20, 0.0, 0.1611),
    ],  # the last two: Newcombe 1998, table I, method 3
)
def test_the_interval_is_wilsons(within, n, low, high):
    assert Share(within, n).interval == pytest.approx((low, high), abs=5e-5)


def test_the_cheapest_tolerance_that_helps_is_tightened():
    design = tappet()
    rows = [
        Tolerance("loads.preload_n", 30.0, cost=1.0),
        Tolerance("loads.follower_mass_kg", 0.01, cost=0.1),  # cheap, but of no use
        Tolerance("loads.gravity_m_s2", 0.001, cost=0.01),
    ]
    case = scatter(design, rows, limit())
    nominal = many(design, {"loads.preload_n": [design.drive.loads.preload_n]}, [LINEAR]).value[LINEAR][0]
    slope = case.slopes()[0, 0]
    case = scatter(design, rows, limit(nominal + slope * 17.0))  # 1.7 sigma of 10 N; 3.4 of 5 N
    assert case.share(2000, 1).value < 0.97
    found = case.tightened(2000, 1, case.slopes())
    assert found is not None
    assert found.halved == {"loads.preload_n": 1}
    assert found.share.value >= 0.9973


def test_the_command_writes_its_three_files(tmp_path, capsys):
    design = load(resources() / "examples" / "transfer_lift.toml")
    rows = (Tolerance("follower.pivot_x_mm", 0.05), Tolerance("follower.pivot_y_mm", 0.05))
    save(replace(design, tolerances=rows, waviness=Waviness(0.01, 10, 20)), tmp_path / "lift.toml")
    assert main(["tolerance", str(tmp_path / "lift.toml"), "--out", str(tmp_path / "out"), "--machines", "200"]) == 0
    assert "200 of 200 machines keep all limits: 100.00%" in capsys.readouterr().out
    told = json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))
    assert (told["share"], told["seed"], told["high"]) == (1.0, 0, 1.0)
    assert told["low"] == pytest.approx(200 / (200 + 1.96**2), abs=1e-4)
    waves = told["waviness"]
    assert waves["lift_error_mm"] == pytest.approx(0.01 / math.cos(math.radians(waves["pressure_angle_deg"])))
    with open(tmp_path / "out" / "bands.csv", newline="", encoding="utf-8") as file:
        bands = list(csv.DictReader(file))
    row = {name: float(cell) for name, cell in bands[60].items()}
    levels = [row[f"pressure_angle_deg_{level}"] for level in ("p0.135", "p5", "p50", "p95", "p99.865")]
    assert levels == sorted(levels)
    assert levels[0] < levels[-1]
    with open(tmp_path / "out" / "sensitivity.csv", newline="", encoding="utf-8") as file:
        lines = [each for each in csv.DictReader(file) if each["quantity"] == "pressure_angle_deg_max"]
    assert sum(float(each["part_of_tolerance"]) for each in lines) == pytest.approx(1.0)
    assert float(lines[0]["part_of_tolerance"]) >= float(lines[1]["part_of_tolerance"])
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    assert main(["tolerance", str(tmp_path / "lift.toml"), "--out", str(tmp_path / "out"), "--machines", "200"]) == 0
    assert before == {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}


def test_what_changes_a_quantity_by_rounding_alone_has_no_share(tmp_path):
    """Without weight nothing depends on the guide's direction, and the torque of a cam not on its base radius."""
    design = put(tappet(), "loads.gravity_m_s2", 0.0)
    fields = ("follower.direction_deg", "cam.base_radius_mm", "loads.preload_n")
    save(replace(design, tolerances=tuple(Tolerance(field, 0.5) for field in fields)), tmp_path / "cam.toml")
    assert main(["tolerance", str(tmp_path / "cam.toml"), "--out", str(tmp_path / "out"), "--machines", "50"]) == 0
    with open(tmp_path / "out" / "sensitivity.csv", newline="", encoding="utf-8") as file:
        rows = {(row["field"], row["quantity"]): row for row in csv.DictReader(file)}
    torque = {field: rows[field, "drive_torque_nm_abs"] for field in fields}
    assert [float(torque[field]["per_unit"]) == 0.0 for field in fields] == [True, True, False]
    assert [float(torque[field]["part_of_tolerance"]) for field in fields] == [0.0, 0.0, 1.0]


def test_waves_of_the_profile_press_by_their_lobes_and_any_phase():
    """In the upper dwell a wave of n lobes adds m e (n ω)² to the greatest force in any phase; n = 10 ... 40, each as likely."""
    design, e, omega = tappet(), 2e-6, 2.0 * math.pi * 20.0
    design = replace(design, shaft=replace(design.shaft, speed_rpm=1200.0), waviness=Waviness(1e3 * e, 10, 40))
    rate = design.drive.loads.spring_rate_n_per_mm
    design = put(put(design, "loads.preload_n", 2000.0), "loads.spring_rate_n_per_mm", 100.0 + rate)
    highest = many(design, {"loads.preload_n": [2000.0]}, [LINEAR]).value[LINEAR][0]
    assert highest == pytest.approx(2000.0 + 20.0 * (100.0 + rate) + 9.80665, rel=1e-9), "in the upper dwell"
    room = e * (28.5 * omega) ** 2
    case, n = Scatter(study_of(StudyFile(design="", limits=(limit(highest + room),)), design)), 3000
    share = 19.0 / 31.0  # 10 ... 28 lobes
    assert abs(case.share(n, 5).value - share) < 4.0 * math.sqrt(share * (1.0 - share) / n)
    (corner,) = case.corners(case.slopes())
    assert corner.value == pytest.approx(highest + e * (40.0 * omega) ** 2, rel=1e-9)
    assert not corner.within
    found = case.waves.by_drive[None].summary()
    steepest = math.cos(math.radians(found["pressure_angle_deg"]))
    assert found["acceleration_mm_s2"] == pytest.approx(1e3 * e * (40.0 * omega) ** 2 / steepest, rel=1e-9)
    assert found["contact_force_n"] == pytest.approx(e * (40.0 * omega) ** 2 / steepest**2, rel=1e-4)
    bands = case.bands(60, 5)["contact_force_n"]
    assert (np.ptp(bands[[0, -1]], axis=0) > 0.9 * e * (30.0 * omega) ** 2).all()


def test_waves_of_a_shaft_are_told_drive_by_drive(tmp_path, capsys):
    unit = load(resources() / "examples" / "transfer_unit.toml")
    save(replace(unit, waviness=Waviness(0.01, 20, 20)), tmp_path / "unit.toml")
    assert main(["tolerance", str(tmp_path / "unit.toml"), "--out", str(tmp_path), "--machines", "20"]) == 0
    assert "waves of Lift: " in capsys.readouterr().out
    told = json.loads((tmp_path / "summary.json").read_text("utf-8"))["waviness"]
    assert list(told) == ["Feed", "Clamp", "Lift", "Torque"]
    lift = replace(only(unit, 2), waviness=Waviness(0.01, 20, 20))
    assert told["Lift"] == waves_of(Study(lift)).summary()


def test_waves_make_an_elastic_follower_vibrate_at_its_own_frequency():
    """m z'' + c z' + k (z - s) + ks z = 0: |z/s| = k/(2 ζ √(k + ks)²) where n ω is near √((k + ks)/m)."""
    design = replace(tappet(), waviness=Waviness(0.002, 10, 60))
    omega, k, ks = 2.0 * math.pi, 40e3, 500.0
    design = put(put(design, "loads.follower_stiffness_n_per_mm", 1e-3 * k), "loads.follower_damping_ratio", 0.05)
    found = waves_of(Study(design)).summary()
    own = math.sqrt(k + ks) / omega
    assert found["natural_lobes"] == pytest.approx(own, rel=1e-9)
    assert found["amplified_lobes"] == round(own)
    x = round(own) / own
    assert found["amplified"] == pytest.approx(k / (k + ks) / math.hypot(1.0 - x * x, 0.1 * x), rel=1e-9)
    assert found["elastic_contact_force_n"] > 5.0 * found["contact_force_n"] * (own / 60.0) ** 2
    lift = load(resources() / "examples" / "transfer_lift.toml")  # an arm: J of all, by the slider
    lift = replace(lift, waviness=Waviness(0.01, 5, 20))
    waves, study = waves_of(Study(lift)), Study(lift)
    energy, speed = quantity("kinetic_energy"), quantity("velocity")
    there = study.at_theta(np.deg2rad([50.0, 60.0, 300.0]))
    mass = 2.0 * energy.value(there) / speed.value(there) ** 2
    assert waves.at(there.theta).mass == pytest.approx(mass, rel=1e-9)


def test_tolerances_that_cannot_be_are_faults_of_the_design(tmp_path, capsys):
    text = dumps(tappet()) + '\n[[tolerances]]\nfield = "cam.base_radios_mm"\nplus = 0.1\n'
    (tmp_path / "d.toml").write_text(text, "utf-8")
    assert main(["tolerance", str(tmp_path / "d.toml"), "--out", str(tmp_path / "out")]) == 2
    assert "tolerances[0].field" in capsys.readouterr().err
    (tmp_path / "d.toml").write_text(dumps(tappet()), "utf-8")
    assert main(["tolerance", str(tmp_path / "d.toml"), "--out", str(tmp_path / "out")]) == 2
    assert "give at least one [[tolerances]]" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
