"""Instant centres of a cam with all that it drives: Kennedy's law, the contact normal, velocities; Q, V_Q and V_R of Shin1995."""

import json
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from mechanisms import LAYOUT_DESIGNS
from shafts import KIM

from core.__main__ import main
from core.output.channels import channel
from core.project import load, save
from core.study import Study

EXAMPLES = Path(__file__).parents[3] / "resources" / "examples"
LIFT = load(EXAMPLES / "transfer_lift.toml")
ZX, ZY, ZL = 873.746, -65.0, 651.081


@pytest.mark.parametrize("letter", ["a", "d", "f", "g"])
def test_every_three_centres_lie_on_a_line_and_the_normal_meets_that_of_cam_and_arm(letter: str) -> None:
    """Layouts on both sides, with the roller above and below; at rest in the dwells, too."""
    study = Study(LAYOUT_DESIGNS[letter], 24)
    table = study.cam_centres
    assert table.bodies == ("frame", "arm", "rod", "slider", "cam")
    rests = ~np.abs(study.motion.displacement[1]).astype(bool)
    assert rests.any()
    assert not rests.all()
    for a, b, c in combinations(table.bodies, 3):
        three = [table.centre(*pair).homogeneous for pair in ((a, b), (a, c), (b, c))]
        volume = np.linalg.det(np.array(three).transpose(2, 0, 1))
        sizes = np.prod([np.linalg.norm(each, axis=0) for each in three], axis=0)
        assert np.abs(volume / sizes).max() < 1e-9, (a, b, c)
    q, flank = table.centre("arm", "cam").finite, study.cam.flank
    normal, away = flank.profile * np.exp(1j * study.sense * study.theta) - flank.reference, flank.reference - q
    assert np.abs((np.conj(normal) * away).imag / np.abs(normal * away)).max() < 1e-9
    assert np.abs(table.centre("frame", "cam").finite).max() < 1e-15


def test_q_and_both_velocities_of_the_lift_are_those_of_its_arm() -> None:
    """(15) to (18): V_Q is that of cam and arm alike, and V_R its share by the arm; φ' from the linkage alone."""
    study = Study(LIFT, 90)
    q, v_q, v_r, phi = (
        channel(LIFT, name).values(study)
        for name in ("instant_centre_mm", "instant_centre_velocity_mm_s", "roller_centre_velocity_mm_s", "phi_rad_s")
    )
    omega, zxy = 20.0 * np.pi / 30.0, np.hypot(ZX, ZY)
    rate = phi / omega
    assert np.abs(q - zxy * rate / (rate - 1.0)).max() < 1e-9
    assert np.abs(v_q - q * omega).max() < 1e-9
    assert np.abs(v_q - phi * (q - zxy)).max() < 1e-9, "the arm has the same velocity there"
    assert np.abs(v_r - v_q * ZL / (zxy - q)).max() < 1e-9
    assert np.abs(np.abs(v_r) - ZL * np.abs(phi)).max() < 1e-9
    assert np.abs(v_r).max() > 200.0
    x, y = (channel(LIFT, name).values(study) for name in ("instant_centre_x_mm", "instant_centre_y_mm"))
    assert np.abs((x + 1j * y) - q * (ZX + 1j * ZY) / zxy).max() < 1e-9


def test_on_a_guide_q_is_the_slope_and_both_velocities_the_followers() -> None:
    study = Study(KIM, 90)
    y = KIM.shaft.speed_rpm * np.pi / 30.0
    v = channel(KIM, "velocity_mm_s").values(study)
    for name in ("instant_centre_velocity_mm_s", "roller_centre_velocity_mm_s"):
        assert channel(KIM, name).values(study) == pytest.approx(v, abs=1e-9)
    assert channel(KIM, "instant_centre_mm").values(study) == pytest.approx(v / y, abs=1e-12)


def test_the_command_lists_the_centres_of_a_cam(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["centres", str(EXAMPLES / "transfer_lift.toml"), "--angle", "50", "--out", str(tmp_path / "out")]) == 0
    told = json.loads(capsys.readouterr().out)
    assert json.loads((tmp_path / "out" / "centres.json").read_text("utf-8")) == told
    assert list(told["centres"]) == [
        ",".join(pair) for pair in combinations(("frame", "arm", "rod", "slider", "cam"), 2)
    ]
    assert told["centres"]["frame,slider"] == {"direction_deg": pytest.approx(90.0)}
    q = complex(*told["centres"]["arm,cam"])
    assert abs(q) == pytest.approx(-told["instant_centre"]["instant_centre_mm"])
    assert told["velocity_ratios"]["arm,cam"]["ratio"] == pytest.approx(
        told["angular_velocity_rad_s"]["arm"] / told["angular_velocity_rad_s"]["cam"]
    )
    pivot, pin = (complex(told["points"][name]["x_mm"], told["points"][name]["y_mm"]) for name in ("pivot", "arm_pin"))
    moved = complex(told["points"]["arm_pin"]["vx_mm_s"], told["points"]["arm_pin"]["vy_mm_s"])
    assert abs(moved - 1j * told["angular_velocity_rad_s"]["arm"] * (pin - pivot)) < 1e-9
    save(KIM, tmp_path / "kim.toml")
    assert main(["centres", str(tmp_path / "kim.toml"), "--angle", "250"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["centres"]["follower,cam"] == pytest.approx([0.0, 0.0])
    assert told["centres"]["frame,follower"] == {"direction_deg": 0.0}
    assert main(["centres", str(EXAMPLES / "four_bar_coupler_cam.toml"), "--angle", "100"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert {"1,2", "3,4", "1,cam", "3,cam"} <= set(told["centres"])
    assert abs(complex(*told["centres"]["3,cam"])) * 1e0 == pytest.approx(
        told["instant_centre"]["instant_centre_velocity_mm_s"] / abs(told["angular_velocity_rad_s"]["cam"])
    )
