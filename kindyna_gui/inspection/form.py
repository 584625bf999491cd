"""How a cut cam is inspected, as a form: probe, radius, tolerance, flank, direction."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QComboBox, QFormLayout, QWidget

from core.design import Design
from core.output.inspection import PROBES, TOLERANCE_MM, Request, own_direction, own_probe
from kindyna_gui.forms.amount import Amount, fill_choices


class ProbeForm(QWidget):
    """The fields; changed: one of them was. It begins with the cam's own follower; flank: filled with the flanks of the cam."""

    changed = Signal()

    def __init__(self, design: Design, flank: QComboBox) -> None:
        super().__init__()
        self._design = design
        self.probe, self.flank = QComboBox(self), flank
        self.radius, self.tolerance, self.direction = Amount(), Amount(), Amount()
        fill_choices(self.probe, {name: row.label.capitalize() for name, row in PROBES.items()})
        for amount, decimals, low, high, unit in (
            (self.radius, 4, 1e-4, 1e5, " mm"),
            (self.tolerance, 6, 0.0, 100.0, " mm"),
            (self.direction, 4, -360.0, 360.0, "°"),
        ):
            amount.setDecimals(decimals)
            amount.setRange(low, high)
            amount.setSuffix(unit)
        self.tolerance.setPrefix("± ")
        self.tolerance.setValue(TOLERANCE_MM)
        self.direction.setValue(own_direction(design))
        self.tolerance.setToolTip("Normal to the profile")
        self.direction.setToolTip("Where the probe stands, seen from the cam centre, counter-clockwise from the x axis")
        self.form = QFormLayout(self)
        self.form.setContentsMargins(0, 0, 0, 0)
        self.form.addRow("Probe", self.probe)
        self.form.addRow("Radius", self.radius)
        self.form.addRow("Tolerance", self.tolerance)
        self.form.addRow("Direction", self.direction)
        if self.flank.count() > 1:
            self.form.addRow("Flank", self.flank)
        self._begin()
        self.flank.currentIndexChanged.connect(self._begin)
        self.flank.currentIndexChanged.connect(self.changed)
        self.probe.currentIndexChanged.connect(self._offer_radius)
        for amount in (self.radius, self.tolerance, self.direction):
            amount.valueChanged.connect(self.changed)

    def _begin(self) -> None:
        """With the probe that is the cam's own follower."""
        name, radius = own_probe(self._design, self.flank.currentData())
        for box in (self.probe, self.radius):
            box.blockSignals(True)
        self.probe.setCurrentIndex(self.probe.findData(name))
        if radius > 0.0:
            self.radius.setValue(radius)
        elif self.radius.value() <= self.radius.minimum():
            self.radius.setValue(5.0)
        for box in (self.probe, self.radius):
            box.blockSignals(False)
        self.radius.setEnabled(PROBES[name].radius)

    def _offer_radius(self) -> None:
        self.radius.setEnabled(PROBES[self.probe.currentData()].radius)
        self.changed.emit()

    def request(self, samples: int) -> Request:
        radius = self.radius.value() if self.radius.isEnabled() else None
        return Request(
            self.probe.currentData(),
            radius,
            self.tolerance.value(),
            samples,
            self.flank.currentData(),
            self.direction.value(),
        )


__all__ = ["ProbeForm"]
