"""Curves of the whole shaft over the machine angle, with a cursor; a click or a drag sets the machine angle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPointF

from core.frozen import frozen
from kindyna_gui.pictures.plots.readouts import Readout, place_readouts
from kindyna_gui.pictures.plots.under_mouse import MachinePlot
from kindyna_gui.pictures.plots.xy import Line
from kindyna_gui.pictures.units import Rung, readable

ONE = Rung("", 1.0, 0.0)


@frozen(eq=False)
class TurnCurve:
    """Values (n,) over the turn in the unit of the plot; read: the value at the cursor stands beside it."""

    label: str
    values: np.ndarray
    colour: str
    dash: tuple[float, ...] = ()
    read: bool = False


class TurnPlot(MachinePlot):
    """Curves of one quantity over the machine angle 0 ... 360°.

    from_zero   whether the axis reaches to zero; else it shows only what the first curve that is read takes up
    numbers     whether the angles stand along the bottom: of plots one below the other only the last has them
    """

    def __init__(self, title: str, unit: str, from_zero: bool = True, numbers: bool = True) -> None:
        self._from_zero = from_zero
        self._readings: list[Readout] = []
        self._read: list[TurnCurve] = []
        self._theta, self.rung = np.zeros(0), ONE
        super().__init__(title)
        self._title, self._unit = title, unit
        self.setMinimumSize(220, 70)
        self.numbers = numbers
        if not numbers:
            self.show_numbers(False)

    def show_curves(self, angles: np.ndarray, curves: Sequence[TurnCurve]) -> None:
        """Draw these curves, of which the first are underneath; angles (n,) [deg] of their values."""
        size = max((float(np.abs(curve.values).max(initial=0.0)) for curve in curves), default=0.0)
        self.rung = readable(self._unit, size)
        self.name_axes(self.ANGLE if self.numbers else "", f"{self._title}, {self.rung.symbol}")
        closed = np.append(angles, 360.0)
        self._theta = angles
        self._read = [curve for curve in curves if curve.read]
        while len(self._readings) > len(self._read):
            self._readings.pop().remove(self._view)
        while len(self._readings) < len(self._read):
            self._readings.append(Readout(self._view, self._theme))
        for reading, curve in zip(self._readings, self._read, strict=True):
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
            low, high = (float(end) for end in (self._read[0].values.min(), self._read[0].values.max()))
            room = 0.1 * (high - low) or 1e-3 * abs(high) or 1.0
            self._view.setRange(yRange=((low - room) / self.rung.size, (high + room) / self.rung.size), padding=0.0)
            self._lay()
        self._place_cursor()

    def show_message(self, text: str) -> None:
        for reading in self._readings:
            reading.hide()
        self._read = []
        if self._cursor is not None:
            self._cursor.setVisible(False)
        super().show_message(text)

    @property
    def shown(self) -> bool:
        return bool(self._read)

    @property
    def readings(self) -> list[str]:
        """The texts beside the cursor."""
        return [reading.tag.text for reading in self._readings if reading.tag.isVisible()]

    def _place_cursor(self) -> None:
        super()._place_cursor()
        if self._cursor is None or not self._read:
            return
        nearest = round(self.machine / 360.0 * self._theta.size) % self._theta.size
        values = [float(curve.values[nearest]) / self.rung.size for curve in self._read]
        place_readouts(self._readings, self.machine, values, self.rung, self.frame())

    def pixel_at(self, angle: float) -> QPointF:
        """Where a machine angle [deg] stands in the widget [pixels], in the middle of the plot's height."""
        frame = self.frame()
        place = self._view.mapViewToScene(QPointF(angle, 0.5 * (frame.low + frame.high)))
        return QPointF(self.mapFromScene(place))
