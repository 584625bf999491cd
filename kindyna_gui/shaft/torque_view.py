"""The shaft's torque over the machine angle: each drive's, the sum, with balance cam and flywheel; its figures, and the true speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QSplitter, QWidget

from core.design import UNITS
from core.errors import NoSolution
from core.shaft import LoadCurve, peaks, rms
from core.study import Camshaft, Study
from kindyna_gui.documents.bands import Band, Bands
from kindyna_gui.documents.session import BALANCE_CAM, Session
from kindyna_gui.drives.rows import swatch
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import reason
from kindyna_gui.note import Note
from kindyna_gui.pictures.plots.lines import closed
from kindyna_gui.pictures.plots.under_mouse import MACHINE_ANGLE, MACHINE_TIP, CursorPlot
from kindyna_gui.pictures.plots.xy import Line
from kindyna_gui.pictures.style import BALANCE, SCREEN
from kindyna_gui.pictures.units import digits, measure, readable
from kindyna_gui.player import Player, obey
from kindyna_gui.preferences.units import size_of
from kindyna_gui.requirements import ALONE, require_list
from kindyna_gui.view import NumberAtHand, View

LATER_MS = 150  # after an edit, before what takes longer: motor, true speed, figures
TORQUE = "N·m"
HEADINGS = (TableHeading("Torque", unit=TORQUE), TableHeading("Mean", number=True), TableHeading("RMS", number=True),
    TableHeading("Peak", number=True),
            TableHeading("at °", number=True), TableHeading("Peak power", number=True))  # fmt: skip
SHAFT, CAMS, MOTOR = "Shaft", "Without balance cam", "Motor"
RPM = UNITS["rpm"].factor
ROUNDING = 1e-12  # of the peak: less is rounding


def show_turn(plot: CursorPlot, title: str, unit: str, lines: Sequence[Line], fit: bool = False) -> None:
    """Draw curves over the machine angle, x [deg] without the end of the turn, y and band in ``unit``, the first of them underneath;
    fit: the axis need not reach to zero."""
    rung = readable(unit, max((float(np.abs(line.y).max(initial=0.0)) for line in lines), default=0.0))
    plot.name_axes(MACHINE_ANGLE, f"{title}, {rung.symbol}")
    whole = [
        replace(
            line,
            x=np.append(line.x, 360.0),
            y=np.append(line.y, line.y[0]) / rung.size,
            band=None if line.band is None else (line.band[0], line.band[1] / rung.size),
        )
        for line in lines
    ]
    plot.show_lines(whole, fit=fit, rung=rung)


def band_in(found: Band, name: str, unit: float = 1.0) -> tuple[np.ndarray, np.ndarray] | None:
    """Machine angles [deg] and percentiles of a drive by its name, empty of all, or of a quantity of the motor, in a unit."""
    return closed(found[name] / unit) if name in found else None


ROOMY = 260  # pixels of height, from which on a plot stands above the table of figures


class _TurnView(View):
    """Plots over the machine angle of all drives together; what takes longer than they comes once editing pauses."""

    of_whole = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self._read_timer = QTimer(self, singleShot=True, interval=LATER_MS)
        self._read_timer.timeout.connect(self._show_later)

    def _lay_out(self, count: int, *more: QWidget) -> None:
        """So many plots one below the other, of which the last has the angles, and more below them."""
        self.plots = tuple(CursorPlot(MACHINE_ANGLE) for _ in range(count))
        self.note = Note(SCREEN.quiet, margin=3)
        parted = QSplitter(Qt.Orientation.Vertical, childrenCollapsible=False)
        for number, plot in enumerate(self.plots, 1):
            plot.setToolTip(MACHINE_TIP)
            plot.setMinimumSize(220, 70)
            plot.show_numbers(number == count)
            plot.moved.connect(self._turn)
            parted.addWidget(plot)
        for part in more:
            parted.addWidget(part)
        parted.setSizes([*([1000] * (count - 1)), 1300, *(1000 for _ in more)])
        self.set_column(parted, self.note, grows=parted)

    def refresh(self, study: Study) -> None:
        require_list(self.session.whole, ALONE)
        self.draw(self.session.shaft)
        self._read_timer.start()

    def draw(self, shaft: Camshaft[Study]) -> None:
        """What follows each edit."""

    def draw_later(self, shaft: Camshaft[Study]) -> None:
        """What takes longer."""

    def _show_later(self) -> None:
        self._read_timer.stop()
        if not self.in_trouble:
            self.draw_later(self.session.shaft)
            self.follow(self.player.theta)

    def settle(self) -> None:
        super().settle()
        if self._read_timer.isActive():
            self._show_later()

    @property
    def busy(self) -> bool:
        return super().busy or self._read_timer.isActive()

    def follow(self, theta: float) -> None:
        machine = math.degrees(self.player.machine_of(theta))
        for plot in self.plots:
            plot.point_out(machine)

    def _turn(self, machine: float) -> None:
        self.player.play(False)
        self.player.set_machine(math.radians(machine))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not obey(self.player, event):
            super().keyPressEvent(event)


class ShaftTorqueView(_TurnView):
    """Each drive's torque in its colour, below it their sum: with balance cam, and as the motor gives it."""

    stages = ("dynamics",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self._lay_out(2)
        self.drives, self.sums = self.plots
        self.bands = Bands.of(session)
        self.bands.changed.connect(self.invalidate)

    def draw(self, shaft: Camshaft[Study]) -> None:
        chosen = self.session.names[self.session.chosen]
        x = shaft.angle_degrees
        curves = [
            Line(
                x,
                shaft.drive_torque(name),
                SCREEN.drive(shaft.drive_number(name)),
                name,
                read=name == chosen,
                band=band_in(self.bands.of_shaft(), name),
            )
            for name in shaft.loading_drives
            if name not in shaft.failures
        ]
        lacking = ""
        try:
            if shaft.design.balancer is not None:
                curves.append(Line(x, shaft.balancer_torque, BALANCE, BALANCE_CAM, read=chosen == BALANCE_CAM))
            self._draw_sums(shaft)
        except NoSolution as error:
            lacking = reason(shaft.design, error)
            self.sums.show_message("")
        self.note.show_message(lacking)
        if curves:
            show_turn(self.drives, "Drives", "N·m", curves)
        else:
            self.drives.show_message("No drive loads the shaft.")

    def _draw_sums(self, shaft: Camshaft[Study], *motor: Line) -> None:
        x, balanced = shaft.angle_degrees, shaft.design.balancer is not None
        cams = [Line(x, shaft.cams_torque, SCREEN.quiet, CAMS)] if balanced else []
        whole = Line(x, shaft.torque, SCREEN.ink, SHAFT, read=True, band=band_in(self.bands.of_shaft(), ""))
        show_turn(self.sums, "Shaft", "N·m", [*cams, whole, *motor])

    def draw_later(self, shaft: Camshaft[Study]) -> None:
        if not shaft.levels_torque:
            return
        try:
            band = band_in(self.bands.of_motor(), "motor_torque")
            motor = Line(shaft.angle_degrees, shaft.motor_torque, SCREEN.family("torque"), MOTOR, read=True, band=band)
            self._draw_sums(shaft, motor)
        except NoSolution as error:
            self.note.show_message(reason(shaft.design, error))


class ShaftFiguresView(_TurnView):
    """The true speed where a flywheel levels it, and a table: mean, root mean square, peak and peak power of each and all."""

    stages = ("dynamics",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(HEADINGS)
        self.offer_explanation(self.table)
        self._lay_out(1, self.table)
        (self.speed,) = self.plots
        self.bands = Bands.of(session)
        self.bands.changed.connect(self.invalidate)
        self._levelled = False
        self._share()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._share()

    def _share(self) -> None:
        """The speed where there is one, and where it does not hide rows of the table."""
        self.speed.setVisible(self._levelled and self.height() >= ROOMY)

    def number_at_hand(self) -> NumberAtHand | None:
        return self.table.number

    def draw(self, shaft: Camshaft[Study]) -> None:
        if not self.table.rows.rows:
            self.draw_later(shaft)

    def draw_later(self, shaft: Camshaft[Study]) -> None:
        self._levelled = shaft.levels_torque
        self._share()
        try:
            if shaft.levels_torque:
                band = band_in(self.bands.of_motor(), "camshaft_speed", RPM)
                speed = Line(shaft.angle_degrees, shaft.speed / RPM, SCREEN.family("speed"), read=True, band=band)
                show_turn(self.speed, "Speed", "rpm", [speed], fit=True)
        except NoSolution as error:
            self.speed.show_message(reason(shaft.design, error))
        self.table.show_rows(figures(shaft))


def figures(shaft: Camshaft[Study]) -> list[TableRow]:
    """Mean, root mean square, peak with its machine angle and peak power of each drive, of the sums, and of the motor."""
    rows = [
        _row(
            name,
            shaft.drive_load(name),
            shaft.omega,
            SCREEN.drive(shaft.drive_number(name)),
            f"{shaft.slugs[name]}_torque_nm",
        )
        for name in shaft.loading_drives
        if name not in shaft.failures
    ]
    try:
        if shaft.design.balancer is not None:
            rows.append(_row(CAMS, shaft.cams_load, shaft.omega, SCREEN.quiet))
        rows.append(_row(SHAFT, shaft.load, shaft.omega, SCREEN.ink, "torque_nm"))
        if shaft.levels_torque:
            found = shaft.motor_range
            ends = found["motor_torque"]
            peak = max((ends.low, ends.high), key=lambda end: abs(end.value))
            power = measure(*_readable("W", found["motor_power"].high.value))
            cells = (MOTOR, _torque(shaft.mean_torque), "", _torque(peak.value), _angle(peak.theta), power)
            rows.append(TableRow(cells, swatch(SCREEN.family("torque")), "with the flywheel, at the true speed"))
    except NoSolution as error:
        rows.append(TableRow((reason(shaft.design, error), "", "", "", "", ""), across=0))
    return rows


def _row(name: str, load: LoadCurve, omega: float, colour: str, column: str = "") -> TableRow:
    """column: of the peak."""
    ends = peaks(load)
    peak = max((ends.low, ends.high), key=lambda end: abs(end.value))
    power = measure(*_readable("W", ends.high.value * omega))
    mean = load.mean if abs(load.mean) > ROUNDING * abs(peak.value) else 0.0
    cells = name, _torque(mean), _torque(rms(load)), _torque(peak.value), _angle(peak.theta), power
    return TableRow(cells, swatch(colour), number=NumberAtHand(column, peak.theta) if column else None)


def _readable(symbol: str, value: float) -> tuple[float, str]:
    rung = readable(symbol, abs(value))
    return value / rung.size, rung.symbol


def _torque(value: float) -> str:
    return digits(value / size_of(TORQUE))


def _angle(theta: float) -> str:
    return digits(math.degrees(theta) % 360.0, 4)


__all__ = ["ShaftFiguresView", "ShaftTorqueView"]
