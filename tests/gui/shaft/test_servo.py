"""Dyna > Add a servo: its fields come, its torque is a curve beside the cam's, and both ways can be undone."""

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtWidgets import QPushButton
from window_user import Open

from core.output.channels import channels
from core.study import Study
from core.study.drive_forces import servo_speed, servo_torque, servo_turn
from kindyna_gui.places import example
from kindyna_gui.shaft import ServoView
from kindyna_gui.view import ReasonPage


@pytest.fixture
def open_user(same_window: Open) -> Open:
    return same_window


def test_a_servo_is_given_edited_and_taken_away(open_user: Open) -> None:
    user = open_user(example("rocker_cam"))
    before = user.design
    user.choose("Dyna", "Add a servo")
    assert user.design.drive.servo is not None
    assert "servo.gear_ratio" in user.design.assumed
    user.enter("servo.gear_ratio", "4")
    assert user.design.drive.servo.gear_ratio == 4.0
    assert {"servo_torque", "servo_speed", "servo_power"} <= {row.name for row in channels(user.design)}
    user.choose("Dyna", "Remove the servo")
    assert user.design == before
    user.choose("Edit", "Undo Remove the servo")
    assert user.design.drive.servo.gear_ratio == 4.0


def test_a_crank_has_nothing_for_it_to_do(open_user: Open) -> None:
    user = open_user(example("four_bar"))
    user.choose("Dyna", "Add a servo")
    assert user.design.drive.servo is None
    assert "a servo needs a motion" in user.window.status.currentMessage()


MOTOR = (
    '\n[servo]\nkind = "rotary"\ngear_ratio = 10.0\nrotor_inertia_kg_m2 = 0.0003\npeak_torque_nm = 6.0\nrated_torque_nm = 2.0\n'
    "rated_rpm = 1500.0\n"
)


def dynamics_of(study: Study) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Torque of the cam, of the motor behind its flywheel, of the servo."""
    return study.shaft_torque, study.flywheel.motor_torque(study.angles), servo_torque(study)


def test_cam_and_servo_stand_side_by_side_in_dyna(open_user: Open, tmp_path: Path) -> None:
    user = open_user(example("rocker_cam"))
    user.choose("Dyna", "Cam or servo")
    view = user.see("servo")
    assert isinstance(view, ServoView)
    page = view.findChild(ReasonPage)
    assert "No servo" in page.label.text()
    assert [each.text() for each in page.findChildren(QPushButton) if each.isVisible()] == ["Add a servo"]
    path = tmp_path / "rocker.toml"
    path.write_text(example("rocker_cam").read_text("utf-8") + MOTOR, "utf-8")
    user = open_user(path)
    view = user.see("servo")
    view.settle()
    study = user.session.study
    table = dynamics_of(study)
    assert len(view.torque.lines) == 3
    for (x, y), known in zip(view.torque.lines, table, strict=True):
        assert x[-1] == 360.0
        assert np.abs(y[:-1] - known).max() <= 1e-12 * np.abs(known).max()
    rows = {row.cells[0]: row.cells for row in view.table.rows.rows}
    for name, known in zip(("Cam, N·m", "Cam and flywheel, N·m", "Servo, N·m"), table, strict=True):
        assert float(rows[name][2]) == pytest.approx(np.abs(known).max(), rel=1e-3), "peak"
        assert float(rows[name][1]) == pytest.approx(np.sqrt((known**2).mean()), rel=3e-3), "rms"
    assert rows["Servo, N·m"][5:] == rows["Cam, N·m"][5:], "the same work on the follower"
    assert rows["Servo, N·m"][7] == "0", "with recovery all that is given comes back"
    assert rows["Servo, segment 2 (modified-sine)"][5] == rows["Cam, N·m"][5]
    assert rows["Inertia ratio"][1] == "0.1236"


def test_the_working_points_of_a_motor_stand_in_its_field(open_user: Open, tmp_path: Path) -> None:
    path = tmp_path / "rocker.toml"
    path.write_text(example("rocker_cam").read_text("utf-8") + MOTOR, "utf-8")
    user = open_user(path)
    view = user.see("servo")
    view.settle()
    study = user.session.study
    (speed, torque), level, peak, rated = view.field.lines
    assert np.abs(speed[:-1] - servo_speed(study) * 30.0 / np.pi).max() <= 1e-9
    assert np.abs(torque[:-1] - servo_torque(study)).max() <= 1e-12
    assert level[1][0] == pytest.approx(servo_turn(study).rms)
    assert (np.abs(peak[0]).max(), np.abs(peak[1]).max()) == (1500.0, 6.0)
    assert (np.abs(rated[0]).max(), np.abs(rated[1]).max()) == (1500.0, 2.0)
    assert (speed[0], torque[0]) == (speed[-1], torque[-1]), "a loop"


def test_a_linear_motor_has_a_plot_of_its_force(open_user: Open, tmp_path: Path) -> None:
    path = tmp_path / "picker.toml"
    path.write_text(example("card_picker").read_text("utf-8") + '\n[servo]\nkind = "linear"\n', "utf-8")
    user = open_user(path)
    view = user.see("servo")
    view.settle()
    (cam,), (force,) = view.torque.lines, view.force.lines
    study = user.session.study
    assert np.abs(cam[1][:-1] - study.shaft_torque).max() <= 1e-12
    assert np.abs(force[1][:-1] - servo_torque(study)).max() <= 1e-12 * np.abs(force[1]).max()


def test_the_pinned_variant_is_next_to_cam_and_servo(open_user: Open, tmp_path: Path) -> None:
    path = tmp_path / "rocker.toml"
    path.write_text(example("rocker_cam").read_text("utf-8") + MOTOR, "utf-8")
    user = open_user(path)
    before = user.session.study
    user.choose("Edit", "Pin this variant")
    user.enter("servo.gear_ratio", "5")
    view = user.see("servo")
    assert isinstance(view, ServoView)
    view.settle()
    pinned = [line for line in view.torque.shown if line.reference == "variant 1"]
    for line, known in zip(pinned, dynamics_of(before), strict=True):
        assert np.abs(line.y[:-1] - known).max() <= 1e-12 * np.abs(known).max()
    (points,) = (line for line in view.field.shown if line.reference)
    assert np.abs(points.y[:-1] - servo_torque(before)).max() <= 1e-12
    assert view.torque.legend.text.count("variant 1") == view.field.legend.text.count("variant 1") == 1
    user.choose("Edit", "Unpin")
    view = user.see("servo")
    assert "variant" not in view.torque.legend.text + view.field.legend.text
