"""Small boxes at the mouse for what is typed while something is drawn: numbers with units and arithmetic, or a name."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QLineEdit, QWidget

from core.design import Unit
from core.frozen import frozen
from kindyna_gui.forms.typed_number import parsed
from kindyna_gui.pictures.style import SCREEN

Typed = float | str | None
Taken = Callable[[Sequence[Typed]], str]
"""Called with what stands in the boxes, None where nothing does; answers why that cannot be, or with nothing."""

BESIDE = QPoint(16, 12)  # pixels from the mouse


@frozen
class Box:
    """One box: its label, the unit of its number, or None where it takes a text; and what stands in it at first."""

    label: str
    unit: Unit | None
    text: str = ""


class TypedBoxes(QFrame):
    """Tab goes from box to box, Enter takes what stands there, Esc leaves all as it is."""

    def __init__(self, parent: QWidget, drawing: QWidget) -> None:
        super().__init__(parent)
        self._sheet, self._drawing = parent, drawing
        self.setObjectName("typed boxes")
        self.setAutoFillBackground(True)
        self.setStyleSheet(f"#typed\\ boxes {{ background: {SCREEN.paper}; border: 1px solid {SCREEN.line}; }}")
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(5, 3, 5, 3)
        self._row.setSpacing(4)
        self._boxes: list[tuple[Box, QLineEdit]] = []
        self._taken: Taken | None = None
        self.hide()

    @property
    def open(self) -> bool:
        return self._taken is not None

    def ask(self, at: QPoint, boxes: Sequence[Box], taken: Taken, typed: str = "", first: int = 0) -> None:
        """Open at a pixel of the parent; typed: the first character, which opened it."""
        self.close_all()
        self._taken = taken
        for box in boxes:
            edit = QLineEdit(box.text)
            edit.setAccessibleName(box.label)
            edit.setFixedWidth(74 if box.unit is not None else 110)
            self._row.addWidget(QLabel(f"{box.label}"))
            self._row.addWidget(edit)
            if box.unit is not None and box.unit.symbol:
                self._row.addWidget(QLabel(box.unit.symbol))
            self._boxes.append((box, edit))
        self.adjustSize()
        room = self._sheet.rect().adjusted(2, 2, -2 - self.width(), -2 - self.height())
        place = at + BESIDE
        self.move(max(room.left(), min(place.x(), room.right())), max(room.top(), min(place.y(), room.bottom())))
        self.show()
        self.raise_()
        edit = self._boxes[first][1]
        edit.setFocus()
        edit.selectAll()
        if typed:
            edit.setText(typed)
            edit.end(False)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.take()
        elif event.key() == Qt.Key.Key_Escape:
            self.close_all()
        # nothing goes on to the drawing behind

    def focusNextPrevChild(self, next: bool) -> bool:
        edits = [edit for _, edit in self._boxes]
        at = next_index(edits, next)
        if at is None:
            return super().focusNextPrevChild(next)
        edits[at].setFocus(Qt.FocusReason.TabFocusReason)
        edits[at].selectAll()
        return True

    def take(self) -> None:
        """What stands in the boxes is meant; one that is no number is framed red, and all stay open."""
        values: list[Typed] = []
        wrong = False
        for box, edit in self._boxes:
            text = edit.text().strip()
            value: Typed = text
            if box.unit is not None:
                value = parsed(text, box.unit) if text else None
            bad = box.unit is not None and bool(text) and value is None
            edit.setStyleSheet(f"border: 1px solid {SCREEN.limit};" if bad else "")
            edit.setToolTip("A number, with a unit if you like: 12.5, 3*12, 1 in" if bad else "")
            wrong = wrong or bad
            values.append(value)
        if wrong or self._taken is None:
            return
        taken = self._taken
        if why := taken(values):
            for _, edit in self._boxes:
                edit.setToolTip(why)
            self._boxes[0][1].setStyleSheet(f"border: 1px solid {SCREEN.limit};")
        elif self._taken is taken:
            self.close_all()

    def close_all(self) -> None:
        """Nothing is typed any longer."""
        self._taken = None
        self._boxes.clear()
        had = self.isAncestorOf(self.window().focusWidget()) if self.window().focusWidget() is not None else False
        self.hide()
        while (item := self._row.takeAt(0)) is not None:
            widget = item.widget()
            if widget is not None:
                widget.hide()
                widget.deleteLater()
        if had:
            self._drawing.setFocus()


def next_index(edits: Sequence[QLineEdit], forward: bool) -> int | None:
    """Which box comes after the one that has the focus; None where none has it."""
    now = next((i for i, edit in enumerate(edits) if edit.hasFocus()), None)
    return None if now is None else (now + (1 if forward else -1)) % len(edits)


__all__ = ["Box", "Typed", "TypedBoxes"]
