"""What a random user does over several views and windows: lines left empty while all else changes, lessons, studies, pinned variants,
windows that are closed and opened again."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QAbstractItemView, QApplication, QComboBox, QLineEdit
from random_actions import Actions
from random_choices import CTRL, ENDS, NO, SHIFT, K
from random_dialogs import activate

from kindyna_gui.pictures.app import ensure_app
from kindyna_gui.studies.plots import SurveyPlot
from kindyna_gui.window.main_window import open_window
from kindyna_gui.window.tutorial import TutorialStrip

LEFT = Qt.MouseButton.LeftButton


def waited_for() -> bool:
    """Whether something that has opened is to be answered first."""
    return QApplication.activeModalWidget() is not None or QApplication.activePopupWidget() is not None


class Visits(Actions):
    """The hands of a random user who goes about in the whole program."""

    def empty_lines(self) -> None:
        """Lines emptied, or not touched, and left by a key; tasks, undo and other designs in between."""
        for _ in range(self.rng.randrange(2, 8)):
            self._empty_line()
            if waited_for():
                return
            if self.rng.random() < 0.5:
                between = (self.task, self.undo_redo, self.undo_redo, self.open_example, self.new_design, self.view)
                self.rng.choice(between)()
                QTest.qWait(self.rng.choice((0, 1, 20)))
            if waited_for():
                return

    def _empty_line(self) -> None:
        if self.rng.random() < 0.25:
            self.note("  Ctrl+K")
            QTest.keyClick(QApplication.focusWidget() or self.window, K.Key_K, CTRL)
            line: Any = QApplication.focusWidget()
        else:
            line = self._some(QLineEdit, self.window)
            if line is not None:
                line.setFocus()
        if not isinstance(line, QLineEdit):
            return
        end, drags = self.rng.choice(ENDS), self.rng.random() < 0.2
        self.note(f"  empty {line.accessibleName() or type(line.parent()).__name__}, {end.name}{', dragging' * drags}")
        if self.rng.random() < 0.7:
            line.selectAll()
            QTest.keyClick(line, self.rng.choice((K.Key_Backspace, K.Key_Delete)))
        if drags:
            QTest.mousePress(line, LEFT, NO, line.rect().center())
            QTest.mouseMove(line, line.rect().center() / 2)
        QTest.keyClick(QApplication.focusWidget() or line, end)
        if drags:
            QTest.mouseRelease(line, LEFT, NO, line.rect().center())

    def lesson(self) -> None:
        """A lesson, begun or gone on with, while other things happen."""
        strips = self.window.findChildren(TutorialStrip)
        if not strips or self.rng.random() < 0.2:
            self._choose(("Help", "Tutorial"))
            return
        for _ in range(self.rng.randrange(1, 6)):
            strip = self.window.findChild(TutorialStrip)
            if strip is None or waited_for():
                return
            self._press(self.rng.choice((strip.where, strip.done, strip.done, strip.next, strip.leave)))
            QTest.qWait(self.rng.choice((1, 200)))

    def study(self) -> None:
        """The dock of studies: one from its menu, numbers that are varied, what is asked, a hand at the map."""
        page = self.window.show_view("study")
        for _ in range(self.rng.randrange(2, 9)):
            if waited_for() or not page.isVisible():
                return
            kind = self.rng.choice(
                ("open", "button", "button", "field", "field", "drag", "click", "table", "other", "wait")
            )
            self.note(f"  study: {kind}")
            if kind == "open":
                self._press(page.open)
                return  # its menu is answered
            if kind == "button":
                self._press(self._some(QAbstractButton, page))
            elif kind == "field":
                self._fill(self._some((QLineEdit, QComboBox), page))
            elif kind in ("drag", "click"):
                plot = self._some(SurveyPlot, page)
                if plot is not None and kind == "drag":
                    self._drag(plot.viewport(), self._place(plot.viewport()), self._place(plot.viewport()))
                elif plot is not None:
                    self._click(plot.viewport())
            elif kind == "table":
                self._in_table(self._some(QAbstractItemView, page))
            elif kind == "other":
                self.rng.choice((self.task, self.undo_redo, self.open_example, self.field))()
            else:
                QTest.qWait(200)

    def variants(self) -> None:
        """Pin, compare, bring another to the front, let go."""
        for _ in range(self.rng.randrange(1, 6)):
            if waited_for():
                return
            kind = self.rng.choice(("pin", "pin", "before", "unpin", "compare", "field", "undo"))
            self.note(f"  variants: {kind}")
            if kind == "pin":
                QTest.keyClick(QApplication.focusWidget() or self.window, K.Key_P, CTRL | SHIFT)
            elif kind in ("before", "unpin"):
                self._choose(("Edit", "Compare with the last step" if kind == "before" else "Unpin"))
            elif kind == "compare":
                page = self.window.show_view("compare")
                self._fill(self._some(QComboBox, page))
            elif kind == "field":
                self.field()
            else:
                self.undo_redo()
            QTest.qWait(self.rng.choice((1, 20)))

    def close_and_open(self) -> None:
        """The window closed, another one opened."""
        if self.window.close():
            self.window.deleteLater()
            QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
            self.window = open_window(ensure_app())
            self.window.show()
            activate(self.window)
        else:
            self.note("  it stays open")


__all__ = ["Visits"]
