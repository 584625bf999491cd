"""find for a whole shaft: flywheel, phases, balancer; as commands and against scans."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mechanisms import LIFT, levels

from core.__main__ import main
from core.design import Balancer, Design, Shaft, distances, faults, with_phase
from core.design.design import TimingRow
from core.errors import KindynaError
from core.find import find
from core.project import load, save
from core.study import Study, at_speeds, extremes_of

FORCE = "loads.least_contact_force_n_min"
RATE, PRELOAD = "balancer.spring_rate_n_per_mm", "balancer.preload_n"

UNIT = Design(
    "unit",
    replace(LIFT.shaft, speed_fluctuation=0.05),
    (
        replace(LIFT.drive, name="lift"),
        replace(
            LIFT.drive, name="Feed 2", phase_deg=40.0,
            motion=levels(0.0, (100.0, 150.0, "cycloidal"), (60.0, 150.0, "dwell"), (200.0, 0.0, "modified-sine")),
        ),
    ),
    timing=(TimingRow("lift.return.1.end", "Feed 2.rise.1.start", -60.0),),
    balancer=Balancer(spring_rate_n_per_mm=200.0, preload_n=3000.0, base_radius_mm=200.0, roller_radius_mm=40.0),
)  # fmt: skip


@pytest.mark.stress
def test_the_least_flywheel_of_a_motor_that_stalls_with_less() -> None:
    """Where so large a fluctuation is allowed that the motor would stall first, the answer is where it just runs."""
    wide = replace(LIFT, shaft=replace(LIFT.shaft, speed_fluctuation=1.9))
    solution = find(wide, "flywheel", {})
    assert solution.is_valid
    assert 0.0 < solution.reached["shaft.speed_fluctuation"] <= 1.9


def test_find_phases_keeps_the_timing_and_writes_the_design(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert not faults(UNIT)
    save(UNIT, tmp_path / "unit.toml")
    made = tmp_path / "better.toml"
    assert main(["find", str(tmp_path / "unit.toml"), "phases", "--for", "rms", "--into", str(made), "--json"]) in (
        0,
        1,
    )
    found = json.loads(capsys.readouterr().out)
    ((path, phase),) = found["answer"].items()
    assert path == "drives[1].phase_deg"
    better = load(made)
    assert better.drives[1].phase_deg == phase
    assert all(row.kept for row in distances(better))
    plain = replace(UNIT, balancer=None)
    scan = [Study(with_phase(plain, 1, float(p))) for p in range(0, 360, 8)]
    rms = [each.camshaft.rms_torque for each in scan if all(row.kept for row in distances(each.design))]
    assert found["reached"]["rms_torque_nm"] <= min(rms)
    assert found["reached"]["rms_torque_nm"] == pytest.approx(min(y for _, y in found["curve"]), rel=0.05)


def test_a_balanced_shaft_needs_no_flywheel_and_no_motor_data() -> None:
    """What the balance cam leaves is rounding, on which the search for the true speed must not founder."""
    found = find(replace(UNIT, shaft=Shaft("ccw", 20.0, speed_fluctuation=0.02)), "flywheel", {})
    assert found.answer == {"shaft.flywheel_inertia_kg_m2": 0.0}
    assert found.curve
    assert max(reached for _, reached in found.curve) <= 1e-9


def test_the_profile_of_the_balance_cam_is_written_as_that_of_a_drive(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save(UNIT, tmp_path / "unit.toml")
    out = tmp_path / "balancer.csv"
    assert main(
        ["profile", str(tmp_path / "unit.toml"), "--drive", "balancer", "--samples", "360", "--out", str(out)]
    ) in (0, 1)
    capsys.readouterr()
    x, y = np.loadtxt(out, delimiter=",", skiprows=1, usecols=(1, 2)).T
    motion = Study(UNIT, 360).camshaft.balancer.motion.y[0] * 1e3
    base = UNIT.balancer.base_radius_mm
    assert np.hypot(x, y).min() == pytest.approx(base, rel=5e-3)
    assert np.hypot(x, y).max() == pytest.approx(base + motion.max(), rel=5e-3)


def test_a_flywheel_that_is_found_gives_the_fluctuation_that_is_allowed() -> None:
    for design in (replace(UNIT, balancer=None), LIFT):
        found = find(design, "flywheel", {"shaft.speed_fluctuation_max": 0.03})
        study = Study(found.design)
        speed = study.camshaft.speed
        assert np.ptp(speed) / study.omega == pytest.approx(0.03, rel=1e-4)
        assert found.is_valid
    small = find(LIFT, "flywheel", {"shaft.flywheel_inertia_kg_m2_max": 100.0})
    assert not small.is_valid
    assert "it requires" in small.violations[0]


def pressure(rate: float, preload: float) -> float:
    """The greatest pressure angle of such a balance cam [deg], by its samples."""
    study = Study(
        replace(UNIT, balancer=replace(UNIT.balancer, spring_rate_n_per_mm=rate, preload_n=preload)), 1800
    ).camshaft.balancer
    assert study is not None
    return math.degrees(float(study.cam.flank.pressure_angle.max()))


def test_find_balancer_is_the_softest_spring_of_the_least_preload_by_a_scan() -> None:
    found = find(UNIT, "balancer", {FORCE: 2000.0, "pressure_angle_deg": 25.0})
    rate, preload = found.answer[RATE], found.answer[PRELOAD]
    assert preload == 2000.0
    assert pressure(rate, preload) == pytest.approx(25.0, abs=1e-3)
    assert found.reached["loads.least_contact_force_n"] == 2000.0
    for softer in np.geomspace(0.02, 0.98, 6) * rate:
        assert pressure(float(softer), preload) > 25.0


@pytest.mark.stress
def test_find_balancer_comes_to_the_same_spring_from_a_far_too_soft_one() -> None:
    wish = {FORCE: 2000.0, "pressure_angle_deg": 25.0, "balancer.spring_rate_n_per_mm_min": 2.0}
    soft = find(replace(UNIT, balancer=replace(UNIT.balancer, spring_rate_n_per_mm=2.0)), "balancer", wish)
    assert soft.answer[PRELOAD] == 2000.0
    assert pressure(soft.answer[RATE], 2000.0) == pytest.approx(25.0, abs=1e-3)


@pytest.mark.stress
def test_the_softest_spring_is_the_same_from_any_rate_and_its_force_grows_by_a_quarter(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Under a preload so high that the pressure angle bounds no spring: one compressed by four strokes before it works."""
    answers = []
    for rate in (0.3, 300.0):
        soft = replace(UNIT, balancer=replace(UNIT.balancer, spring_rate_n_per_mm=rate, preload_n=80_000.0))
        save(soft, tmp_path / "soft.toml")
        assert (
            main(["find", str(tmp_path / "soft.toml"), "balancer", "--into", str(tmp_path / "found.toml"), "--json"])
            == 0
        )
        answers.append(json.loads(capsys.readouterr().out))
    assert answers[0]["answer"] == answers[1]["answer"]
    assert answers[0]["reached"]["balancer.force_rise"] == pytest.approx(0.25, rel=1e-9)
    found = Study(load(tmp_path / "found.toml"))
    assert found.camshaft.balancer is not None
    stroke = extremes_of(found.camshaft.balancer, "motion", ("displacement",))["displacement"].high.value * 1e3
    part = found.design.balancer
    assert part.preload_n == 80_000.0
    assert part.spring_rate_n_per_mm * stroke == pytest.approx(0.25 * part.preload_n, rel=1e-9)
    assert part.preload_n / part.spring_rate_n_per_mm == pytest.approx(4.0 * stroke, rel=1e-9)


@pytest.mark.stress
def test_a_limit_of_the_balance_cam_that_is_taken_away_holds_no_more() -> None:
    """Without a least growth of its force any softer spring serves, down to none that would push at all."""
    soft = replace(UNIT, balancer=replace(UNIT.balancer, preload_n=80_000.0))
    usual = find(soft, "balancer", {})
    free = find(soft, "balancer", {"balancer.force_rise_min": None})
    assert "balancer.force_rise" in usual.limits
    assert "balancer.force_rise" not in free.limits
    assert free.is_valid
    assert free.answer[RATE] < 0.5 * usual.answer[RATE]


@pytest.mark.stress
def test_with_a_bounded_rate_find_balancer_gives_the_least_preload_by_a_scan() -> None:
    wish = {FORCE: 2000.0, f"{RATE}_max": 60.0, "pressure_angle_deg": 25.0}
    stiff = find(UNIT, "balancer", wish)
    assert not stiff.is_valid, "compressed by more than ten strokes"
    assert stiff.violations == ("its force rises by 0.08593 of the preload, limit 0.25: use a stiffer spring",)
    found = find(UNIT, "balancer", {**wish, "balancer.force_rise_min": 0.0})
    assert dict(stiff.answer) == pytest.approx(dict(found.answer))
    rate, preload = found.answer[RATE], found.answer[PRELOAD]
    assert pressure(rate, preload) == pytest.approx(25.0, abs=1e-3)
    for each in np.linspace(5.0, 60.0, 4):
        for less in np.linspace(2000.0, 0.99 * preload, 3):
            assert pressure(float(each), float(less)) > 25.0


def test_what_no_search_can_give_is_named() -> None:
    slack = find(UNIT, "balancer", {f"{RATE}_max": 1.0, f"{PRELOAD}_max": 3500.0})
    assert not slack.is_valid
    assert "pressure angle" in slack.violations[0]
    with pytest.raises(KindynaError, match="find balancer: this design has one drive alone"):
        find(LIFT, "balancer", {})
    with pytest.raises(KindynaError, match="one drive alone"):
        find(LIFT, "phases", {})
    with pytest.raises(KindynaError, match=r"limit 'cam.bore_mm_max': flywheel has none"):
        find(LIFT, "flywheel", {"cam.bore_mm_max": 3.0})


def test_against_speed_a_balance_cam_stays_as_it_was_made() -> None:
    """At its own speed it leaves the mean; at another what the drives ask there, and the spring gives as before."""
    found = at_speeds(UNIT, np.array([UNIT.speed_rpm, 0.5 * UNIT.speed_rpm]))
    study = Study(UNIT)
    assert found.peak[0] == pytest.approx(
        abs(study.camshaft.mean_torque), rel=1e-6, abs=1e-9 * np.ptp(study.camshaft.cams_torque)
    )
    slower = Study(replace(UNIT, shaft=replace(UNIT.camshaft, speed_rpm=0.5 * UNIT.speed_rpm), balancer=None))
    assert found.peak[1] == pytest.approx(
        np.abs(slower.camshaft.torque + study.camshaft.balancer_torque).max(), rel=1e-4
    )
