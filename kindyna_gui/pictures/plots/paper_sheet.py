"""What plots stand on in a file."""

from __future__ import annotations

from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QWidget

from kindyna_gui.pictures.style import Theme

MARGIN = 8  # around the plots, pixels


class PaperSheet(QWidget):
    """A widget in the colour of a theme's paper; subclasses lay out their plots ``MARGIN`` from its edges."""

    def __init__(self, theme: Theme) -> None:
        super().__init__()
        paper = QPalette(self.palette())
        paper.setColor(QPalette.ColorRole.Window, QColor(theme.paper))
        self.setPalette(paper)
        self.setAutoFillBackground(True)


__all__ = ["MARGIN", "PaperSheet"]
