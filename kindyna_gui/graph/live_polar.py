"""Curves in polar form with the mouse: set the cam angle, and open a menu."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QWidget

from core.output.drawing.scales import UNSEEN
from kindyna_gui.graph.live_plot import TIP
from kindyna_gui.pictures.plots.mouse import AngleMouse
from kindyna_gui.pictures.plots.polar import PolarPlot


class LivePolar(AngleMouse, PolarPlot):
    """Curves in polar form, with the mouse."""

    unseen = UNSEEN

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.setToolTip(TIP)
