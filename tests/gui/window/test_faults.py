"""kindyna_gui.window.faults: what fails in a slot is said where it happened, stands in the log, and leaves the design as it was."""

import sys

import pytest
from PySide6.QtCore import Qt, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDialog, QLabel, QPlainTextEdit, QPushButton, QVBoxLayout
from window_user import User, settle, wait_for

from core.study import Study
from kindyna_gui.fault_log import FaultLog, log_file, log_text
from kindyna_gui.graph.plots_view import PlotView

ROD = "follower.rod_mm"


@pytest.fixture
def user(nothing_unheard: None, monkeypatch: pytest.MonkeyPatch, open_user: object) -> User:
    """A user at a window in which faults are wanted."""
    monkeypatch.setattr(sys, "excepthook", lambda *_: None)  # else the fixture for all tests would hear of them
    return open_user()  # type: ignore[operator]


def said(user: User) -> str:
    return user.window.status.currentMessage()


def fail(*_: object) -> None:
    raise IndexError("no such row")


def test_a_slot_that_fails_is_said_in_words_and_logged_with_what_was_done_before(user: User) -> None:
    user.enter(ROD, "846")
    timer = QTimer(user.window, singleShot=True, interval=0)
    timer.timeout.connect(fail)
    timer.start()
    wait_for(lambda: "failed" in said(user))
    assert said(user) == "The window failed (IndexError: no such row). The design is as it was before. See Help > Log."
    user.choose("Help", "Log")
    shown = user.window.show_view("log").findChild(QPlainTextEdit)
    text = shown.toPlainText()
    assert 'raise IndexError("no such row")' in text, "the traceback"
    assert "rod L2 to 846 mm" in text, "the last step"
    assert log_file().is_file()
    assert text == log_text()


def test_an_edit_whose_slot_fails_half_way_is_taken_back_and_can_be_made_again(user: User) -> None:
    before = user.design
    user.session.design_changed.connect(fail)
    user.enter(ROD, "846")
    wait_for(lambda: "failed" in said(user))
    assert user.design == before
    assert not user.session.modified
    assert said(user).startswith("Change rod L2 to 846 mm failed (IndexError: no such row")
    user.session.design_changed.disconnect(fail)
    user.choose("Edit", "Redo Change rod L2 to 846 mm")
    assert user.design.drive.mechanism.rod_mm == 846.0


def test_of_a_gesture_only_the_part_that_failed_is_taken_back(user: User) -> None:
    assert user.session.edit(ROD, 846.0, "Change rod")
    settle()
    good = user.design
    user.session.design_changed.connect(fail)
    assert user.session.edit(ROD, 847.0, "Change rod")
    wait_for(lambda: "failed" in said(user))
    user.session.design_changed.disconnect(fail)
    assert user.design == good


def test_an_undo_that_fails_is_taken_back_too(user: User) -> None:
    user.enter(ROD, "846")
    changed = user.design
    user.session.design_changed.connect(fail)
    user.choose("Edit", "Undo Change rod L2 to 846 mm")
    wait_for(lambda: "failed" in said(user))
    user.session.design_changed.disconnect(fail)
    assert user.design == changed
    assert said(user).startswith("Undo Change rod L2 to 846 mm failed")


def test_a_view_that_fails_says_so_in_its_place_and_shows_again_when_asked(
    user: User, monkeypatch: pytest.MonkeyPatch
) -> None:
    view = user.see("contact_force")
    before = user.design
    right = PlotView.refresh

    def wrong(self: PlotView, study: Study) -> None:
        if self is view:
            fail()
        right(self, study)

    monkeypatch.setattr(PlotView, "refresh", wrong)
    user.enter(ROD, "846")
    wait_for(lambda: "failed" in said(user))
    assert said(user).startswith("Change rod L2 to 846 mm failed in Contact force (IndexError: no such row")
    assert user.design == before
    assert any("This view has failed (IndexError: no such row)" in label.text() for label in view.findChildren(QLabel))
    user.choose("Edit", "Redo Change rod L2 to 846 mm")
    assert user.design.drive.mechanism.rod_mm == 846.0, "a view that rests keeps no one from working"
    monkeypatch.setattr(PlotView, "refresh", right)
    again = next(b for b in view.findChildren(QPushButton) if b.text() == "Try again")
    QTest.mouseClick(again, Qt.MouseButton.LeftButton)
    assert view.up_to_date
    assert not view.in_trouble


def test_what_fails_in_a_dialog_is_said_there(user: User) -> None:
    dialog = QDialog(user.window)
    button = QPushButton("Work")
    QVBoxLayout(dialog).addWidget(button)
    button.clicked.connect(fail)
    dialog.open()
    assert QTest.qWaitForWindowExposed(dialog)
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    wait_for(lambda: any("IndexError: no such row" in label.text() for label in dialog.findChildren(QLabel)))
    dialog.close()
    dialog.deleteLater()


def test_the_log_is_bounded_and_a_fault_at_every_frame_does_not_fill_it() -> None:
    def raised(name: str) -> Exception:
        try:
            fail()
        except IndexError as error:
            return type(name, (IndexError,), {})("x" * 5000).with_traceback(error.__traceback__)
        raise AssertionError

    log = FaultLog()
    for _ in range(1000):
        log.write(raised("Same"), "")
    assert len(log_text().splitlines()) < 40
    for number in range(150):
        log.write(raised(f"Fault{number}"), "")
    sizes = [path.stat().st_size for path in log_file().parent.glob("kindyna.log*")]
    assert 1 < len(sizes) < 10
    assert sum(sizes) < 1_000_000, "and 1.5 million bytes were written"
    assert "Fault149" in log_text()


def test_the_log_is_copied_for_a_report_with_the_versions(user: User) -> None:
    view = user.window.show_view("log")
    settle()
    (button,) = [each for each in view.findChildren(QPushButton) if each.text() == "Copy for a report"]
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    text = QApplication.clipboard().text()
    assert text.startswith("Python 3.")
    for name in ("PySide6-Essentials 6.", "numpy 2.", "scipy 1.", "pyqtgraph 0.14"):
        assert name in text
    assert text.rstrip().endswith(log_text().rstrip() or "Nothing has failed.")
