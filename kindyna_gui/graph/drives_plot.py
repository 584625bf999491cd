"""One quantity of all drives on a shaft, by their colours, over the machine angle."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, radians

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent

from core.errors import KindynaError
from core.study import ShaftStudy
from kindyna_gui.graph.quantities import quantities_for, rows_of, split
from kindyna_gui.pictures.plots.lines import Cursor
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import LIGHT, drive_colour
from kindyna_gui.pictures.units import readable

ANGLE = "Machine angle, °"
TORQUE = "drive_torque"
"""The quantity of which the drives on a shaft have a sum."""


def curves_of_all(shaft: ShaftStudy, usual: Sequence[str]) -> tuple[list[Line], str, list[str]]:
    """The first of these quantities of each drive over the machine angle [deg], of torques their sum too; the title of the axis; and
    a line for each drive that is left out."""
    found, missing, first = [], [], None
    for number, (name, study) in enumerate(shaft.drives.items()):
        try:
            rows, _ = split(study, rows_of(study, quantities_for(study, usual)))
            values = rows[0].values(study) if rows else np.zeros(0)
        except KindynaError as error:
            missing.append(f"{name}: {error}")
            continue
        first = first or (rows[0] if rows else None)
        if not rows or first is None or rows[0].unit.symbol != first.unit.symbol:
            what = f"in {rows[0].unit.symbol}, not in {first.unit.symbol}" if rows and first else "none"
            missing.append(f"{name}: {what}")
            continue
        machine = np.degrees(shaft.places[name].machine(study.theta))
        order = np.argsort(machine)
        found.append((machine[order], values[order], drive_colour(number), name))
    if first is None:
        return [], "", missing
    if first.quantity == TORQUE and len(found) > 1 and not missing:
        found.append((shaft.angle_degrees, shaft.torque, LIGHT.ink, "Shaft"))
    rung = readable(first.unit.symbol, max(float(np.nanmax(np.abs(values))) for _, values, _, _ in found))
    lines = [_closed(x, values / rung.size, colour, name) for x, values, colour, name in found]
    return lines, f"{first.label}, {rung.symbol}", missing


def _closed(x: np.ndarray, y: np.ndarray, colour: str, name: str) -> Line:
    """From 0 to 360 degrees."""
    edge = np.interp(360.0, np.append(x, x[0] + 360.0), np.append(y, y[0]))
    return Line(np.concatenate(([0.0], x, [360.0])), np.concatenate(([edge], y, [edge])), colour, name)


class DrivesPlot(XYPlot):
    """The curves, with a cursor at the machine angle.

    angle_moved   the user has clicked at, or drawn the cursor to, this machine angle [rad]
    """

    angle_moved = Signal(float)

    def __init__(self) -> None:
        self._cursor: Cursor | None = None
        super().__init__(ANGLE, "")
        self._cursor = Cursor(self._view, self._theme)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.setToolTip("Click or drag to set the machine angle")

    def show_all(self, lines: list[Line], title: str) -> None:
        """Draw these curves."""
        self.name_axes(ANGLE, title)
        self.show_lines(lines)

    def set_machine(self, machine: float) -> None:
        """Move the cursor [rad]."""
        if self._cursor is not None:
            self._cursor.setPos(degrees(machine), 0.0)

    @property
    def machine(self) -> float:
        """Machine angle of the cursor [deg]."""
        return 0.0 if self._cursor is None else self._cursor.value()

    def _lay(self, *args: object) -> None:
        super()._lay(*args)
        if self._cursor is not None:
            frame = self.frame()
            self._cursor.span(frame.low, frame.high)
            self._cursor.setVisible(bool(self._drawn))

    def _go(self, event: QMouseEvent) -> None:
        if self._drawn:
            place = self._view.mapSceneToView(self.mapToScene(event.position().toPoint()))
            self.angle_moved.emit(radians(min(max(float(place.x()), 0.0), 360.0)))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._go(event)
        event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._go(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        event.ignore()  # the keys belong to the player


__all__ = ["DrivesPlot", "curves_of_all"]
