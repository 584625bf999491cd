"""A shaft with a disk cam and a globoidal indexer: its torque, balancer, wind-up and servo against sums by hand."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.__main__ import main
from core.design import Design
from core.project import dumps, load, loads
from core.study import Study, findings_of

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
PHASE, SAMPLES = 40, 720
OMEGA = 2.0 * np.pi * 300.0 / 60.0


def shared_shaft() -> Design:
    """The rocker of one example, and the indexer of another one 40° later, at 300 rpm."""
    rocker, indexer = (load(EXAMPLES / f"{name}.toml") for name in ("rocker_cam", "globoidal_indexer"))
    drives = replace(rocker.drive, name="Rocker"), replace(indexer.drive, name="Indexer", phase_deg=float(PHASE))
    return replace(rocker, name="Two drives", drives=drives, assumed=())


def modified_sine(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and acceleration of the standard curve at parts t of the span."""
    scale, middle = np.pi / (4.0 + np.pi), (t > 0.125) & (t < 0.875)
    inner = np.pi / 3.0 + 4.0 * np.pi * t / 3.0
    velocity = scale * np.where(middle, 1.0 - 3.0 * np.cos(inner), 1.0 - np.cos(4.0 * np.pi * t))
    return velocity, 4.0 * np.pi * scale * np.where(middle, np.sin(inner), np.sin(4.0 * np.pi * t))


def indexer_effort(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Torque Q = I ω² φ'' + M sign φ' of the turret, φ' and φ'' at its cam angles: 60° in 120° after a dwell of 240°."""
    rise, span = np.deg2rad(60.0), np.deg2rad(120.0)
    t = (np.mod(theta, 2.0 * np.pi) - np.deg2rad(240.0)) / span
    moves = t >= 0.0
    velocity, acceleration = modified_sine(np.clip(t, 0.0, 1.0))
    y_1, y_2 = np.where(moves, velocity, 0.0) * rise / span, np.where(moves, acceleration, 0.0) * rise / span**2
    return 0.05 * OMEGA**2 * y_2 + 2.0 * moves, y_1, y_2


def columns(file: Path) -> dict[str, np.ndarray]:
    with file.open(encoding="utf-8") as stream:
        header, *rows = csv.reader(stream)
    return dict(zip(header, np.array(rows, dtype=float).T, strict=True))


def exported(design: Design, folder: Path, table: str = "shaft.csv") -> dict[str, np.ndarray]:
    """A table of the command ``export``."""
    file = folder / "design.toml"
    file.write_text(dumps(design), "utf-8")
    assert main(["export", str(file), "--out", str(folder), "--samples", str(SAMPLES)]) == 0
    return columns(folder / table)


THETA = np.arange(SAMPLES) * 2.0 * np.pi / SAMPLES


def test_torque_of_the_shaft_is_the_sum_of_both_cams(tmp_path) -> None:
    design = shared_shaft()
    table = exported(design, tmp_path)
    effort, y_1, _ = indexer_effort(THETA - np.deg2rad(PHASE))
    alone = Study(replace(design, drives=(replace(design.drives[0], name=""),)), SAMPLES).dynamics.torque
    assert table["indexer_torque_nm"] == pytest.approx(effort * y_1, abs=1e-9)
    assert table["rocker_torque_nm"] == pytest.approx(alone, abs=1e-9)
    assert table["torque_nm"] == pytest.approx(alone + effort * y_1, abs=1e-9)
    work = np.cumsum(table["torque_nm"] - 1.0 / 3.0) * 2.0 * np.pi / SAMPLES
    flywheel = json.loads((tmp_path / "summary.json").read_text("utf-8"))["flywheel"]
    assert flywheel["energy_swing_j"] == pytest.approx(np.ptp(work), rel=1e-3)
    # only friction takes energy: 2 N·m over 60° a turn
    assert table["torque_nm"].mean() == pytest.approx(2.0 * np.deg2rad(60.0) / (2.0 * np.pi), abs=1e-3)


def test_a_balancer_leaves_the_mean_of_both_cams(tmp_path) -> None:
    text = dumps(shared_shaft()) + (
        "\n[balancer]\nspring_rate_n_per_mm = 20.0\npreload_n = 100.0\nphase_deg = 0.0\nbase_radius_mm = 40.0\nroller_radius_mm = 10.0\n"
    )
    torque = exported(loads(text, "balanced"), tmp_path)["torque_nm"]
    assert torque == pytest.approx(np.full(SAMPLES, 1.0 / 3.0), abs=1e-9)


def test_a_stiff_shaft_winds_up_by_its_torque_over_its_stiffness() -> None:
    """What is left is the inertia of the shaft, which has less part in it the stiffer the shaft is."""
    errors = []
    for stiffness in (2e4, 1e5):
        elastic = f"[shaft]\nstiffness_nm_per_rad = {stiffness}\ncamshaft_inertia_kg_m2 = 0.05\ndamping_ratio = 0.05\n"
        study = Study(loads(dumps(shared_shaft()).replace("[shaft]\n", elastic), "elastic"), SAMPLES)
        torque = study.camshaft.torque
        difference = stiffness * study.steady_turn.wind_up(THETA) - torque
        errors.append(np.abs(difference).max() / np.abs(torque).max())
    assert errors[1] < 0.07
    assert errors[1] < 0.5 * errors[0]


def test_a_servo_of_the_indexer_turns_the_turret_by_itself(tmp_path) -> None:
    """T = (Q + I_r i² φ̈)/i at the motor; the cam's torque is the same as without it."""
    text = dumps(shared_shaft()) + '\n[drives.servo]\nkind = "rotary"\ngear_ratio = 5.0\nrotor_inertia_kg_m2 = 1e-4\n'
    table = exported(loads(text, "servo"), tmp_path, "indexer/servo.csv")
    effort, y_1, y_2 = indexer_effort(THETA)
    assert table["motor_torque_nm"] == pytest.approx(effort / 5.0 + 1e-4 * 5.0 * OMEGA**2 * y_2, abs=1e-9)
    assert table["motor_speed_rpm"] == pytest.approx(5.0 * 300.0 * y_1, abs=1e-9)


def test_times_of_both_drives_are_compared() -> None:
    """The rocker has risen at 170°, the turret starts at 240° + 40°: 110° later."""
    for least, is_kept in ((110.0, True), (110.1, False)):
        text = dumps(shared_shaft()) + (
            f'\n[[timing]]\nfirst = "rocker.rise.1.end"\nsecond = "indexer.rise.1.start"\nleast_deg = {least}\n'
        )
        codes = {finding.code for finding in findings_of(Study(loads(text, "timing")))}
        assert ("timing-broken" not in codes) == is_kept, codes
