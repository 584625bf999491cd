"""Make > Blend a sequence: any curves in a row, answered while they are typed, by mouse and keys."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit
from window_user import Open, User, settle, wait_for

from core.blend import Request, best, blend
from core.design import require_motion
from kindyna_gui.blend.sequence_dialog import SequenceDialog
from kindyna_gui.blend.settings import LiveBox
from kindyna_gui.places import example


@pytest.fixture
def user(same_window: Open) -> User:
    return same_window(example("tappet_flat"))


@pytest.fixture
def dialog(user: User) -> SequenceDialog:
    user.choose("Make", "Blend a sequence...")
    found = QApplication.activeModalWidget()
    assert isinstance(found, SequenceDialog)
    return found


def over(dialog: SequenceDialog, line: QLineEdit | LiveBox, text: str) -> None:
    """Type over what stands there."""
    line.setFocus()
    line.selectAll()
    QTest.keyClicks(line, text)
    QApplication.processEvents()
    wait_for(lambda: not dialog.is_solving)


def give(dialog: SequenceDialog, **settings: str) -> None:
    """Tick and type these settings."""
    for name, text in settings.items():
        row = dialog.rows[name]
        if not row.is_used:
            QTest.mouseClick(row.check, Qt.MouseButton.LeftButton, pos=QPoint(8, row.check.height() // 2))
        over(dialog, row.box, text)


def test_units_are_those_that_the_window_shows_elsewhere(user: User, dialog: SequenceDialog) -> None:
    """Written so that they are known, and follow the preferences."""
    over(dialog, dialog.curves, "c1-c2-c3-c4")
    assert [dialog.rows[name].unit.text() for name in ("h1", "span1", "v1", "a1", "end1")] == [
        "mm", "°", "mm/°", "mm/°²", "°",
    ]  # fmt: skip
    dialog.reject()


@pytest.mark.stress
def test_curves_that_are_typed_and_set_become_the_motion(user: User, dialog: SequenceDialog) -> None:
    over(dialog, dialog.curves, "c1-h2")
    offered = [dialog.add.itemText(i) for i in range(dialog.add.count())]
    assert "P2" in offered
    assert "C1" not in offered  # which does not begin where H2 ends
    dialog.add.setCurrentIndex(offered.index("P2"))
    dialog.add.activated.emit(offered.index("P2"))
    over(dialog, dialog.start, "30")
    over(dialog, dialog.end, "200")
    assert dialog.curves.text().upper() == "C1-H2-P2"
    assert dialog.count.text() == "C1-H2-P2 requires 3 settings: 3 more to set, or select what to optimise"
    assert not dialog.put_button.isEnabled()
    give(dialog, rise1="10", return1="10", span1="50")
    assert dialog.count.text() == "C1-H2-P2 requires 3 settings"
    given = {"rise1": 10.0, "return1": 10.0, "span1": 50.0}
    wanted = blend(Request("", 0.0, 30.0, 200.0, settings=given, sequence="C1-H2-P2"))
    assert dialog.blended is not None
    assert dialog.blended.segments == wanted.segments
    give(dialog, span2="60")
    assert "1 too many set" in dialog.count.text()
    assert dialog.blended is None
    QTest.mouseClick(dialog.rows["span2"].check, Qt.MouseButton.LeftButton, pos=QPoint(8, 8))
    wait_for(lambda: not dialog.is_solving and dialog.put_button.isEnabled())
    QTest.mouseClick(dialog.put_button, Qt.MouseButton.LeftButton)
    settle()
    made = [s for s in require_motion(user.design).segments if s.rise]
    assert [(s.curve, s.span_deg, s.rise) for s in made] == [(s.curve, s.span_deg, s.rise) for s in wanted.segments]


def test_what_is_left_open_is_made_least_and_curves_that_do_not_join_are_refused(dialog: SequenceDialog) -> None:
    over(dialog, dialog.curves, "C1-P2")
    assert dialog.message.text().startswith("C1-P2: ")
    assert not dialog.put_button.isEnabled()
    over(dialog, dialog.curves, "C1-H2-P2")
    over(dialog, dialog.start, "0")
    over(dialog, dialog.end, "360")
    give(dialog, rise1="10", return1="10")
    dialog.goal.setFocus()
    QTest.keyClick(dialog.goal, Qt.Key.Key_Down)
    dialog.goal.activated.emit(dialog.goal.currentIndex())
    wait_for(lambda: not dialog.is_solving)
    request = Request("", 10.0, 0.0, 360.0, return_stroke=10.0, sequence="C1-H2-P2")
    assert dialog.blended is not None
    assert dialog.blended.segments == best(request, "acceleration").segments
    dialog.reject()


def test_one_curve_has_the_place_of_the_motion_and_a_button_brings_it_back(dialog: SequenceDialog) -> None:
    assert (dialog.start.number, dialog.end.number) == (140.0, 360.0)
    over(dialog, dialog.curves, "C5")
    give(dialog, rise1="10")
    wait_for(lambda: not dialog.is_solving)
    assert dialog.put_button.isEnabled(), dialog.message.text()
    over(dialog, dialog.start, "0")
    over(dialog, dialog.end, "360")
    wait_for(lambda: not dialog.is_solving)
    assert not dialog.put_button.isEnabled()
    assert list(dialog.message.buttons) == ["Use 140 … 360°"]
    QTest.mouseClick(dialog.message.buttons["Use 140 … 360°"], Qt.MouseButton.LeftButton)
    wait_for(lambda: not dialog.is_solving and dialog.put_button.isEnabled())
    assert (dialog.start.number, dialog.end.number) == (140.0, 360.0)
    dialog.reject()


def test_curves_that_do_not_join_go_back_by_a_button_and_give_no_command(dialog: SequenceDialog) -> None:
    over(dialog, dialog.curves, "C1-H2-P2")
    assert dialog.copy.isEnabled()
    over(dialog, dialog.curves, "C1-P2")
    assert (dialog.curves.is_refused, dialog.copy.isEnabled()) == (True, False)
    QTest.mouseClick(dialog.message.buttons["Back to C1-H2-P2"], Qt.MouseButton.LeftButton)
    wait_for(lambda: not dialog.is_solving)
    assert (dialog.curves.text(), dialog.curves.is_refused, dialog.copy.isEnabled()) == ("C1-H2-P2", False, True)
    over(dialog, dialog.start, "-10")
    assert dialog.message.text() == "From: outside its range; allowed: 0 ... 360 °, not −10°"
    assert list(dialog.message.buttons) == ["Use 0°", "Back to 140°"]
    assert (dialog.start.is_refused, dialog.copy.isEnabled()) == (True, False)
    QTest.mouseClick(dialog.message.buttons["Use 0°"], Qt.MouseButton.LeftButton)
    wait_for(lambda: not dialog.is_solving)
    assert (dialog.start.number, dialog.start.is_refused, dialog.copy.isEnabled()) == (0.0, False, True)
    dialog.reject()
