"""Flywheel, vibration."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSplitter

from core.design import UNITS, Design, is_assumed, require_motion
from core.dynamics import ContactMap, Flights
from core.elastic import ResidualVibration, Spectrum
from core.errors import KindynaError
from core.output.subject_files import (
    SPECTRUM_SPEEDS,
    contact_force_map,
    lift_off_lines,
    spectrum_speeds,
    vibration_units,
)
from core.shaft import Flywheel, has_flywheel, rounded_up
from core.study import Camshaft, Study, extremes_of, quantities_of
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import reason, step_text
from kindyna_gui.look import beside
from kindyna_gui.pictures.plots.xy import ACROSS, ROWS, CursorPlot, Line, XYPlot, show_map
from kindyna_gui.pictures.style import BLUE, DASHED, ROUNDING, VERMILION, torque_size
from kindyna_gui.pictures.units import DisplayUnit, digits, measure, readable, short, with_unit
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_ELASTIC, NO_FLIGHT, NO_WHEEL, RIGID_FOLLOWER, Unavailable, turned_shaft
from kindyna_gui.view import BackgroundView, ExplainableNumber, View

# -- flywheel view ---------------------------------------------------------------------------------------

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


def _whole_peaks(shaft: Camshaft[Study], floor: float) -> list[TableRow]:
    """Those of all drives together, and of the motor."""
    found = {("Shaft torque", "torque_nm"): shaft.peaks}
    if shaft.levels_torque and shaft.flywheel.runs:
        found[_PEAKS["motor_torque"], ""] = shaft.motor_range["motor_torque"]
    return [
        _row(f"{label}, {end}", at.value, "N·m", floor=floor, name=name, theta=at.theta)
        for (label, name), ends in found.items()
        for end, at in (("lowest", ends.low), ("highest", ends.high))
    ]


def _row(
    label: str, value: float, symbol: str, tip: str = "", floor: float = 0.0, name: str = "", theta: float | None = None
) -> TableRow:
    """floor: size below which the value is what rounding leaves of a zero; name: its column or figure, at theta where that has one."""
    value = 0.0 if abs(value) <= floor else value
    rung = readable(symbol, abs(value))
    number = ExplainableNumber(name, theta) if name else None
    return TableRow((label, digits(value / rung.size, 5), rung.symbol), tip=tip, number=number)


FIELD, SLOPE = "shaft.flywheel_inertia_kg_m2", "shaft.motor_slope_nm_s_per_rad"
DIGITS = 5  # of what the sizing shows, and puts into the design


class FlywheelView(View):
    """The figures of the flywheel, and the button that fits one of the inertia needed."""

    is_design_wide = True
    stages = ("dynamics",)
    pause_ms = 200

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(FLYWHEEL_HEADINGS)
        self.offer_explanation(self.table)
        self.use_button = QPushButton("Use this flywheel")
        self.use_button.clicked.connect(self._use)
        self._needed = 0.0
        row = QHBoxLayout()
        row.setContentsMargins(6, 4, 6, 4)
        row.addWidget(self.use_button)
        row.addStretch(1)
        self.set_column(self.table, row, grows=self.table)

    def selected_number(self) -> ExplainableNumber | None:
        return self.table.number

    def refresh(self, study: Study) -> None:
        self._needed = 0.0
        self.use_button.setEnabled(False)
        several, whole = self.session.several, self.session.full_study
        shaft = turned_shaft(whole, NO_WHEEL)
        wheel = whole.flywheel
        slope = _row(
            "Motor slope, assumed",
            shaft.motor_slope_nm_s_per_rad,
            "N·m·s/rad",
            "nobody gave one; the inertia rests on it",
        )
        floor = ROUNDING * max(torque_size(each) for each in whole.drives.values())
        tiny = floor / (shaft.speed_fluctuation * study.omega**2)
        self._needed = rounded_up(wheel.needed_inertia, DIGITS) if wheel.estimated_inertia > tiny else 0.0
        percent = f"{100 * shaft.speed_fluctuation:g} % fluctuation of speed"
        self.use_button.setEnabled(self._needed not in (0.0, shaft.flywheel_inertia_kg_m2))
        self.use_button.setToolTip(f"Fit {digits(self._needed, DIGITS)} kg·m², which {percent} asks for")
        swing_tip = "largest surplus of work the flywheel has to take up"
        inertia_tip = "the least with which the true speed keeps it, by the motor's slope"
        self.table.show_rows(
            [
                _row("Mean torque", wheel.mean_torque, "N·m", floor=floor, name="mean_torque_nm"),
                _row("Energy swing", wheel.energy_swing, "J", swing_tip, floor, "energy_swing_j"),
                _row(f"Inertia for {percent}", self._needed, "kg·m²", inertia_tip, name="needed_inertia_kg_m2"),
                _row(
                    "Estimate of it by energy",
                    wheel.estimated_inertia,
                    "kg·m²",
                    "energy swing/(fluctuation × speed²)",
                    tiny,
                    "estimated_inertia_kg_m2",
                ),
                *([slope] if is_assumed(whole.design, SLOPE) else []),
                _row("Inertia fitted", shaft.flywheel_inertia_kg_m2, "kg·m²"),
                *self._reached(wheel),
                *(_whole_peaks(self.session.shaft, floor) if several else self._peaks(study, floor)),
            ]
        )

    def _reached(self, wheel: Flywheel) -> list[TableRow]:
        """What the flywheel fitted makes of the speed."""
        if not has_flywheel(wheel.shaft):
            return [TableRow(("Speed taken as constant", "", ""), tip="no flywheel is fitted")]
        if not wheel.runs:
            tip = "the true motion with this flywheel comes to a standstill; enlarge it, or the motor's slope"
            least = _row("Least inertia with which it does not", wheel.least_inertia, "kg·m²", tip)
            return [TableRow(("The motor stalls", "", ""), tip=tip), least]
        low, high = (speed / UNITS["rpm"].factor for speed in wheel.speed_range)
        return [
            TableRow(
                ("Fluctuation reached", digits(100.0 * wheel.fluctuation, 4), "%"),
                tip="(highest - lowest)/mean",
                number=ExplainableNumber("fluctuation"),
            ),
            TableRow(("Speed, lowest", digits(low, DIGITS), "rpm"), number=ExplainableNumber("min_speed_rpm")),
            TableRow(("Speed, highest", digits(high, DIGITS), "rpm"), number=ExplainableNumber("max_speed_rpm")),
        ]

    def _peaks(self, study: Study, floor: float) -> list[TableRow]:
        known = quantities_of(study, "dynamics")
        names = [name for name in _PEAKS if name in known and known[name].exists(study)]
        if "drive_torque" in names and "driver_torque" in names:  # a cam turns the shaft, not the linkage under it
            names.remove("driver_torque")
        limits = extremes_of(study, "dynamics", tuple(names))
        rows = []
        for name in names:
            for end, at in (("lowest", limits[name].low), ("highest", limits[name].high)):
                slug = known[name].slug
                rows.append(_row(f"{_PEAKS[name]}, {end}", at.value, "N·m", floor=floor, name=slug, theta=at.theta))
        return rows

    def _use(self) -> None:
        """One step of the undo stack; of the design in place, whatever was shown of the one before."""
        self.pull()
        if self._needed and self.use_button.isEnabled():
            self.session.edit(FIELD, self._needed, step_text("Flywheel inertia", self._needed, UNITS["kg_m2"]))
            self.session.end_gesture()


# -- contact view ----------------------------------------------------------------------------------------

HELD = "A groove, or a conjugate pair, holds the follower from both sides: it cannot leave its cam."
MAP, FLIGHT = "map", "flight"
CONTACT_PAGES = {MAP: "Force over speed", FLIGHT: "Flight after lift-off"}
ANGLES, SPEEDS = 361, 80
CONTACT_PAGE_WIDTH = 150  # pixels
MOST_TURNS = 3
POINTS = 361  # of the motion, in each turn


class ContactView(BackgroundView):
    """Computed beside the window, and only what is on top while it can be seen."""

    stages = ("linkage", "cam", "dynamics")
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.page, self.text = WordBox(), QLabel(wordWrap=True)
        self.page.setAccessibleName("What is shown")
        fill_choices(self.page, CONTACT_PAGES)
        self.page.setMinimumWidth(CONTACT_PAGE_WIDTH)
        self.plot = XYPlot(ACROSS, "")
        self.plot.setMinimumSize(220, 100)
        self._work.result.connect(self._computed)
        self.page.activated.connect(self._choose)
        row = beside(self.page, self.text)
        self.set_column(row, self.plot, grows=self.plot)

    def refresh(self, study: Study) -> None:
        if study.design.drive.cam is None:
            raise Unavailable(NO_FLIGHT)
        if study.is_form_closed:
            raise Unavailable(HELD)
        study.contact_force  # noqa: B018 - says why, where no contact can be lost
        page = str(self.page.currentData())
        self._work.start([((page, study.design), partial(_COMPUTED[page], study.design))])

    def _choose(self, _: int) -> None:
        self.plot.show_message("")
        self._stale = True
        self.pull()

    def _computed(self, key: tuple[str, Design], result: Any) -> None:
        _, design = key
        if isinstance(result, KindynaError):
            self.text.setText("")
            self.plot.show_message(reason(design, result))
            return
        lines, found = result
        self.text.setText(" ".join(lines))
        if isinstance(found, ContactMap):
            show_map(self.plot, found, design.speed_rpm)
        elif isinstance(found, Flights):
            self._show_flights(design, found)

    def _show_flights(self, design: Design, found: Flights) -> None:
        """The follower's way beside the motion, with where each flight ends."""
        if not found.flights:
            self.plot.show_message(f"At {short(design.speed_rpm, 6)} rpm the follower stays on the cam.")
            return
        study, unit = Study(design), UNITS[require_motion(design).unit]
        last = max((one.theta[-1] for one in found.flights), default=0.0)
        turns = min(MOST_TURNS, max(1, math.ceil(last / (2.0 * math.pi))))
        theta = np.linspace(0.0, 2.0 * math.pi * turns, POINTS * turns)
        motion = study.at_theta(np.mod(theta, 2.0 * math.pi)).motion.displacement[0]
        lines = [Line(np.rad2deg(theta), motion / unit.factor, BLUE, "motion", DASHED)]
        for i, one in enumerate(one for one in found.flights if one.lift < theta[-1]):
            inside = one.theta <= theta[-1]
            way = Line(np.rad2deg(one.theta[inside]), one.y[inside] / unit.factor, VERMILION, "" if i else "flight")
            lines.append(way)
        first = found.flights[0]
        marks = [(math.degrees(first.lift), "off")]
        if first.land < theta[-1]:
            marks.append((math.degrees(first.land), "on"))
        self.plot.name_axes(ACROSS, f"Displacement, {unit.symbol}")
        self.plot.show_lines(lines, tuple(marks))

    def settle(self) -> None:
        super().settle()
        self._work.wait(30.0)


def _map(design: Design) -> tuple[list[str], ContactMap]:
    study = Study(design)
    return lift_off_lines(study), contact_force_map(study, np.linspace(0.0, 2.0 * math.pi, ANGLES)[:-1], None, SPEEDS)


def _flights(design: Design) -> tuple[list[str], Flights]:
    study = Study(design)
    found = study.flights()
    return _flight_text(study, found), found


def _flight_text(study: Study, found: Flights) -> list[str]:
    """The first flight, and how many there are."""
    if not found.flights:
        return lift_off_lines(study)
    first, unit = found.flights[0], UNITS[study.program.motion.unit]
    text = (
        f"Off at {math.degrees(first.lift):.2f}°, {with_unit(short(first.height / unit.factor, 4), unit.symbol)} high"
    )
    if math.isfinite(first.land):
        text += f", on at {math.degrees(first.land):.2f}° with {short(first.speed / unit.factor, 4)} {unit.symbol}/s"
    if not found.steady:
        return [f"{text}; flights do not repeat in three turns."]
    count = len(found.flights) - found.repeats
    return [
        f"{text}; {count} flight{'s' if count > 1 else ''} {'a turn' if found.turns == 1 else f'in {found.turns} turns'}"
    ]


_COMPUTED = {MAP: _map, FLIGHT: _flights}


# -- vibration view --------------------------------------------------------------------------------------

NO_DWELL = "The motion has no dwell in which the follower could come to rest."
SPEED = "Machine speed, rpm"
FROM_REST, STEADY, ACCELERATION = "from_rest", "steady", "acceleration"
VIBRATION_PAGES = {FROM_REST: "Residual, from rest", STEADY: "Residual, steady", ACCELERATION: "Largest acceleration"}
TIPS = {
    FROM_REST: "what the motion since the dwell before leaves in a dwell, if the follower stood still at its end",
    STEADY: "what it does turn after turn: earlier strokes are still ringing",
    ACCELERATION: "the largest of the elastic follower over the turn; of an arm that of the roller's centre",
}
VIBRATION_PAGE_WIDTH = 160  # pixels
VIBRATION_HEADINGS = (
    TableHeading("Dwell", wide=True), TableHeading("From rest", number=True), TableHeading("", number=True),
        TableHeading("Steady", number=True),
    TableHeading("", number=True),
)  # fmt: skip
ROOMY = 300  # pixels of height from which on the table is shown
RPM = UNITS["rpm"].factor
CROWDED = 2.5  # times the greatest value up to the design's speed: what is higher is not shown, else that speed lies on the axis


class VibrationView(BackgroundView):
    """Computed beside the window while it can be seen; it follows each step of an edit."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.page, self.text = WordBox(), QLabel(wordWrap=True)
        self.page.setAccessibleName("What is shown over speed")
        fill_choices(self.page, VIBRATION_PAGES)
        for i, tip in enumerate(TIPS.values()):
            self.page.setItemData(i, tip, Qt.ItemDataRole.ToolTipRole)
        self.page.setMinimumWidth(VIBRATION_PAGE_WIDTH)
        self.plot, self.table = CursorPlot(SPEED, reads=True), RowsTable(VIBRATION_HEADINGS)
        self.plot.setMinimumSize(220, 100)
        self.table.setMinimumHeight(40)
        self._summary, self._read_of = "", _Reading()
        self._work.result.connect(self._computed)
        self.page.activated.connect(self._choose)
        self.plot.read.connect(self._read)
        row = beside(self.page, self.text)
        parted = QSplitter(Qt.Orientation.Vertical)
        parted.addWidget(self.plot)
        parted.addWidget(self.table)
        parted.setSizes([3000, 1000])
        self.set_column(row, parted, grows=parted)

    def refresh(self, study: Study) -> None:
        if study.design.drive.cam is None:
            raise Unavailable(NO_ELASTIC)
        if not study.is_elastic:
            raise Unavailable(RIGID_FOLLOWER)
        study.elasticity  # noqa: B018 - says why, where nothing vibrates
        page = str(self.page.currentData())
        self._work.start([((page, study.design), partial(_found, study.design, page))])

    def resizeEvent(self, event: QResizeEvent) -> None:
        """The names of the curves hold the figures too: where the view is low the plot has its height for itself."""
        super().resizeEvent(event)
        self.table.setVisible(self.height() >= ROOMY)

    def _choose(self, _: int) -> None:
        self._stale = True
        self.pull()

    def _computed(
        self, key: tuple[str, Design], result: tuple[tuple[ResidualVibration, ...], Spectrum] | KindynaError
    ) -> None:
        page, design = key
        if isinstance(result, KindynaError):
            self._summary, self._read_of = "", _Reading()
            self.table.show_rows([])
            self.plot.show_message(reason(design, result))
            self._read(None)
            return
        residuals, found = result
        study = Study(design)
        one = study.elasticity.middle
        periods = short(one.natural_frequency / abs(study.omega), 4)
        frequency = measure(one.natural_frequency / math.tau, "Hz")
        self._summary = (
            f"Natural frequency {frequency}, {periods} periods a turn, damping ratio {short(one.damping_ratio, 3)}"
        )
        self.table.show_rows([_residual_row(study, each) for each in residuals])
        self._draw(study, page, residuals, found)
        self._read(self.plot.cursor_at)

    def _draw(self, study: Study, page: str, residuals: tuple[ResidualVibration, ...], found: Spectrum) -> None:
        rpm = found.omega / RPM
        (_, size), *_ = vibration_units(study)
        if page == ACCELERATION:
            names: tuple[str, ...] = ("from rest", "steady")
            title, symbol = "Acceleration", UNITS["mm_s2"].symbol
            values, now = found.acceleration * size, []
        elif residuals:
            names, title, symbol = tuple(_span(each) for each in residuals), "Residual", UNITS["mm"].symbol
            values = found.residual[(FROM_REST, STEADY).index(page)] * size
            now = [_in_mm(getattr(each, page) * size) for each in residuals]
        else:
            self._read_of = _Reading()
            self.plot.show_message(NO_DWELL)
            return
        shown = np.where(np.isfinite(values), values, np.nan)
        own = abs(study.omega) / RPM
        near = shown[:, rpm <= own]
        most = CROWDED * float(np.nanmax(near)) if np.isfinite(near).any() else math.inf
        rung = readable(symbol, min(most, float(np.nanmax(shown, initial=0.0))))
        self.plot.name_axes(SPEED, f"{title}, {rung.symbol}")
        colours = [ROWS[i % len(ROWS)] for i in range(len(names))]
        labels = [f"{name}: {value}" for name, value in zip(names, now, strict=True)] if now else names
        lines = [
            Line(rpm, y / rung.size, colour, label) for y, colour, label in zip(shown, colours, labels, strict=True)
        ]
        self.plot.show_lines(lines, ((own, "now"),))
        highest = min(most, float(np.nanmax(shown, initial=0.0))) / rung.size
        if highest > 0.0:
            self.plot.show_range(upwards=(0.0, 1.05 * highest))
        self._read_of = _Reading(rpm, values, names, rung)

    def _read(self, at: float | None) -> None:
        """The values at the mouse; what is known of the follower where it is elsewhere."""
        self.text.setText((self._read_of.text(at) if at is not None else "") or self._summary)

    def settle(self) -> None:
        super().settle()
        self._work.wait(30.0)


class _Reading:
    """Values of curves (k, n) over speeds (n,) [rpm], to be read."""

    def __init__(
        self,
        rpm: np.ndarray | None = None,
        values: np.ndarray | None = None,
        names: tuple[str, ...] = (),
        rung: DisplayUnit | None = None,
    ) -> None:
        self._rpm, self._values, self._names, self._rung = rpm, values, names, rung

    def text(self, at: float) -> str:
        """The values at a speed, between those that were computed; empty where there are none."""
        if self._rpm is None or self._values is None or self._rung is None:
            return ""
        symbol = self._rung.symbol
        read = [
            f"{name}: {measure(float(np.interp(at, self._rpm, row)) / self._rung.size, symbol, 3)}"
            for name, row in zip(self._names, self._values, strict=True)
        ]
        return f"{digits(at, 4)} rpm, " + ", ".join(read)


def _span(residual: ResidualVibration) -> str:
    return f"{short(math.degrees(residual.dwell.start), 4)}–{short(math.degrees(residual.dwell.end), 4)}°"


def _in_mm(value: float) -> str:
    rung = readable("mm", value)
    return measure(value / rung.size, rung.symbol, 3)


def _residual_row(study: Study, residual: ResidualVibration) -> TableRow:
    """Both amplitudes, in millimetres, and in degrees where the motion turns."""
    rows = (("from rest", residual.from_rest), ("steady", residual.steady))
    (_, size), *swings = vibration_units(study)
    cells = [_span(residual)]
    for _, value in rows:
        cells.append(_in_mm(value * size))
        cells.append(measure(value * swings[0][1], "°", 3) if swings else "")
    return TableRow(
        tuple(cells),
        tip="amplitude of the follower's error z - s about the place where it would stand, at the dwell's start",
    )


def _found(design: Design, page: str) -> tuple[tuple[ResidualVibration, ...], Spectrum]:
    study = Study(design)
    return study.follower_response.residuals, study.vibration(
        spectrum_speeds(study, count=SPECTRUM_SPEEDS), page == ACCELERATION
    )
