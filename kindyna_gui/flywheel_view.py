"""The flywheel: what it would have to be, and what the one fitted makes of the torque."""

from __future__ import annotations

from core.study import Study
from kindyna_gui.pictures.sizes import ROUNDING, torque_size
from kindyna_gui.pictures.units import digits, readable
from kindyna_gui.player import Player
from kindyna_gui.reads import READS
from kindyna_gui.session import Session
from kindyna_gui.shown_kinds import only_cams
from kindyna_gui.tables import Heading, Row, RowsTable
from kindyna_gui.view import View

HEADINGS = (Heading("Flywheel and torque", wide=True), Heading("Value", number=True), Heading("Unit"))
_PEAKS = {"drive_torque": "Cam torque", "motor_torque": "Motor torque, with the flywheel fitted"}


def _row(label: str, value: float, symbol: str, tip: str = "", floor: float = 0.0) -> Row:
    """floor: size below which the value is what rounding leaves of a zero."""
    value = 0.0 if abs(value) <= floor else value
    rung = readable(symbol, abs(value))
    return Row((label, digits(value / rung.size, 5), rung.symbol), tip=tip)


class FlywheelView(View):
    """The figures of the flywheel."""

    stages = READS["flywheel"]
    pause_ms = 200

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(HEADINGS)
        self.set_column(self.table, grows=self.table)

    def refresh(self, study: Study) -> None:
        design = only_cams(study.design, "A flywheel is sized for a cam and its follower; a linkage has none here.")
        wheel, shaft = study.flywheel, design.shaft
        floor = ROUNDING * torque_size(study)
        swing_tip = "largest surplus of work the flywheel has to take up"
        rows = [
            _row("Mean torque", wheel.mean_torque, "N·m", floor=floor),
            _row("Energy swing", wheel.energy_swing, "J", swing_tip, floor),
            _row(
                f"Inertia for {100 * shaft.speed_fluctuation:g} % fluctuation of speed",
                wheel.needed_inertia,
                "kg·m²",
                "at the camshaft, all turning parts together",
                floor / (shaft.speed_fluctuation * study.omega**2),
            ),
            _row("Inertia fitted", shaft.flywheel_inertia_kg_m2, "kg·m²"),
        ]
        found = study.extremes("dynamics", tuple(_PEAKS))
        for name, label in _PEAKS.items():
            rows.append(_row(f"{label}, lowest", found[name].low.value, "N·m", floor=floor))
            rows.append(_row(f"{label}, highest", found[name].high.value, "N·m", floor=floor))
        self.table.show_rows(rows)
