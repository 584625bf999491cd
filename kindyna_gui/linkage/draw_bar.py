"""The strip of the drawing tools."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSize
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QHBoxLayout, QLabel, QVBoxLayout, QWidget

from kindyna_gui.look import tool_bar
from kindyna_gui.note import SteadyText


class DrawBar(QWidget):
    """The strip of tools over the drawing, and below them what the drawing lacks and what is to be clicked."""

    def __init__(self, actions: Sequence[QAction]) -> None:
        super().__init__()
        self.tools = tool_bar("Draw", self)
        self.tools.setIconSize(QSize(20, 20))
        for action in actions:
            self.tools.addAction(action)
        self.prompt = QLabel()
        self.state = SteadyText()
        row = QHBoxLayout()
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.tools)
        row.addWidget(self.prompt, 1)
        self.prompt.setMinimumWidth(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(4, 1, 4, 2)
        column.setSpacing(1)
        column.addLayout(row)
        column.addWidget(self.state)
        self.hide()


__all__ = ["DrawBar"]
