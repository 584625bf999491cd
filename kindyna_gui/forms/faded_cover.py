"""Cover over results that no longer follow from what is typed."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QRect, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.style import SCREEN, TEXT, font

OPACITY = 0.72


class FadedCover(QWidget):
    """Translucent cover over a widget, with a text."""

    def __init__(self, over: QWidget) -> None:
        super().__init__(over)
        self._text, self._covered = "", over
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        over.installEventFilter(self)
        self.hide()

    @property
    def text(self) -> str:
        """Text on the cover; empty while it is hidden."""
        return self._text

    def show_text(self, text: str) -> None:
        """Cover the widget with this text; an empty text uncovers it."""
        self._text = text
        self.setGeometry(self._covered.rect())
        self.setVisible(bool(text))
        self.raise_()
        self.update()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if event.type() == QEvent.Type.Resize:
            self.setGeometry(self._covered.rect())
        return super().eventFilter(watched, event)

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        background = QColor(SCREEN.paper)
        background.setAlphaF(OPACITY)
        painter.fillRect(self.rect(), background)
        painter.setFont(font(TEXT))
        width, height = text_size(self._text, TEXT)
        box = QRect(0, 0, round(width) + 24, round(height) + 12)
        box.moveCenter(self.rect().center())
        painter.fillRect(box, QColor(SCREEN.paper))
        painter.setPen(QColor(SCREEN.quiet))
        painter.drawRect(box)
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, self._text)
        painter.end()
