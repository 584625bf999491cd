"""A row of buttons for what can be done with the chosen segment."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QLayout, QMenu, QToolButton, QWidget

from core.design import Design
from kindyna_gui.look import icon
from kindyna_gui.motion.actions import ACTIONS


class SegmentBar(QWidget):
    """The rows of ``ACTIONS`` as buttons; without their texts where there is no room for these.

    wanted             (name, cam angle [deg] or None): a button was clicked, or an entry of ``menu``
    abilities_changed  (dict: name -> whether it makes sense now)
    """

    wanted = Signal(str, object)
    abilities_changed = Signal(dict)

    def __init__(self) -> None:
        super().__init__()
        self._able: dict[str, bool] = {}
        self.buttons = {name: self._button(name) for name, row in ACTIONS.items() if row.button}
        row = QHBoxLayout(self)
        row.setContentsMargins(4, 1, 4, 3)
        row.setSpacing(0)
        for button in self.buttons.values():
            row.addWidget(button)
        row.addStretch(1)
        row.setSizeConstraint(QLayout.SizeConstraint.SetNoConstraint)
        self._text_width = sum(button.sizeHint().width() for button in self.buttons.values()) + 8

    def _button(self, name: str) -> QToolButton:
        row = ACTIONS[name]
        button = QToolButton(autoRaise=True)
        button.setText(row.text)
        button.setIcon(icon(row.icon))
        button.setToolTip(row.tip)
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        button.setIconSize(QSize(16, 16))
        button.clicked.connect(lambda: self.wanted.emit(name, None))
        return button

    def minimumSizeHint(self) -> QSize:
        height = max(button.sizeHint().height() for button in self.buttons.values()) + 4
        return QSize(len(self.buttons) * (height + 4), height)

    def sizeHint(self) -> QSize:
        return QSize(self._text_width, self.minimumSizeHint().height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        with_text = self.width() >= self._text_width
        style = Qt.ToolButtonStyle.ToolButtonTextBesideIcon if with_text else Qt.ToolButtonStyle.ToolButtonIconOnly
        for button in self.buttons.values():
            button.setToolButtonStyle(style)

    def show_segment(self, design: Design, index: int) -> None:
        """Grey what makes no sense for a segment."""
        able = {name: action.makes_sense(design, index) for name, action in ACTIONS.items()}
        if able != self._able:
            self._able = able
            for name, button in self.buttons.items():
                button.setEnabled(able[name])
            self.abilities_changed.emit(able)

    def menu(self, parent: QWidget, angle: float | None = None) -> QMenu:
        """The same as a menu, which goes when it closes; angle: the cam angle that was pointed at [deg]."""
        made = QMenu(parent)
        made.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        for name, row in ACTIONS.items():
            entry = made.addAction(icon(row.icon), row.entry, partial(self.wanted.emit, name, angle))
            entry.setEnabled(self._able.get(name, False))
        return made


__all__ = ["SegmentBar"]
