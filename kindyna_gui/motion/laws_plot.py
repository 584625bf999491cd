"""New motions of machines, plots that compare motion laws, and the ranking of laws or blends in a design."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QHideEvent, QPainter, QPaintEvent, QResizeEvent, QShowEvent
from PySide6.QtWidgets import (
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from core.design import Design
from core.errors import DesignError, KindynaError
from core.find import RankingColumn, RankingRow, ranking_columns, ranking_row, sorted_rows
from core.find.ranking import Candidate
from core.frozen import frozen
from core.laws import LAWS, Law
from core.motion.new_motions import FlyingShear, Indexer, flying_shear, indexer
from core.numerics.lazy import Cancelled
from core.output.channels import new_design_text
from core.output.drawing.palette import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION
from core.output.drawing.turn import shown_range
from core.requests import command_words
from kindyna_gui.background import Background
from kindyna_gui.forms.request_form import RequestDialog, RequestForm
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import law_label, sentence
from kindyna_gui.look import coloured, linked
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.plots.lines import LEFT_WIDTH
from kindyna_gui.pictures.plots.plot import RIGHT_MARGIN
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import SCREEN, SMALL, Theme, font
from kindyna_gui.pictures.units import digits
from kindyna_gui.rebuilt import ContentArea, fill, single_shot
from kindyna_gui.requirements import NO_RANKING
from kindyna_gui.settings import sized

TEXT_WIDTH = 380  # of a dialog, pixels
POINTS = 241  # of a piece of a law
QUANTITIES = (
    ("Displacement", "s", "displacement"),
    ("Velocity", "v", "velocity"),
    ("Acceleration", "a", "acceleration"),
    ("Jerk", "j", "jerk"),
)
"""Name, symbol and family of each plot, in the order of the derivatives."""
COLOURS = (BLUE, VERMILION, GREEN, BLACK, PURPLE, ORANGE, SKY)
DASHES: tuple[tuple[float, ...], ...] = ((), (8.0, 3.0), (2.0, 2.0), (9.0, 3.0, 2.0, 3.0), (14.0, 4.0))
REDRAW_MS, POLL_MS = 80, 20
HEADING_MARGIN = 24  # pixels next to a heading, with room for the arrow of sorting
NO_VALUE = "–"

# -- new motions -----------------------------------------------------------------------------------------


@frozen
class NewMotion:
    """A motion that a design can begin with.

    Attributes
    ----------
    title : name in the menu
    command : command of the command line
    kind : dataclass of the request
    make : function from the request to the design
    """

    title: str
    command: str
    kind: Any
    make: Callable[[Any], Design]


NEW_MOTIONS: Mapping[str, NewMotion] = MappingProxyType(
    {
        "indexer": NewMotion("Indexer", "indexer", Indexer, indexer),
        "flying_shear": NewMotion("Flying shear", "flying-shear", FlyingShear, flying_shear),
    }
)


class NewMotionDialog(RequestDialog):
    """Form of a row of ``NEW_MOTIONS``."""

    reads = False

    def __init__(self, parent: QWidget, row: NewMotion) -> None:
        self.row, self.command, self.help_page = row, row.command, f"making#{row.title}"
        super().__init__(
            parent, f"New {row.title[:1].lower()}{row.title[1:]}", RequestForm(row.kind), "Begin", self._message
        )
        self.summary.setFixedWidth(TEXT_WIDTH)
        self.summary.setMinimumHeight(6 * self.fontMetrics().lineSpacing())
        self.form.note_valid()

    def command_options(self) -> tuple[str, list[str]]:
        return f"{self.command}.toml", command_words(self.row.kind, self.form.values)

    def design(self) -> Design:
        """Return the requested design; raises DesignError where it is not possible."""
        return self._build(self.form.values)

    def _build(self, values: Mapping[str, Any]) -> Design:
        return self.row.make(self.row.kind(**values))

    def _message(self, values: Mapping[str, Any]) -> str:
        try:
            return new_design_text(self._build(values))
        except DesignError:
            return ""

    @property
    def is_complete(self) -> bool:
        return super().is_complete and not self._misfit

    @property
    def _misfit(self) -> str:
        """Why the values do not fit together."""
        try:
            self.design()
        except DesignError as error:
            return "; ".join(f"{fault.problem}; allowed: {fault.allowed}" for fault in error.faults)
        return ""

    def update_summary(self) -> None:
        super().update_summary()
        if self.form.is_valid:
            self.form.refuse_last(self._misfit)
        if self.is_complete:
            self.form.note_valid()


def ask_new_motion(parent: QWidget, name: str) -> Design | None:
    """Ask for a row of ``NEW_MOTIONS`` and return its design; None if the user cancels."""
    dialog = NewMotionDialog(parent, NEW_MOTIONS[name])
    accepted = dialog.exec() == RequestDialog.DialogCode.Accepted
    design = dialog.design() if accepted else None
    dialog.deleteLater()
    return design


# -- plots of laws ---------------------------------------------------------------------------------------


@frozen
class LineStyle:
    """Colour, dashes and relative width of a curve."""

    colour: str
    dash: tuple[float, ...]
    width: int = 1


def line_style(number: int) -> LineStyle:
    """Line style of a curve by its number from 0.

    All styles differ, and successive ones differ in colour and in dashes, so that curves can be distinguished without
    colour; after all combinations the lines become wider.
    """
    colours, dashes = len(COLOURS), len(DASHES)
    return LineStyle(COLOURS[number % colours], DASHES[number % dashes], 1 + number // (colours * dashes))


@cache
def _samples(law: Law) -> tuple[np.ndarray, np.ndarray]:
    """Return u (n,) and s, v, a, j (4, n) of a law, with both sides of the joins inside, so that jumps are vertical."""
    starts = [piece.start for piece in law.pieces]
    rows = []
    for start, end in zip(starts, [*starts[1:], 1.0], strict=True):
        u = np.linspace(start, end, POINTS)
        u[-1] = end if end == 1.0 else np.nextafter(end, 0.0)
        rows.append(u)
    u = np.concatenate(rows)
    return u, law(u)


def show_laws(plot: XYPlot, order: int, laws: Sequence[tuple[Law, LineStyle]]) -> None:
    """Draw a quantity of these laws; order: its number in ``QUANTITIES``."""
    quantity, symbol, family = QUANTITIES[order]
    lines = [
        Line(_samples(law)[0], _samples(law)[1][order], style.colour, dash=style.dash, width=style.width)
        for law, style in laws
    ]
    if lines:
        plot.name_axes("u, share of the span", f"{quantity}, {symbol}")
        plot.show_lines(lines)
        plot.show_range(upwards=shown_range([line.y for line in lines], {family}, ()))
    else:
        plot.show_message("")


class LawsLegend(QWidget):
    """Legend with names and line styles, in as many lines as it needs."""

    GAP, LINE, SAMPLE = 16, 17, 26  # pixels: between entries, height of a line, length of a sample

    def __init__(self, theme: Theme = SCREEN) -> None:
        super().__init__()
        self._theme = theme
        self.laws: list[tuple[Law, LineStyle]] = []
        policy = QSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.setSizePolicy(policy)

    def show_laws(self, laws: Sequence[tuple[Law, LineStyle]]) -> None:
        """Show these laws."""
        self.laws = list(laws)
        self.setAccessibleName("Laws drawn: " + (", ".join(law.label for law, _ in laws) or "none"))
        self._fit()
        self.update()

    def _positions(self) -> list[tuple[float, int]]:
        """Left edge [pixels] and line of each entry."""
        left = sized(LEFT_WIDTH)
        positions, x, line = [], left, 0
        for law, _ in self.laws:
            width = self.SAMPLE + 6.0 + text_size(law.label, SMALL)[0]
            if x > left and x + width > self.width() - RIGHT_MARGIN:
                x, line = left, line + 1
            positions.append((x, line))
            x += width + self.GAP
        return positions

    def _fit(self) -> None:
        lines = 1 + max((line for _, line in self._positions()), default=0)
        self.setFixedHeight(round(lines * sized(self.LINE)) + 6)

    def update_style(self) -> None:
        """Follow a change of theme or font size."""
        self._fit()
        self.update()

    def sizeHint(self) -> QSize:
        return QSize(LEFT_WIDTH, round(sized(self.LINE)) + 6)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(self._theme.paper))
        painter.setFont(font(SMALL))
        for (law, style), (x, line) in zip(self.laws, self._positions(), strict=True):
            middle = 4.0 + (line + 0.5) * sized(self.LINE)
            painter.setPen(self._theme.pen(self._theme.seen(style.colour), 2.0 * style.width, style.dash))
            painter.drawLine(QPointF(x, middle), QPointF(x + self.SAMPLE, middle))
            painter.setPen(QColor(self._theme.ink))
            box = QRectF(x + self.SAMPLE + 6.0, middle - sized(self.LINE) / 2.0, self.width(), sized(self.LINE))
            painter.drawText(box, Qt.AlignmentFlag.AlignVCenter, law.label)
        painter.end()


# -- ranking ---------------------------------------------------------------------------------------------


class RankingPanel(QWidget):
    """Table that ranks laws or blends in a design, computed in the background once the table is visible.

    ``offer`` sets the candidates. A candidate that is not possible shows the reason instead of its figures. ``chosen`` (str)
    gives the name of a selected candidate.

    Attributes
    ----------
    rows : results so far, by the names of the candidates
    figures : columns
    """

    chosen = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.rows: dict[str, RankingRow] = {}
        self.figures: tuple[RankingColumn, ...] = ()
        self.table: RowsTable | None = None
        self._candidates: Mapping[str, Candidate] = {}
        self._design: Design | None = None
        self._current, self._mark, self._stale = "", "", True
        self._shown: list[str] = []  # names, from top to bottom
        self._order: tuple[int, bool] | None = (0, False)  # figure, descending
        self._work = Background(self, POLL_MS)
        self._work.result.connect(self._take_result)
        self._soon = single_shot(self, self._show, REDRAW_MS)
        self.bar, self.text = QProgressBar(textVisible=False), QLabel()
        self.bar.setAccessibleName("Ranking")
        self.bar.setFixedHeight(10)
        self.text.setWordWrap(True)
        coloured(self.text, SCREEN.quiet)
        self.cancel, self.resume = QPushButton("Cancel"), QPushButton("Continue")
        for button, do in ((self.cancel, self._work.cancel), (self.resume, self._begin)):
            button.setAutoDefault(False)
            button.clicked.connect(lambda _=False, do=do: do())
        self._table = ContentArea()
        row = fill(QHBoxLayout(), (self.text, 1), (self.bar, 1), self.cancel, self.resume, margins=(6, 3, 6, 3))
        fill(QVBoxLayout(self), (self._table, 1), row, margins=0, spacing=0)

    @property
    def busy(self) -> bool:
        """Whether the ranking is still being computed."""
        return self._work.busy or self._soon.isActive()

    def offer(self, design: Design, candidates: Mapping[str, Candidate], current: str = "", mark: str = "now") -> None:
        """Compare these candidates in a design; current: the one with the mark."""
        self.stop()
        self._mark = mark
        self._candidates, self._current, self.rows, self._stale = dict(candidates), current, {}, True
        self._design = design
        if self.isVisible():
            self._start()

    def stop(self) -> None:
        """Stop the calculation."""
        self._work.stop()
        self._soon.stop()

    def close_work(self) -> None:
        """Stop the calculation and wait for its end."""
        self._work.close()

    # -- calculation -------------------------------------------------------------------------------------

    def _start(self) -> None:
        assert self._design is not None
        self._stale = False
        self._name_columns(ranking_columns(self._design))
        self._begin()

    def _begin(self) -> None:
        """Compute the missing rows."""
        missing = [name for name in self._candidates if name not in self.rows] if self.figures else []
        self._work.start([(name, partial(ranking_row, name, self._candidates[name], self.figures)) for name in missing])
        self._show()

    def _take_result(self, name: str, result: RankingRow | KindynaError | Cancelled) -> None:
        if isinstance(result, RankingRow):
            self.rows[name] = result
        if self._work.busy:
            if not self._soon.isActive():
                self._soon.start()
        else:
            self._soon.stop()
            self._show()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if self._stale and self._design is not None:
            self._start()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        if self._work.busy:
            self.stop()
            self._stale = True

    # -- table -------------------------------------------------------------------------------------------

    def _name_columns(self, figures: tuple[RankingColumn, ...]) -> None:
        if figures == self.figures and self.table is not None:
            return
        self.figures = figures
        self._order = (0, False)
        columns = [TableHeading(f"{figure.title}\n{figure.symbol}", number=True, tip=figure.help) for figure in figures]
        self.table = table = RowsTable([TableHeading("Law or blend", wide=True), *columns])
        header = table.horizontalHeader()
        for number, figure in enumerate(figures, 1):
            header.setSectionResizeMode(number, QHeaderView.ResizeMode.Fixed)
            header.resizeSection(number, table.fontMetrics().horizontalAdvance(figure.title) + HEADING_MARGIN)
        header.setSectionsClickable(True)
        header.setSortIndicatorShown(True)
        header.setSortIndicator(-1, Qt.SortOrder.AscendingOrder)
        header.sectionClicked.connect(self._sort)
        for chosen in (table.clicked, table.activated):  # by the mouse, and by Enter
            chosen.connect(lambda index: self.chosen.emit(self._shown[index.row()]))
        self._table.replace(table)

    def _sort(self, column: int) -> None:
        """Sort by a figure, ascending first; the first column restores the order of the candidates."""
        number = column - 1
        if not 0 <= number < len(self.figures):
            self._order = None
        else:
            self._order = (number, self._order == (number, False))
        self._show()

    def _show(self) -> None:
        """Show the results so far."""
        count, total, busy = len(self.rows), len(self._candidates), self._work.busy
        self.bar.setRange(0, max(total, 1))
        self.bar.setValue(count)
        self.bar.setVisible(busy)
        self.cancel.setVisible(busy)
        self.resume.setVisible(bool(self.figures) and not busy and count < total)
        if not self.figures:
            self.text.setText(linked(NO_RANKING))
        else:
            self.text.setText(f"{count} of {total}" if count < total else "")
        if self.table is None:
            return
        rows = [self.rows[name] for name in self._candidates if name in self.rows]
        header = self.table.horizontalHeader()
        if self._order is None:
            header.setSortIndicator(-1, Qt.SortOrder.AscendingOrder)
        else:
            column, descending = self._order
            rows = sorted_rows(rows, column, descending)
            header.setSortIndicator(
                column + 1, Qt.SortOrder.DescendingOrder if descending else Qt.SortOrder.AscendingOrder
            )
        self._shown = [row.name for row in rows]
        self.table.show_rows([self._row(row) for row in rows])

    def _row(self, row: RankingRow) -> TableRow:
        label = law_label(row.name) if row.name in LAWS else row.name
        name = f"{label}  ◂ {self._mark}" if row.name == self._current else label
        if row.problem:
            why = sentence(row.problem)
            return TableRow((name, why, *("" for _ in self.figures[1:])), tip=why, colour=SCREEN.quiet, across=1)
        return TableRow((name, *(NO_VALUE if value is None else digits(value, 4) for value in row.figures)), tip=label)
