"""What every list with buttons below it has: the buttons, and the keys that move and remove its rows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QKeyEvent, QKeySequence, QResizeEvent
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QToolButton, QWidget

from kindyna_gui.look import icon

_ARROWS = {"up": Qt.ArrowType.UpArrow, "down": Qt.ArrowType.DownArrow}
_STEPS: Mapping[int, int] = {Qt.Key.Key_Up: -1, Qt.Key.Key_Down: 1}


def list_button(text: str, picture: str, tip: str, slot: Callable[[], object] | None) -> QToolButton:
    """A flat button with its picture, where it has one, or an arrow alone (picture "up", "down"); the slot is called without the
    button's state."""
    button = QToolButton(autoRaise=True)
    button.setText(text)
    button.setToolTip(tip)
    button.setStatusTip(tip)
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    button.setAccessibleName(text)
    if picture in _ARROWS:
        button.setArrowType(_ARROWS[picture])
    elif picture:
        button.setIcon(icon(picture))
        button.setIconSize(QSize(16, 16))
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
    if slot is not None:
        button.clicked.connect(lambda: slot())
    return button


def taken_by_list(rows: Any, event: QKeyEvent) -> bool:
    """Whether a key is one of the list's own: Alt+Up and Alt+Down emit ``moved`` (-1 or 1), Delete emits ``removed``."""
    if event.key() in _STEPS and event.modifiers() & Qt.KeyboardModifier.AltModifier:
        rows.moved.emit(_STEPS[event.key()])
    elif event.matches(QKeySequence.StandardKey.Delete):
        rows.removed.emit()
    else:
        return False
    return True


def row_of_buttons(buttons: Iterable[QToolButton], above: int = 0) -> QHBoxLayout:
    """The buttons of a list side by side at the left; so many pixels free above and below them."""
    row = QHBoxLayout()
    row.setContentsMargins(4, above, 4, above)
    row.setSpacing(0)
    for button in buttons:
        row.addWidget(button)
    row.addStretch(1)
    return row


class TwoGroups(QWidget):
    """Two groups of buttons in a row, at the left and at the right; the second below the first where that has no room."""

    def __init__(self, first: Iterable[QToolButton], second: Iterable[QToolButton], above: int = 0) -> None:
        super().__init__()
        self._line = QBoxLayout(QBoxLayout.Direction.LeftToRight, self)
        self._line.setContentsMargins(0, above, 0, above)
        self._line.setSpacing(0)
        self._groups = [row_of_buttons(group) for group in (first, second)]
        for stretch, group in zip((1, 0), self._groups, strict=True):
            self._line.addLayout(group, stretch)

    def resizeEvent(self, event: QResizeEvent) -> None:
        beside = sum(group.sizeHint().width() for group in self._groups) <= event.size().width()
        self._line.setDirection(QBoxLayout.Direction.LeftToRight if beside else QBoxLayout.Direction.TopToBottom)
        super().resizeEvent(event)


__all__ = ["TwoGroups", "list_button", "row_of_buttons", "taken_by_list"]
