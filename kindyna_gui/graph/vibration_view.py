"""The response spectrum of an elastic follower: how it vibrates in each dwell at the design's speed, and against speed."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QSplitter

from core.design import UNITS, Design
from core.elastic import ResidualVibration, Spectrum
from core.errors import KindynaError
from core.output.subject_files import SPECTRUM_SPEEDS, speeds_of, units_of
from core.study import Study
from kindyna_gui.background_view import BackgroundView
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.amount import fill_choices
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import reason
from kindyna_gui.note import beside
from kindyna_gui.pictures.plots.under_mouse import CursorPlot
from kindyna_gui.pictures.plots.xy import ROWS, Line
from kindyna_gui.pictures.units import DisplayUnit, digits, measure, readable, short
from kindyna_gui.player import Player
from kindyna_gui.requirements import NO_ELASTIC, RIGID_FOLLOWER, NotHere

NO_DWELL = "The motion has no dwell in which the follower could come to rest."
SPEED = "Machine speed, rpm"
FROM_REST, STEADY, ACCELERATION = "from_rest", "steady", "acceleration"
PAGES = {FROM_REST: "Residual, from rest", STEADY: "Residual, steady", ACCELERATION: "Largest acceleration"}
TIPS = {
    FROM_REST: "what the motion since the dwell before leaves in a dwell, if the follower stood still at its end",
    STEADY: "what it does turn after turn: earlier strokes are still ringing",
    ACCELERATION: "the largest of the elastic follower over the turn; of an arm that of the roller's centre",
}
PAGE_WIDTH = 160  # pixels
HEADINGS = (
    TableHeading("Dwell", wide=True), TableHeading("From rest", number=True), TableHeading("", number=True),
        TableHeading("Steady", number=True),
    TableHeading("", number=True),
)  # fmt: skip
ROOMY = 300  # pixels of height from which on the table is shown
RPM = UNITS["rpm"].factor
CROWDED = 2.5  # times the greatest value up to the design's speed: what is higher is not shown, else that speed lies on the axis


class VibrationView(BackgroundView):
    """Computed beside the window while it can be seen; it follows each step of an edit."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.page, self.text = WordBox(), QLabel(wordWrap=True)
        self.page.setAccessibleName("What is shown over speed")
        fill_choices(self.page, PAGES)
        for i, tip in enumerate(TIPS.values()):
            self.page.setItemData(i, tip, Qt.ItemDataRole.ToolTipRole)
        self.page.setMinimumWidth(PAGE_WIDTH)
        self.plot, self.table = CursorPlot(SPEED, reads=True), RowsTable(HEADINGS)
        self.plot.setMinimumSize(220, 100)
        self.table.setMinimumHeight(40)
        self._summary, self._read_of = "", _Reading()
        self._work.result.connect(self._computed)
        self.page.activated.connect(self._choose)
        self.plot.read.connect(self._read)
        row = beside(self.page, self.text)
        parted = QSplitter(Qt.Orientation.Vertical)
        parted.addWidget(self.plot)
        parted.addWidget(self.table)
        parted.setSizes([3000, 1000])
        self.set_column(row, parted, grows=parted)

    def refresh(self, study: Study) -> None:
        if study.design.drive.cam is None:
            raise NotHere(NO_ELASTIC)
        if not study.is_elastic:
            raise NotHere(RIGID_FOLLOWER)
        study.elasticity  # noqa: B018 - says why, where nothing vibrates
        page = str(self.page.currentData())
        self._work.start([((page, study.design), partial(_found, study.design, page))])

    def resizeEvent(self, event: QResizeEvent) -> None:
        """The names of the curves hold the figures too: where the view is low the plot has its height for itself."""
        super().resizeEvent(event)
        self.table.setVisible(self.height() >= ROOMY)

    def _choose(self, _: int) -> None:
        self._stale = True
        self.pull()

    def _computed(
        self, key: tuple[str, Design], result: tuple[tuple[ResidualVibration, ...], Spectrum] | KindynaError
    ) -> None:
        page, design = key
        if isinstance(result, KindynaError):
            self._summary, self._read_of = "", _Reading()
            self.table.show_rows([])
            self.plot.show_message(reason(design, result))
            self._read(None)
            return
        residuals, found = result
        study = Study(design)
        one = study.elasticity.middle
        periods = short(one.natural_frequency / abs(study.omega), 4)
        frequency = measure(one.natural_frequency / math.tau, "Hz")
        self._summary = (
            f"Natural frequency {frequency}, {periods} periods a turn, damping ratio {short(one.damping_ratio, 3)}"
        )
        self.table.show_rows([_row(study, each) for each in residuals])
        self._draw(study, page, residuals, found)
        self._read(self.plot.cursor_at)

    def _draw(self, study: Study, page: str, residuals: tuple[ResidualVibration, ...], found: Spectrum) -> None:
        rpm = found.omega / RPM
        (_, size), *_ = units_of(study)
        if page == ACCELERATION:
            names: tuple[str, ...] = ("from rest", "steady")
            title, symbol = "Acceleration", UNITS["mm_s2"].symbol
            values, now = found.acceleration * size, []
        elif residuals:
            names, title, symbol = tuple(_span(each) for each in residuals), "Residual", UNITS["mm"].symbol
            values = found.residual[(FROM_REST, STEADY).index(page)] * size
            now = [_in_mm(getattr(each, page) * size) for each in residuals]
        else:
            self._read_of = _Reading()
            self.plot.show_message(NO_DWELL)
            return
        shown = np.where(np.isfinite(values), values, np.nan)
        own = abs(study.omega) / RPM
        near = shown[:, rpm <= own]
        most = CROWDED * float(np.nanmax(near)) if np.isfinite(near).any() else math.inf
        rung = readable(symbol, min(most, float(np.nanmax(shown, initial=0.0))))
        self.plot.name_axes(SPEED, f"{title}, {rung.symbol}")
        colours = [ROWS[i % len(ROWS)] for i in range(len(names))]
        labels = [f"{name}: {value}" for name, value in zip(names, now, strict=True)] if now else names
        lines = [
            Line(rpm, y / rung.size, colour, label) for y, colour, label in zip(shown, colours, labels, strict=True)
        ]
        self.plot.show_lines(lines, ((own, "now"),))
        highest = min(most, float(np.nanmax(shown, initial=0.0))) / rung.size
        if highest > 0.0:
            self.plot.show_range(upwards=(0.0, 1.05 * highest))
        self._read_of = _Reading(rpm, values, names, rung)

    def _read(self, at: float | None) -> None:
        """The values at the mouse; what is known of the follower where it is elsewhere."""
        self.text.setText((self._read_of.text(at) if at is not None else "") or self._summary)

    def settle(self) -> None:
        super().settle()
        self._work.wait(30.0)


class _Reading:
    """Values of curves (k, n) over speeds (n,) [rpm], to be read."""

    def __init__(
        self,
        rpm: np.ndarray | None = None,
        values: np.ndarray | None = None,
        names: tuple[str, ...] = (),
        rung: DisplayUnit | None = None,
    ) -> None:
        self._rpm, self._values, self._names, self._rung = rpm, values, names, rung

    def text(self, at: float) -> str:
        """The values at a speed, between those that were computed; empty where there are none."""
        if self._rpm is None or self._values is None or self._rung is None:
            return ""
        symbol = self._rung.symbol
        read = [
            f"{name}: {measure(float(np.interp(at, self._rpm, row)) / self._rung.size, symbol, 3)}"
            for name, row in zip(self._names, self._values, strict=True)
        ]
        return f"{digits(at, 4)} rpm, " + ", ".join(read)


def _span(residual: ResidualVibration) -> str:
    return f"{short(math.degrees(residual.dwell.start), 4)}–{short(math.degrees(residual.dwell.end), 4)}°"


def _in_mm(value: float) -> str:
    rung = readable("mm", value)
    return measure(value / rung.size, rung.symbol, 3)


def _row(study: Study, residual: ResidualVibration) -> TableRow:
    """Both amplitudes, in millimetres, and in degrees where the motion turns."""
    rows = (("from rest", residual.from_rest), ("steady", residual.steady))
    (_, size), *swings = units_of(study)
    cells = [_span(residual)]
    for _, value in rows:
        cells.append(_in_mm(value * size))
        cells.append(measure(value * swings[0][1], "°", 3) if swings else "")
    return TableRow(
        tuple(cells),
        tip="amplitude of the follower's error z - s about the place where it would stand, at the dwell's start",
    )


def _found(design: Design, page: str) -> tuple[tuple[ResidualVibration, ...], Spectrum]:
    study = Study(design)
    return study.follower_response.residuals, study.vibration(
        speeds_of(study, count=SPECTRUM_SPEEDS), page == ACCELERATION
    )


__all__ = ["VibrationView"]
