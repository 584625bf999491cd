"""The transfer unit's own file by commands: check, export, find, stability. Numbers against the study, and sums of what is written."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
from sampled import stressed

from core.__main__ import main
from core.design import only
from core.errors import DesignError
from core.numerics.derivatives import ISOMETRIC, seen_from
from core.project import load
from core.study import Study, extremes_of, findings_of

FILE = str(Path(__file__).parents[3] / "resources" / "examples" / "transfer_unit.toml")
SAMPLES = 72
SLUGS = ("feed", "clamp", "lift", "torque")
NEW_SPRING = ("balancer.spring_rate_n_per_mm", "balancer.preload_n")


@pytest.fixture(scope="module")
def unit() -> Study:
    return Study(load(FILE), SAMPLES)


def table(path: Path) -> dict[str, np.ndarray]:
    with path.open(encoding="utf-8", newline="") as lines:
        names, *rows = csv.reader(lines)
    return dict(zip(names, np.array(rows, dtype=float).T, strict=True))


def test_check_has_nothing_against_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", FILE]) == 0
    assert "0 findings" in capsys.readouterr().out


def test_export_writes_the_shaft_and_a_folder_for_each_drive(unit: Study, tmp_path: Path) -> None:
    assert main(["export", FILE, "--out", str(tmp_path), "--samples", str(SAMPLES)]) == 0
    assert sorted(each.name for each in tmp_path.iterdir()) == sorted((*SLUGS, "shaft.csv", "summary.json"))
    shaft = table(tmp_path / "shaft.csv")
    assert list(shaft)[:2] == ["machine_angle_deg", "torque_nm"]
    assert list(shaft)[-2:] == ["motor_torque_nm", "speed_rpm"]
    total = shaft["torque_nm"]
    assert np.abs(sum(shaft[f"{slug}_torque_nm"] for slug in SLUGS) - total).max() <= 1e-12 * np.ptp(total) * len(SLUGS)
    assert np.allclose(total, unit.camshaft.torque, rtol=0.0, atol=1e-12 * np.ptp(total))
    for drive, slug in zip(unit.design.drives, SLUGS, strict=True):
        names = {each.name for each in (tmp_path / slug).iterdir()}
        assert names == {"profile.csv", "kinematics.csv", "dynamics.csv", "summary.json"}
        own = table(tmp_path / slug / "dynamics.csv")
        assert "motor_torque_nm" not in own
        if drive.phase_deg % 5.0 == 0.0:  # a row of its own table is one of the shaft's
            turned = np.roll(own["drive_torque_nm"], round(drive.phase_deg / 5.0))
            assert np.array_equal(turned, shaft[f"{slug}_torque_nm"])
    summary = json.loads((tmp_path / "summary.json").read_text("utf-8"))
    assert summary["name"] == "Transfer unit"
    assert summary["findings"] == []
    assert all(abs(each["value"]) <= each["bound"] for each in summary["certificate"].values())


def found(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, dict[str, float]]:
    assert main(["find", FILE, *words, "--json"]) == 0
    answer: dict[str, dict[str, float]] = json.loads(capsys.readouterr().out)
    return answer


def test_find_gives_the_flywheel_for_the_fluctuation_that_is_allowed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    answer = found(
        capsys, "flywheel", "--limit", "shaft.speed_fluctuation_max=0.01", "--into", str(tmp_path / "even.toml")
    )["answer"]
    even = Study(load(tmp_path / "even.toml"))
    assert even.design.camshaft.flywheel_inertia_kg_m2 == answer["shaft.flywheel_inertia_kg_m2"]
    speed = even.camshaft.motor_range["speed"]
    assert (speed.high.value - speed.low.value) / even.omega == pytest.approx(0.01, rel=1e-6)


@pytest.mark.parametrize(
    ("aim", "key"),
    [
        ("peak", "peak_torque_nm"),
        stressed("rms", "rms_torque_nm"),
        stressed("fluctuation", "energy_swing_j"),
    ],
)
def test_find_gives_the_best_phases(
    aim: str, key: str, unit: Study, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    reached = found(capsys, "phases", "--for", aim, "--into", str(tmp_path / "turned.toml"))["reached"]
    turned = Study(load(tmp_path / "turned.toml"))

    def figure(study: Study) -> float:
        angles = np.deg2rad(np.arange(7200) * 0.05)
        torque = study.camshaft.at_theta(angles).torque
        if aim == "fluctuation":
            energy = np.cumsum(torque - torque.mean()) * (angles[1] - angles[0])
            return float(np.ptp(energy))
        return float(np.abs(torque).max() if aim == "peak" else np.sqrt(np.mean(torque**2)))

    assert figure(turned) == pytest.approx(reached[key], rel=1e-4)
    assert figure(turned) <= figure(unit) * (1.0 + 1e-9)
    assert {f.code for f in findings_of(turned)} <= {"speed-fluctuates"}, "the timing is kept"


@pytest.mark.stress
def test_find_gives_a_balance_cam_to_a_shaft_without_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    near = [f"{NEW_SPRING[0]}_min=110", f"{NEW_SPRING[0]}_max=118"]
    answer = found(
        capsys, "balancer", "--limit", near[0], "--limit", near[1], "--into", str(tmp_path / "balanced.toml")
    )["answer"]
    assert tuple(answer) == NEW_SPRING
    balanced = Study(load(tmp_path / "balanced.toml"), SAMPLES)
    balancer = balanced.camshaft.balancer
    assert balancer is not None
    steepest = extremes_of(balancer, "cam", ("pressure_angle",))["pressure_angle"].high.value
    assert np.rad2deg(steepest) <= 30.0 * (1.0 + 1e-9)
    assert np.ptp(balanced.camshaft.torque) <= 1e-10 * np.ptp(balanced.camshaft.cams_torque)
    assert [path for path in balanced.design.assumed if path.startswith("balancer.")]


@pytest.mark.stress
def test_stability_prints_the_forbidden_speeds(unit: Study, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["stability", FILE]) == 0
    printed = capsys.readouterr().out
    rows = re.findall(r"^tongue (\d+)\s+([\d.]+)\s+([\d.]+)", printed, re.MULTILINE)
    bands = unit.flexible_shaft().bands
    assert bands
    assert [(int(n), float(low), float(high)) for n, low, high in rows] == [
        (band.n, pytest.approx(band.rpm_lo, abs=1e-3), pytest.approx(band.rpm_hi, abs=1e-3)) for band in bands
    ]


def test_the_part_goes_round_in_space_as_its_drives_carry_it(tmp_path: Path) -> None:
    """Feed along x at the end of its arm, clamp along y, lift along z: each by its own motion, turned by its phase."""
    unit = load(FILE)
    assert [drive.carries for drive in unit.drives] == [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), ()]
    path = Study(unit, 360).camshaft.transfer_path * 1e3
    for axis, (name, lever) in enumerate((("Feed", 500.0), ("Clamp", 1e3), ("Lift", 1e3))):
        number = next(i for i, drive in enumerate(unit.drives) if drive.name == name)
        alone = Study(only(unit, number), 360)
        own = np.deg2rad(np.arange(360.0) - unit.drives[number].phase_deg)
        wanted = alone.at_theta(np.mod(own, 2.0 * np.pi)).motion.displacement[0] * lever
        assert np.abs(path[:, axis] - wanted).max() < 1e-9
    assert np.ptp(path, axis=0) == pytest.approx([np.deg2rad(24.0) * 500.0, 40.0, 150.0], abs=1e-9)
    assert main(["curves", FILE, "--out", str(tmp_path / "p.csv"), "--samples", "4"]) == 0
    head, *rows = (tmp_path / "p.csv").read_text("utf-8").splitlines()
    assert head == "machine_angle_deg,x_mm,y_mm,z_mm"
    assert [float(x) for x in rows[1].split(",")[1:]] == pytest.approx(path[90], abs=1e-9)
    seen = seen_from(np.eye(3), *ISOMETRIC)
    assert np.abs(seen) == pytest.approx(np.full(3, np.sqrt(2.0 / 3.0)))  # all axes look as long
    assert main(["curves", FILE, "--out", str(tmp_path / "p.svg")]) == 0
    assert '<g id="PATH"' in (tmp_path / "p.svg").read_text("utf-8")


@pytest.mark.parametrize(("value", "problem"), [("[0.0, 0.0, 0.0]", "no direction"), ("[1.0, 2.0]", "no direction")])
def test_a_direction_that_is_none_is_refused(value: str, problem: str, tmp_path: Path) -> None:
    text = Path(FILE).read_text("utf-8").replace("[0.0, 1.0, 0.0]", value)
    (tmp_path / "unit.toml").write_text(text, "utf-8")
    with pytest.raises(DesignError, match=rf"drives\[1\].carries.*{problem}"):
        load(tmp_path / "unit.toml")
