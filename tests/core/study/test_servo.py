"""Servo motors against closed forms: a trapezoid of velocity and 3-4-5 on pure inertia, losses, gear ratio, limits."""

import json
import math

import numpy as np
import pytest

from core.__main__ import main
from core.errors import DesignError
from core.process import resources
from core.project import loads
from core.study import Study, findings_of
from core.study.drive_forces import servo_power, servo_turn

TURN = 1.0  # s, at 60 rpm
HEAD = 'format = 1\nname = "Servo"\n'
SHAFT = '[shaft]\nrotation = "ccw"\nspeed_rpm = 60.0\n'
SWINGING = (
    '[follower]\nkind = "oscillating"\narm_mm = 80.0\npivot_x_mm = 110.0\npivot_y_mm = 0.0\nside = "right"\n'
    "[cam]\nbase_radius_mm = 50.0\nroller_radius_mm = 10.0\n[loads]\narm_inertia_kg_m2 = 0.5\ngravity_m_s2 = 0.0\n"
)
SLIDING = (
    '[follower]\nkind = "translating"\noffset_mm = 0.0\n[cam]\nbase_radius_mm = 50.0\nroller_radius_mm = 10.0\n'
    "[loads]\nfollower_mass_kg = 4.0\ngravity_m_s2 = 0.0\n"
)
MOVES = '[motion]\nstart_{u} = 0.0\n' + "".join(
    f'[[motion.segments]]\nlaw = "{law}"\nspan_deg = 90.0\n{rise}'
    for law, rise in (("3-4-5", "rise_{u} = 30.0\n"), ("dwell", ""), ("3-4-5", "rise_{u} = -30.0\n"), ("dwell", ""))
)  # fmt: skip
# to V in 30°, so for 60°, and to rest in 30°: 30 V/2 + 60 V + 30 V/2 = 90 V
RAMPS = "".join(
    f'[[motion.segments]]\nlaw = "polynomial"\nspan_deg = {span}\nrise_deg = {rise}\n'
    f"start = {{ velocity = {v0}, acceleration = {a} }}\nend = {{ velocity = {v1}, acceleration = {a} }}\n"
    for span, rise, v0, v1, a in (
        (30.0, 7.5, 0.0, 0.5, 0.5 / 30.0), (60.0, 30.0, 0.5, 0.5, 0.0), (30.0, 7.5, 0.5, 0.0, -0.5 / 30.0),
        (60.0, -15.0, 0.0, -0.5, -0.5 / 60.0), (30.0, -15.0, -0.5, -0.5, 0.0), (60.0, -15.0, -0.5, 0.0, 0.5 / 60.0),
    )
)  # fmt: skip
TRAPEZOID = "[motion]\nstart_deg = 0.0\n" + RAMPS + '[[motion.segments]]\nlaw = "dwell"\nspan_deg = 90.0\n'
MOTOR = (
    '[servo]\nkind = "rotary"\ngear_ratio = 5.0\nrotor_inertia_kg_m2 = 0.002\ninertia_kg_m2 = 0.3\nregenerates = true\n'
)


def study(motion, mechanism, servo, unit="deg"):
    return Study(loads(HEAD + motion.replace("{u}", unit) + mechanism + SHAFT + servo))


def summary_of(each):
    from core.output.summary import servo

    return servo(each)


def test_3_4_5_on_pure_inertia():
    """⟨a²⟩ = 120/7 h²/T⁴ while it moves, half of the turn; v_max = 15/8 h/T; a_max = 10/√3 h/T²."""
    found = summary_of(study(MOVES, SWINGING, MOTOR))
    j, i, h, t = 0.8, 5.0, math.radians(30.0), 0.25
    torque = 0.002 * i + j / i
    assert found["rms_nm"] == pytest.approx(torque * math.sqrt(120.0 / 7.0 / 2.0) * h / t**2, rel=1e-12)
    assert found["peak_nm"] == pytest.approx(torque * 10.0 / math.sqrt(3.0) * h / t**2, rel=1e-9)
    energy = 2.0 * 0.5 * (j + 0.002 * i**2) * (15.0 / 8.0 * h / t) ** 2
    assert found["energy_j"] == pytest.approx(energy, rel=1e-12)
    assert found["recovered_j"] == pytest.approx(energy, rel=1e-12)
    assert [part["energy_j"] for part in found["parts"]] == pytest.approx(
        [energy / 2.0, 0.0, energy / 2.0, 0.0], rel=1e-12
    )
    assert found["inertia_ratio"] == pytest.approx(j / i**2 / 0.002, rel=1e-12)
    assert summary_of(study(MOVES, SWINGING, MOTOR.replace("true", "false")))["recovered_j"] == 0.0


def test_a_trapezoid_of_velocity_on_pure_inertia():
    each = study(TRAPEZOID, SWINGING, MOTOR)
    j, i, v = 0.8, 5.0, math.radians(0.5) * 360.0
    up, down = v / (30.0 / 360.0), v / (60.0 / 360.0)
    squares = (2.0 * 30.0 * up**2 + 2.0 * 60.0 * down**2) / 360.0
    found = summary_of(each)
    assert found["rms_nm"] == pytest.approx((0.002 * i + j / i) * math.sqrt(squares), rel=1e-12)
    assert found["peak_nm"] == pytest.approx((0.002 * i + j / i) * up, rel=1e-12)
    assert found["energy_j"] == pytest.approx(2.0 * 0.5 * (j + 0.002 * i**2) * v**2, rel=1e-12)
    assert np.abs(servo_power(each)[each.angle_degrees > 271.0]).max() == 0.0


def test_over_a_turn_what_is_given_less_what_is_braked_is_what_rubs():
    """Friction torque F over the way 2h; through a gear of efficiency η a part more is lost both ways."""
    way = 2.0 * math.radians(30.0)
    turn = servo_turn(study(MOVES, SWINGING, MOTOR + "friction_nm = 2.5\n"))
    assert turn.given - turn.braked == pytest.approx(2.5 * way, rel=1e-12)
    lossy = servo_turn(study(MOVES, SWINGING, MOTOR.replace("0.002", "0.0") + "efficiency = 0.8\n"))
    whole = servo_turn(study(MOVES, SWINGING, MOTOR.replace("0.002", "0.0")))
    assert lossy.given == pytest.approx(whole.given / 0.8, rel=1e-12)
    assert lossy.braked == pytest.approx(whole.braked * 0.8, rel=1e-12)


def test_a_slide_on_a_screw_and_by_a_linear_motor():
    """Of 4 + 2 kg over 30 mm: forces m a; the screw turns them into torque, F travel/2π, i turns faster."""
    mass, h, t = 6.0, 0.03, 0.25
    peak = mass * 10.0 / math.sqrt(3.0) * h / t**2
    linear = study(MOVES, SLIDING, '[servo]\nkind = "linear"\nmass_kg = 2.0\n', "mm")
    assert summary_of(linear)["peak_n"] == pytest.approx(peak, rel=1e-9)
    screw = '[servo]\nkind = "rotary"\nmass_kg = 2.0\ntravel_mm_per_turn = 10.0\ngear_ratio = 2.0\n'
    found = summary_of(study(MOVES, SLIDING, screw, "mm"))
    assert found["peak_nm"] == pytest.approx(peak * 0.01 / (2.0 * math.pi) / 2.0, rel=1e-9)
    assert found["energy_j"] == pytest.approx(mass * (15.0 / 8.0 * h / t) ** 2, rel=1e-12)
    assert found["inertia_ratio"] is None


def test_the_force_on_the_motion_is_that_which_the_cam_gives():
    """Without friction the cam's torque and the servo's have the same power at every angle; slider, swinging arm, linkage."""
    for name, servo in (
        ("card_picker", '[servo]\nkind = "linear"\n'),
        ("rocker_cam", '[servo]\nkind = "rotary"\n'),
        ("four_bar_coupler_cam", None),
    ):
        text = (resources() / "examples" / f"{name}.toml").read_text("utf-8")
        unit = loads(text).drive.motion.unit
        each = Study(loads(text + (servo or f'[servo]\nkind = "{"linear" if unit == "mm" else "rotary"}"\n')))
        power = each.dynamics.torque * each.omega
        assert np.abs(servo_power(each) - power).max() <= 1e-12 * np.abs(power).max()


def test_the_best_gear_ratio_is_that_of_equal_inertias(tmp_path, capsys):
    design = tmp_path / "servo.toml"
    design.write_text(HEAD + MOVES.replace("{u}", "deg") + SWINGING + SHAFT + MOTOR, "utf-8")
    made = tmp_path / "best.toml"
    assert main(["find", str(design), "gear-ratio", "--json", "--into", str(made)]) in (0, 1)
    found = json.loads(capsys.readouterr().out)
    assert found["answer"]["servo.gear_ratio"] == pytest.approx(math.sqrt(0.8 / 0.002), rel=1e-9)
    rms = {
        ratio: servo_turn(study(MOVES, SWINGING, MOTOR.replace("5.0", str(ratio)))).rms for ratio in (19.9, 20.0, 20.1)
    }
    assert rms[20.0] == pytest.approx(found["reached"]["servo.rms_nm"], rel=1e-12)
    assert rms[20.0] < min(rms[19.9], rms[20.1])
    assert "gear_ratio = 20.0" in made.read_text("utf-8")
    loaded = MOTOR + "friction_nm = 20.0\nrated_rpm = 500.0\n"
    design.write_text(HEAD + MOVES.replace("{u}", "deg") + SWINGING + SHAFT + loaded, "utf-8")
    assert main(["find", str(design), "gear-ratio", "--json"]) in (0, 1, 2)
    found = json.loads(capsys.readouterr().out)
    fastest = 15.0 / 8.0 * math.radians(30.0) / 0.25 * 30.0 / math.pi
    assert found["answer"]["servo.gear_ratio"] == pytest.approx(500.0 / fastest, rel=1e-9)


def test_what_an_axis_without_a_shaft_or_a_motor_has_none_of_is_not_sought(tmp_path, capsys):
    axis = tmp_path / "axis.toml"
    axis.write_text(HEAD + MOVES.replace("{u}", "deg") + SHAFT + "[loads]\ninertia_kg_m2 = 0.5\n", "utf-8")
    for what, text in (
        ("flywheel", "no shaft drives this design"),
        ("gear-ratio", "this design has no motor with a gear"),
    ):
        assert main(["find", str(axis), what]) == 2
        assert capsys.readouterr().err.startswith(f"find {what}: {text}")


def test_the_cams_shaft_stands_beside_the_servo():
    """Its figures are those of the camshaft's load; of the motor behind the flywheel over time, by many samples."""
    text = (resources() / "examples" / "rocker_cam.toml").read_text("utf-8")
    each = Study(loads(text + '[servo]\nkind = "rotary"\n'))
    found, shaft = summary_of(each), each.camshaft
    assert found["cam"]["rms_nm"] == pytest.approx(shaft.rms_torque, rel=1e-9)
    assert found["cam"]["peak_nm"] == pytest.approx(abs(shaft.peak_torque.value), rel=1e-9)
    assert found["cam"]["energy_j"] - found["cam"]["recovered_j"] == pytest.approx(
        shaft.mean_torque * 2.0 * math.pi, abs=1e-9
    )
    assert found["cam"]["energy_j"] == pytest.approx(found["energy_j"], rel=1e-9), "the same work on the follower"
    fine = each.at_theta(np.linspace(0.0, 2.0 * math.pi, 36000, endpoint=False))
    torque, rate = each.flywheel.motor_torque(fine.angles), each.flywheel.speed(fine.angles)
    levelled = found["cam_with_flywheel"]
    assert levelled["rms_nm"] == pytest.approx(math.sqrt((torque**2 / rate).sum() / (1.0 / rate).sum()), rel=1e-6)
    assert levelled["energy_j"] == pytest.approx(np.maximum(torque, 0.0).mean() * 2.0 * math.pi, rel=1e-6)
    assert levelled["peak_power_w"] == pytest.approx(np.abs(torque * rate).max(), rel=1e-6)


@pytest.mark.parametrize(
    ("limit", "code"),
    [
        ("peak_torque_nm = 8.0", "servo-peak"),
        ("rated_torque_nm = 4.1", "servo-rms"),
        ("rated_rpm = 187.0", "servo-speed"),
    ],
)
def test_what_the_motor_cannot_give_is_a_finding(limit, code):
    """The motor gives 8.22 N·m at most, 4.17 as rms, at up to 187.5 rpm."""
    passed = [f for f in findings_of(study(MOVES, SWINGING, MOTOR + limit + "\n")) if f.code.startswith("servo")]
    assert [f.code for f in passed] == [code]
    assert limit.split()[-1].removesuffix(".0") in passed[0].message
    number = float(limit.split()[-1])
    kept = limit.replace(limit.split()[-1], str(number * 1.03))
    assert not [f for f in findings_of(study(MOVES, SWINGING, MOTOR + kept + "\n")) if f.code.startswith("servo")]


def test_its_table_and_its_ranks(tmp_path, capsys):
    design, out = tmp_path / "servo.toml", tmp_path / "out"
    design.write_text(HEAD + MOVES.replace("{u}", "deg") + SWINGING + SHAFT + MOTOR, "utf-8")
    assert main(["export", str(design), "--out", str(out), "--samples", "36"]) in (0, 1)
    table = np.genfromtxt(out / "servo.csv", delimiter=",", names=True)
    assert table.dtype.names == ("cam_angle_deg", "motor_torque_nm", "motor_speed_rpm", "motor_power_w")
    power = table["motor_torque_nm"] * table["motor_speed_rpm"] * math.pi / 30.0
    assert np.abs(table["motor_power_w"] - power).max() <= 1e-12 * np.abs(power).max()
    assert json.loads((out / "summary.json").read_text("utf-8"))["servo"]["inertia_ratio"] == pytest.approx(16.0)
    capsys.readouterr()
    assert main(["laws", str(design), "--by", "motor_rms", "--json"]) in (0, 1)
    rows = [row for row in json.loads(capsys.readouterr().out) if row.get("motor_rms_nm") is not None]
    values = [row["motor_rms_nm"] for row in rows]
    assert values == sorted(values)
    assert {"peak_power_w", "energy_j"} <= set(rows[0])


@pytest.mark.stress
def test_blends_are_ranked_by_what_they_ask_of_the_servo(tmp_path, capsys):
    """Up and down by 30° in 90° each: of the law 3-4-5 rms and energy by closed form, peak power at many places."""
    design = tmp_path / "servo.toml"
    motor = MOTOR.replace("true", "false")
    design.write_text(HEAD + MOVES.replace("{u}", "deg") + SWINGING + SHAFT + motor, "utf-8")
    words = [
        "blend",
        "--type",
        "DRRD",
        "--unit",
        "deg",
        "--stroke",
        "30",
        "--start",
        "90",
        "--end",
        "270",
        "--best",
        "acceleration",
    ]
    u, h, t, inertia = np.linspace(0.0, 1.0, 100001), math.radians(30.0), 0.25, 0.8 + 0.002 * 25.0
    v, a = (30.0 * u**2 - 60.0 * u**3 + 30.0 * u**4) * h / t, (60.0 * u - 180.0 * u**2 + 120.0 * u**3) * h / t**2
    known = {
        "motor_rms_nm": inertia / 5.0 * math.sqrt(120.0 / 7.0 / 2.0) * h / t**2,
        "peak_power_w": inertia * (v * a).max(),
        "energy_j": inertia * (15.0 / 8.0 * h / t) ** 2,
    }
    orders = {}
    for by, column in zip(("motor_rms", "peak_power", "energy"), known, strict=True):
        assert main([*words, "--rank", str(design), "--by", by, "--json"]) == 0
        rows = json.loads(capsys.readouterr().out)["ranking"]
        values = [row[column] for row in rows if row[column] is not None]
        assert values == sorted(values)
        assert len(values) > 10
        (law,) = [row for row in rows if row["blend"] == "3-4-5"]
        assert law[column] == pytest.approx(known[column], rel=1e-8)
        orders[by] = [row["blend"] for row in rows]
    assert orders["motor_rms"] != orders["peak_power"] != orders["energy"]


@pytest.mark.parametrize(
    ("mechanism", "unit", "servo", "says"),
    [
        (
            SWINGING,
            "deg",
            'kind = "linear"',
            "servo.kind = 'linear': a linear motor makes no motion in degrees; allowed: rotary",
        ),
        (
            SLIDING,
            "mm",
            'kind = "rotary"',
            "servo.travel_mm_per_turn: a rotary motor needs the travel of the slide per turn; allowed: > 0 mm",
        ),
        (
            SWINGING,
            "deg",
            'kind = "rotary"\nmass_kg = 2.0',
            "servo.mass_kg = 2.0: the part that this motor moves has none",
        ),
        (SWINGING, "deg", 'kind = "rotary"\nefficiency = 1.5', "servo.efficiency = 1.5: outside its range"),
        (SWINGING, "deg", 'kind = "rotary"\nrotor = 1.5', "servo.rotor"),
        (SLIDING, "mm", 'kind = "linear"\ngear_ratio = 2.0', "servo.gear_ratio = 2.0: a linear motor has none"),
    ],
)
def test_what_does_not_fit_is_a_fault_of_its_field(mechanism, unit, servo, says):
    with pytest.raises(DesignError) as raised:
        study(MOVES, mechanism, f"[servo]\n{servo}\n", unit)
    assert says in str(raised.value)


def test_a_design_with_a_servo_is_written_as_it_was_read():
    from core.project import dumps

    design = loads(HEAD + MOVES.replace("{u}", "deg") + SWINGING + SHAFT + MOTOR + "peak_torque_nm = 8.0\n")
    assert loads(dumps(design)) == design
    assert "[servo]" in dumps(design)
