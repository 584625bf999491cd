"""The dialog before a drawing of the cam is written: paper and flank, with the sheet as it will be, computed beside the window."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import partial
from typing import Any

from PySide6.QtCore import QSize
from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from core.design import Design
from core.output.files.cam_drawing import drawing
from core.output.files.sheet import DrawingRequest, DrawingSheet, Letterhead
from core.requests import build_request, command_words
from core.study import Study
from kindyna_gui.export.report_dialog import kept_cover
from kindyna_gui.forms.computed_dialog import ComputedDialog, accepted, flanks
from kindyna_gui.forms.request_form import RequestForm
from kindyna_gui.pictures.sheet_file import paint_sheet


class SheetPicture(QWidget):
    """A sheet as large as there is room; faint while another is computed."""

    def __init__(self) -> None:
        super().__init__()
        self.shown: DrawingSheet | None = None
        self.faint = False
        self.setAccessibleName("The sheet")
        self.setMinimumSize(420, 300)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def sizeHint(self) -> QSize:
        return QSize(840, 594)

    def show_sheet(self, sheet: DrawingSheet | None) -> None:
        """Draw this sheet; None: nothing."""
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
    """``made`` is the sheet for the choices, None while there is none."""

    command, ending, help_page = "drawing", ".pdf", "tour#Export > Drawing"

    def __init__(self, parent: QWidget, design: Design) -> None:
        self._design, self.picture = design, SheetPicture()
        kept = kept_cover()
        self._head = {each.name: kept[each.name] for each in fields(Letterhead)}
        super().__init__(parent, "drawing", RequestForm(DrawingRequest, flanks(design)), self.picture)
        self.changed()

    @property
    def _values(self) -> dict[str, Any]:
        return {**self._head, **self.form.values}

    def asked(self) -> tuple[str, list[str]]:
        return self.ending, command_words(DrawingRequest, self._values)

    def job(self) -> Callable[[], DrawingSheet]:
        return partial(_computed, self._design, build_request(DrawingRequest, self._values))

    def show_waiting(self) -> None:
        self.picture.wait()

    def show_made(self, made: DrawingSheet | None) -> str:
        self.picture.show_sheet(made)
        return "" if made is None else "\n".join(filter(None, (made.about, made.missing)))


def _computed(design: Design, request: DrawingRequest) -> DrawingSheet:
    return drawing(Study(design), request)


def drawing_wanted(parent: QWidget, design: Design) -> DrawingSheet | None:
    """Ask what a drawing shall be like; the sheet, None where the user cancels."""
    sheet: DrawingSheet | None = accepted(DrawingDialog(parent, design))
    return sheet
