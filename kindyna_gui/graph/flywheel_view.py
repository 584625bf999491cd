"""The flywheel: what it would have to be, and what the one fitted makes of speed and torque."""

from __future__ import annotations

from PySide6.QtWidgets import QHBoxLayout, QPushButton

from core.design import UNITS, is_assumed
from core.shaft import Flywheel, levels, rounded_up
from core.study import Camshaft, Study, extremes_of, quantities_of
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import step_text
from kindyna_gui.pictures.sizes import ROUNDING, torque_size
from kindyna_gui.pictures.units import digits, readable
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_WHEEL, turned_shaft
from kindyna_gui.view import NumberAtHand, View

HEADINGS = (TableHeading("Flywheel and torque", wide=True), TableHeading("Value", number=True), TableHeading("Unit"))
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
    number = NumberAtHand(name, theta) if name else None
    return TableRow((label, digits(value / rung.size, 5), rung.symbol), tip=tip, number=number)


FIELD, SLOPE = "shaft.flywheel_inertia_kg_m2", "shaft.motor_slope_nm_s_per_rad"
DIGITS = 5  # of what the sizing shows, and puts into the design


class FlywheelView(View):
    """The figures of the flywheel, and the button that fits one of the inertia needed."""

    of_whole = True
    stages = ("dynamics",)
    pause_ms = 200

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(HEADINGS)
        self.offer_explanation(self.table)
        self.use_button = QPushButton("Use this flywheel")
        self.use_button.clicked.connect(self._use)
        self._needed = 0.0
        row = QHBoxLayout()
        row.setContentsMargins(6, 4, 6, 4)
        row.addWidget(self.use_button)
        row.addStretch(1)
        self.set_column(self.table, row, grows=self.table)

    def number_at_hand(self) -> NumberAtHand | None:
        return self.table.number

    def refresh(self, study: Study) -> None:
        self._needed = 0.0
        self.use_button.setEnabled(False)
        several, whole = self.session.several, self.session.whole_study
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
        if not levels(wheel.shaft):
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
                number=NumberAtHand("fluctuation"),
            ),
            TableRow(("Speed, lowest", digits(low, DIGITS), "rpm"), number=NumberAtHand("min_speed_rpm")),
            TableRow(("Speed, highest", digits(high, DIGITS), "rpm"), number=NumberAtHand("max_speed_rpm")),
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
