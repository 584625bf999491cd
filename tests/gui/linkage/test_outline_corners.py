"""Corners of outlines are dragged in the drawing, at any angle, in the frame of their body; a drag is one undo step."""

from pathlib import Path

import pytest
from outlined import example, outline
from window_user import Open, User, settle

PLATE = outline("link 2", points=[[0.0, -5.0], [30.0, -5.0], [30.0, 5.0], [0.0, 5.0]])


def opened(open_design: Open, tmp_path: Path, text: str) -> User:
    path = tmp_path / "bars.toml"
    path.write_text(text, "utf-8")
    user = open_design(path)
    settle()
    return user


def corner(user: User, outline_number: int, number: int) -> tuple[float, float]:
    point = user.design.outlines[outline_number].points[number]
    return point.x_mm, point.y_mm


def test_a_corner_follows_the_mouse_in_the_frame_of_its_turned_link(same_window: Open, tmp_path: Path) -> None:
    """Crank at 90 degrees: its corner (30, 5) is at (-5, 30); dragged to (-12, 34) it is (34, 12)."""
    user = opened(same_window, tmp_path, example("four_bar") + PLATE)
    user.turn(90.0)
    user.drag(complex(-5.0, 30.0), complex(-12.0, 34.0))
    pixel = 1.5 / user.drawing().canvas.scale_now
    assert corner(user, 0, 2) == pytest.approx((34.0, 12.0), abs=pixel)
    assert corner(user, 0, 1) == (30.0, -5.0)
    assert user.steps == ["Move corner 3 of the outline of link 2"]
    user.session.stack.undo()
    assert corner(user, 0, 2) == (30.0, 5.0)


def test_a_corner_that_would_make_the_outline_cross_itself_stops_there(same_window: Open, tmp_path: Path) -> None:
    user = opened(same_window, tmp_path, example("four_bar") + PLATE)
    user.turn(90.0)
    user.drag(complex(-5.0, 30.0), complex(40.0, 10.0))
    x, y = corner(user, 0, 2)
    assert (x, y) != pytest.approx((10.0, -40.0), abs=2.0)  # where the sides would cross


def test_corners_of_a_hidden_layer_are_not_dragged(same_window: Open, tmp_path: Path) -> None:
    user = opened(same_window, tmp_path, example("four_bar") + PLATE)
    user.turn(90.0)
    user.drawing().show_layer("outlines", False)
    settle()
    user.drag(complex(-5.0, 30.0), complex(-12.0, 34.0))
    assert corner(user, 0, 2) == (30.0, 5.0)
    user.drawing().show_layer("outlines", True)


def test_a_corner_of_a_cam_turns_with_it(same_window: Open, tmp_path: Path) -> None:
    tab = outline("cam", points=[[500.0, -20.0], [560.0, -20.0], [560.0, 20.0], [500.0, 20.0]])
    user = opened(same_window, tmp_path, example("transfer_lift") + tab)
    user.turn(90.0)  # counter-clockwise: (560, 20) is at (-20, 560)
    user.drag(complex(-20.0, 560.0), complex(-60.0, 600.0))
    pixel = 1.5 / user.drawing().canvas.scale_now
    assert corner(user, 0, 2) == pytest.approx((600.0, 60.0), abs=pixel)
