"""Parts of the window that are made anew: nothing of the former ones is left behind in Python, nor obeys any longer."""

import pytest
import shiboken6
from PySide6.QtCore import QCoreApplication, QEvent, QObject, Qt, Signal
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLayoutItem, QLineEdit, QPushButton, QVBoxLayout, QWidget
from window_user import Alone, Open, User, settle, wait_for

from kindyna_gui.places import example
from kindyna_gui.rebuilt import ContentArea


@pytest.fixture
def whole(open_user: Open) -> User:
    """Nothing has been done in it before."""
    return open_user(whole=True)


@pytest.fixture
def user(whole: User) -> User:
    return whole


def item_wrappers() -> list[tuple[QLayoutItem, QWidget]]:
    """Python's wrappers of items of layouts, each with its widget."""
    known = shiboken6.getAllValidWrappers()
    items = [each for each in known if isinstance(each, QLayoutItem) and not isinstance(each, QObject)]
    return [(item, widget) for item in items if (widget := item.widget()) is not None]


def go() -> None:
    """Let deleted widgets go."""
    settle()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    settle()


def left_behind(held: list[tuple[QLayoutItem, QWidget]]) -> list[str]:
    """Wrappers of items that Qt has deleted with their widget: the next object at the address is taken for one of them."""
    return [type(item).__name__ for item, widget in held if shiboken6.isValid(item) and not shiboken6.isValid(widget)]


@pytest.mark.stress
def test_examples_of_each_kind_in_turn_leave_no_item_of_a_layout_behind(user: User) -> None:
    for name in (
        "lecture_six_bar",
        "transfer_lift",
        "four_bar_coupler_cam",
        "kim_1990",
        "slider_crank",
        "transfer_lift",
    ):
        held = item_wrappers()
        user.window.documents.open_example(example(name))
        go()
        assert left_behind(held) == [], name


@pytest.mark.stress
def test_what_a_user_opens_and_takes_away_leaves_no_item_behind(user: User) -> None:
    graph = user.see("graph")
    kinds = [text for text in user.entries("File", "New by type") if not text.endswith("...")]
    assert kinds
    steps = (
        *(lambda row=row: user.motion().choose(row, 0) for row in range(4)),
        lambda: user.choose("Make", "Split segment"),
        user.session.stack.undo,
        lambda: graph.set_form("polar"),  # type: ignore[attr-defined]
        lambda: graph.remove_plot(0),  # type: ignore[attr-defined]
        *(lambda kind=kind: user.choose("File", "New by type", kind) for kind in kinds),
    )
    for step in steps:
        held = item_wrappers()
        step()
        go()
        assert left_behind(held) == []


class Editor(QObject):
    """Counts what it is told, and tells when its line loses the focus."""

    left = Signal()

    def __init__(self, source: QObject) -> None:
        super().__init__()
        self.paper, self.heard = QWidget(), 0
        self.setParent(self.paper)
        self.line = QLineEdit()
        QVBoxLayout(self.paper).addWidget(self.line)
        self.line.editingFinished.connect(self.left)
        source.objectNameChanged.connect(self.hear)

    def hear(self, *_: object) -> None:
        self.heard += 1


def test_a_content_that_is_replaced_is_silent_and_deaf_at_once(alone: Alone) -> None:
    """The focus leaves the editor that goes: that enters nothing any more."""
    source, told = QObject(), []
    place = alone(ContentArea(source), 200, 100)
    first, second = Editor(source), Editor(source)
    for editor in (first, second):
        editor.left.connect(lambda: told.append("left"))
    place.replace(first.paper)
    place.activateWindow()
    first.line.setFocus()
    wait_for(first.line.hasFocus)
    QTest.keyClicks(first.line, "12")
    place.replace(second.paper)
    assert place.content is second.paper
    assert not first.paper.isVisible()
    assert second.line.isVisible()
    source.setObjectName("another")
    assert (first.heard, second.heard) == (0, 1)
    settle()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    assert not shiboken6.isValid(first.line)
    assert told == []


def test_a_content_may_be_replaced_by_its_own_signal(alone: Alone) -> None:
    place = alone(ContentArea(), 200, 100)
    made: list[QPushButton] = []

    def renew() -> None:
        button = QPushButton("again")
        button.clicked.connect(renew)
        made.append(button)
        place.replace(button)

    renew()
    settle()
    for number in range(1, 6):
        QTest.mouseClick(made[-1], Qt.MouseButton.LeftButton)
        assert len(made) == number + 1
        go()
        assert [shiboken6.isValid(button) for button in made] == [False] * number + [True]
