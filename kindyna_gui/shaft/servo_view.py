"""Cam or servo: the torque that each asks for the same motion, the working points of the servo's motor, energy and inertia ratio."""

from __future__ import annotations

import math

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QSplitter

from core.output.subject_files import SERVO, Asked, asked, field_plot, torque_figure
from core.study import Study
from core.study.drive_forces import ServoTurn, has_servo, servo_part, servo_turn
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.pictures.plots.under_mouse import CursorPlot
from kindyna_gui.pictures.plots.xy import XYPlot
from kindyna_gui.pictures.units import digits
from kindyna_gui.player import Player, obey
from kindyna_gui.requirements import NO_SERVO, NotHere
from kindyna_gui.view import View

HEADINGS = (
    TableHeading("Over a turn", wide=True), TableHeading("RMS", number=True), TableHeading("Peak", number=True),
    TableHeading("at °", number=True), TableHeading("Peak power, W", number=True), TableHeading("Energy given, J", number=True),
    TableHeading("given back, J", number=True), TableHeading("with recovery, J", number=True),
)  # fmt: skip
KEPT = "the motor takes back what the load gives"
ROUNDING = 1e-12  # of the energy given: less is rounding
LOST = "what the load gives back is lost as heat: servo.regenerates is false, so the motor needs what it gives"


class ServoView(View):
    """Two plots and a table; the figures wait until editing pauses."""

    stages = ("dynamics",)
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.torque, self.force, self.field = CursorPlot(""), CursorPlot(""), XYPlot("", "")
        self.table = RowsTable(HEADINGS)
        plots, parted = QSplitter(Qt.Orientation.Horizontal), QSplitter(Qt.Orientation.Vertical)
        turn = QSplitter(Qt.Orientation.Vertical)
        for plot in (self.torque, self.force):
            plot.setToolTip("Click or drag to set the cam angle")
            plot.moved.connect(self._turn)
            turn.addWidget(plot)
        for plot in (self.torque, self.force, self.field):
            plot.setMinimumSize(160, 70)
        plots.addWidget(turn)
        plots.addWidget(self.field)
        plots.setSizes([3000, 2000])
        parted.addWidget(plots)
        parted.addWidget(self.table)
        parted.setSizes([3000, 2000])
        self.set_column(parted, grows=parted)

    def refresh(self, study: Study) -> None:
        if not has_servo(study.design):
            raise NotHere(NO_SERVO)
        study.require_load()
        found, turn = asked(study), servo_turn(study)
        plots = torque_figure(study, found).plots
        self.force.setVisible(len(plots) > 1)
        for widget, plot in zip((self.torque, self.force), plots, strict=False):
            widget.show_plot(plot)
        self.field.show_plot(field_plot(study, turn.rms))
        self.table.show_rows(_rows(study, found, turn))

    def follow(self, theta: float) -> None:
        for plot in (self.torque, self.force):
            plot.point_out(math.degrees(theta) % 360.0)

    def _turn(self, angle: float) -> None:
        self.player.play(False)
        self.player.set_theta(math.radians(angle))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not obey(self.player, event):
            super().keyPressEvent(event)


def _energies(given: float, braked: float) -> tuple[str, str, str]:
    net = given - braked
    return digits(given), digits(braked), digits(net if abs(net) > ROUNDING * given else 0.0)


def _rows(study: Study, found: tuple[Asked, ...], turn: ServoTurn) -> list[TableRow]:
    """Each way, then the segments of the motion by the servo, then the ratio of inertias."""
    rows = []
    for each in found:
        tip = KEPT if each.way != SERVO or servo_part(study).regenerates else LOST
        cells = f"{each.label}, {each.unit}", *map(digits, (each.rms, each.peak)), digits(each.peak_deg, 4)
        energies = _energies(each.given, each.braked)
        rows.append(TableRow((*cells, digits(each.peak_power), *energies), tip=tip))
    segments = study.program.motion.segments
    for part in turn.parts:
        name = f"Servo, segment {part.segment + 1} ({segments[part.segment].curve.law})"
        rows.append(TableRow((name, "", "", "", "", *_energies(part.given, part.braked))))
    ratio = "unknown" if turn.inertia_ratio is None else digits(turn.inertia_ratio)
    tip = "largest inertia of the load at the motor over that of the rotor, servo.rotor_inertia_kg_m2"
    return [*rows, TableRow(("Inertia ratio", ratio, *([""] * 6)), tip=tip)]


__all__ = ["ServoView"]
