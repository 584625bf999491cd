"""A user at the window: opens menus, types into fields, reads what is shown. For tests of the window."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from math import radians
from pathlib import Path
from typing import Any, TypeVar

import pytest
from PySide6.QtCore import QDeadlineTimer, QPoint, QPointF, QRect, Qt, QTimer, QTimerEvent
from PySide6.QtGui import QAction
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QAbstractItemView, QApplication, QMenu, QMessageBox, QWidget

from core.design import Design
from core.study import Study
from kindyna_gui import dialogs
from kindyna_gui.background import Worker
from kindyna_gui.dialogs import SaveAnswer
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import Field
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.forms.parameters_view import ParametersView
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.linkage.mechanism_view import MechanismView
from kindyna_gui.motion.segments_view import SegmentsView
from kindyna_gui.view import View
from kindyna_gui.window.main_window import MainWindow

PATIENCE_MS = 40_000
LONGEST_PAUSE_MS = 500  # a message stays for longer, and a file is looked for after longer
QUESTIONS = {
    name: getattr(dialogs, name) for name in ("ask_to_save", "ask_on_conflict", "ask_incomplete", "ask_to_recover")
}
"""Those that are buttons to be clicked, as the program asks them."""


def plain(text: str) -> str:
    """A menu's text without its keys of access, and without what stands at its right."""
    return text.partition("\t")[0].replace("&&", "\0").replace("&", "").replace("\0", "&")


def wait_for(condition: Callable[[], bool]) -> None:
    """Let events run, and other threads, until something is so. While nothing is computed no pause is waited out."""
    patience = QDeadlineTimer(PATIENCE_MS)
    while True:
        settle()
        if condition():
            return
        assert not patience.hasExpired(), "waited in vain"
        if any(isinstance(each, Worker) for each in threading.enumerate()) or not end_a_pause():
            time.sleep(0.002)


@contextmanager
def answering(kind: type[QWidget], act: Callable[[Any], None]) -> Iterator[None]:
    """Act on the dialog of this kind that is about to open; what goes wrong there is raised here, once it is closed."""
    raised: list[BaseException] = []
    seen: list[Any] = []

    def look() -> None:
        dialog = QApplication.activeModalWidget()
        if not isinstance(dialog, kind):
            QTimer.singleShot(5, look)
            return
        seen.append(dialog)
        try:
            act(dialog)
        except BaseException as error:
            raised.append(error)
            dialog.reject()

    QTimer.singleShot(0, look)
    yield
    assert seen, "no dialog opened"
    if raised:
        raise raised[0]


def end_a_pause() -> bool:
    """The pause of editing that would be over next, is; False where there is none."""
    timers = [each for top in QApplication.topLevelWidgets() for each in top.findChildren(QTimer)]
    pauses = [
        each for each in timers if each.isActive() and each.isSingleShot() and each.interval() <= LONGEST_PAUSE_MS
    ]
    if not pauses:
        return False
    over = min(pauses, key=QTimer.remainingTime)
    QApplication.sendEvent(over, QTimerEvent(over.timerId()))
    return True


def end_pauses() -> None:
    """All that would begin after a pause has begun."""
    while end_a_pause():
        settle()


def settle() -> None:
    """Let the events at hand run, and those that they start."""
    for _ in range(5):
        QApplication.processEvents()


Open = Callable[..., "User"]
"""Opens a window: the file, and the size."""


Shown = TypeVar("Shown", bound=QWidget)
Alone = Callable[..., Any]
"""Shows a view in a window of its own: the view, width and height; gives it back."""


def _not_foreseen(question: str, *_: Any) -> None:
    raise AssertionError(f"{question}: nobody has said what the user would answer")


def pixel(canvas: Canvas, at: complex) -> QPoint:
    """The pixel of a place of the drawing [mm]."""
    return canvas.viewportTransform().map(QPointF(at.real, at.imag)).toPoint()


class User:
    """Works with one window the way a user does."""

    def __init__(self, window: MainWindow, patch: pytest.MonkeyPatch) -> None:
        self.window = window
        self._patch = patch
        self.faults: list[tuple[str, list[str]]] = []
        patch.setattr(dialogs, "show_faults", lambda _, what, lines: self.faults.append((what, list(lines))))
        for question in (*QUESTIONS, "design_to_open", "design_to_save", "picture_to_save"):
            patch.setattr(dialogs, question, partial(_not_foreseen, question))

    @property
    def session(self) -> Session:
        return self.window.session

    @property
    def design(self) -> Design:
        return self.session.design

    @property
    def steps(self) -> list[str]:
        """The names of the undo stack's steps."""
        return [self.session.stack.text(i) for i in range(self.session.stack.count())]

    # -- menus --------------------------------------------------------------------------------------------

    def action(self, *way: str) -> QAction:
        """An entry of the menu bar, every menu on the way being opened."""
        place: QWidget = self.window.menuBar()
        for i, text in enumerate(way):
            found = next((a for a in place.actions() if plain(a.text()) == text), None)
            assert found is not None, f"{text}: not among {[plain(a.text()) for a in place.actions()]}"
            menu = found.menu()
            if i == len(way) - 1:
                return found
            assert isinstance(menu, QMenu)
            menu.aboutToShow.emit()
            place = menu
        raise AssertionError(way)

    def choose(self, *way: str) -> None:
        """Click an entry of the menu bar."""
        action = self.action(*way)
        assert action.isEnabled(), f"{way} cannot be chosen"
        action.trigger()
        settle()

    def entries(self, *way: str) -> list[str]:
        """What a menu offers."""
        menu = self.action(*way).menu()
        assert isinstance(menu, QMenu)
        menu.aboutToShow.emit()
        return [plain(a.text()) for a in menu.actions() if not a.isSeparator() and a.isVisible()]

    # -- keys and fields ----------------------------------------------------------------------------------

    def press(self, *keys: Qt.Key, modifier: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier) -> None:
        """Keys on whatever has the focus."""
        for key in keys:
            target = QApplication.focusWidget()
            assert target is not None, "nothing has the focus"
            QTest.keyClick(target, key, modifier)
        settle()

    def type(self, text: str) -> None:
        target = QApplication.focusWidget()
        assert target is not None, "nothing has the focus"
        QTest.keyClicks(target, text)

    def parameters(self) -> ParametersView:
        view = self.window.show_view("parameters")
        assert isinstance(view, ParametersView)
        view.pull()
        return view

    def motion(self) -> SegmentsView:
        view = self.window.show_view("motion")
        settle()  # a view called is laid out once it has said what room it needs
        assert isinstance(view, SegmentsView)
        view.pull()
        return view

    def field(self, path: str) -> Field:
        """The row of a path, brought before the reader; of the motion in its editor."""
        if path.startswith("motion"):
            self.motion()
        self.window.focus_field(path)
        settle()
        found = self.motion().fields.get(path) if path.startswith("motion") else self.parameters().field(path)
        assert found is not None, f"{path}: no such field"
        return found

    def number(self, path: str) -> NumberBox:
        editor = self.field(path).editor
        assert isinstance(editor, NumberBox)
        return editor

    def wait_for_laws(self) -> None:
        """Wait until the optimal laws of what is typed are known."""
        wait_for(lambda: not self.session.laws.busy)

    def enter(self, path: str, text: str) -> None:
        """Type a text into a field, and Enter."""
        box = self.number(path)
        box.selectAll()
        if not text:
            self.press(Qt.Key.Key_Delete)
        self.type(text)
        self.press(Qt.Key.Key_Return)

    # -- the table of segments ----------------------------------------------------------------------------

    def cell(self, row: int, column: int) -> str:
        model = self.motion().model
        return str(model.data(model.index(row, column)))

    def enter_cell(self, row: int, column: int, text: str) -> None:
        """Choose a cell, type over it, and Enter."""
        view = self.motion()
        view.choose(row, column)
        view.table.setFocus()
        self.press(Qt.Key.Key_Return)
        wait_for(lambda: view.table.state() == QAbstractItemView.State.EditingState)
        self.type(text)
        self.press(Qt.Key.Key_Return)
        wait_for(lambda: view.table.state() != QAbstractItemView.State.EditingState)

    # -- the drawing --------------------------------------------------------------------------------------

    def drawing(self) -> MechanismView:
        view = self.window.view("mechanism")
        assert isinstance(view, MechanismView)
        view.pull()
        return view

    def turn(self, degrees: float) -> Study:
        """The cam, or the driver, at another angle; the study there."""
        self.window.player.set_theta(radians(degrees))
        settle()
        return self.session.at(self.window.player.theta)

    def see(self, name: str) -> View:
        """A view, brought before the reader and up to date."""
        view = self.window.show_view(name)
        wait_for(lambda: view.up_to_date and view.on_screen())
        return view

    def drag_width(self, name: str, width: int) -> None:
        """Drag the edge between a dock at a side and the middle until the dock has this width."""
        window: QWidget = self.window
        dock = self.window.docks[name]
        at_right = self.window.dockWidgetArea(dock) == Qt.DockWidgetArea.RightDockWidgetArea
        box = dock.geometry()
        edge = QPoint(box.left() - 3 if at_right else box.right() + 3, box.center().y())
        end = edge + QPoint((box.width() - width) if at_right else (width - box.width()), 0)
        QTest.mousePress(window, Qt.MouseButton.LeftButton, pos=edge)
        for at in (QRect(edge, end).center(), end):
            QTest.mouseMove(window, at)
            settle()
        wait_for(lambda: abs(dock.width() - width) <= 1)
        QTest.mouseRelease(window, Qt.MouseButton.LeftButton, pos=end)
        settle()

    def drag(self, start: complex, end: complex) -> None:
        """Draw with the left button from one place of the drawing to another [mm]."""
        canvas = self.drawing().canvas
        one, other = pixel(canvas, start), pixel(canvas, end)
        QTest.mousePress(canvas.viewport(), Qt.MouseButton.LeftButton, pos=one)
        for part in (0.3, 0.7, 1.0):
            QTest.mouseMove(canvas.viewport(), one + (other - one) * part)
        QTest.mouseRelease(canvas.viewport(), Qt.MouseButton.LeftButton, pos=other)
        settle()

    # -- questions ----------------------------------------------------------------------------------------

    def answers(self, answer: SaveAnswer) -> list[str]:
        """What the user will say about unsaved changes; the names asked about are noted in the list."""
        asked: list[str] = []

        def ask(_: QWidget, name: str, *__: str) -> SaveAnswer:
            asked.append(name)
            return answer

        self._patch.setattr(dialogs, "ask_to_save", ask)
        return asked

    def clicks(self, *buttons: str, before: Callable[[QWidget], object] = lambda _: None) -> list[str]:
        """The buttons the user will click in the dialogs that come, one in each; what they say is noted.

        before   called with each dialog before its button is clicked
        """
        asked: list[str] = []
        left = list(buttons)
        for name, question in QUESTIONS.items():
            self._patch.setattr(dialogs, name, question)

        def look() -> None:
            box = QApplication.activeModalWidget()
            if box is not None and box.isVisible():
                asked.append(box.text() if isinstance(box, QMessageBox) else box.windowTitle())
                before(box)
                found = [b for b in box.findChildren(QAbstractButton) if plain(b.text()) == left[0] and b.isEnabled()]
                wanted = left.pop(0)
                if found:
                    QTest.mouseClick(found[0], Qt.MouseButton.LeftButton)
                else:
                    box.close()
                    raise AssertionError(f"{wanted}: no such button")
            if left:
                timer.start()

        timer = QTimer(self.window, singleShot=True, interval=5)
        timer.timeout.connect(look)
        timer.start()
        return asked

    def picks(self, dialog: str, path: Path | None) -> list[Any]:
        """What the user will pick in a dialog of ``kindyna_gui.dialogs``; what was suggested is noted."""
        suggested: list[Any] = []

        def pick(_: QWidget, suggestion: Path) -> Path | None:
            suggested.append(suggestion)
            return path

        self._patch.setattr(dialogs, dialog, pick)
        return suggested
