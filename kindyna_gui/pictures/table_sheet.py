"""A table of a paper as it is painted: its title, its heads, its rows; words to the left, numbers to the right."""

from __future__ import annotations

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from core.papers import FigureTable
from kindyna_gui.pictures.style import LIGHT, TEXT, THIN, Theme, font

EDGE, GAP, ROOM = 16.0, 18.0, 6.0  # around it, between columns, above and below a row, pixels
WIDEST, WIDEST_TITLE = 380.0, 560.0  # a column, the title, before words are broken
DIGITS = 8
MOST_ROWS = 40
SIGNIFICANT = f".{DIGITS}g"


class TableSheet(QWidget):
    """As large as the table is."""

    def __init__(self, table: FigureTable, theme: Theme = LIGHT) -> None:
        super().__init__()
        self._theme, self._title = theme, table.title
        rows = [[_words(value) for value in row] for row in table.rows]
        left_out = len(rows) - MOST_ROWS
        self._rows = rows[:MOST_ROWS] + (
            [[f"… {left_out} rows more"] + [""] * (len(table.names) - 1)] if left_out > 0 else []
        )
        self._heads = [_head(name) for name in table.names]
        self._right = [all(_is_number(row[i]) or not row[i] for row in rows) for i in range(len(table.names))]
        self._widths = [
            min(WIDEST, max(self._width(text, i) for text in column)) for i, column in enumerate(self._columns())
        ]
        self._heights = [
            max(self._height(text, width) for text, width in zip(row, self._widths, strict=True)) for row in self._rows
        ]
        own = sum(self._widths) + GAP * (len(self._widths) - 1)
        self._across = max(own, min(WIDEST_TITLE, self._title_width))
        self.resize(round(self._across + 2.0 * EDGE), round(self._top + sum(self._heights) + EDGE))

    def _columns(self) -> list[list[str]]:
        return [[head, *(row[i] for row in self._rows)] for i, head in enumerate(self._heads)]

    def _width(self, text: str, column: int) -> float:
        return QFontMetricsF(font(TEXT, bold=text == self._heads[column])).horizontalAdvance(text) + 2.0

    def _height(self, text: str, width: float) -> float:
        box = QFontMetricsF(font(TEXT)).boundingRect(QRectF(0.0, 0.0, width, 1e6), Qt.TextFlag.TextWordWrap, text)
        return float(box.height()) + ROOM

    @property
    def _title_width(self) -> float:
        return QFontMetricsF(font(TEXT + 1, bold=True)).horizontalAdvance(self._title)

    @property
    def _line(self) -> float:
        return QFontMetricsF(font(TEXT)).height() + ROOM

    @property
    def _top(self) -> float:
        """Where the rows begin."""
        return EDGE + self._line + self._title_height

    @property
    def _title_height(self) -> float:
        if not self._title:
            return 0.0
        room = QRectF(0.0, 0.0, self._across, 1e6)
        letters = QFontMetricsF(font(TEXT + 1, bold=True))
        return float(letters.boundingRect(room, Qt.TextFlag.TextWordWrap, self._title).height()) + 2.0 * ROOM

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(self._theme.paper))
        painter.setPen(QColor(self._theme.ink))
        y = EDGE
        if self._title:
            painter.setFont(font(TEXT + 1, bold=True))
            box = QRectF(EDGE, y, self._across, self._title_height)
            painter.drawText(box, int(Qt.AlignmentFlag.AlignLeft | Qt.TextFlag.TextWordWrap), self._title)
            y += self._title_height
        painter.setFont(font(TEXT, bold=True))
        self._row(painter, self._heads, y, self._line)
        y += self._line
        painter.setPen(QPen(QColor(self._theme.ink), THIN))
        painter.drawLine(round(EDGE), round(y - 0.5 * ROOM), round(self.width() - EDGE), round(y - 0.5 * ROOM))
        painter.setFont(font(TEXT))
        for number, (row, height) in enumerate(zip(self._rows, self._heights, strict=True)):
            if number % 2:
                painter.fillRect(
                    QRectF(EDGE - 4.0, y - 0.5 * ROOM, self.width() - 2.0 * EDGE + 8.0, height),
                    QColor(self._theme.band),
                )
            painter.setPen(QColor(self._theme.ink))
            self._row(painter, row, y, height)
            y += height
        painter.end()

    def _row(self, painter: QPainter, row: list[str], y: float, height: float) -> None:
        x = EDGE
        for text, width, right in zip(row, self._widths, self._right, strict=True):
            side = Qt.AlignmentFlag.AlignRight if right else Qt.AlignmentFlag.AlignLeft
            painter.drawText(QRectF(x, y, width, height), int(side | Qt.TextFlag.TextWordWrap), text)
            x += width + GAP


def _head(name: str) -> str:
    """A column's name as words."""
    return name.replace("_", " ")


def _is_number(text: str) -> bool:
    try:
        float(text.replace("\N{MINUS SIGN}", "-"))
    except ValueError:
        return False
    return True


def _words(value: object) -> str:
    """Numbers with as many digits as are read, with a proper minus."""
    text = str(value)
    if not _is_number(text) or text.isdecimal():
        return text
    return format(float(text), SIGNIFICANT).replace("-", "\N{MINUS SIGN}")


__all__ = ["TableSheet"]
