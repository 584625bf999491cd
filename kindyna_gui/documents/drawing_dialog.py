"""The dialog before a drawing of the cam is written: paper and flank, with the sheet as it will be, computed beside the window."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSize
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from core.cam import form_row
from core.design import Design
from core.errors import KindynaError
from core.output.drawing import PAPERS, Sheet, drawing
from core.study import Study
from kindyna_gui.background import Background
from kindyna_gui.look import INK, QUIET, WRONG, coloured
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


class DrawingDialog(QDialog):
    """``sheet`` is what was computed for the choices, None while there is none."""

    def __init__(self, parent: QWidget, design: Design) -> None:
        super().__init__(parent)
        self.setWindowTitle("Export drawing")
        self.sheet: Sheet | None = None
        self._design, self._work = design, Background(self)
        self.paper, self.flank = QComboBox(self), QComboBox(self)
        self.paper.addItems(list(PAPERS))
        assert design.drive.cam is not None, "a design without cam has no drawing"
        for name in form_row(design.drive.cam.form).flanks:
            self.flank.addItem(name.capitalize(), name)
        self.picture, self.result = SheetPicture(), QLabel()
        self.result.setWordWrap(True)
        self._lay_out()
        self._work.result.connect(self._take)
        for box in (self.paper, self.flank):
            box.currentIndexChanged.connect(self._compute)
        self.finished.connect(self._work.close)
        self._compute()

    def _lay_out(self) -> None:
        choices = QHBoxLayout()
        choices.addWidget(QLabel("Paper"))
        choices.addWidget(self.paper)
        several, label = self.flank.count() > 1, QLabel("Flank", self)
        choices.addWidget(label)
        choices.addWidget(self.flank)
        label.setVisible(several)
        self.flank.setVisible(several)
        choices.addWidget(self.result, 1)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.export: QPushButton = buttons.button(QDialogButtonBox.StandardButton.Ok)
        self.export.setText("Choose file...")
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addLayout(choices)
        column.addWidget(self.picture, 1)
        column.addWidget(buttons)

    def _compute(self) -> None:
        self.sheet = None
        self.export.setEnabled(False)
        self.picture.wait()
        self._tell("computing ...", QUIET)
        self._work.start([("", partial(_computed, self._design, self.flank.currentData(), self.paper.currentText()))])

    def _take(self, _: object, result: Sheet | KindynaError) -> None:
        if isinstance(result, Sheet):
            self.sheet = result
            self._tell(result.about, INK)
        else:
            self._tell(str(result), WRONG)
        self.picture.show_sheet(self.sheet)
        self.export.setEnabled(self.sheet is not None)

    def _tell(self, text: str, colour: str) -> None:
        self.result.setText(text)
        coloured(self.result, colour)


def _computed(design: Design, flank: str, paper: str) -> Sheet:
    return drawing(Study(design), flank, paper)


def drawing_wanted(parent: QWidget, design: Design) -> Sheet | None:
    """Ask what a drawing shall be like; the sheet, None where the user cancels."""
    dialog = DrawingDialog(parent, design)
    accepted = dialog.exec() == QDialog.DialogCode.Accepted
    sheet = dialog.sheet if accepted else None
    dialog.deleteLater()
    return sheet
