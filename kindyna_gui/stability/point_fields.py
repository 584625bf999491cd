"""The chosen point of the chart as numbers: frequency ratio and inertia ratio, or a speed of the machine in place of the first."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QWidget

from core.design import NO_UNIT, UNITS, Info
from core.stability import Machine
from kindyna_gui.forms.field_parts import UnitLabel
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.look import coloured
from kindyna_gui.pictures.style import SCREEN

MOST_ETA, MOST_Q = 60.0, 100.0  # as far as a point can be followed
DIGITS = 7  # of a speed or of the machine's own figures, which nobody typed


class PointFields(QWidget):
    """η, Q and rpm side by side, and a button back to the machine's own point.

    entered   (float, float): another η and Q was typed
    returned  the machine's own point is wanted
    """

    entered = Signal(float, float)
    returned = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.eta = NumberBox(Info("Frequency ratio η", low=0.0, high=MOST_ETA, open_low=True, step=0.01), NO_UNIT)
        self.q = NumberBox(Info("Inertia ratio Q", low=0.0, high=MOST_Q, step=0.01), NO_UNIT)
        self.rpm = NumberBox(Info("Speed", low=0.0, high=1e5, open_low=True, step=10.0), UNITS["rpm"])
        self.back = QPushButton("Machine's own")
        self.back.setToolTip("Choose the machine's own point again")
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        for before, box, after in (
            ("Point: η", self.eta, NO_UNIT),
            ("Q", self.q, NO_UNIT),
            ("or at", self.rpm, UNITS["rpm"]),
        ):
            for part in (_quiet(before), box, *([UnitLabel(after)] if after.symbol else [])):
                row.addWidget(part)
        row.addWidget(self.back)
        self._machine: Machine | None = None
        self._point = (0.0, 0.0)
        self.eta.entered.connect(self._typed_eta)
        self.q.entered.connect(self._typed_q)
        self.rpm.entered.connect(self._typed_rpm)
        self.back.clicked.connect(self.returned)
        self.setEnabled(False)

    def show_point(self, machine: Machine, eta: float, q: float, own: bool) -> None:
        """Show a point of this machine's chart; what was typed and refused is forgotten."""
        self._machine, self._point = machine, (eta, q)
        self.eta.show_value(_rounded(eta) if own else eta)
        self.q.show_value(_rounded(q) if own else q)
        self.rpm.show_value(_rounded(machine.rpm(eta)))
        least = machine.rpm(MOST_ETA)
        limits = (
            (self.eta, f"above 0, up to {MOST_ETA:g}"),
            (self.q, f"0 ... {MOST_Q:g}"),
            (self.rpm, f"{least:.5g} rpm and more"),
        )
        for box, allowed in limits:
            box.setToolTip(f"Allowed: {allowed}")
        self.back.setEnabled(not own)
        self.setEnabled(True)

    def _typed_eta(self, value: float) -> None:
        self._take(self.eta, value, self._point[1])

    def _typed_q(self, value: float) -> None:
        self._take(self.q, self._point[0], value)

    def _typed_rpm(self, value: float) -> None:
        assert self._machine is not None
        self._take(self.rpm, self._machine.eta_at(value) if value > 0.0 else 0.0, self._point[1])

    def _take(self, box: NumberBox, eta: float, q: float) -> None:
        if 0.0 < eta <= MOST_ETA and 0.0 <= q <= MOST_Q:
            self.entered.emit(eta, q)
        else:
            box.set_refused(True)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _quiet(text: str) -> QLabel:
    label = QLabel(text)
    coloured(label, SCREEN.quiet)
    return label


__all__ = ["PointFields"]
