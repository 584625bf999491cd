"""Plots over a turn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from math import degrees, radians
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeyEvent, QPalette
from PySide6.QtWidgets import QStackedWidget

from core.errors import KindynaError
from core.motion import degrees as turn_degrees
from core.motion.extremes import Extremes
from core.study import Camshaft, Quantity, Study
from kindyna_gui.documents.pins import Bands, Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.graph.marked_view import MarkedView
from kindyna_gui.look import Note
from kindyna_gui.pictures.plots.quantities import figures_of, quantities_for, rows_of, split, stages_of, why_empty
from kindyna_gui.pictures.plots.xy import MACHINE_ANGLE, MACHINE_TIP, CursorPlot, Line
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import readable
from kindyna_gui.player import Player, obey
from kindyna_gui.requirements import Unavailable, suggestions_for
from kindyna_gui.saving import save_numbers, save_picture
from kindyna_gui.view import ExplainableNumber

# -- drives plot -----------------------------------------------------------------------------------------

TORQUE = "drive_torque"
"""The quantity of which the drives on a shaft have a sum."""


def curves_of_all(shaft: Camshaft[Study], usual: Sequence[str], bands: Bands) -> tuple[list[Line], str, list[str]]:
    """The first of these quantities of each drive over the machine angle [deg] with its band, of torques their sum too; the title of
    the axis; and a line for each drive that is left out."""
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
        band = bands.read(rows[:1], number).get(rows[0].slug)
        place = shaft.positions[name]
        shade = None if band is None else (place.machine_angle(np.deg2rad(turn_degrees(band.shape[1]))), band)
        found.append((place.machine_angle(study.theta), values, SCREEN.drive(number), name, shade))
    if first is None:
        return [], "", missing
    if first.name == TORQUE and len(found) > 1 and not missing:
        sum_band = bands.of_shaft().get("")
        shade = None if sum_band is None else (np.deg2rad(turn_degrees(sum_band.shape[1])), sum_band)
        found.append((shaft.theta, shaft.torque, SCREEN.ink, "Shaft", shade))
    rung = readable(first.unit.symbol, max(float(np.nanmax(np.abs(values))) for _, values, *_ in found))
    lines = [
        Line(*_closed(x, values / rung.size), colour, name, band=shade and _closed(shade[0], shade[1] / rung.size))
        for x, values, colour, name, shade in found
    ]
    return lines, f"{first.label}, {rung.symbol}", missing


def _closed(machine: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Machine angles (n,) [rad] and values (..., n) there as angles (n + 2,) [deg] in their order, from 0 to 360, and values."""
    order = np.argsort(machine)
    x, y = np.degrees(machine[order]), y[..., order]
    part = (360.0 - x[-1]) / (x[0] + 360.0 - x[-1])
    edge = y[..., -1:] + part * (y[..., :1] - y[..., -1:])
    return np.concatenate(([0.0], x, [360.0])), np.concatenate((edge, y, edge), axis=-1)


# -- curves over one turn, one plot in each dock ---------------------------------------------------------

LEAST_WIDTH = 240  # below it labels and axes no longer fit


class PlotView(MarkedView):
    """One plot of a few quantities of one unit; those that a design does not have are named with the reason."""

    def __init__(self, session: Session, player: Player, quantities: Sequence[str]) -> None:
        super().__init__(session, player)
        self.usual = tuple(quantities)
        self.plot = LivePlot()
        self.plot.setMinimumWidth(LEAST_WIDTH)
        self.note = Note(SCREEN.quiet, margin=3)
        self.note.setIndent(6)
        self.rows: tuple[Quantity, ...] = ()
        self.message = ""  # in place of the curves
        self._pages = QStackedWidget()
        self._pages.addWidget(self.plot)
        self._drives: CursorPlot | None = None  # made when it is first asked for
        self.set_column(self._pages, self.note, grows=self._pages)
        self.content.setBackgroundRole(QPalette.ColorRole.Base)
        self.content.setAutoFillBackground(True)
        self.plot.angle_moved.connect(self._turn)
        self.offer_explanation(self.plot)
        for text, slot in (
            ("Export picture...", lambda: save_picture(self, self.usual[0])),
            ("Export numbers...", lambda: save_numbers(self, self.rows, self.usual[0])),
        ):
            action = QAction(text, self.plot)
            action.triggered.connect(slot)
            self.plot.addAction(action)
        self.plot.addActions([self.marks, self.plot.whole_action])
        self.offer_deeds(self.plot, lambda: self.rows)
        self.all_drives = QAction("Of all drives", self, checkable=True, visible=session.several)
        self.all_drives.setToolTip(
            "All drives on the shaft by their colours over the machine angle; of torques their sum too"
        )
        self.all_drives.toggled.connect(self.invalidate)
        self.plot.addAction(self.all_drives)
        session.full_design_changed.connect(self._whole_changed)
        Pins.of(session).changed.connect(self.invalidate)

    @property
    def quantities(self) -> tuple[str, ...]:
        """What is shown of the design in place."""
        return quantities_for(self.session.study, self.usual)

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Those that the quantities shown need."""
        return stages_of(self.quantities)

    @property
    def shows_all(self) -> bool:
        """Whether the curves are those of all drives on the shaft."""
        return self.all_drives.isChecked() and self.all_drives.isVisible()

    @property
    def plot_of_all(self) -> CursorPlot:
        """The plot of all drives, made now where it is not there yet."""
        if self._drives is None:
            self._drives = CursorPlot(MACHINE_ANGLE)
            self._drives.setToolTip(MACHINE_TIP)
            self._drives.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)
            self._drives.addAction(self.all_drives)
            self._drives.moved.connect(self._turn_machine)
            self._pages.addWidget(self._drives)
        return self._drives

    def _whole_changed(self) -> None:
        self.all_drives.setVisible(self.session.several)
        if self.all_drives.isChecked():
            self.invalidate()

    def _show_all(self, study: Study) -> None:
        """The curves of all drives, each over the machine angle."""
        lines, title, missing = curves_of_all(self.session.shaft, self.usual, self.bands)
        if lines:
            self.plot_of_all.name_axes(MACHINE_ANGLE, title)
            self.plot_of_all.show_lines(lines)
        else:
            self.plot_of_all.show_message("\n".join(missing) or why_empty(study, self.usual))
        self.note.show_message("; ".join(missing) if lines else "")
        self._pages.setCurrentWidget(self.plot_of_all)

    def _turn_machine(self, machine: float) -> None:
        self.player.play(False)
        self.player.set_machine(radians(machine))

    def refresh(self, study: Study) -> None:
        if self.shows_all:
            self._show_all(study)
            return
        self._pages.setCurrentWidget(self.plot)
        quantities = self.quantities
        if not quantities and study.design.drive.links:
            _ = study.linkage  # where it stands nowhere, that is the reason
        drawn, missing = split(study, rows_of(study, quantities))
        self.rows = tuple(drawn)
        self.plot.name_angle(study)
        self.message = "" if drawn else "\n".join(missing) or why_empty(study, self.usual)
        if suggestions_for(self.message):
            raise Unavailable(self.message)
        notes = ["; ".join(missing), *figures_of(study, self.usual)]
        if drawn:
            pinned, lacking = self._pinned(drawn)
            bands = self.bands.read(drawn)
            self.plot.set_curves(study, drawn, pinned, read=False, bands=bands)  # ``follow`` comes next
            notes.append(lacking)
        else:
            self.plot.show_message(self.message)
        self.note.show_message("\n".join(filter(None, notes)) if drawn else "")
        self.look_for_extremes(study)

    def _pinned(self, drawn: Sequence[Quantity]) -> tuple[Study | None, str]:
        """The pinned variant, drawn dashed, where it has these quantities; else why it is not."""
        pins = Pins.of(self.session)
        study = pins.study
        if study is None or pins.front is None:
            return None, ""
        try:
            with pins.named():
                there, missing = split(study, rows_of(study, [row.name for row in drawn]))
                for row in there:
                    row.value(study)
        except Unavailable as error:
            return None, str(error)
        if missing or len(there) < len(drawn):
            return None, f"Pinned {pins.front.name} has no such curve"
        return study, ""

    def lacking(self, study: Study) -> tuple[Quantity, ...]:
        return self.rows if self.plot.lacks_extremes else ()

    def show_extremes(self, found: Mapping[str, Extremes] | None) -> None:
        self.plot.show_extremes(found)

    def follow(self, theta: float) -> None:
        if self.shows_all:
            self.plot_of_all.point_out(degrees(self.player.machine))
            return
        self.plot.set_angle(theta, self.session.at(theta) if self.rows else None)
        self.extremes.resume()

    def selected_number(self) -> ExplainableNumber | None:
        return ExplainableNumber(self.rows[0].slug) if self.rows else None

    def _turn(self, theta: float) -> None:
        self.player.play(False)
        self.player.set_theta(theta)

    @property
    def no_picture(self) -> str:
        return super().no_picture or self.message

    def picture(self, ending: str) -> bytes:
        """The plot on paper, without the cursor."""
        from kindyna_gui.pictures.painter import curves_file

        self.pull()
        if self.shows_all:
            return super().picture(ending)
        bands = self.bands.read(self.rows)
        return curves_file(self.session.study, [self.rows], ending, self.marks.isChecked(), bands)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not obey(self.player, event):
            super().keyPressEvent(event)


# -- stack view ------------------------------------------------------------------------------------------

SHARES: Mapping[str, int] = MappingProxyType(
    {"displacement": 22, "velocity": 18, "acceleration": 18, "jerk": 18, "pressure_angle": 24}
)
"""Quantity -> its share of the height; the first has the names of the segments above it, the last the angles below it."""


class StackView(MarkedView):
    """One plot for each of ``SHARES``; one that the design does not have says why."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        first, *_, last = SHARES
        self.plots = {name: LivePlot(names=name == first, angles=name == last) for name in SHARES}
        self._drawn: dict[str, list[Quantity]] = {}
        for plot in self.plots.values():
            plot.setMinimumHeight(1)
            plot.angle_moved.connect(self._turn)
            self.offer_explanation(plot)
            self.offer_deeds(plot, partial(self._rows_of, plot))
            plot.addActions([self.marks, plot.whole_action])
        self.set_column(*self.plots.values(), grows=self.plots[first])
        for index, share in enumerate(SHARES.values()):
            self.content.layout().setStretch(index, share)  # type: ignore[union-attr]
        self.content.setBackgroundRole(QPalette.ColorRole.Base)
        self.content.setAutoFillBackground(True)

    @property
    def stages(self) -> tuple[str, ...]:  # type: ignore[override]
        """Those that the quantities shown need."""
        return stages_of(quantities_for(self.session.study, tuple(SHARES)))

    def refresh(self, study: Study) -> None:
        for name, plot in self.plots.items():
            drawn, missing = split(study, rows_of(study, quantities_for(study, (name,))))
            self._drawn[name] = list(drawn)
            plot.name_angle(study)
            if drawn:
                plot.set_curves(study, drawn, read=False, bands=self.bands.read(drawn))  # ``follow`` comes next
            else:
                plot.show_message("\n".join(missing) or why_empty(study, (name,)))
        self.look_for_extremes(study)

    def _rows_of(self, plot: LivePlot) -> list[Quantity]:
        return next((rows for name, rows in self._drawn.items() if self.plots[name] is plot), [])

    def lacking(self, study: Study) -> tuple[Quantity, ...]:
        return tuple(row for name, plot in self.plots.items() if plot.lacks_extremes for row in self._drawn[name])

    def show_extremes(self, found: Mapping[str, Extremes] | None) -> None:
        for plot in self.plots.values():
            if found is None or plot.lacks_extremes:  # those that were found before are not among them
                plot.show_extremes(found)

    def follow(self, theta: float) -> None:
        for name, plot in self.plots.items():
            plot.set_angle(theta, self.session.at(theta) if self._drawn[name] else None)
        self.extremes.resume()

    def selected_number(self) -> ExplainableNumber | None:
        chosen = next((name for name, plot in self.plots.items() if plot.underMouse()), "pressure_angle")
        rows = self._drawn.get(chosen)
        return ExplainableNumber(rows[0].slug) if rows else None

    def _turn(self, theta: float) -> None:
        self.player.play(False)
        self.player.set_theta(theta)

    def picture(self, ending: str) -> bytes:
        """The plots on paper, without the cursor."""
        from kindyna_gui.pictures.painter import curves_file

        self.pull()
        drawn = [rows for rows in self._drawn.values() if rows]
        bands = self.bands.read([row for rows in drawn for row in rows])
        return curves_file(self.session.study, drawn, ending, self.marks.isChecked(), bands)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not obey(self.player, event):
            super().keyPressEvent(event)
