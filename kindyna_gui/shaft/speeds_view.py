"""The shaft at other speeds than its own: torque, motor and fluctuation of speed against the machine's speed."""

from __future__ import annotations

from functools import partial

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QProgressBar, QSplitter

from core.errors import KindynaError
from core.numerics.lazy import Cancelled
from core.shaft import AgainstSpeed
from core.study import Study
from core.study.speeds import at_speeds
from kindyna_gui.background_view import BackgroundView
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import reason
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import BLUE, GREEN, SCREEN, VERMILION
from kindyna_gui.pictures.units import readable
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_WHEEL, turned_shaft

SPEED = "Machine speed, rpm"
LEAST, MOST, COUNT = 0.25, 2.0, 36  # times the design's speed; speeds between
POLL_MS = 25


class AgainstSpeedView(BackgroundView):
    """Two plots, found beside the window while they can be seen."""

    of_whole = True
    stages = ("dynamics",)
    pause_ms = 250

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player, POLL_MS)
        self.found: AgainstSpeed | None = None
        self.torque, self.fluctuation = XYPlot(SPEED, ""), XYPlot(SPEED, "")
        for plot in (self.torque, self.fluctuation):
            plot.setMinimumSize(220, 70)
        self.bar = QProgressBar(minimum=0, maximum=0, textVisible=False)
        self.bar.setAccessibleName("Computing")
        self.bar.setFixedHeight(6)
        self.bar.hide()
        parted = QSplitter(Qt.Orientation.Vertical)
        parted.addWidget(self.torque)
        parted.addWidget(self.fluctuation)
        parted.setSizes([3000, 2000])
        self.set_column(parted, self.bar, grows=parted)
        self._work.result.connect(self._answered)

    def refresh(self, study: Study) -> None:
        design = self.session.whole
        rpm = turned_shaft(self.session.whole_study, NO_WHEEL).speed_rpm * np.linspace(LEAST, MOST, COUNT)
        self.found = None
        self.bar.show()
        self._work.start([(design, partial(at_speeds, design, rpm))])

    def _answered(self, design: object, result: AgainstSpeed | KindynaError | Cancelled) -> None:
        self.bar.hide()
        if isinstance(result, AgainstSpeed):
            self.found = result
            self._draw(result)
        elif isinstance(result, KindynaError):
            for plot in (self.torque, self.fluctuation):
                plot.show_message("")
            self.torque.show_message(reason(self.session.whole, result))

    def _draw(self, found: AgainstSpeed) -> None:
        own = ((self.session.whole.camshaft.speed_rpm, "now"),)
        rung = readable("N·m", float(np.abs(found.peak).max()))
        self.torque.name_axes(SPEED, f"Torque, {rung.symbol}")
        levelled = bool(np.any(found.motor_peak != found.peak))
        rows = [("Peak", found.peak, VERMILION), ("RMS", found.rms, BLUE), ("Mean", found.mean, GREEN)]
        rows += [("Motor peak", found.motor_peak, SCREEN.ink)] if levelled else []
        self.torque.show_lines([Line(found.rpm, y / rung.size, colour, name) for name, y, colour in rows], own)
        if np.isfinite(found.fluctuation).any():
            self.fluctuation.name_axes(SPEED, "Fluctuation, %")
            allowed = 100.0 * self.session.whole.camshaft.speed_fluctuation
            ends = Line(found.rpm[[0, -1]], np.full(2, allowed), SCREEN.limit, "allowed")
            reached = Line(found.rpm, 100.0 * found.fluctuation, SCREEN.family("speed"), "reached")
            self.fluctuation.show_lines(
                [reached, ends], own, note="the motor stalls" if np.isnan(found.fluctuation).any() else ""
            )
        else:
            self.fluctuation.show_message("The motor stalls at all of these speeds.")

    def _rest(self) -> None:
        super()._rest()
        self.bar.hide()


__all__ = ["AgainstSpeedView"]
