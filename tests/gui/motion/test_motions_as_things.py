"""The motion as a thing in the window: shifted by menu and mouse, saved, taken from a file, a dwell put before a segment."""

from pathlib import Path

import pytest
from feeds import FEED
from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QInputDialog
from window_user import Open, User, answering, settle

from core.project import load
from kindyna_gui.dialogs import SEGMENT_FROM
from kindyna_gui.places import example


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window(example("transfer_lift"))


def spans(user: User) -> list[float]:
    return [s.span_deg for s in user.design.drive.motion.segments]


def test_the_motion_is_shifted_by_a_number_typed(user: User) -> None:
    def act(dialog: QInputDialog) -> None:
        dialog.setDoubleValue(12.5)
        dialog.accept()

    with answering(QInputDialog, act):
        user.choose("Make", "Shift the motion by...")
    assert spans(user) == [47.5, 41.5, 207.0, 41.5, 22.5]
    assert user.steps == ["Shift the motion by 12.5°"]


def test_the_motion_is_shifted_along_the_names_above_the_diagram(user: User) -> None:
    diagram = user.motion().diagram
    scale = diagram.scale_now()
    start = diagram.mapFromScene(QPointF(scale.x(180.0), scale.top - 6.0))
    end = diagram.mapFromScene(QPointF(scale.x(200.0), scale.top - 6.0))
    QTest.mousePress(diagram.viewport(), Qt.MouseButton.LeftButton, pos=start)
    for part in (0.4, 1.0):
        QTest.mouseMove(diagram.viewport(), start + (end - start) * part)
    QTest.mouseRelease(diagram.viewport(), Qt.MouseButton.LeftButton, pos=end)
    settle()
    assert spans(user)[0] == pytest.approx(55.0, abs=1.0)
    assert sum(spans(user)) == pytest.approx(360.0, abs=1e-9)
    assert len(user.steps) == 1
    user.choose("Edit", f"Undo {user.steps[0]}")
    assert spans(user) == [35.0, 41.5, 207.0, 41.5, 35.0]


def test_the_motion_is_saved_by_itself_and_taken_from_a_file(user: User, tmp_path: Path) -> None:
    file = tmp_path / "m.toml"
    user.picks("design_to_save", file)
    user.choose("Make", "Save motion...")
    assert load(file).drive.motion == user.design.drive.motion
    user.picks("design_to_open", file)
    user.enter_cell(1, 4, "-140")
    user.choose("Make", "Motion from a design or file...")
    assert user.design.drive.motion == load(file).drive.motion
    file.write_text(FEED, encoding="utf-8")
    before = user.design
    user.choose("Make", "Motion from a design or file...")
    assert user.design == before  # a cam cannot go on; the status line says so
    assert "a disk cam repeats its motion" in user.window.statusBar().currentMessage()


def test_the_motion_of_one_drive_of_several_is_taken(user: User) -> None:
    user.picks("design_to_open", example("transfer_unit"))

    def act(dialog: QInputDialog) -> None:
        dialog.setTextValue("Clamp")
        dialog.accept()

    with answering(QInputDialog, act):
        user.choose("Make", "Motion from a design or file...")
    assert spans(user) == [38.0, 169.0, 38.0, 115.0]


def test_a_dwell_is_put_before_the_chosen_segment(user: User) -> None:
    user.motion().choose(1)
    user.choose("Make", "Insert before")
    assert spans(user) == [35.0, 20.75, 20.75, 207.0, 41.5, 35.0]


def test_a_copied_table_becomes_the_chosen_segment(user: User) -> None:
    QApplication.clipboard().setText("0\t0\n10\t2\n20\t5\n30\t9\n40\t10\n")
    user.motion().choose(3)

    def act(dialog: QInputDialog) -> None:
        dialog.setTextValue(SEGMENT_FROM[2])
        dialog.accept()

    with answering(QInputDialog, act):
        user.choose("Make", "Segment from clipboard")
    segment = user.session.typed.drive.motion.segments[3]
    assert (segment.curve.law, segment.span_deg, segment.rise, len(segment.curve.points)) == ("table", 40.0, 10.0, 5)
    assert user.steps == ["Segment 4 from clipboard"]
