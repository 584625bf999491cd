"""Compo > Find a linkage: poses pressed and turned, a path drawn, numbers typed, cards, taken over as one step."""

import cmath
from math import cos, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton, QWidget
from window_user import Open, User, settle, wait_for

from core.mechanism.driver_ranges import driver_ranges_of
from core.mechanism.solving import unit_speed_kinematics
from core.synthesis import Task, load_task
from kindyna_gui.synthesis.find_linkage_view import FindLinkageView
from kindyna_gui.synthesis.sheet_painting import ARM
from kindyna_gui.synthesis.task_form import FIRST_POSES

EXAMPLE = Path(__file__).parents[3] / "resources" / "examples" / "four_bar.toml"
LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window(EXAMPLE)


def opened(user: User) -> FindLinkageView:
    user.choose("Compo", "Find a linkage")
    view = user.window.view("find_linkage")
    assert isinstance(view, FindLinkageView)
    view.show_task(Task(kind="poses", poses=FIRST_POSES))  # the window may be that of the test before
    return view


def answered(view: FindLinkageView) -> None:
    """Wait until the present task has its cards."""
    wait_for(view.strip.put_button.isEnabled)


def button(view: FindLinkageView, text: str) -> QPushButton:
    return next(b for b in view.findChildren(QPushButton) if b.text() == text and b.isVisible())


def viewport(view: FindLinkageView) -> QWidget:
    """The drawing, on which the sheet is."""
    assert view.sheet.canvas is not None
    return view.sheet.canvas.viewport()


def press_key(view: FindLinkageView, key: Qt.Key) -> None:
    """A key on the drawing."""
    assert view.sheet.canvas is not None
    QTest.keyClick(view.sheet.canvas, key)


def drag(view: FindLinkageView, *points: QPoint) -> None:
    QTest.mousePress(viewport(view), LEFT, pos=points[0])
    for point in points[1:]:
        QTest.mouseMove(viewport(view), point)
    QTest.mouseRelease(viewport(view), LEFT, pos=points[-1])


def pixel(view: FindLinkageView, z: complex) -> QPoint:
    return view.sheet.pixel(z).toPoint()


def test_three_poses_pressed_and_turned_become_a_running_four_bar(user: User) -> None:
    view = opened(user)
    answered(view)
    while view.sheet.task.poses:  # away with those of the beginning
        QTest.mouseClick(viewport(view), LEFT, pos=pixel(view, view.sheet.task.poses[0].z))
        press_key(view, Qt.Key.Key_Delete)
    assert not view.form.poses
    typed = ((0.0, 0.0, 0.0), (60.0, 20.0, 30.0), (110.0, 0.0, 60.0))
    for x, y, angle in typed:
        at = pixel(view, complex(x, y))
        arm = cmath.rect(60.0, radians(angle))
        drag(view, at, at + QPoint(round(arm.real), -round(arm.imag)))
    drawn = [(pose.x_mm, pose.y_mm, pose.angle_deg) for pose in view.sheet.task.poses]
    assert np.abs(np.array(drawn) - typed).max() <= 2.0
    assert [[box.number for box in row] for row in view.form.poses] == [list(row) for row in drawn]
    answered(view)
    first = view.strip.answer
    assert first is not None
    assert first.error_mm < 1e-9
    before = user.steps
    QTest.mouseClick(view.strip.put_button, LEFT)
    settle()
    assert len(user.steps) == len(before) + 1
    linkage = user.design.drive.linkage
    assert linkage.links == first.candidate.linkage.links
    assert linkage.drawn == first.candidate.linkage.drawn
    ranges = driver_ranges_of(linkage)
    body = unit_speed_kinematics(linkage, first.candidate.positions, driver_ranges_of(linkage)).bodies["link3"]
    assert ranges.ranges
    assert np.abs(1e3 * body.fixed_point(0j)[0] - [complex(x, y) for x, y, _ in drawn]).max() < 1e-6
    user.choose("Edit", "Undo Take over a linkage")
    assert user.design.drive.linkage != linkage


def test_from_any_task_it_opens_in_compo_where_the_drawing_is_large(user: User) -> None:
    for task in ("make", "dyna"):
        user.window.show_task(task)
        view = opened(user)
        settle()
        assert user.window.layouts.current == "compo"
        assert viewport(view).height() > 300
        user.window.close_view("find_linkage")


def test_a_search_that_another_task_of_the_window_stops_is_made_up_for(user: User) -> None:
    view = opened(user)
    answered(view)
    before = view.strip.answer
    second = pixel(view, view.sheet.task.poses[1].z)
    drag(view, second, second + QPoint(30, -20), second + QPoint(60, -40))
    user.window.show_task("dyna")
    settle()
    assert not view.busy
    user.window.show_task("compo")
    answered(view)
    assert view.strip.proposals is not None
    assert view.strip.proposals.task == view.task
    assert view.strip.answer is not before


def test_a_frame_is_moved_by_its_origin_and_turned_by_its_arm(user: User) -> None:
    view = opened(user)
    answered(view)
    second = view.sheet.task.poses[1]
    start = pixel(view, second.z)
    drag(view, start, start + QPoint(20, 0), start + QPoint(40, -30))
    moved = view.sheet.task.poses[1]
    assert moved.x_mm > second.x_mm
    assert moved.y_mm > second.y_mm
    assert moved.angle_deg == second.angle_deg
    arm = cmath.rect(ARM, radians(moved.angle_deg))
    end = pixel(view, moved.z) + QPoint(round(arm.real), -round(arm.imag))
    drag(view, end, end + QPoint(5, 5), pixel(view, moved.z) + QPoint(0, -60))
    assert view.sheet.task.poses[1].angle_deg == pytest.approx(90.0, abs=2.0)
    assert view.form.poses[1][2].number == view.sheet.task.poses[1].angle_deg


def test_a_fixed_pivot_is_put_with_shift_and_dragged(user: User) -> None:
    view = opened(user)
    answered(view)
    at = pixel(view, 20.0 - 40.0j)
    QTest.mouseClick(viewport(view), LEFT, Qt.KeyboardModifier.ShiftModifier, at)
    settle()
    z = view.sheet.task.pivots[0].z
    assert z is not None
    assert abs(z - (20.0 - 40.0j)) < 3.0
    assert [box.number for box in view.form.pivots[0].all_boxes] == [z.real, z.imag, None]
    answered(view)
    assert view.strip.answer is not None
    assert z in view.strip.answer.candidate.linkage.by_number[1].places.values()
    drag(view, at, at + QPoint(0, 20), at + QPoint(0, 40))
    moved = view.sheet.task.pivots[0].z
    assert moved is not None
    assert moved.imag < z.imag
    assert len(view.task.pivots) == 1


def test_a_path_drawn_in_one_stroke_is_followed_within_a_percent(user: User) -> None:
    view = opened(user)
    view.form.kind.setFocus()
    QTest.keyClick(view.form.kind, Qt.Key.Key_Down)
    settle()
    assert view.form.kind.currentText() == "Path of a point"
    assert not view.strip.put_button.isEnabled()
    middle = viewport(view).rect().center()
    turns = [2.0 * pi * i / 40.0 for i in range(40)]
    drag(view, *(middle + QPoint(round(150 * cos(a)), round(70 * sin(a) + 15 * cos(2 * a))) for a in turns))
    assert view.form.closed.isChecked()
    answered(view)
    best = view.strip.answer
    assert best is not None
    assert view.task.path is not None
    size = np.ptp([point.x_mm for point in view.task.path.points])
    assert best.error_mm < 0.01 * size
    assert not best.defects
    QTest.mouseClick(view.strip.put_button, LEFT)
    settle()
    assert "P" in user.design.drive.linkage.by_number[3].places


def test_a_wrong_number_is_named_and_hides_the_answers(user: User) -> None:
    view = opened(user)
    answered(view)
    box = view.form.limits[0]
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, "95")
    QTest.keyClick(box, Qt.Key.Key_Tab)
    wait_for(lambda: "90" in view.form.message.text())
    assert not view.strip.put_button.isEnabled()
    assert box.is_refused


def test_equal_poses_are_refused_in_a_sentence(user: User) -> None:
    view = opened(user)
    answered(view)
    for box, text in zip(view.form.poses[1], ("0", "0", "0"), strict=True):
        box.setFocus()
        box.selectAll()
        QTest.keyClicks(box, text)
        QTest.keyClick(box, Qt.Key.Key_Tab)
    wait_for(lambda: "equal" in view.form.message.text())
    assert not view.strip.put_button.isEnabled()


def test_a_task_is_saved_and_opened_again(user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    view = opened(user)
    answered(view)
    file = tmp_path / "task.toml"
    monkeypatch.setattr(
        "kindyna_gui.synthesis.find_linkage_view.QFileDialog.getSaveFileName", lambda *_: (str(file), "")
    )
    QTest.mouseClick(button(view, "&Save the task..."), LEFT)
    assert load_task(file).poses == view.task.poses
    QTest.mouseClick(button(view, "&Add a pose"), LEFT)
    assert len(view.form.poses) == 4
    monkeypatch.setattr(
        "kindyna_gui.synthesis.find_linkage_view.QFileDialog.getOpenFileName", lambda *_: (str(file), "")
    )
    QTest.mouseClick(button(view, "&Open a task..."), LEFT)
    assert len(view.form.poses) == 3


def test_linkages_with_defects_or_beyond_limits_are_shown_where_there_is_no_other(user: User) -> None:
    view = opened(user)
    answered(view)
    for _ in range(2):
        QTest.mouseClick(button(view, "&Add a pose"), LEFT)
    wait_for(lambda: view.strip.summary.text().startswith("Only with defects or beyond limits"))
    answered(view)
    assert view.strip.answer is not None
    assert view.strip.answer.defects
    assert f"{view.strip.answer.defects[0]} defect" in view.strip.board.list.currentItem().text()
