"""Curves of the whole shaft over the machine angle, with a cursor; a click or a drag sets the machine angle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPointF

from core.frozen import frozen
from kindyna_gui.pictures.plots.readouts import Readout, place_readouts
from kindyna_gui.pictures.plots.under_mouse import MACHINE_ANGLE, MACHINE_TIP, CursorPlot
from kindyna_gui.pictures.plots.xy import Line
from kindyna_gui.pictures.units import DisplayUnit, readable

ONE = DisplayUnit("", 1.0, 0.0)


@frozen(eq=False)
class TurnCurve:
    """Values (n,) over the turn in the unit of the plot; read: the value at the cursor stands beside it."""

    label: str
    values: np.ndarray
    colour: str
    dash: tuple[float, ...] = ()
    read: bool = False


class TurnPlot(CursorPlot):
    """Curves of one quantity over the machine angle 0 ... 360°.

    from_zero   whether the axis reaches to zero; else it shows only what the first curve that is read takes up
    numbers     whether the angles stand along the bottom: of plots one below the other only the last has them
    """

    def __init__(self, title: str, unit: str, from_zero: bool = True, numbers: bool = True) -> None:
        self._from_zero = from_zero
        self._readings: list[Readout] = []
        self._curves_read: list[TurnCurve] = []
        self._theta, self.rung, self._machine = np.zeros(0), ONE, 0.0
        super().__init__(MACHINE_ANGLE, title)
        self.setToolTip(MACHINE_TIP)
        self._title, self._unit = title, unit
        self.setMinimumSize(220, 70)
        self.numbers = numbers
        if not numbers:
            self.show_numbers(False)

    def show_curves(self, angles: np.ndarray, curves: Sequence[TurnCurve]) -> None:
        """Draw these curves, of which the first are underneath; angles (n,) [deg] of their values."""
        size = max((float(np.abs(curve.values).max(initial=0.0)) for curve in curves), default=0.0)
        self.rung = readable(self._unit, size)
        self.name_axes(MACHINE_ANGLE if self.numbers else "", f"{self._title}, {self.rung.symbol}")
        closed = np.append(angles, 360.0)
        self._theta = angles
        self._curves_read = [curve for curve in curves if curve.read]
        while len(self._readings) > len(self._curves_read):
            self._readings.pop().remove(self._view)
        while len(self._readings) < len(self._curves_read):
            self._readings.append(Readout(self._view, self._theme))
        for reading, curve in zip(self._readings, self._curves_read, strict=True):
            reading.set_colour(curve.colour)
        self.show_lines(
            [
                Line(
                    closed,
                    np.append(curve.values, curve.values[0]) / self.rung.size,
                    curve.colour,
                    curve.label,
                    curve.dash,
                )
                for curve in curves
            ]
        )
        if not self._from_zero:
            low, high = (float(end) for end in (self._curves_read[0].values.min(), self._curves_read[0].values.max()))
            room = 0.1 * (high - low) or 1e-3 * abs(high) or 1.0
            self.show_range(upwards=((low - room) / self.rung.size, (high + room) / self.rung.size))
        self.set_machine(self._machine)

    def show_message(self, text: str) -> None:
        for reading in self._readings:
            reading.hide()
        self._curves_read = []
        super().show_message(text)

    @property
    def shown(self) -> bool:
        return bool(self._curves_read)

    @property
    def readings(self) -> list[str]:
        """The texts beside the cursor."""
        return [reading.tag.text for reading in self._readings if reading.tag.isVisible()]

    def set_machine(self, machine: float) -> None:
        """Move the cursor [deg]."""
        self._machine = machine
        self.point_out(machine)
        self._read_out()

    def _read_out(self) -> None:
        if self._curves_read:
            nearest = round(self._machine / 360.0 * self._theta.size) % self._theta.size
            values = [float(curve.values[nearest]) / self.rung.size for curve in self._curves_read]
            place_readouts(self._readings, self._machine, values, self.rung, self.frame())

    def _lay(self, *args: object) -> None:
        super()._lay(*args)
        self._read_out()

    def pixel_at(self, angle: float) -> QPointF:
        """Where a machine angle [deg] stands in the widget [pixels], in the middle of the plot's height."""
        frame = self.frame()
        place = self._view.mapViewToScene(QPointF(angle, 0.5 * (frame.low + frame.high)))
        return QPointF(self.mapFromScene(place))
