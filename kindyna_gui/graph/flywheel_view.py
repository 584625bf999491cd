"""Docks Flywheel, Contact over speed (force map, lift-off) and Vibration of an elastic follower."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSplitter

from core.design import UNITS, Design, is_assumed, require_motion
from core.dynamics import ContactMap, Flight, Flights
from core.elastic import ResidualVibration, Spectrum
from core.errors import KindynaError
from core.frozen import frozen
from core.number_text import COMPARED_DIGITS, RESULT_DIGITS, rounded_up
from core.output.drawing.palette import BLUE, VERMILION
from core.output.drawing.scales import DisplayUnit
from core.output.drawing.turn import ROUNDING, torque_size
from core.output.subject_files import (
    SPECTRUM_SPEEDS,
    contact_force_map,
    lift_off_lines,
    spectrum_speeds,
    vibration_units,
)
from core.shaft import Flywheel, has_flywheel
from core.study import Camshaft, Study, extremes_of, quantities_of
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import reason, step_text
from kindyna_gui.look import answer_label, row_with_text
from kindyna_gui.pictures.plots.xy import (
    ACROSS,
    ROWS,
    CursorPlot,
    Line,
    XYPlot,
    reference_lines,
    show_map,
    zero_lines,
)
from kindyna_gui.pictures.units import brief, digits, measure, number, readable, short, typed, with_unit
from kindyna_gui.player import Player
from kindyna_gui.requirements import (
    NO_ELASTIC,
    NO_FLIGHT,
    NO_WHEEL,
    RIGID_FOLLOWER,
    RIGID_IN_SPACE,
    Unavailable,
    turned_shaft,
)
from kindyna_gui.settings import size_of, symbol_of
from kindyna_gui.view import BackgroundView, ExplainableNumber, View

FLYWHEEL_HEADINGS = (
    TableHeading("Flywheel and torque", wide=True),
    TableHeading("Value", number=True),
    TableHeading("Unit"),
)
_PEAKS = {
    "drive_torque": "Cam torque",
    "driver_torque": "Driver torque",
    "motor_torque": "Motor torque, with the flywheel fitted",
}


FIELD, SLOPE = "shaft.flywheel_inertia_kg_m2", "shaft.motor_slope_nm_s_per_rad"

FORM_CLOSED = "A groove, a rib or a conjugate pair guides the follower on both sides: it cannot leave its cam."
MAP, FLIGHT = "map", "flight"
CONTACT_PAGES = {MAP: "Force over speed", FLIGHT: "Flight after lift-off"}
ANGLES, SPEEDS = 361, 80
CONTACT_PAGE_WIDTH = 150  # pixels
MOST_TURNS = 3
POINTS = 361  # of the motion, in each turn

NO_DWELL = "The motion has no dwell in which the follower could come to rest."
SPEED = "Machine speed, rpm"
FROM_REST, STEADY, ACCELERATION = "from_rest", "steady", "acceleration"
VIBRATION_PAGES = {FROM_REST: "Residual, from rest", STEADY: "Residual, steady", ACCELERATION: "Largest acceleration"}
TIPS = {
    FROM_REST: "Residual vibration in a dwell, if the follower was at rest in the dwell before",
    STEADY: "Residual vibration in a dwell after many turns, with the vibration of earlier strokes",
    ACCELERATION: "Largest acceleration of the elastic follower over the turn; for an arm that of the roller's centre",
}
VIBRATION_PAGE_WIDTH = 160  # pixels
VIBRATION_HEADINGS = (
    TableHeading("Dwell", wide=True), TableHeading("From rest", number=True), TableHeading("", number=True),
    TableHeading("Steady", number=True), TableHeading("", number=True),
)  # fmt: skip
TABLE_HEIGHT = 300  # pixels of height of the dock, from which on the table is shown
RPM = UNITS["rpm"].factor
RANGE_FACTOR = 2.5  # end of the axis over the greatest value up to the design's speed; higher values are cut off
WAIT_S = 30.0

# -- flywheel --------------------------------------------------------------------------------------------


def flywheel_text(wheel: Flywheel, needed: float, allowed: str) -> str:
    """Whether the flywheel suffices, and the inertia that does, as a sentence.

    needed : least inertia that keeps the speed within the allowed fluctuation [kg m²], 0 where it needs none
    """
    if not needed:
        return f"No flywheel is needed: the speed stays within {allowed} without one."
    keeps = f"{_inertia(needed, COMPARED_DIGITS)} keep the speed within {allowed}"
    if not has_flywheel(wheel.shaft):
        return f"No flywheel, and the speed is taken as constant: {keeps}."
    own = _inertia(wheel.shaft.flywheel_inertia_kg_m2, COMPARED_DIGITS)
    if not wheel.runs:
        return f"The motor stalls with {own}: {_inertia(wheel.least_inertia)} prevent it, {keeps}."
    state = f"With {own} the speed varies by {digits(100.0 * wheel.fluctuation)} %, {allowed} are allowed"
    if wheel.fluctuation <= wheel.shaft.speed_fluctuation:
        return f"{state}: the flywheel suffices, the least is {_inertia(needed, COMPARED_DIGITS)}."
    return f"{state}: too much, {keeps}."


def _inertia(value: float, most: int = RESULT_DIGITS) -> str:
    return brief(value, "kg·m²", most)


def _shaft_peaks(shaft: Camshaft[Study], floor: float) -> list[TableRow]:
    """Rows of the extremes of the shaft's total torque, and of the motor's torque."""
    torques = {("Shaft torque", "torque_nm"): shaft.peaks}
    if shaft.levels_torque and shaft.flywheel.runs:
        torques[_PEAKS["motor_torque"], ""] = shaft.motor_range["motor_torque"]
    return [
        _row(f"{label}, {end}", peak.value, "N·m", floor=floor, name=name, theta=peak.theta)
        for (label, name), extremes in torques.items()
        for end, peak in (("lowest", extremes.low), ("highest", extremes.high))
    ]


def _row(
    label: str,
    value: float,
    symbol: str,
    tip: str = "",
    floor: float = 0.0,
    name: str = "",
    theta: float | None = None,
    most: int = RESULT_DIGITS,
) -> TableRow:
    """Row of a value. floor: smaller values are rounding errors of 0; name: column or figure to explain, at theta [rad]."""
    value = 0.0 if abs(value) <= floor else value
    display_unit = readable(symbol, abs(value))
    number = ExplainableNumber(name, theta) if name else None
    return TableRow((label, digits(value / display_unit.size, most), display_unit.symbol), tip=tip, number=number)


def _input_row(label: str, value: float, symbol: str, tip: str = "") -> TableRow:
    return TableRow((label, typed(value / size_of(symbol)), symbol_of(symbol)), tip=tip)


class FlywheelView(View):
    """Table of the flywheel's figures, and the button that sets the required inertia."""

    is_design_wide = True
    stages = ("dynamics",)
    pause_ms = 200

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.answer = answer_label()
        self.table = RowsTable(FLYWHEEL_HEADINGS)
        self.offer_explanation(self.table)
        self.use_button = QPushButton("Use this flywheel")
        self.use_button.clicked.connect(self._use)
        self._needed = 0.0
        row = QHBoxLayout()
        row.setContentsMargins(6, 4, 6, 4)
        row.addWidget(self.use_button)
        row.addStretch(1)
        self.set_column(self.answer, self.table, row, grows=self.table)

    def selected_number(self) -> ExplainableNumber | None:
        return self.table.number

    def refresh(self, study: Study) -> None:
        self._needed = 0.0
        self.use_button.setEnabled(False)
        full_study = self.session.full_study
        shaft = turned_shaft(full_study, NO_WHEEL)
        wheel = full_study.flywheel
        slope = _input_row(
            "Motor slope, assumed",
            shaft.motor_slope_nm_s_per_rad,
            "N·m·s/rad",
            "Assumed; the flywheel size depends on it",
        )
        floor = ROUNDING * max(torque_size(drive) for drive in full_study.drives.values())
        inertia_floor = floor / (shaft.speed_fluctuation * study.omega**2)
        self._needed = (
            rounded_up(wheel.needed_inertia, COMPARED_DIGITS) if wheel.estimated_inertia > inertia_floor else 0.0
        )
        allowed = f"{short(100 * shaft.speed_fluctuation)} %"
        percent = f"{allowed} fluctuation of speed"
        self.use_button.setEnabled(self._needed not in (0.0, shaft.flywheel_inertia_kg_m2))
        self.use_button.setToolTip(
            f"Set the inertia to {_inertia(self._needed, COMPARED_DIGITS)}, required for {percent}"
        )
        self.answer.setText(flywheel_text(wheel, self._needed, allowed))
        swing_tip = "Largest surplus of energy that the flywheel stores"
        inertia_tip = "Least inertia whose calculated speed, with the motor's slope, fluctuates no more than this"
        self.table.show_rows(
            [
                _row("Mean torque", wheel.mean_torque, "N·m", floor=floor, name="mean_torque_nm"),
                _row("Energy swing", wheel.energy_swing, "J", swing_tip, floor, "energy_swing_j"),
                _row(
                    f"Inertia for {percent}",
                    self._needed,
                    "kg·m²",
                    inertia_tip,
                    name="needed_inertia_kg_m2",
                    most=COMPARED_DIGITS,
                ),
                _row(
                    "Estimate from the energy",
                    wheel.estimated_inertia,
                    "kg·m²",
                    "Energy swing/(fluctuation × speed²)",
                    inertia_floor,
                    "estimated_inertia_kg_m2",
                ),
                *([slope] if is_assumed(full_study.design, SLOPE) else []),
                _input_row("Inertia of this design", shaft.flywheel_inertia_kg_m2, "kg·m²"),
                *self._speed_rows(wheel),
                *(
                    _shaft_peaks(self.session.shaft, floor)
                    if self.session.has_several_drives
                    else self._peaks(study, floor)
                ),
            ]
        )

    def _speed_rows(self, wheel: Flywheel) -> list[TableRow]:
        """Rows of the speed with the flywheel of the design."""
        if not has_flywheel(wheel.shaft):
            return [TableRow(("Speed assumed constant", "", ""), tip="The design has no flywheel")]
        if not wheel.runs:
            tip = "The motor stops with this flywheel: enlarge the flywheel, or the motor's slope"
            least = _row("Least inertia that prevents it", wheel.least_inertia, "kg·m²", tip)
            return [TableRow(("The motor stalls", "", ""), tip=tip), least]
        low, high = (speed / UNITS["rpm"].factor for speed in wheel.speed_range)
        return [
            TableRow(
                ("Speed fluctuation", digits(100.0 * wheel.fluctuation), "%"),
                tip="(highest − lowest)/mean",
                number=ExplainableNumber("fluctuation"),
            ),
            _row("Speed, lowest", low, "rpm", name="min_speed_rpm"),
            _row("Speed, highest", high, "rpm", name="max_speed_rpm"),
        ]

    def _peaks(self, study: Study, floor: float) -> list[TableRow]:
        known = quantities_of(study, "dynamics")
        names = [name for name in _PEAKS if name in known and known[name].exists(study)]
        if (
            "drive_torque" in names and "driver_torque" in names
        ):  # the shaft turns the cam; the driver's torque is not that of the shaft
            names.remove("driver_torque")
        extremes = extremes_of(study, "dynamics", tuple(names))
        return [
            _row(f"{_PEAKS[name]}, {end}", peak.value, "N·m", floor=floor, name=known[name].slug, theta=peak.theta)
            for name in names
            for end, peak in (("lowest", extremes[name].low), ("highest", extremes[name].high))
        ]

    def _use(self) -> None:
        """Set the required inertia of the current design, as one step of undo."""
        self.pull()
        if self._needed and self.use_button.isEnabled():
            self.session.edit(FIELD, self._needed, step_text("Flywheel inertia", self._needed, UNITS["kg_m2"]))
            self.session.end_gesture()


# -- contact over speed ----------------------------------------------------------------------------------


class PagedView(BackgroundView):
    """A view that draws the selected one of several pages, computed in the background, with a text next to the choice.

    Parameters
    ----------
    name : accessible name of the choice
    pages : name and text of each page
    width : least width of the choice [pixels]
    """

    def __init__(
        self, session: Session, player: Player, name: str, pages: Mapping[str, str], width: int, plot: XYPlot
    ) -> None:
        super().__init__(session, player)
        self.pins = Pins.of(session)
        self.pins.changed.connect(self.invalidate)
        self.page, self.text, self.plot = WordBox(), QLabel(wordWrap=True), plot
        self.page.setAccessibleName(name)
        fill_choices(self.page, pages)
        self.page.setMinimumWidth(width)
        self._reference: tuple[Design, Any, str] | None = None  # result of the pinned variant, and its name
        self._work.result.connect(self._receive)
        self.page.activated.connect(self._choose)

    def _choose(self, _: int) -> None:
        self._stale = True
        self.pull()

    def _start(self, study: Study, compute: Callable[[Design, str], Any]) -> None:
        """Compute the selected page, a function of the design and the page, for the pinned variant first."""
        page, pinned, designs = str(self.page.currentData()), self.pins.study, []
        if pinned is not None and pinned.design != study.design:
            with suppress(KindynaError):
                self._require(pinned)
                designs.append(pinned.design)
        self._reference = None
        self._work.start([((page, design), partial(compute, design, page)) for design in (*designs, study.design)])

    def _receive(self, key: tuple[str, Design], result: Any) -> None:
        """Show a result together with that of the pinned variant; a variant without one has no curve."""
        if key[1] == self.session.study.design:
            self._show_result(key, result)
        elif not isinstance(result, KindynaError) and self.pins.front is not None:
            self._reference = (key[1], result, self.pins.front.name)

    def _require(self, study: Study) -> None:
        """Raise the reason why a design has nothing for the pages."""
        raise NotImplementedError

    def _show_result(self, key: tuple[str, Design], result: Any) -> None:
        """Show the result for a page and a design, or the reason for a missing one."""
        raise NotImplementedError

    def settle(self) -> None:
        super().settle()
        self._work.wait(WAIT_S)


class ContactView(PagedView):
    """Contact force over angle and speed, or the flight after lift-off."""

    stages = ("linkage", "cam", "dynamics")
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player, "Plot", CONTACT_PAGES, CONTACT_PAGE_WIDTH, XYPlot(ACROSS, ""))
        self.set_column(row_with_text(self.page, self.text), self.plot, grows=self.plot)

    def _require(self, study: Study) -> None:
        if study.design.drive.cam is None:
            raise Unavailable(NO_FLIGHT)
        if study.is_form_closed:
            raise Unavailable(FORM_CLOSED)
        study.contact_force  # noqa: B018 - raises the reason if there is none

    def refresh(self, study: Study) -> None:
        self._require(study)
        self._start(study, lambda design, page: _COMPUTATIONS[page](design))

    def _choose(self, page: int) -> None:
        self.plot.show_message("")
        super()._choose(page)

    def _show_result(self, key: tuple[str, Design], result: Any) -> None:
        _, design = key
        if isinstance(result, KindynaError):
            self.text.setText("")
            self.plot.show_message(reason(design, result))
            return
        lines, data = result
        self.text.setText(" ".join(lines))
        if isinstance(data, ContactMap):
            show_map(self.plot, data, design.speed_rpm, self._pinned(lambda _, pinned: zero_lines(pinned)))
        elif isinstance(data, Flights):
            self._show_flights(design, data.flights)

    def _pinned(self, draw: Callable[[Design, Any], Sequence[Line]]) -> list[Line]:
        """Curves of the pinned variant, drawn from its design and the result of its page."""
        if self._reference is None:
            return []
        design, (_, data), name = self._reference
        return reference_lines(draw(design, data), name)

    def _show_flights(self, design: Design, flights: Sequence[Flight]) -> None:
        """Draw the displacement of the follower during its flights together with the motion."""
        if not flights:
            self.plot.show_message(f"At {short(design.speed_rpm, 6)} rpm the follower stays on the cam.")
            return
        lines = _flight_lines(design, flights)
        first, last = flights[0], lines[0].x[-1]
        marks = [(math.degrees(first.lift), "off")]
        if math.degrees(first.land) < last:
            marks.append((math.degrees(first.land), "on"))
        self.plot.name_axes(ACROSS, f"Displacement, {UNITS[require_motion(design).unit].symbol}")
        pinned = self._pinned(lambda other, data: _flight_lines(other, data.flights))
        self.plot.show_lines([*lines, *pinned], tuple(marks))


def _flight_lines(design: Design, flights: Sequence[Flight]) -> list[Line]:
    """The motion, and the displacement of the follower during its flights, over the turns that they last."""
    if not flights:
        return []
    study, unit = Study(design), UNITS[require_motion(design).unit]
    last = max(flight.theta[-1] for flight in flights)
    turns = min(MOST_TURNS, max(1, math.ceil(last / (2.0 * math.pi))))
    theta = np.linspace(0.0, 2.0 * math.pi * turns, POINTS * turns)
    motion = study.at_theta(np.mod(theta, 2.0 * math.pi)).motion.displacement[0]
    lines = [Line(np.rad2deg(theta), motion / unit.factor, BLUE, "motion")]
    for i, flight in enumerate(flight for flight in flights if flight.lift < theta[-1]):
        inside = flight.theta <= theta[-1]
        x, y = np.rad2deg(flight.theta[inside]), flight.y[inside] / unit.factor
        lines.append(Line(x, y, VERMILION, "" if i else "flight"))
    return lines


def _force_map(design: Design) -> tuple[list[str], ContactMap]:
    study = Study(design)
    return lift_off_lines(study), contact_force_map(study, np.linspace(0.0, 2.0 * math.pi, ANGLES)[:-1], None, SPEEDS)


def _flights(design: Design) -> tuple[list[str], Flights]:
    study = Study(design)
    result = study.flights()
    return _flight_text(study, result), result


def _flight_text(study: Study, result: Flights) -> list[str]:
    """Describe the first flight, and the number of flights."""
    if not result.flights:
        return lift_off_lines(study)
    first, unit = result.flights[0], UNITS[study.program.motion.unit]
    height = with_unit(short(first.height / unit.factor, 4), unit.symbol)
    text = f"Lift-off at {number(math.degrees(first.lift), 2)}°, {height} high"
    if math.isfinite(first.land):
        speed = with_unit(short(first.speed / unit.factor, 4), f"{unit.symbol}/s")
        text += f", impact at {number(math.degrees(first.land), 2)}° with {speed}"
    if not result.steady:
        return [f"{text}; flights do not repeat within three turns."]
    count = len(result.flights) - result.repeats
    period = "per turn" if result.turns == 1 else f"in {result.turns} turns"
    return [f"{text}; {count} flight{'s' if count > 1 else ''} {period}."]


_COMPUTATIONS = {MAP: _force_map, FLIGHT: _flights}


# -- vibration over speed --------------------------------------------------------------------------------


class VibrationView(PagedView):
    """Vibration of an elastic follower over the machine speed, computed in the background while it is visible."""

    plot: CursorPlot

    def __init__(self, session: Session, player: Player) -> None:
        plot = CursorPlot(SPEED, reads=True)
        super().__init__(session, player, "Quantity over speed", VIBRATION_PAGES, VIBRATION_PAGE_WIDTH, plot)
        for i, tip in enumerate(TIPS.values()):
            self.page.setItemData(i, tip, Qt.ItemDataRole.ToolTipRole)
        self.table = RowsTable(VIBRATION_HEADINGS)
        self.table.setMinimumHeight(40)
        self._summary = ""
        self._curves: _SpeedCurves | None = None
        plot.read.connect(self._show_values)
        splitter = QSplitter(Qt.Orientation.Vertical)
        splitter.addWidget(self.plot)
        splitter.addWidget(self.table)
        splitter.setSizes([3000, 1000])
        self.set_column(row_with_text(self.page, self.text), splitter, grows=splitter)

    def _require(self, study: Study) -> None:
        if study.has_surface:
            raise Unavailable(RIGID_IN_SPACE)
        if not study.design.drive.has_disk:
            raise Unavailable(NO_ELASTIC)
        if not study.is_elastic:
            raise Unavailable(RIGID_FOLLOWER)
        study.elasticity  # noqa: B018 - raises the reason if nothing vibrates

    def refresh(self, study: Study) -> None:
        self._require(study)
        self._start(study, _vibration)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Hide the table in a low dock; the names of the curves contain its values, too."""
        super().resizeEvent(event)
        self.table.setVisible(self.height() >= TABLE_HEIGHT)

    def _show_result(
        self, key: tuple[str, Design], result: tuple[tuple[ResidualVibration, ...], Spectrum] | KindynaError
    ) -> None:
        page, design = key
        if isinstance(result, KindynaError):
            self._summary, self._curves = "", None
            self.table.show_rows([])
            self.plot.show_message(reason(design, result))
            self._show_values(None)
            return
        residuals, spectrum = result
        study = Study(design)
        follower = study.elasticity.middle
        periods = short(follower.natural_frequency / abs(study.omega), 4)
        frequency = measure(follower.natural_frequency / math.tau, "Hz")
        damping = short(follower.damping_ratio, 3)
        own = f"Natural frequency {frequency}, {periods} periods a turn, damping ratio {damping}"
        self._summary = f"{_largest_text(study, residuals)}{own}"
        self.table.show_rows([_residual_row(study, residual) for residual in residuals])
        self._draw(study, page, residuals, spectrum)
        self._show_values(self.plot.cursor_at)

    def _draw(self, study: Study, page: str, residuals: tuple[ResidualVibration, ...], spectrum: Spectrum) -> None:
        rpm = spectrum.omega / RPM
        (_, size), *_ = vibration_units(study)
        if page == ACCELERATION:
            names: tuple[str, ...] = ("from rest", "steady")
            title, symbol = "Acceleration", UNITS["mm_s2"].symbol
            current = []
        elif residuals:
            names, title, symbol = tuple(_span(residual) for residual in residuals), "Residual", UNITS["mm"].symbol
            current = [_in_mm(getattr(residual, page) * size) for residual in residuals]
        else:
            self._curves = None
            self.plot.show_message(NO_DWELL)
            return
        values = _page_values(study, page, spectrum)
        finite = np.where(np.isfinite(values), values, np.nan)
        design_rpm = abs(study.omega) / RPM
        below = finite[:, rpm <= design_rpm]
        limit = RANGE_FACTOR * float(np.nanmax(below)) if np.isfinite(below).any() else math.inf
        highest = min(limit, float(np.nanmax(finite, initial=0.0)))
        display_unit = readable(symbol, highest)
        self.plot.name_axes(SPEED, f"{title}, {display_unit.symbol}")
        colours = [ROWS[i % len(ROWS)] for i in range(len(names))]
        labels = [f"{name}: {value}" for name, value in zip(names, current, strict=True)] if current else names
        lines = [
            Line(rpm, y / display_unit.size, colour, label)
            for y, colour, label in zip(finite, colours, labels, strict=True)
        ]
        self.plot.show_lines([*lines, *self._pinned(page, display_unit, colours)], ((design_rpm, "now"),))
        if highest > 0.0:
            self.plot.show_range(upwards=(0.0, 1.05 * (highest / display_unit.size)))
        self._curves = _SpeedCurves(rpm, values, names, display_unit)

    def _pinned(self, page: str, unit: DisplayUnit, colours: Sequence[str]) -> list[Line]:
        """Curves of the pinned variant, in the colours of those of the design."""
        if self._reference is None:
            return []
        design, (_, spectrum), name = self._reference
        values = _page_values(Study(design), page, spectrum)
        rows = zip(np.where(np.isfinite(values), values, np.nan), colours, strict=False)
        return reference_lines((Line(spectrum.omega / RPM, y / unit.size, colour) for y, colour in rows), name)

    def _show_values(self, rpm: float | None) -> None:
        """Show the values at the mouse, or the summary if the mouse is outside the plot."""
        self.text.setText(self._summary if rpm is None or self._curves is None else self._curves.text(rpm))


def _page_values(study: Study, page: str, spectrum: Spectrum) -> np.ndarray:
    """Values (k, n) of a page at n speeds, a row for each curve [mm or mm/s²]."""
    (_, size), *_ = vibration_units(study)
    return size * (
        spectrum.acceleration if page == ACCELERATION else spectrum.residual[(FROM_REST, STEADY).index(page)]
    )


@frozen(eq=False)
class _SpeedCurves:
    """Values of k curves (k, n) over speeds (n,) [rpm], with their names and display unit."""

    rpm: np.ndarray
    values: np.ndarray
    names: tuple[str, ...]
    unit: DisplayUnit

    def text(self, rpm: float) -> str:
        """Return the values at a speed, interpolated linearly."""
        values = [
            f"{name}: {measure(float(np.interp(rpm, self.rpm, row)) / self.unit.size, self.unit.symbol, 3)}"
            for name, row in zip(self.names, self.values, strict=True)
        ]
        return f"{digits(rpm, 4)} rpm, " + ", ".join(values)


def _span(residual: ResidualVibration) -> str:
    return f"{short(math.degrees(residual.dwell.start), 4)}–{short(math.degrees(residual.dwell.end), 4)}°"


def _in_mm(value: float) -> str:
    display_unit = readable("mm", value)
    return measure(value / display_unit.size, display_unit.symbol, 3)


def _largest_text(study: Study, residuals: Sequence[ResidualVibration]) -> str:
    """Largest residual vibration in a dwell at the design's speed; empty without a dwell."""
    if not residuals:
        return ""
    worst = max(residuals, key=lambda residual: residual.steady)
    (_, size), *_ = vibration_units(study)
    rpm = digits(abs(study.omega) / RPM, 4)
    return f"At {rpm} rpm the follower vibrates by {_in_mm(worst.steady * size)} in the dwell {_span(worst)}. "


def _residual_row(study: Study, residual: ResidualVibration) -> TableRow:
    """Row of both amplitudes, in mm, and in degrees for a rotating follower."""
    (_, size), *angles = vibration_units(study)
    cells = [_span(residual)]
    for value in (residual.from_rest, residual.steady):
        cells.append(_in_mm(value * size))
        cells.append(measure(value * angles[0][1], "°", 3) if angles else "")
    tip = "Amplitude of the follower's error z − s about its position at rest, at the start of the dwell"
    return TableRow(tuple(cells), tip=tip)


def _vibration(design: Design, page: str) -> tuple[tuple[ResidualVibration, ...], Spectrum]:
    study = Study(design)
    return study.follower_response.residuals, study.vibration(
        spectrum_speeds(study, count=SPECTRUM_SPEEDS), page == ACCELERATION
    )
