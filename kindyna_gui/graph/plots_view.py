"""Docks with plots over one turn: a few quantities in one plot, or a stack of plots of the motion."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import degrees, radians
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QPalette
from PySide6.QtWidgets import QStackedWidget

from core.errors import KindynaError
from core.motion import degrees as turn_degrees
from core.motion.extremes import Extremes
from core.study import Camshaft, Quantity, Study
from core.study.extremes import parts_of
from kindyna_gui.documents.pins import Bands, Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.graph.marked_view import PlotsView
from kindyna_gui.look import Note
from kindyna_gui.pictures.plots.curves import TurnCurves
from kindyna_gui.pictures.plots.quantities import (
    figures_of,
    needs_flywheel,
    quantities_for,
    rows_of,
    split,
    stages_of,
    why_empty,
)
from kindyna_gui.pictures.plots.xy import MACHINE_ANGLE, MACHINE_TIP, CursorPlot, Line
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import readable
from kindyna_gui.player import Player
from kindyna_gui.requirements import Unavailable, suggestions_for
from kindyna_gui.saving import save_numbers, save_picture
from kindyna_gui.view import ExplainableNumber

TORQUE = "drive_torque"  # the quantity whose sum over the drives is drawn, too
SHARES: Mapping[str, int] = MappingProxyType(
    {"displacement": 22, "velocity": 18, "acceleration": 18, "jerk": 18, "pressure_angle": 24}
)
"""Quantity -> its share of the height; names of segments are above the first plot, angles below the last."""

# -- all drives over the machine angle -------------------------------------------------------------------


def drive_curves(
    shaft: Camshaft[Study], names: Sequence[str], bands: Bands, pins: Pins
) -> tuple[list[Line], str, list[str]]:
    """Return the first of these quantities for all drives over the machine angle, and for torques their sum.

    Returns
    -------
    lines : list of Line
        Curves over the machine angle [deg], with their bands, and those of the pinned variant below them.
    title : str
        Title of the axis, empty without a curve.
    missing : list of str
        A line for each drive that has no curve.
    """
    first, lines, missing = _drive_lines(shaft, names, bands)
    if first is None:
        return [], "", missing

    def draw_pinned(pinned: Camshaft[Study]) -> list[Line]:
        unit, drawn, _ = _drive_lines(pinned, names)
        return drawn if unit is not None and unit.unit.symbol == first.unit.symbol else []

    lines = [*pins.shaft_lines(draw_pinned), *lines]
    unit = readable(first.unit.symbol, max(float(np.nanmax(np.abs(line.y))) for line in lines))
    shown = [
        replace(line, y=line.y / unit.size, band=line.band and (line.band[0], line.band[1] / unit.size))
        for line in lines
    ]
    return shown, f"{first.label}, {unit.symbol}", missing


def _drive_lines(
    shaft: Camshaft[Study], names: Sequence[str], bands: Bands | None = None
) -> tuple[Quantity | None, list[Line], list[str]]:
    """Quantity of the first drive that has one, curves of all drives in its unit, and a line for each drive without one."""
    lines: list[Line] = []
    missing: list[str] = []
    first: Quantity | None = None
    for number, (name, study) in enumerate(shaft.drives.items()):
        try:
            rows, _ = split(study, rows_of(study, quantities_for(study, names)))
            values = rows[0].values(study) if rows else np.zeros(0)
        except KindynaError as error:
            missing.append(f"{name}: {error}")
            continue
        first = first or (rows[0] if rows else None)
        if not rows or first is None or rows[0].unit.symbol != first.unit.symbol:
            text = f"in {rows[0].unit.symbol}, not in {first.unit.symbol}" if rows and first else "no such curve"
            missing.append(f"{name}: {text}")
            continue
        band = None if bands is None else bands.read(rows[:1], number).get(rows[0].slug)
        position = shaft.positions[name]
        shade = None if band is None else _closed(position.machine_angle(np.deg2rad(turn_degrees(band.shape[1]))), band)
        lines.append(
            Line(*_closed(position.machine_angle(study.theta), values), SCREEN.drive(number), name, band=shade)
        )
    if first is not None and first.name == TORQUE and len(lines) > 1 and not missing:
        sum_band = None if bands is None else bands.of_shaft().get("")
        shade = None if sum_band is None else _closed(np.deg2rad(turn_degrees(sum_band.shape[1])), sum_band)
        lines.append(Line(*_closed(shaft.theta, shaft.torque), SCREEN.ink, "Shaft", band=shade))
    return first, lines, missing


def _closed(machine_angle: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sort machine angles (n,) [rad] and their values (..., n), and extend them to 0 ... 360°: angles (n + 2,) [deg], values."""
    order = np.argsort(machine_angle)
    x, y = np.degrees(machine_angle[order]), y[..., order]
    part = (360.0 - x[-1]) / (x[0] + 360.0 - x[-1])
    edge = y[..., -1:] + part * (y[..., :1] - y[..., -1:])
    return np.concatenate(([0.0], x, [360.0])), np.concatenate((edge, y, edge), axis=-1)


# -- one plot --------------------------------------------------------------------------------------------


class PlotView(PlotsView):
    """Plot of a few quantities of one unit; quantities that the design does not have are listed with the reason."""

    def __init__(self, session: Session, player: Player, quantities: Sequence[str]) -> None:
        super().__init__(session, player)
        self.names = tuple(quantities)
        self.plot = LivePlot()
        self.note = Note(SCREEN.quiet, margin=3)
        self.note.setIndent(6)
        self.rows: tuple[Quantity, ...] = ()
        self.message = ""  # in place of the curves
        self._pages = QStackedWidget()
        self._pages.addWidget(self.plot)
        self._drives_plot: CursorPlot | None = None
        self.set_column(self._pages, self.note, grows=self._pages)
        self.content.setBackgroundRole(QPalette.ColorRole.Base)
        self.content.setAutoFillBackground(True)
        self.offer_explanation(self.plot)
        exports = (
            ("Export picture...", lambda: save_picture(self, self.names[0])),
            ("Export numbers...", lambda: save_numbers(self, self.rows, self.names[0])),
        )
        self.offer_actions(self.plot, lambda: self.rows, exports)
        self.all_drives = QAction("All drives", self, checkable=True, visible=session.has_several_drives)
        self.all_drives.setToolTip("Show all drives of the shaft over the machine angle, and the sum of torques")
        self.all_drives.toggled.connect(self.invalidate)
        self.plot.addAction(self.all_drives)
        session.full_design_changed.connect(self._update_drives)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Quantities on display for the current design."""
        return quantities_for(self.session.study, self.names)

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Stages that the quantities on display need."""
        return stages_of(self.quantities)

    @property
    def is_slow(self) -> bool:
        return needs_flywheel(self.session.study, self.quantities)

    def turn_plots(self) -> Sequence[TurnCurves]:
        return (self.plot,)

    @property
    def shows_all_drives(self) -> bool:
        """Whether the curves of all drives of the shaft are on display."""
        return self.all_drives.isChecked() and self.all_drives.isVisible()

    @property
    def drives_plot(self) -> CursorPlot:
        """The plot of all drives, created when it is first used."""
        if self._drives_plot is None:
            self._drives_plot = CursorPlot(MACHINE_ANGLE)
            self._drives_plot.setToolTip(MACHINE_TIP)
            self._drives_plot.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
            self._drives_plot.addAction(self.all_drives)
            self._drives_plot.moved.connect(self._turn_machine)
            self._pages.addWidget(self._drives_plot)
        return self._drives_plot

    def _update_drives(self) -> None:
        self.all_drives.setVisible(self.session.has_several_drives)
        if self.all_drives.isChecked():
            self.invalidate()

    def _show_all_drives(self, study: Study) -> None:
        lines, title, missing = drive_curves(self.session.shaft, self.names, self.bands, self.pins)
        if lines:
            self.drives_plot.name_axes(MACHINE_ANGLE, title)
            self.drives_plot.show_lines(lines)
        else:
            self.drives_plot.show_message("\n".join(missing) or why_empty(study, self.names))
        self.note.show_message("; ".join(missing) if lines else "")
        self._pages.setCurrentWidget(self.drives_plot)

    def _turn_machine(self, angle: float) -> None:
        self.player.play(False)
        self.player.set_machine(radians(angle))

    def refresh(self, study: Study) -> None:
        if self.shows_all_drives:
            self._show_all_drives(study)
            return
        self._pages.setCurrentWidget(self.plot)
        quantities = self.quantities
        if not quantities and study.design.drive.links:
            _ = study.linkage  # raises the reason if it cannot be assembled
        drawn, missing = split(study, rows_of(study, quantities))
        self.rows = tuple(drawn)
        self.plot.name_angle(study)
        self.message = "" if drawn else "\n".join(missing) or why_empty(study, self.names)
        if suggestions_for(self.message):
            raise Unavailable(self.message)
        notes = ["; ".join(missing), *figures_of(study, self.names)]
        if drawn:
            self.plot.set_curves(study, drawn, read=False, **self.companions(drawn))  # ``follow`` comes next
            notes.append(self.pin_note)
        else:
            self.plot.show_message(self.message)
        self.note.show_message("\n".join(filter(None, notes)) if drawn else "")
        self.request_extremes(study)

    def shown_parts(self, study: Study) -> Hashable:
        drive, quantities = study.design.drive, self.quantities
        if not self.rows or self.note.text() or self.shows_all_drives or drive.links or self.plot.bands:
            return None  # a reason, a selection or a band depends on more
        parts = [parts_of(study, stage, quantities) for stage in self.stages]
        return self.session.chosen, quantities, drive.limits, study.omega, tuple(parts)

    def lacking(self, study: Study) -> tuple[Quantity, ...]:
        return self.rows if self.plot.lacks_extremes else ()

    def show_extremes(self, extremes: Mapping[str, Extremes] | None) -> None:
        self.plot.show_extremes(extremes)

    def follow(self, theta: float) -> None:
        if self.shows_all_drives:
            self.drives_plot.point_out(degrees(self.player.machine))
            return
        self.plot.set_angle(theta, self.session.at(theta) if self.rows else None)
        self.extremes.resume()

    def selected_number(self) -> ExplainableNumber | None:
        return ExplainableNumber(self.rows[0].slug) if self.rows else None

    @property
    def no_picture(self) -> str:
        return super().no_picture or self.message

    def picture(self, ending: str) -> bytes:
        """Return the plot without the cursor, as the content of a file."""
        from kindyna_gui.pictures.painter import curves_file

        self.pull()
        if self.shows_all_drives:
            return super().picture(ending)
        return curves_file(self.session.study, [self.rows], ending, self.marks.isChecked(), self.companions)


# -- stack of plots --------------------------------------------------------------------------------------


class StackView(PlotsView):
    """A plot for each quantity of ``SHARES``; a plot without a curve shows the reason."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        first, *_, last = SHARES
        self.plots = {name: LivePlot(names=name == first, angles=name == last) for name in SHARES}
        self._drawn: dict[str, list[Quantity]] = {}
        for plot in self.plots.values():
            self.offer_explanation(plot)
            self.offer_actions(plot, partial(self._rows_of, plot))
        self.set_column(*self.plots.values(), grows=self.plots[first])
        for index, share in enumerate(SHARES.values()):
            self.content.layout().setStretch(index, share)  # type: ignore[union-attr]
        self.content.setBackgroundRole(QPalette.ColorRole.Base)
        self.content.setAutoFillBackground(True)

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Stages that the quantities on display need."""
        return stages_of(quantities_for(self.session.study, tuple(SHARES)))

    def refresh(self, study: Study) -> None:
        for name, plot in self.plots.items():
            drawn, missing = split(study, rows_of(study, quantities_for(study, (name,))))
            self._drawn[name] = list(drawn)
            plot.name_angle(study)
            if drawn:
                plot.set_curves(study, drawn, read=False, **self.companions(drawn))  # ``follow`` comes next
            else:
                plot.show_message("\n".join(missing) or why_empty(study, (name,)))
        self.request_extremes(study)

    def _rows_of(self, plot: LivePlot) -> list[Quantity]:
        return next((rows for name, rows in self._drawn.items() if self.plots[name] is plot), [])

    def lacking(self, study: Study) -> tuple[Quantity, ...]:
        return tuple(row for name, plot in self.plots.items() if plot.lacks_extremes for row in self._drawn[name])

    def show_extremes(self, extremes: Mapping[str, Extremes] | None) -> None:
        for plot in self.plots.values():
            if extremes is None or plot.lacks_extremes:  # marks of the other plots are current
                plot.show_extremes(extremes)

    def follow(self, theta: float) -> None:
        for name, plot in self.plots.items():
            plot.set_angle(theta, self.session.at(theta) if self._drawn[name] else None)
        self.extremes.resume()

    def selected_number(self) -> ExplainableNumber | None:
        name = next((name for name, plot in self.plots.items() if plot.underMouse()), "pressure_angle")
        rows = self._drawn.get(name)
        return ExplainableNumber(rows[0].slug) if rows else None

    def picture(self, ending: str) -> bytes:
        """Return the plots without the cursor, as the content of a file."""
        from kindyna_gui.pictures.painter import curves_file

        self.pull()
        drawn = [rows for rows in self._drawn.values() if rows]
        return curves_file(self.session.study, drawn, ending, self.marks.isChecked(), self.companions)
