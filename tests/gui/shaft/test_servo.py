"""Dyna > Give it a servo: its fields come, its torque is a curve beside the cam's, and both ways can be undone."""

from window_user import Open

from core.output.channels import channels
from kindyna_gui.places import example


def test_a_servo_is_given_edited_and_taken_away(open_user: Open) -> None:
    user = open_user(example("rocker_cam"))
    before = user.design
    user.choose("Dyna", "Give it a servo")
    assert user.design.drive.servo is not None
    assert "servo.gear_ratio" in user.design.assumed
    user.enter("servo.gear_ratio", "4")
    assert user.design.drive.servo.gear_ratio == 4.0
    assert {"servo_torque", "servo_speed", "servo_power"} <= {row.name for row in channels(user.design)}
    user.choose("Dyna", "Take the servo away")
    assert user.design == before
    user.choose("Edit", "Undo Take the servo away")
    assert user.design.drive.servo.gear_ratio == 4.0


def test_a_crank_has_nothing_for_it_to_do(open_user: Open) -> None:
    user = open_user(example("four_bar"))
    user.choose("Dyna", "Give it a servo")
    assert user.design.drive.servo is None
    assert "there is no motion for a servo to make" in user.window.status.currentMessage()
