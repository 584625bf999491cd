"""Laws compared."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from types import MappingProxyType
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, QTimer, Signal
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
from core.errors import KindynaError
from core.find import RankingColumn, RankingRow, ranking_columns, ranking_row, sorted_rows
from core.find.ranking import Candidate
from core.frozen import frozen
from core.laws import LAWS, Law
from core.motion.curves import FlyingShear, Indexer, flying_shear, indexer
from core.numerics.lazy import Cancelled
from core.output.channels import new_design_text
from core.requests import command_words
from kindyna_gui.background import Background
from kindyna_gui.forms.request_form import RequestDialog, RequestForm
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import law_label, sentence
from kindyna_gui.look import coloured, linked
from kindyna_gui.pictures.items import text_size
from kindyna_gui.pictures.plots.lines import LEFT_WIDTH
from kindyna_gui.pictures.plots.plot import RIGHT_MARGIN, shown_range
from kindyna_gui.pictures.plots.xy import Line, XYPlot
from kindyna_gui.pictures.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SCREEN, SKY, SMALL, VERMILION, Theme, font
from kindyna_gui.pictures.units import digits
from kindyna_gui.rebuilt import ContentArea
from kindyna_gui.requirements import NO_RANKING
from kindyna_gui.settings import sized

# -- begin dialog ----------------------------------------------------------------------------------------

WIDTH = 380  # pixels


@frozen
class Beginning:
    """One row: title, command of the command line, what is asked for, what makes the design of it."""

    title: str
    command: str
    kind: Any
    make: Callable[[Any], Design]


BEGINNINGS: Mapping[str, Beginning] = MappingProxyType(
    {
        "indexer": Beginning("Indexer", "indexer", Indexer, indexer),
        "flying_shear": Beginning("Flying shear", "flying-shear", FlyingShear, flying_shear),
    }
)


class BeginDialog(RequestDialog):
    """The form of a row of ``BEGINNINGS``."""

    reads = False

    def __init__(self, parent: QWidget, row: Beginning) -> None:
        self.row, self.command, self.help_page = row, row.command, f"making#{row.title}"
        super().__init__(
            parent, f"New {row.title[:1].lower()}{row.title[1:]}", RequestForm(row.kind), "Begin", self._tell
        )
        self.summary.setFixedWidth(WIDTH)
        self.summary.setMinimumHeight(6 * self.fontMetrics().lineSpacing())
        self.form.changed.connect(self._allow)
        self._allow()

    def command_options(self) -> tuple[str, list[str]]:
        return f"{self.command}.toml", command_words(self.row.kind, self.form.values)

    def design(self) -> Design:
        """That is asked for. Raises DesignError where it cannot be."""
        return self.row.make(self.row.kind(**self.form.values))

    def _tell(self, values: Mapping[str, Any]) -> str:
        try:
            return new_design_text(self.row.make(self.row.kind(**values)))
        except KindynaError as error:
            return str(error)

    def _allow(self) -> None:
        try:
            self.design()
        except KindynaError:
            self.accept_button.setEnabled(False)
        else:
            self.accept_button.setEnabled(True)


def beginning_wanted(parent: QWidget, name: str) -> Design | None:
    """Ask for what a design begins with; None where the user cancels."""
    dialog = BeginDialog(parent, BEGINNINGS[name])
    accepted = dialog.exec() == RequestDialog.DialogCode.Accepted
    made = dialog.design() if accepted else None
    dialog.deleteLater()
    return made


# -- laws plot -------------------------------------------------------------------------------------------

POINTS = 241  # of a piece of a law
QUANTITIES = (
    ("Displacement", "s", "displacement"),
    ("Velocity", "v", "velocity"),
    ("Acceleration", "a", "acceleration"),
    ("Jerk", "j", "jerk"),
)
"""Name, letter and family of each plot, in the order of the derivatives."""


@frozen
class LineStyle:
    """Colour and dashes of a curve, and how many times as wide as others it is."""

    colour: str
    dash: tuple[float, ...]
    width: int = 1


_COLOURS = (BLUE, VERMILION, GREEN, BLACK, PURPLE, ORANGE, SKY)
_DASHES: tuple[tuple[float, ...], ...] = ((), (8.0, 3.0), (2.0, 2.0), (9.0, 3.0, 2.0, 3.0), (14.0, 4.0))


def stroke_of(number: int) -> LineStyle:
    """The stroke of the curve of that number, from 0: all different, and neighbours in colour and dashes both, so that the curves
    can be told apart without colour; those behind all pairs of these are wider."""
    colours, dashes = len(_COLOURS), len(_DASHES)
    return LineStyle(_COLOURS[number % colours], _DASHES[number % dashes], 1 + number // (colours * dashes))


@cache
def _samples(law: Law) -> tuple[np.ndarray, np.ndarray]:
    """u (n,), and s, v, a, j there (4, n): at a join inside the law both sides, so that a jump is upright."""
    starts = [piece.start for piece in law.pieces]
    rows = []
    for start, end in zip(starts, [*starts[1:], 1.0], strict=True):
        u = np.linspace(start, end, POINTS)
        u[-1] = end if end == 1.0 else np.nextafter(end, 0.0)
        rows.append(u)
    u = np.concatenate(rows)
    return u, law(u)


def show_laws(plot: XYPlot, order: int, laws: Sequence[tuple[Law, LineStyle]]) -> None:
    """Draw one of ``QUANTITIES``, by its number, of these laws."""
    quantity, letter, family = QUANTITIES[order]
    lines = [
        Line(_samples(law)[0], _samples(law)[1][order], style.colour, dash=style.dash, width=style.width)
        for law, style in laws
    ]
    if lines:
        plot.name_axes("u, share of the span", f"{quantity}, {letter}")
        plot.show_lines(lines)
        plot.show_range(upwards=shown_range([line.y for line in lines], {family}, ()))
    else:
        plot.show_message("")


class LawsLegend(QWidget):
    """Names of the curves with their strokes, in as many lines as they need."""

    GAP, LINE, SAMPLE = 16, 17, 26  # pixels: between entries, height of a line, of a stroke

    def __init__(self, theme: Theme = SCREEN) -> None:
        super().__init__()
        self._theme = theme
        self.laws: list[tuple[Law, LineStyle]] = []
        policy = QSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.setSizePolicy(policy)

    def show_laws(self, laws: Sequence[tuple[Law, LineStyle]]) -> None:
        """Name these laws and no others."""
        self.laws = list(laws)
        self.setAccessibleName("Laws drawn: " + (", ".join(law.label for law, _ in laws) or "none"))
        self._fit()
        self.update()

    def _places(self) -> list[tuple[float, int]]:
        """Left edge [pixels] and line of each entry."""
        left = sized(LEFT_WIDTH)
        made, x, line = [], left, 0
        for law, _ in self.laws:
            width = self.SAMPLE + 6.0 + text_size(law.label, SMALL)[0]
            if x > left and x + width > self.width() - RIGHT_MARGIN:
                x, line = left, line + 1
            made.append((x, line))
            x += width + self.GAP
        return made

    def _fit(self) -> None:
        lines = 1 + max((line for _, line in self._places()), default=0)
        self.setFixedHeight(round(lines * sized(self.LINE)) + 6)

    def update_style(self) -> None:
        """Theme or letters have changed."""
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
        for (law, stroke), (x, line) in zip(self.laws, self._places(), strict=True):
            middle = 4.0 + (line + 0.5) * sized(self.LINE)
            painter.setPen(self._theme.pen(self._theme.seen(stroke.colour), 2.0 * stroke.width, stroke.dash))
            painter.drawLine(QPointF(x, middle), QPointF(x + self.SAMPLE, middle))
            painter.setPen(QColor(self._theme.ink))
            box = QRectF(x + self.SAMPLE + 6.0, middle - sized(self.LINE) / 2.0, self.width(), sized(self.LINE))
            painter.drawText(box, Qt.AlignmentFlag.AlignVCenter, law.label)
        painter.end()


# -- ranking ---------------------------------------------------------------------------------------------

# A law or blend that the design cannot take says why in place of its figures.

REDRAW_MS, POLL_MS = 80, 20
BESIDE = 24  # pixels beside a heading, where the mark of sorting stands too
NONE = "–"


class RankingPanel(QWidget):
    """A row for each candidate. ``offer`` says what is compared; nothing is computed of it before the table is seen.

    chosen (str): a row was chosen, by the name of its candidate

    rows     what is computed so far, in the order of the candidates
    figures  the columns
    """

    chosen = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.rows: dict[str, RankingRow] = {}
        self.figures: tuple[RankingColumn, ...] = ()
        self.table: RowsTable | None = None
        self._candidates: Mapping[str, Candidate] = {}
        self._design: Design | None = None
        self._own, self._mark, self._stale = "", "", True
        self._shown: list[str] = []  # names, from top to bottom
        self._sorted: tuple[int, bool] | None = (0, False)  # figure, downwards
        self._work = Background(self, POLL_MS)
        self._work.result.connect(self._answered)
        self._soon = QTimer(self, singleShot=True, interval=REDRAW_MS)
        self._soon.timeout.connect(self._show)
        self.bar, self.text = QProgressBar(textVisible=False), QLabel()
        self.bar.setAccessibleName("Ranking")
        self.bar.setFixedHeight(10)
        self.text.setWordWrap(True)
        coloured(self.text, SCREEN.quiet)
        self.cancel, self.again = QPushButton("Cancel"), QPushButton("Go on")
        for button, do in ((self.cancel, self._work.cancel), (self.again, self._begin)):
            button.setAutoDefault(False)
            button.clicked.connect(lambda _=False, do=do: do())
        self._table = ContentArea()
        row = QHBoxLayout()
        row.setContentsMargins(6, 3, 6, 3)
        for part in (self.text, self.bar, self.cancel, self.again):
            row.addWidget(part, 1 if part in (self.text, self.bar) else 0)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self._table, 1)
        column.addLayout(row)

    @property
    def busy(self) -> bool:
        return self._work.busy or self._soon.isActive()

    def offer(self, design: Design, candidates: Mapping[str, Candidate], own: str = "", mark: str = "now") -> None:
        """Compare these in a design; own: the one that is marked, and how."""
        self.stop()
        self._mark = mark
        self._candidates, self._own, self.rows, self._stale = dict(candidates), own, {}, True
        self._design = design
        if self.isVisible():
            self._start()

    def stop(self) -> None:
        """Nothing is computed any longer."""
        self._work.stop()
        self._soon.stop()

    def close_work(self) -> None:
        """Be sure that nothing is running any longer."""
        self._work.close()

    # -- computing ------------------------------------------------------------------------------------------

    def _start(self) -> None:
        assert self._design is not None, "what is offered is offered in a design"
        self._stale = False
        self._name_columns(ranking_columns(self._design))
        self._begin()

    def _begin(self) -> None:
        """Compute what is missing."""
        missing = [name for name in self._candidates if name not in self.rows] if self.figures else []
        self._work.start([(name, partial(ranking_row, name, self._candidates[name], self.figures)) for name in missing])
        self._show()

    def _answered(self, name: str, result: RankingRow | KindynaError | Cancelled) -> None:
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

    # -- showing --------------------------------------------------------------------------------------------

    def _name_columns(self, figures: tuple[RankingColumn, ...]) -> None:
        if figures == self.figures and self.table is not None:
            return
        self.figures = figures
        self._sorted = (0, False)
        columns = [TableHeading(f"{figure.title}\n{figure.symbol}", number=True, tip=figure.help) for figure in figures]
        self.table = table = RowsTable([TableHeading("Law or blend", wide=True), *columns])
        head = table.horizontalHeader()
        for number, figure in enumerate(figures, 1):
            head.setSectionResizeMode(number, QHeaderView.ResizeMode.Fixed)
            head.resizeSection(number, table.fontMetrics().horizontalAdvance(figure.title) + BESIDE)
        head.setSectionsClickable(True)
        head.setSortIndicatorShown(True)
        head.setSortIndicator(-1, Qt.SortOrder.AscendingOrder)
        head.sectionClicked.connect(self._sort)
        for chosen in (table.clicked, table.activated):  # by the mouse, and by Enter
            chosen.connect(lambda index: self.chosen.emit(self._shown[index.row()]))
        self._table.replace(table)

    def _sort(self, column: int) -> None:
        """By a figure, upwards first; by the first column as they stand."""
        number = column - 1
        if not 0 <= number < len(self.figures):
            self._sorted = None
        else:
            self._sorted = (number, self._sorted == (number, False))
        self._show()

    def _show(self) -> None:
        """What is known so far."""
        count, of, busy = len(self.rows), len(self._candidates), self._work.busy
        self.bar.setRange(0, max(of, 1))
        self.bar.setValue(count)
        self.bar.setVisible(busy)
        self.cancel.setVisible(busy)
        self.again.setVisible(bool(self.figures) and not busy and count < of)
        if not self.figures:
            self.text.setText(linked(NO_RANKING))
        else:
            self.text.setText(f"{count} of {of}" if count < of else "")
        if self.table is None:
            return
        rows = [self.rows[name] for name in self._candidates if name in self.rows]
        head = self.table.horizontalHeader()
        if self._sorted is None:
            head.setSortIndicator(-1, Qt.SortOrder.AscendingOrder)
        else:
            column, downwards = self._sorted
            rows = sorted_rows(rows, column, downwards)
            head.setSortIndicator(
                column + 1, Qt.SortOrder.DescendingOrder if downwards else Qt.SortOrder.AscendingOrder
            )
        self._shown = [row.name for row in rows]
        self.table.show_rows([self._row(row) for row in rows])

    def _row(self, row: RankingRow) -> TableRow:
        label = law_label(row.name) if row.name in LAWS else row.name
        name = f"{label}  ◂ {self._mark}" if row.name == self._own else label
        if row.problem:
            why = sentence(row.problem)
            return TableRow((name, why, *("" for _ in self.figures[1:])), tip=why, colour=SCREEN.quiet, across=1)
        return TableRow((name, *(NONE if value is None else digits(value, 4) for value in row.figures)), tip=label)
