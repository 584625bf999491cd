"""The flywheel: what it would have to be, and what the one fitted makes of the torque."""

from __future__ import annotations

from PySide6.QtWidgets import QVBoxLayout

from core.study import Study
from kindyna_gui.pictures.units import digits, readable
from kindyna_gui.player import Player
from kindyna_gui.session import Session
from kindyna_gui.tables import Heading, Row, RowsTable
from kindyna_gui.view import View

HEADINGS = (Heading("Flywheel and torque", wide=True), Heading("Value", number=True), Heading("Unit"))
_PEAKS = {"drive_torque": "Cam torque", "motor_torque": "Motor torque, with the flywheel fitted"}


def _row(label: str, value: float, symbol: str, tip: str = "") -> Row:
    rung = readable(symbol, abs(value))
    return Row((label, digits(value / rung.size, 5), rung.symbol), tip=tip)


class FlywheelView(View):
    """The figures of the flywheel."""

    stages = ("dynamics",)
    pause_ms = 200

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(HEADINGS)
        layout = QVBoxLayout()
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.table)
        self.set_content_layout(layout)

    def refresh(self, study: Study) -> None:
        wheel, shaft = study.flywheel, study.design.shaft
        rows = [
            _row("Mean torque", wheel.mean_torque, "N·m"),
            _row("Energy swing", wheel.energy_swing, "J", "largest surplus of work the flywheel has to take up"),
            _row(
                f"Inertia for {100 * shaft.speed_fluctuation:g} % fluctuation of speed",
                wheel.needed_inertia,
                "kg·m²",
                "at the camshaft, all turning parts together",
            ),
            _row("Inertia fitted", shaft.flywheel_inertia_kg_m2, "kg·m²"),
        ]
        found = study.extremes("dynamics", tuple(_PEAKS))
        for name, label in _PEAKS.items():
            rows.append(_row(f"{label}, lowest", found[name].low.value, "N·m"))
            rows.append(_row(f"{label}, highest", found[name].high.value, "N·m"))
        self.table.show_rows(rows)
