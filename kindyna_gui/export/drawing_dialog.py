"""The dialog before a drawing of the cam is written: paper and flank, with the sheet as it will be, computed beside the window."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSize
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QSizePolicy, QVBoxLayout, QWidget

from core.design import Design
from core.output.drawing import PAPERS, Sheet, drawing
from core.study import Study
from kindyna_gui.forms.computed_dialog import ComputedDialog, accepted
from kindyna_gui.pictures.sheet_file import paint_sheet


class SheetPicture(QWidget):
    """A sheet as large as there is room; faint while another is computed."""

    def __init__(self) -> None:
        super().__init__()
        self.shown: Sheet | None = None
        self.faint = False
        self.setMinimumSize(420, 300)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def sizeHint(self) -> QSize:
        return QSize(840, 594)

    def show_sheet(self, sheet: Sheet | None) -> None:
        self.shown, self.faint = sheet, False
        self.update()

    def wait(self) -> None:
        self.faint = True
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        if self.shown is None:
            return
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setOpacity(0.4 if self.faint else 1.0)
        paint_sheet(painter, self.shown, self.rect())
        painter.end()


class DrawingDialog(ComputedDialog):
    """``sheet`` is what was computed for the choices, None while there is none."""

    def __init__(self, parent: QWidget, design: Design) -> None:
        super().__init__(parent, design, "drawing")
        self._design = design
        self.paper, self.picture = QComboBox(self), SheetPicture()
        self.paper.addItems(list(PAPERS))
        self._lay_out()
        for box in (self.paper, self.flank):
            box.currentIndexChanged.connect(self._compute)
        self._compute()

    @property
    def sheet(self) -> Sheet | None:
        sheet: Sheet | None = self.made
        return sheet

    def _lay_out(self) -> None:
        choices = QHBoxLayout()
        choices.addWidget(QLabel("Paper"))
        choices.addWidget(self.paper)
        label = QLabel("Flank", self)
        choices.addWidget(label)
        choices.addWidget(self.flank)
        label.setVisible(self.several_flanks)
        choices.addWidget(self.result, 1)
        column = QVBoxLayout(self)
        column.addLayout(choices)
        column.addWidget(self.picture, 1)
        column.addWidget(self.buttons)

    def _compute(self) -> None:
        self.expect()
        self.begin(partial(_computed, self._design, self.flank.currentData(), self.paper.currentText()))

    def show_waiting(self) -> None:
        self.picture.wait()

    def show_made(self, made: Sheet | None) -> str:
        self.picture.show_sheet(made)
        return "" if made is None else made.about


def _computed(design: Design, flank: str, paper: str) -> Sheet:
    return drawing(Study(design), flank, paper)


def drawing_wanted(parent: QWidget, design: Design) -> Sheet | None:
    """Ask what a drawing shall be like; the sheet, None where the user cancels."""
    sheet: Sheet | None = accepted(DrawingDialog(parent, design))
    return sheet
