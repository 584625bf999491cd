"""The strip of a lesson, above the drawing: what to do now, a mark where, and on to the next as soon as it is done."""

from __future__ import annotations

from weakref import WeakSet

from PySide6.QtCore import QPoint, QRect, Qt, QTimer
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSizePolicy, QToolBar, QWidget
from shiboken6 import isValid

from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.places import example
from kindyna_gui.rebuilt import take_away
from kindyna_gui.window.base import Window
from kindyna_gui.window.tutorial.conditions import met
from kindyna_gui.window.tutorial.deeds import DEEDS, CannotDo, place_of, play
from kindyna_gui.window.tutorial.lessons import Lesson, Step

LOOK_MS = 150  # how often it is looked whether a step is done
LINES = 3  # of text that have room
EDGE = 4  # pixels between a mark and what it marks


class Mark(QWidget):
    """A frame around a place of a window, dialog or menu, which it belongs to and goes with; the mouse goes through it."""

    def __init__(self, top: QWidget) -> None:
        super().__init__(top)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAccessibleName("Place of this step")

    def put(self, widget: QWidget, rect: QRect) -> None:
        """Around a part of a widget, in front of its window."""
        top = self.window()
        wanted = QRect(widget.mapTo(top, QPoint(0, 0)) + rect.topLeft(), rect.size())
        wanted = wanted.adjusted(-EDGE, -EDGE, EDGE, EDGE) & top.rect()
        if self.geometry() != wanted or not self.isVisible():
            self.setGeometry(wanted)
            self.show()
            self.raise_()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(SCREEN.assumed), 3.0))
        painter.drawRoundedRect(self.rect().adjusted(2, 2, -2, -2), 5.0, 5.0)


class TutorialStrip(QToolBar):
    """One lesson in one window."""

    def __init__(self, window: Window, lesson: Lesson) -> None:
        super().__init__("Tutorial", window)
        self.host, self.lesson, self.number = window, lesson, 0
        self.setObjectName("tutorial")
        self.setMovable(False)
        self.toggleViewAction().setVisible(False)
        self.count, self.text = QLabel(), QLabel(wordWrap=True, textFormat=Qt.TextFormat.RichText)
        self.text.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.where, self.done, self.next, self.leave = (
            QPushButton("Show where"), QPushButton("Do it for me"), QPushButton("Next"), QPushButton("Leave"),
        )  # fmt: skip
        self.where.setToolTip("Bring the place of this step into sight")
        self.done.setToolTip("Mouse and keys do this step by themselves")
        self.next.setToolTip("On, where this is so already")
        self.leave.setToolTip("End the lesson; the design stays")
        content = QWidget()
        content.setFixedHeight(LINES * self.fontMetrics().lineSpacing() + 10)
        row = QHBoxLayout(content)
        row.setContentsMargins(8, 4, 8, 4)
        row.addWidget(self.count)
        row.addWidget(self.text, 1)
        for button, act in (
            (self.where, self._show_where), (self.done, self._do), (self.next, self.go_on), (self.leave, self.end),
        ):  # fmt: skip
            button.clicked.connect(act)
            row.addWidget(button)
        self.addWidget(content)
        self._marks: WeakSet[Mark] = WeakSet()
        self._met_before = self._plays = self.ended = False
        self._look = QTimer(self, interval=LOOK_MS)
        self._look.timeout.connect(self.look)
        self._begin()
        self._look.start()

    @property
    def marks(self) -> list[Mark]:
        """Those whose windows are still there."""
        return [mark for mark in self._marks if isValid(mark)]

    @property
    def step(self) -> Step | None:
        """The one at hand; None once all are done."""
        return self.lesson.steps[self.number] if self.number < len(self.lesson.steps) else None

    def _begin(self) -> None:
        step, count = self.step, len(self.lesson.steps)
        self._met_before = step is not None and met(self.host, step.until)
        self.count.setText(f"<b>{self.lesson.title}</b><br>{min(self.number + 1, count)} of {count}")
        self.text.setText("That was all. The design is yours now." if step is None else step.text)
        for button in (self.where, self.done, self.next):
            button.setVisible(step is not None)
        self.leave.setText("Close" if step is None else "Leave")
        self.show_mark()

    def hold(self) -> None:
        """No longer go on by itself: another leads."""
        self._look.stop()

    def look(self) -> None:
        """Go on where the step is done; else mark its place."""
        step = self.step
        if step is None:
            return
        so = met(self.host, step.until)
        if so and not self._met_before:
            self.go_on()
            return
        self._met_before = so
        self.next.setEnabled(so)
        self.show_mark()

    def show_mark(self) -> None:
        """Where the step is done, as far as that is in sight."""
        place = place_of(self.host, self.step.do) if self.step is not None else None
        top = None if place is None else place[0].window()
        for mark in self.marks:
            if mark.parentWidget() is not top:
                mark.hide()
        if place is not None and top is not None:
            mark = next((each for each in self.marks if each.parentWidget() is top), None) or Mark(top)
            self._marks.add(mark)
            mark.put(*place)

    def go_on(self) -> None:
        """The next step."""
        self.number += 1
        self._begin()

    def _show_where(self) -> None:
        if self.step is not None:
            for key, what in self.step.do.items():
                DEEDS[key].show(self.host, what)
            self.show_mark()

    def _do(self) -> None:
        if self.step is None:
            return
        if self.isAncestorOf(self.host.focusWidget()):
            self.host.setFocus()  # the keys that are played are not for the button that was clicked
        self.setEnabled(False)
        self._plays = True
        try:
            play(self.host, self.step.do)
        except CannotDo as error:
            self.host.status.show_message(str(error))
        self._plays = False
        self.setEnabled(True)
        if self.ended:
            take_away(self)
        else:
            self.look()

    def end(self) -> None:
        """Take the strip away, or let it go once it has played; the design stays as it is."""
        self.ended = True
        self._look.stop()
        for mark in self.marks:
            take_away(mark)
        self.host.removeToolBar(self)
        if not self._plays:
            take_away(self)


def begin(window: Window, lesson: Lesson) -> TutorialStrip:
    """Begin a lesson, in place of the one at hand."""
    for before in window.findChildren(TutorialStrip):
        before.end()
    if lesson.design:
        window.documents.open_example(example(lesson.design))
    strip = TutorialStrip(window, lesson)
    window.addToolBarBreak()
    window.addToolBar(Qt.ToolBarArea.TopToolBarArea, strip)
    strip.show()
    return strip
