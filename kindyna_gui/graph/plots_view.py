"""Curves over one turn, one plot in each dock."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import degrees, radians

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeyEvent, QPalette
from PySide6.QtWidgets import QStackedWidget

from core.motion.extremes import Extremes
from core.study import Quantity, Study
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.drives_plot import curves_of_all
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.graph.marked_view import MarkedView
from kindyna_gui.note import Note
from kindyna_gui.pictures.plots.quantities import figures_of, quantities_for, rows_of, split, stages_of, why_empty
from kindyna_gui.pictures.plots.under_mouse import MACHINE_ANGLE, MACHINE_TIP, CursorPlot
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player, obey
from kindyna_gui.requirements import NotHere, ways_of
from kindyna_gui.saving import save_numbers, save_picture
from kindyna_gui.view import NumberAtHand

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
        session.whole_changed.connect(self._whole_changed)
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
        if ways_of(self.message):
            raise NotHere(self.message)
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
        except NotHere as error:
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

    def number_at_hand(self) -> NumberAtHand | None:
        return NumberAtHand(self.rows[0].slug) if self.rows else None

    def _turn(self, theta: float) -> None:
        self.player.play(False)
        self.player.set_theta(theta)

    @property
    def no_picture(self) -> str:
        return super().no_picture or self.message

    def picture(self, ending: str) -> bytes:
        """The plot on paper, without the cursor."""
        from kindyna_gui.pictures.files import curves_file

        self.pull()
        if self.shows_all:
            return super().picture(ending)
        bands = self.bands.read(self.rows)
        return curves_file(self.session.study, [self.rows], ending, self.marks.isChecked(), bands)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if not obey(self.player, event):
            super().keyPressEvent(event)


__all__ = ["PlotView"]
