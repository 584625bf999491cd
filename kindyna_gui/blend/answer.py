"""The answer of the blend wizard: curves, spans and levels as Yang's Fig. 4 has them, and the motion that comes of it."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QObject, QRect, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QFrame, QLabel, QVBoxLayout, QWidget

from core.blend import BlendResult
from core.design import UNITS, Design
from core.output.channels import channels
from core.study import Study
from kindyna_gui.blend.fields import quiet
from kindyna_gui.blend.texts import HEADINGS, figures, table
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.plots.plot import CurvePlot
from kindyna_gui.pictures.style import SCREEN, TEXT, font
from kindyna_gui.preferences.units import symbol_of

QUANTITIES = ("displacement", "velocity", "acceleration")
SAMPLES = 720
"""Cam angles of the curves, which change with every keystroke."""
VEIL = 0.72  # of the paper over what no longer holds


class FadedCover(QWidget):
    """Paper over a widget, thin enough to read what is under it, with a text on it."""

    def __init__(self, over: QWidget) -> None:
        super().__init__(over)
        self._text, self._covered = "", over
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        over.installEventFilter(self)
        self.hide()

    @property
    def text(self) -> str:
        return self._text

    def draw(self, text: str) -> None:
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
        paper = QColor(SCREEN.paper)
        paper.setAlphaF(VEIL)
        painter.fillRect(self.rect(), paper)
        painter.setFont(font(TEXT))
        width, height = text_size(self._text, TEXT)
        box = QRect(0, 0, round(width) + 24, round(height) + 12)
        box.moveCenter(self.rect().center())
        painter.fillRect(box, QColor(SCREEN.paper))
        painter.setPen(QColor(SCREEN.quiet))
        painter.drawRect(box)
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, self._text)
        painter.end()


class AnswerPanel(QFrame):
    """The sequence, its figures, its table, and the curves over the whole turn with those of the design dashed."""

    def __init__(self, unit: str) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setBackgroundRole(QPalette.ColorRole.Base)
        self.setAutoFillBackground(True)
        symbol = symbol_of(UNITS[unit].symbol)
        self.headline = QLabel()
        big = self.headline.font()
        big.setBold(True)
        big.setPixelSize(round(self.headline.fontInfo().pixelSize() * 1.2))
        self.headline.setFont(big)
        self.figures = quiet()
        self.figures.setWordWrap(True)
        for label in (self.headline, self.figures):
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        columns = [(i > 0, heading) for i, heading in enumerate(HEADINGS)]
        # what names its unit is long: it takes the room it needs, the angles share the rest
        self.table = RowsTable(
            [TableHeading(text.format(u=symbol), number=n, wide=n and "{u}" not in text) for n, text in columns]
        )
        self.table.setFrameShape(QFrame.Shape.NoFrame)
        self.table.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.plots = [CurvePlot(names=i == 0, angles=i == len(QUANTITIES) - 1) for i in range(len(QUANTITIES))]
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 6, 8, 6)
        column.setSpacing(4)
        column.addWidget(self.headline)
        column.addWidget(self.figures)
        column.addWidget(self.table)
        for plot in self.plots:
            plot.setMinimumHeight(84)
            plot.show_cursor(False)
            column.addWidget(plot, 1)
        self.veil = FadedCover(self)
        self._keep_height()

    def show_answer(self, blended: BlendResult, design: Design | None, before: Study) -> None:
        """The curves, and the motion of a design that has them, over that of the design before; None: that has no
        place for them."""
        self.headline.setText("–".join(blended.curves))
        self.figures.setText("\n".join(figures(blended, before.design.speed_rpm)))
        rows = table(blended)
        self.table.show_rows([TableRow(cells) for cells in rows])
        self._keep_height()
        if design is None:
            for plot in self.plots:
                plot.show_message("")
            self.plots[0].show_message("These curves have no place in the motion as it is")
        else:
            self._draw(design, before)
        self.veil.draw("")

    def show_before(self, before: Study) -> None:
        """Show the motion of the design in place, before there is an answer."""
        self.headline.setText("No motion yet")
        self.figures.setText("The design's motion as it is")
        self._draw(before.design, None)

    def _draw(self, design: Design, before: Study | None) -> None:
        study = Study(design, SAMPLES)
        rows = {row.name: row for row in channels(design)}
        for quantity, plot in zip(QUANTITIES, self.plots, strict=True):
            plot.set_curves(study, [rows[quantity]], before)

    def _keep_height(self) -> None:
        """As many rows as there are, none of them scrolled."""
        rows = sum(self.table.rowHeight(i) for i in range(len(self.table.rows.rows)))
        self.table.setFixedHeight(self.table.horizontalHeader().sizeHint().height() + rows + 2)


__all__ = ["QUANTITIES", "AnswerPanel", "FadedCover"]
