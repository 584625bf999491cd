"""Compo > Find a linkage: poses pressed and turned, a path drawn, numbers typed, cards, taken over as one step."""

import cmath
from math import cos, pi, radians, sin
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton
from window_user import Open, User, settle, wait_for

from core.mechanism.driver_ranges import driver_ranges_of
from core.mechanism.solving import unit_speed_kinematics
from core.synthesis import load_task
from kindyna_gui.synthesis.dialog import FindLinkageDialog

EXAMPLE = Path(__file__).parents[3] / "resources" / "examples" / "four_bar.toml"
LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window(EXAMPLE)


def opened(user: User) -> FindLinkageDialog:
    user.choose("Compo", "Find a linkage...")
    dialog = QApplication.activeModalWidget()
    assert isinstance(dialog, FindLinkageDialog)
    return dialog


def answered(dialog: FindLinkageDialog) -> None:
    """Wait until the present task has its cards."""
    wait_for(dialog.put_button.isEnabled)


def button(dialog: FindLinkageDialog, text: str) -> QPushButton:
    return next(b for b in dialog.findChildren(QPushButton) if b.text() == text and b.isVisible())


def drag(dialog: FindLinkageDialog, *points: QPoint) -> None:
    QTest.mousePress(dialog.sheet, LEFT, pos=points[0])
    for point in points[1:]:
        QTest.mouseMove(dialog.sheet, point)
    QTest.mouseRelease(dialog.sheet, LEFT, pos=points[-1])


def pixel(dialog: FindLinkageDialog, z: complex) -> QPoint:
    return dialog.sheet.at(z).toPoint()


def test_three_poses_pressed_and_turned_become_a_running_four_bar(user: User) -> None:
    dialog = opened(user)
    answered(dialog)
    while dialog.sheet.poses:  # away with those of the beginning
        dialog.sheet.chosen = 0
        QTest.keyClick(dialog.sheet, Qt.Key.Key_Delete)
    assert not dialog.poses
    typed = ((0.0, 0.0, 0.0), (60.0, 20.0, 30.0), (110.0, 0.0, 60.0))
    for x, y, angle in typed:
        at = pixel(dialog, complex(x, y))
        arm = cmath.rect(60.0, radians(angle))
        drag(dialog, at, at + QPoint(round(arm.real), -round(arm.imag)))
    drawn = [(pose.x_mm, pose.y_mm, pose.angle_deg) for pose in dialog.sheet.poses]
    assert np.abs(np.array(drawn) - typed).max() <= 2.0
    assert [[box.number for box in row] for row in dialog.poses] == [list(row) for row in drawn]
    answered(dialog)
    first = dialog.answer
    assert first is not None
    assert first.error_mm < 1e-9
    before = user.steps
    QTest.mouseClick(dialog.put_button, LEFT)
    settle()
    assert len(user.steps) == len(before) + 1
    linkage = user.design.drive.linkage
    assert linkage == first.candidate.linkage
    ranges = driver_ranges_of(linkage)
    body = unit_speed_kinematics(linkage, first.candidate.positions, driver_ranges_of(linkage)).bodies["link3"]
    assert ranges.ranges
    assert np.abs(1e3 * body.fixed_point(0j)[0] - [complex(x, y) for x, y, _ in drawn]).max() < 1e-6
    user.choose("Edit", "Undo Take over a linkage")
    assert user.design.drive.linkage != linkage


def test_a_frame_is_moved_by_its_origin_and_turned_by_its_arm(user: User) -> None:
    dialog = opened(user)
    answered(dialog)
    second = dialog.sheet.poses[1]
    start = pixel(dialog, second.z)
    drag(dialog, start, start + QPoint(20, 0), start + QPoint(40, -30))
    moved = dialog.sheet.poses[1]
    assert moved.x_mm > second.x_mm
    assert moved.y_mm > second.y_mm
    assert moved.angle_deg == second.angle_deg
    end = dialog.sheet.arm_end(moved).toPoint()
    drag(dialog, end, end + QPoint(5, 5), pixel(dialog, moved.z) + QPoint(0, -60))
    assert dialog.sheet.poses[1].angle_deg == pytest.approx(90.0, abs=2.0)
    assert dialog.poses[1][2].number == dialog.sheet.poses[1].angle_deg
    dialog.reject()
    settle()


def test_a_fixed_pivot_is_put_with_shift_and_dragged(user: User) -> None:
    dialog = opened(user)
    answered(dialog)
    at = pixel(dialog, 20.0 - 40.0j)
    QTest.mouseClick(dialog.sheet, LEFT, Qt.KeyboardModifier.ShiftModifier, at)
    settle()
    z = dialog.sheet.pivots[0]
    assert z is not None
    assert abs(z - (20.0 - 40.0j)) < 3.0
    assert [box.number for box in dialog.pivots[0]] == [z.real, z.imag]
    answered(dialog)
    assert dialog.answer is not None
    assert z in dialog.answer.candidate.linkage.by_number[1].places.values()
    drag(dialog, at, at + QPoint(0, 20), at + QPoint(0, 40))
    moved = dialog.sheet.pivots[0]
    assert moved is not None
    assert moved.imag < z.imag
    assert len(dialog.task.pivots) == 1
    dialog.reject()
    settle()


def test_a_path_drawn_in_one_stroke_is_followed_within_a_percent(user: User) -> None:
    dialog = opened(user)
    dialog.kind.setFocus()
    QTest.keyClick(dialog.kind, Qt.Key.Key_Down)
    settle()
    assert dialog.kind.currentText() == "Path of a point"
    assert not dialog.put_button.isEnabled()
    middle = dialog.sheet.rect().center()
    turns = [2.0 * pi * i / 40.0 for i in range(40)]
    drag(dialog, *(middle + QPoint(round(150 * cos(a)), round(70 * sin(a) + 15 * cos(2 * a))) for a in turns))
    assert dialog.closed.isChecked()
    answered(dialog)
    best = dialog.answer
    assert best is not None
    size = np.ptp([point.x_mm for point in dialog.sheet.points])
    assert best.error_mm < 0.02 * size
    assert not best.defects
    QTest.mouseClick(dialog.put_button, LEFT)
    settle()
    assert "P" in user.design.drive.linkage.by_number[3].places


def test_a_wrong_number_is_named_and_hides_the_answers(user: User) -> None:
    dialog = opened(user)
    answered(dialog)
    box = dialog.limits[0]
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, "95")
    QTest.keyClick(box, Qt.Key.Key_Tab)
    wait_for(lambda: "90" in dialog.message.text())
    assert not dialog.put_button.isEnabled()
    assert box.is_refused
    dialog.reject()
    settle()


def test_equal_poses_are_refused_in_a_sentence(user: User) -> None:
    dialog = opened(user)
    answered(dialog)
    for box, text in zip(dialog.poses[1], ("0", "0", "0"), strict=True):
        box.setFocus()
        box.selectAll()
        QTest.keyClicks(box, text)
        QTest.keyClick(box, Qt.Key.Key_Tab)
    wait_for(lambda: "equal" in dialog.message.text())
    assert not dialog.put_button.isEnabled()
    dialog.reject()
    settle()


def test_a_task_is_saved_and_opened_again(user: User, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    dialog = opened(user)
    answered(dialog)
    file = tmp_path / "task.toml"
    monkeypatch.setattr("kindyna_gui.synthesis.dialog.QFileDialog.getSaveFileName", lambda *_: (str(file), ""))
    QTest.mouseClick(button(dialog, "&Save the task..."), LEFT)
    assert load_task(file).poses == dialog.task.poses
    QTest.mouseClick(button(dialog, "&Add a pose"), LEFT)
    assert len(dialog.poses) == 4
    monkeypatch.setattr("kindyna_gui.synthesis.dialog.QFileDialog.getOpenFileName", lambda *_: (str(file), ""))
    QTest.mouseClick(button(dialog, "&Open a task..."), LEFT)
    assert len(dialog.poses) == 3
    dialog.reject()
    settle()


def test_linkages_with_defects_or_beyond_limits_are_shown_where_there_is_no_other(user: User) -> None:
    dialog = opened(user)
    answered(dialog)
    for _ in range(2):
        QTest.mouseClick(button(dialog, "&Add a pose"), LEFT)
    wait_for(lambda: dialog.found.text().startswith("Only with defects or beyond limits"))
    answered(dialog)
    assert dialog.answer is not None
    assert dialog.answer.defects
    assert f"{dialog.answer.defects[0]} defect" in dialog.board.list.currentItem().text()
    dialog.reject()
    settle()
