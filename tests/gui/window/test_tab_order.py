"""The key Tab: through the forms and the motion in the order in which they are read, and never into a dead end."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QToolButton, QWidget
from window_user import User

from kindyna_gui.motion.editor import MotionEditor
from kindyna_gui.motion.segments_table import SegmentsTable
from kindyna_gui.motion.segments_view import SegmentBar


def at() -> QWidget:
    """What has the focus; that nothing has it is the dead end."""
    focused = QApplication.focusWidget()
    assert focused is not None, "the keys go nowhere"
    return focused


def walk(user: User, steps: int) -> list[QWidget]:
    """What has the focus after each Tab."""
    passed = []
    for _ in range(steps):
        user.press(Qt.Key.Key_Tab)
        passed.append(at())
    return passed


def test_tab_goes_down_the_form(user: User) -> None:
    view = user.parameters()
    view.name.setFocus()
    fields = [field.editor for field in view.forms["follower"].fields.values()]
    assert walk(user, 10) == [view.filter, *fields[:9]]


def test_ctrl_tab_turns_the_page_of_the_form(user: User) -> None:
    user.choose("Compo", "Follower")
    user.press(Qt.Key.Key_Tab, modifier=Qt.KeyboardModifier.ControlModifier)
    assert user.parameters().tabs.tabText(user.parameters().tabs.currentIndex()) == "Cam"


def test_tab_leads_from_the_stroke_over_diagram_and_table_to_the_buttons(user: User) -> None:
    user.motion()
    user.choose("Make", "Stroke")
    diagram, table, button = walk(user, 3)
    assert isinstance(diagram, MotionEditor)
    assert isinstance(table, SegmentsTable)
    assert isinstance(button, QToolButton)
    assert isinstance(button.parent(), SegmentBar)
