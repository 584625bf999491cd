"""Draws linkages in the window by mouse and keys alone. For tests of drawing."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from window_user import Open, User, pixel, settle

from core.design import Design
from kindyna_gui.dialogs import SaveAnswer

Key = Qt.Key
NONE, SHIFT, CTRL = (
    Qt.KeyboardModifier.NoModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.ControlModifier,
)


class Pen:
    """Draws in the window, and counts what it does: a click, a drag, a key, or values typed with Enter are an action each."""

    def __init__(self, user: User) -> None:
        self.user, self.actions = user, 0

    @property
    def canvas(self) -> Any:
        return self.user.drawing().canvas

    @property
    def design(self) -> Design:
        return self.user.session.typed

    def shape(self, number: int) -> Mapping[str, complex]:
        return dict(self.design.drive.linkage.by_number[number].places)

    @property
    def places(self) -> Mapping[str, complex]:
        return self.user.drawing().drawing.layout[1]

    def at(self, where: complex | str) -> QPoint:
        return pixel(self.canvas, self.places[where] if isinstance(where, str) else where)

    def hover(self, where: complex | str) -> None:
        QTest.mouseMove(self.canvas.viewport(), self.at(where))
        settle()

    def click(self, where: complex | str, modifier: Qt.KeyboardModifier = NONE) -> None:
        self.actions += 1
        self.hover(where)
        QTest.mouseClick(self.canvas.viewport(), Qt.MouseButton.LeftButton, modifier, self.at(where))
        settle()

    def drag(self, start: complex | str, end: complex | str) -> None:
        self.actions += 1
        one, other = self.at(start), self.at(end)
        self.hover(start)
        QTest.mousePress(self.canvas.viewport(), Qt.MouseButton.LeftButton, NONE, one)
        for part in (0.3, 0.7, 1.0):
            QTest.mouseMove(self.canvas.viewport(), one + (other - one) * part)
            settle()
        QTest.mouseRelease(self.canvas.viewport(), Qt.MouseButton.LeftButton, NONE, other)
        settle()

    def key(self, key: Qt.Key, modifier: Qt.KeyboardModifier = NONE) -> None:
        self.actions += 1
        QTest.keyClick(QApplication.focusWidget(), key, modifier)
        settle()

    def type(self, *values: str) -> None:
        """Type into the boxes that the first digit opens, Tab between, Enter at the end."""
        self.actions += 1
        for i, value in enumerate(values):
            if i:
                QTest.keyClick(QApplication.focusWidget(), Key.Key_Tab)
            QTest.keyClicks(QApplication.focusWidget(), value[:1])
            settle()
            QTest.keyClicks(QApplication.focusWidget(), value[1:])
        QTest.keyClick(QApplication.focusWidget(), Key.Key_Return)
        settle()

    def choose(self, *way: str) -> None:
        self.actions += 1
        self.user.choose(*way)

    def length(self, one: str, other: str) -> complex:
        """Where the number of a length stands in the drawing."""
        view = self.user.drawing()
        view.canvas.grab()
        boxes = view.drawing.sketch.lengths
        rect = next(rect for (_, a, b), rect in boxes.items() if {a, b} == {one, other})
        place = view.canvas.viewportTransform().inverted()[0].map(rect.center())
        return complex(place.x(), place.y())


def start(open_user: Open, whole: bool = False, size: tuple[int, int] = (1280, 1000)) -> Pen:
    user = open_user(whole=whole, size=size)
    user.answers(SaveAnswer.DISCARD)
    pen = Pen(user)
    pen.choose("File", "New by type", "Linkage by drawing")
    return pen


def four_bar(open_user: Open) -> Pen:
    pen = start(open_user)
    pen.key(Key.Key_G)
    pen.click(0j)
    pen.click(100 + 0j)
    pen.key(Key.Key_B)
    pen.drag("O1", 30j)
    pen.drag("A", 80 + 70j)
    pen.drag("B", "O2")
    pen.key(Key.Key_Escape)
    return pen
