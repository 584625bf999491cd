"""The events of a measured cam: off the base circle, its durations at stated lifts, ramps, and jumps of velocity."""

import json
from math import asin, degrees, pi
from pathlib import Path

import numpy as np
import pytest

from core.__main__ import main

ANGLES = np.arange(0.0, 360.0, 1.0)
HEADER = "angle [deg],lift [mm]\n"


def answer(path: Path, values: np.ndarray, capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, object]:
    path.write_text(HEADER + "".join(f"{a:g},{y:.9f}\n" for a, y in zip(ANGLES, values, strict=True)), "utf-8")
    assert main(["measured", str(path), "--error", "0.00001", "--json", *words]) == 0
    return json.loads(capsys.readouterr().out)


def test_durations_of_an_event_that_passes_cam_angle_0(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A harmonic lift of 9 mm from 300 over 0 to 60 deg: s = 4.5 (1 - cos 3x), so that s = L at x = 2/3 asin √(L/9)."""
    x = np.mod(ANGLES - 300.0, 360.0)
    values = np.where(x < 120.0, 4.5 * (1.0 - np.cos(np.deg2rad(3.0 * x))), 0.0)
    found = answer(tmp_path / "cam.csv", values, capsys)
    (event,) = found["events"]  # type: ignore[misc]
    assert (event["start_deg"], event["end_deg"]) == pytest.approx((300.0, 420.0), abs=1e-3)
    assert event["lift_mm"] == pytest.approx(9.0, abs=1e-4)
    for row, lift in zip(event["durations"], (1.0, 1.27), strict=True):
        leaves = 2.0 / 3.0 * degrees(asin((lift / 9.0) ** 0.5))
        assert row["lift_mm"] == lift
        assert row["duration_deg"] == pytest.approx(120.0 - 2.0 * leaves, abs=1e-3)
    found = answer(tmp_path / "cam.csv", values, capsys, "--lift", "4.5", "--lift", "20")
    (row,) = found["events"][0]["durations"]  # type: ignore[index]
    assert row["duration_deg"] == pytest.approx(60.0, abs=1e-3)
    assert main(["measured", str(tmp_path / "cam.csv")]) == 0
    text = capsys.readouterr().out
    assert "at 1.27 mm lift (0.05 in): " in text
    assert "120 deg off the base circle, lift 9 mm" in text


def test_an_event_that_begins_with_the_turn_is_told_from_cam_angle_0(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    values = np.where(ANGLES < 120.0, 4.5 * (1.0 - np.cos(np.deg2rad(3.0 * ANGLES))), 0.0)
    (event,) = answer(tmp_path / "cam.csv", values, capsys)["events"]  # type: ignore[misc]
    assert (event["start_deg"], event["end_deg"]) == pytest.approx((0.0, 120.0), abs=1e-3)
    assert 0.0 < event["durations"][0]["start_deg"] < 30.0


def test_a_ramp_and_the_jumps_of_velocity_at_its_ends_are_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A ramp of 0.02 mm a degree from 100 to 120 deg, the lift from its end on, a dwell at the top, and a jumping way down."""
    u = np.clip((ANGLES - 120.0) / 80.0, 0.0, 1.0)
    rise = 0.02 * np.clip(ANGLES - 100.0, 0.0, 20.0) + 8.0 * (u - np.sin(2.0 * pi * u) / (2.0 * pi))
    down = np.clip((ANGLES - 240.0) / 60.0, 0.0, 1.0)
    found = answer(tmp_path / "cam.csv", rise - 8.4 * down, capsys)
    (event,) = found["events"]  # type: ignore[misc]
    ramp = event["ramps"][0]
    assert ramp["mm_per_deg"] == pytest.approx(0.02, rel=0.02)
    assert (ramp["start_deg"], ramp["end_deg"]) == pytest.approx((100.0, 120.0), abs=0.05)
    jumps = found["velocity_jumps"]
    at = [jump["cam_angle_deg"] for jump in jumps]  # type: ignore[attr-defined]
    assert at == pytest.approx([100.0, 120.0, 240.0, 300.0], abs=0.05)
    by = [jump["after"] - jump["before"] for jump in jumps]  # type: ignore[attr-defined]
    assert by == pytest.approx([0.02, -0.02, -0.14, 0.14], abs=2e-4)
    assert any("the velocity jumps at 240 deg, from 0 to \u22120.14 mm/deg" in note for note in found["notes"])  # type: ignore[attr-defined]
    assert found["suspects"] == [], "the rows at a kink are right"
