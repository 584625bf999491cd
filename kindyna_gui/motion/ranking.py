"""What laws and blends cost in this design, side by side: computed beside the window while the table can be seen, sorted by a click.

A law or blend that the design cannot take says why in place of its figures.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QHeaderView, QLabel, QProgressBar, QPushButton, QVBoxLayout, QWidget

from core.design import Design
from core.errors import KindynaError
from core.find import RankingColumn, RankingRow, ranking_columns, ranking_row, sorted_rows
from core.find.ranking import Candidate
from core.laws import LAWS
from core.numerics.lazy import Cancelled
from kindyna_gui.background import Background
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import law_label, sentence
from kindyna_gui.look import coloured
from kindyna_gui.note import linked
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import digits
from kindyna_gui.rebuilt import Rebuilt
from kindyna_gui.requirements import NO_RANKING

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
        self._table = Rebuilt()
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


__all__ = ["RankingPanel"]
