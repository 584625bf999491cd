"""Views of the shaft: torque and power of the servo, torque over the machine speed, torque and speed over the turn."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QProgressBar, QSplitter, QWidget

from core.design import UNITS
from core.errors import KindynaError, NoSolution
from core.numerics.lazy import Cancelled
from core.output.drawing.palette import BLUE, GREEN, VERMILION
from core.output.subject_files import SERVO, DriveEffort, drive_efforts, field_plot, torque_figure
from core.plot import Plot
from core.shaft import AgainstSpeed, LoadCurve, peaks, rms
from core.study import Camshaft, Study
from core.study.drive_forces import ServoTurn, has_servo, servo_part, servo_turn
from core.study.speeds import at_speeds
from kindyna_gui.documents.pins import Band, Bands, Pins
from kindyna_gui.documents.session import BALANCE_CAM, Session
from kindyna_gui.drives import swatch
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import reason
from kindyna_gui.look import Note, answer_label, described
from kindyna_gui.pictures.plots.lines import closed_band
from kindyna_gui.pictures.plots.xy import MACHINE_ANGLE, MACHINE_TIP, CursorPlot, Line, XYPlot, reference_lines
from kindyna_gui.pictures.style import BALANCE, SCREEN
from kindyna_gui.pictures.units import digits, measure, readable, short, with_unit
from kindyna_gui.player import Player, obey
from kindyna_gui.rebuilt import single_shot
from kindyna_gui.requirements import NO_SERVO, NO_WHEEL, ONE_DRIVE_TORQUE, Unavailable, require_list, turned_shaft
from kindyna_gui.settings import size_of
from kindyna_gui.view import BackgroundView, ExplainableNumber, View

# -- servo view ------------------------------------------------------------------------------------------

SERVO_HEADINGS = (
    TableHeading("Over a turn", wide=True), TableHeading("RMS", number=True), TableHeading("Peak", number=True),
    TableHeading("at °", number=True), TableHeading("Peak power, W", number=True), TableHeading("Energy given, J", number=True),
    TableHeading("given back, J", number=True), TableHeading("with recovery, J", number=True),
)  # fmt: skip
RECOVERED = "the motor recovers the energy that the load returns"
DISSIPATED = "the energy that the load returns becomes heat, because servo.regenerates is false"
ROUNDING = 1e-12  # rounding error of an energy, as a share of the energy given


class ServoView(View):
    """Plots of the effort over the turn and over the speed, and a table of its figures."""

    stages = ("dynamics",)
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.pins = Pins.of(session)
        self.pins.changed.connect(self.invalidate)
        self.torque, self.force, self.field = CursorPlot(""), CursorPlot(""), XYPlot("", "")
        self.table = RowsTable(SERVO_HEADINGS)
        plots, splitter = QSplitter(Qt.Orientation.Horizontal), QSplitter(Qt.Orientation.Vertical)
        turn = QSplitter(Qt.Orientation.Vertical)
        for plot in (self.torque, self.force):
            plot.setToolTip("Click or drag to set the cam angle")
            plot.moved.connect(self._turn)
            turn.addWidget(plot)
        plots.addWidget(turn)
        plots.addWidget(self.field)
        plots.setSizes([3000, 2000])
        splitter.addWidget(plots)
        splitter.addWidget(self.table)
        splitter.setSizes([3000, 2000])
        self.set_column(splitter, grows=splitter)

    def refresh(self, study: Study) -> None:
        if not has_servo(study.design):
            raise Unavailable(NO_SERVO)
        study.require_load()
        efforts, turn = drive_efforts(study), servo_turn(study)
        over_turn, front = torque_figure(study, efforts).plots, self.pins.front
        self.force.setVisible(len(over_turn) > 1)
        pinned, name = self._pinned_plots(), "" if front is None else front.name
        plots = [*zip((self.torque, self.force), over_turn, strict=False), (self.field, field_plot(study, turn.rms))]
        for widget, plot in plots:
            widget.show_plot(plot, pinned.get((plot.across, plot.upwards)), name)
        self.table.show_rows(_rows(study, efforts, turn))

    def _pinned_plots(self) -> dict[tuple[str, str], Plot]:
        """The same plots of the pinned variant, by the titles of their axes; none where it has no servo."""
        study = self.pins.study
        with suppress(KindynaError):
            if study is not None and has_servo(study.design):
                field = field_plot(study, servo_turn(study).rms)
                return {(p.across, p.upwards): p for p in (*torque_figure(study, drive_efforts(study)).plots, field)}
        return {}

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


def _rows(study: Study, efforts: tuple[DriveEffort, ...], turn: ServoTurn) -> list[TableRow]:
    """Rows of the efforts, of the segments of the servo's motion, and of the inertia ratio."""
    rows = []
    for effort in efforts:
        tip = RECOVERED if effort.drive != SERVO or servo_part(study).regenerates else DISSIPATED
        cells = f"{effort.label}, {effort.unit}", *map(digits, (effort.rms, effort.peak)), digits(effort.peak_deg, 4)
        energies = _energies(effort.given, effort.braked)
        rows.append(TableRow((*cells, digits(effort.peak_power), *energies), tip=tip))
    segments = study.program.motion.segments
    for part in turn.parts:
        name = f"Servo, segment {part.segment + 1} ({segments[part.segment].curve.law})"
        rows.append(TableRow((name, "", "", "", "", *_energies(part.given, part.braked))))
    ratio = "unknown" if turn.inertia_ratio is None else digits(turn.inertia_ratio)
    tip = "largest inertia of the load at the motor, divided by that of the rotor (servo.rotor_inertia_kg_m2)"
    return [*rows, TableRow(("Inertia ratio", ratio, *([""] * 6)), tip=tip)]


# -- speeds view -----------------------------------------------------------------------------------------

SPEED = "Machine speed, rpm"
LEAST, MOST, COUNT = 0.25, 2.0, 36  # lowest and highest speed, as a multiple of the design's; number of speeds
POLL_MS = 25


def speed_text(curves: AgainstSpeed, rpm: float, allowed: float) -> str:
    """Peak torque at the machine's speed, and the speeds at which the fluctuation is allowed, as a sentence."""
    peak = float(np.interp(rpm, curves.rpm, curves.peak))
    unit = readable(TORQUE, abs(peak))
    torque = f"{short(rpm)} rpm: peak torque {with_unit(short(peak / unit.size), unit.symbol)}"
    reached = np.where(np.isfinite(curves.fluctuation), curves.fluctuation, np.inf)
    if not np.isfinite(reached).any():
        return f"{torque}; the motor stalls at all these speeds."
    fits = curves.rpm[reached <= allowed]
    percent = f"{short(100.0 * allowed)} %"
    if not fits.size:
        return f"{torque}; the speed varies by more than {percent} at all these speeds."
    first = f"from {short(fits[0], 3)} rpm on" if fits[0] > curves.rpm[0] else ""
    last = f"up to {short(fits[-1], 3)} rpm" if fits[-1] < curves.rpm[-1] else ""
    where = " and ".join(filter(None, (first, last))) or "at all these speeds"
    return f"{torque}; the speed varies by at most {percent} {where}."


class AgainstSpeedView(BackgroundView):
    """Plots of torque and speed fluctuation over the machine speed, calculated in the background."""

    is_design_wide = True
    stages = ("dynamics",)
    pause_ms = 250

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player, POLL_MS)
        self.curves: AgainstSpeed | None = None
        self.pinned: AgainstSpeed | None = None  # curves of the pinned variant
        self.pins = Pins.of(session)
        self.pins.changed.connect(self.invalidate)
        self.answer = answer_label()
        self.torque, self.fluctuation = XYPlot(SPEED, ""), XYPlot(SPEED, "")
        self.bar = described(QProgressBar(minimum=0, maximum=0, textVisible=False), name="Computing")
        self.bar.setFixedHeight(6)
        self.bar.hide()
        splitter = QSplitter(Qt.Orientation.Vertical)
        splitter.addWidget(self.torque)
        splitter.addWidget(self.fluctuation)
        splitter.setSizes([3000, 2000])
        self.set_column(self.answer, splitter, self.bar, grows=splitter)
        self._work.result.connect(self._show_result)

    def refresh(self, study: Study) -> None:
        design = self.session.full_design
        rpm = turned_shaft(self.session.full_study, NO_WHEEL).speed_rpm * np.linspace(LEAST, MOST, COUNT)
        self.curves = self.pinned = None
        self.bar.show()
        jobs = [("", partial(at_speeds, design, rpm))]
        pinned, front = self.pins.full_study, self.pins.front
        with suppress(KindynaError):  # the variant has no shaft that turns
            if pinned is not None and front is not None and turned_shaft(pinned, NO_WHEEL):
                jobs.append((front.name, partial(at_speeds, front.design, rpm)))
        self._work.start(jobs)

    def _show_result(self, variant: str, result: AgainstSpeed | KindynaError | Cancelled) -> None:
        """Show the result of the current design, or of the pinned variant with this name."""
        self.bar.hide()
        if isinstance(result, AgainstSpeed):
            if variant:
                self.pinned = result
            else:
                self.curves = result
            if self.curves is not None:
                self._draw(self.curves, self.pinned, variant)
        elif isinstance(result, KindynaError) and not variant:
            for plot in (self.torque, self.fluctuation):
                plot.show_message("")
            self.torque.show_message(reason(self.session.full_design, result))

    def _draw(self, curves: AgainstSpeed, pinned: AgainstSpeed | None, variant: str) -> None:
        shaft = self.session.full_design.camshaft
        self.answer.setText(speed_text(curves, shaft.speed_rpm, shaft.speed_fluctuation))
        present = ((shaft.speed_rpm, "now"),)
        lines = _torque_lines(curves)
        lines += reference_lines(_torque_lines(pinned), variant) if pinned is not None else []
        display_unit = readable("N·m", max(float(np.nanmax(np.abs(line.y), initial=0.0)) for line in lines))
        self.torque.name_axes(SPEED, f"Torque, {display_unit.symbol}")
        self.torque.show_lines([replace(line, y=line.y / display_unit.size) for line in lines], present)
        if np.isfinite(curves.fluctuation).any():
            self.fluctuation.name_axes(SPEED, "Fluctuation, %")
            allowed = 100.0 * shaft.speed_fluctuation
            ends = Line(curves.rpm[[0, -1]], np.full(2, allowed), SCREEN.limit, "allowed")
            others = reference_lines(_fluctuation_lines(pinned), variant) if pinned is not None else []
            self.fluctuation.show_lines(
                [*_fluctuation_lines(curves), ends, *others],
                present,
                note="the motor stalls" if np.isnan(curves.fluctuation).any() else "",
            )
        else:
            self.fluctuation.show_message("The motor stalls at all these speeds.")

    def _stop_work(self) -> None:
        super()._stop_work()
        self.bar.hide()


def _torque_lines(curves: AgainstSpeed) -> list[Line]:
    """Curves of the torque over the speed [N m]; that of the motor where it differs."""
    rows = [("Peak", curves.peak, VERMILION), ("RMS", curves.rms, BLUE), ("Mean", curves.mean, GREEN)]
    has_motor_curve = bool(np.any(curves.motor_peak != curves.peak))
    rows += [("Motor peak", curves.motor_peak, SCREEN.ink)] if has_motor_curve else []
    return [Line(curves.rpm, y, colour, name) for name, y, colour in rows]


def _fluctuation_lines(curves: AgainstSpeed) -> list[Line]:
    """Curve of the speed fluctuation [%]; none where the motor stalls at all speeds."""
    if not np.isfinite(curves.fluctuation).any():
        return []
    return [Line(curves.rpm, 100.0 * curves.fluctuation, SCREEN.family("speed"), "reached")]


# -- torque view -----------------------------------------------------------------------------------------

LATER_MS = 150  # pause in editing before the slow results: motor, true speed, figures
TORQUE = "N·m"
FIGURE_HEADINGS = (
    TableHeading("Torque", unit=TORQUE), TableHeading("Mean", number=True), TableHeading("RMS", number=True),
    TableHeading("Peak", number=True), TableHeading("at °", number=True, spare=2), TableHeading("Peak power", number=True, spare=1),
)  # fmt: skip
SHAFT, CAMS, MOTOR = "Shaft", "Without balance cam", "Motor"
RPM = UNITS["rpm"].factor


def show_turn(plot: CursorPlot, title: str, unit: str, lines: Sequence[Line], fit: bool = False) -> None:
    """Plot curves over the machine angle, the first one underneath.

    ``lines``: x [deg] without the end of the turn, y and band in ``unit``. ``fit``: the axis need not include zero.
    """
    display_unit = readable(unit, max((float(np.abs(line.y).max(initial=0.0)) for line in lines), default=0.0))
    plot.name_axes(MACHINE_ANGLE, f"{title}, {display_unit.symbol}")
    closed = [
        replace(
            line,
            x=np.append(line.x, 360.0),
            y=np.append(line.y, line.y[0]) / display_unit.size,
            band=None if line.band is None else (line.band[0], line.band[1] / display_unit.size),
        )
        for line in lines
    ]
    plot.show_lines(closed, fit=fit, display_unit=display_unit)


def band_in(bands: Band, name: str, unit: float = 1.0) -> tuple[np.ndarray, np.ndarray] | None:
    """Return machine angles [deg] and percentiles in a unit; None where the band is unknown.

    ``name``: of a drive, empty for the shaft, or of a quantity of the motor.
    """
    return closed_band(bands[name] / unit) if name in bands else None


class _TurnView(View):
    """Plots over the machine angle for all drives; slow results follow once editing pauses."""

    is_design_wide = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self._read_timer = single_shot(self, self._show_later, LATER_MS)
        self.bands, self.pins = Bands.of(session), Pins.of(session)
        for others in (self.bands, self.pins):
            others.changed.connect(self.invalidate)

    def _lay_out(self, count: int, *more: QWidget) -> None:
        """Lay out a number of plots with common angles, and other widgets below them."""
        self.plots = tuple(CursorPlot(MACHINE_ANGLE) for _ in range(count))
        self.note = Note(SCREEN.quiet, margin=3)
        self.splitter = splitter = QSplitter(Qt.Orientation.Vertical, childrenCollapsible=False)
        for number, plot in enumerate(self.plots, 1):
            plot.setToolTip(MACHINE_TIP)
            plot.show_numbers(number == count)
            plot.moved.connect(self._turn)
            splitter.addWidget(plot)
        for part in more:
            splitter.addWidget(part)
        splitter.setSizes([*([1000] * (count - 1)), 1300, *(1000 for _ in more)])
        self.set_column(splitter, self.note, grows=splitter)

    def refresh(self, study: Study) -> None:
        require_list(self.session.full_design, ONE_DRIVE_TORQUE)
        self.draw(self.session.shaft)
        self._read_timer.start()

    def draw(self, shaft: Camshaft[Study]) -> None:
        """Draw the fast results, after each edit."""

    def draw_later(self, shaft: Camshaft[Study]) -> None:
        """Draw the slow results, once editing pauses."""

    def _show_later(self) -> None:
        self._read_timer.stop()
        if self.up_to_date and not self.in_trouble:  # else a refresh follows, of a design that may have no mechanism
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
    """Torque of each drive, and below it the torque of the shaft, without the balance cam, and of the motor."""

    stages = ("dynamics",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self._lay_out(2)
        self.drives, self.sums = self.plots

    def draw(self, shaft: Camshaft[Study]) -> None:
        chosen = self.session.names[self.session.chosen]
        bands = self.bands.of_shaft()
        curves = [
            replace(line, read=line.label == chosen, band=band_in(bands, line.label)) for line in _drive_torques(shaft)
        ]
        x, lacking = shaft.angle_degrees, ""
        try:
            if shaft.design.balancer is not None:
                curves.append(Line(x, shaft.balancer_torque, BALANCE, BALANCE_CAM, read=chosen == BALANCE_CAM))
            self._draw_sums(shaft)
        except NoSolution as error:
            lacking = reason(shaft.design, error)
            self.sums.show_message("")
        self.note.show_message(lacking)
        if curves:
            show_turn(self.drives, "Drives", "N·m", [*self.pins.shaft_lines(_drive_torques), *curves])
        else:
            self.drives.show_message("No drive loads the shaft.")

    def _draw_sums(self, shaft: Camshaft[Study], *motor: Line) -> None:
        x, balanced = shaft.angle_degrees, shaft.design.balancer is not None
        cams = [Line(x, shaft.cams_torque, SCREEN.quiet, CAMS)] if balanced else []
        total = Line(x, shaft.torque, SCREEN.ink, SHAFT, read=True, band=band_in(self.bands.of_shaft(), ""))
        pinned = self.pins.shaft_lines(lambda shaft: [Line(shaft.angle_degrees, shaft.torque, SCREEN.ink)])
        if motor:
            pinned += self.pins.shaft_lines(_motor_torque)
        show_turn(self.sums, "Shaft", "N·m", [*pinned, *cams, total, *motor])

    def draw_later(self, shaft: Camshaft[Study]) -> None:
        if not shaft.levels_torque:
            return
        try:
            band = band_in(self.bands.of_motor(), "motor_torque")
            self._draw_sums(shaft, *(replace(line, read=True, band=band) for line in _motor_torque(shaft)))
        except NoSolution as error:
            self.note.show_message(reason(shaft.design, error))


def _drive_torques(shaft: Camshaft[Study]) -> list[Line]:
    x, names = shaft.angle_degrees, [name for name in shaft.loading_drives if name not in shaft.failures]
    return [Line(x, shaft.drive_torque(name), SCREEN.drive(shaft.drive_number(name)), name) for name in names]


def _motor_torque(shaft: Camshaft[Study]) -> list[Line]:
    if not shaft.levels_torque:
        return []
    return [Line(shaft.angle_degrees, shaft.motor_torque, SCREEN.family("torque"), MOTOR)]


def _speed(shaft: Camshaft[Study]) -> list[Line]:
    return [Line(shaft.angle_degrees, shaft.speed / RPM, SCREEN.family("speed"))] if shaft.levels_torque else []


class ShaftFiguresView(_TurnView):
    """Table of mean, RMS, peak and peak power of each torque, and the true speed where there is a flywheel."""

    stages = ("dynamics",)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(FIGURE_HEADINGS)
        self.offer_explanation(self.table)
        self._lay_out(1, self.table)
        (self.speed,) = self.plots
        self._has_speed = False
        self._show_speed_if_roomy()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._show_speed_if_roomy()

    def _show_speed_if_roomy(self) -> None:
        """Show the plot of the speed where it leaves room for the rows of the table."""
        table = self.table.height_of(self.table.rows.rowCount())
        above = self.height() - table - self.splitter.handleWidth()
        self.speed.setVisible(self._has_speed and above >= self.speed.minimumSizeHint().height())
        self.splitter.setSizes([above, table])

    def selected_number(self) -> ExplainableNumber | None:
        return self.table.number

    def draw(self, shaft: Camshaft[Study]) -> None:
        if not self.table.rows.rows:
            self.draw_later(shaft)

    def draw_later(self, shaft: Camshaft[Study]) -> None:
        self._has_speed = shaft.levels_torque
        try:
            if shaft.levels_torque:
                band = band_in(self.bands.of_motor(), "camshaft_speed", RPM)
                speed = [replace(line, read=True, band=band) for line in _speed(shaft)]
                show_turn(self.speed, "Speed", "rpm", [*self.pins.shaft_lines(_speed), *speed], fit=True)
        except NoSolution as error:
            self.speed.show_message(reason(shaft.design, error))
        self.table.show_rows(figures(shaft))
        self._show_speed_if_roomy()


def figures(shaft: Camshaft[Study]) -> list[TableRow]:
    """Rows with mean, RMS, peak, its machine angle and peak power for each drive, for the shaft and for the motor."""
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
            extremes = shaft.motor_range
            ends = extremes["motor_torque"]
            peak = max((ends.low, ends.high), key=lambda end: abs(end.value))
            power = measure(*_readable("W", extremes["motor_power"].high.value))
            cells = (MOTOR, _torque(shaft.mean_torque), "", _torque(peak.value), _angle(peak.theta), power)
            rows.append(TableRow(cells, swatch(SCREEN.family("torque")), "with the flywheel, at the true speed"))
    except NoSolution as error:
        rows.append(TableRow((reason(shaft.design, error), "", "", "", "", ""), across=0))
    return rows


def _row(name: str, load: LoadCurve, omega: float, colour: str, column: str = "") -> TableRow:
    """``column``: the column of the torque, to explain its peak."""
    ends = peaks(load)
    peak = max((ends.low, ends.high), key=lambda end: abs(end.value))
    power = measure(*_readable("W", ends.high.value * omega))
    mean = load.mean if abs(load.mean) > ROUNDING * abs(peak.value) else 0.0
    cells = name, _torque(mean), _torque(rms(load)), _torque(peak.value), _angle(peak.theta), power
    return TableRow(cells, swatch(colour), number=ExplainableNumber(column, peak.theta) if column else None)


def _readable(symbol: str, value: float) -> tuple[float, str]:
    display_unit = readable(symbol, abs(value))
    return value / display_unit.size, display_unit.symbol


def _torque(value: float) -> str:
    return digits(value / size_of(TORQUE))


def _angle(theta: float) -> str:
    return digits(math.degrees(theta) % 360.0, 4)
