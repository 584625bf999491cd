"""What is shown of each drive: its name, its colour, and why it has no answer where it has none."""

from __future__ import annotations

from functools import lru_cache

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPen, QPixmap

from core.errors import NoSolution
from core.findings import ERROR
from core.frozen import frozen
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import reason
from kindyna_gui.look import sign
from kindyna_gui.pictures.style import BALANCE, SCREEN


@frozen
class DriveRow:
    """One drive, or the balance cam behind them: its name, its colour, and why it cannot be assembled, empty where it can."""

    name: str
    colour: str
    problem: str = ""

    @property
    def icon(self) -> QIcon:
        """A swatch of its colour, or the sign of an error."""
        return sign(ERROR) if self.problem else swatch(self.colour)


def drive_rows(session: Session) -> tuple[DriveRow, ...]:
    """The drives in the order of the list. Of each only where its bodies stand is computed."""
    rows = []
    for number, study in enumerate(session.shaft.drives.values()):
        problem = ""
        try:
            _ = study.linkage
        except NoSolution as error:
            problem = reason(study.design, error)
        rows.append(DriveRow(session.names[number], SCREEN.drive(number), problem))
    return (*rows, *(DriveRow(name, SCREEN.seen(BALANCE)) for name in session.names[len(rows) :]))


@lru_cache(maxsize=64)
def swatch(colour: str) -> QIcon:
    """A small square of a colour."""
    made = QIcon()
    for scale in (1, 2):
        picture = QPixmap(16 * scale, 16 * scale)
        picture.setDevicePixelRatio(scale)
        picture.fill(Qt.GlobalColor.transparent)
        painter = QPainter(picture)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(Qt.PenStyle.NoPen))
        painter.setBrush(QColor(colour))
        painter.drawRoundedRect(QRectF(2.0, 2.0, 12.0, 12.0), 3.0, 3.0)
        painter.end()
        for mode in (QIcon.Mode.Normal, QIcon.Mode.Selected):  # a chosen row must not tint it
            made.addPixmap(picture, mode)
    return made
