"""Law table: the motion laws with peak coefficients and curves, and their ranking in the current design."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, partial
from itertools import count
from typing import Any

import numpy as np
from PySide6.QtCore import QAbstractTableModel, QModelIndex, QObject, QPersistentModelIndex, QPointF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QIcon, QKeyEvent, QKeySequence, QPainter, QPalette, QPixmap, QResizeEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QApplication,
    QGridLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QMenu,
    QSplitter,
    QStackedLayout,
    QTableView,
    QToolButton,
    QWidget,
)

from core.design import UNITS, Motion, edited, motion_of
from core.design.edits import is_dwell
from core.find import law_candidates, moving_segments
from core.frozen import frozen
from core.laws import LAWS, Law, peaks
from core.number_text import shortest
from core.study import Study
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import law_label, value_text
from kindyna_gui.look import coloured, icon, text_button
from kindyna_gui.motion.laws_plot import QUANTITIES, LawsLegend, LineStyle, RankingPanel, line_style, show_laws
from kindyna_gui.pictures.plots.xy import XYPlot
from kindyna_gui.pictures.style import SCREEN, cached_by_theme
from kindyna_gui.pictures.units import digits
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import add_entry, clear_menu, connect_all, fill
from kindyna_gui.view import View, ViewHost

Index = QModelIndex | QPersistentModelIndex
NAME, VELOCITY, ACCELERATION, JERK, TORQUE, ENDS = range(6)
RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
ZERO = 1e-9  # an end value below this share of the peak is 0
EMPTY = "Tick laws in the table to draw them here"
FIRST_TICKED = ("cycloidal", "modified-sine", "modified-trapezoid", "3-4-5")
"""Ticked at first, together with the law of the selected segment."""
WIDE = 900  # pixels: from this width on the plots are in a column next to the table, else two by two below it
AROUND_PLOTS = 16  # pixels of margins and gaps of a column of plots
LEAST_NAME_WIDTH = 160  # pixels for the names of laws
LEAST_ROWS = 3  # of the table in sight
TABLE_WIDTH, TABLE_SHARE = 560, 0.42  # pixels next to the plots, share of the height above them

# -- columns and rows ------------------------------------------------------------------------------------


@frozen
class LawsColumn:
    """Heading and tip of a column."""

    title: str
    help: str


COLUMNS = (
    LawsColumn("Law", "Tick laws to draw them over each other"),
    LawsColumn("Velocity", "Largest velocity, a multiple of rise / span"),
    LawsColumn("Accel.", "Largest acceleration, a multiple of rise / span²"),
    LawsColumn("Jerk", "Largest jerk inside the law, a multiple of rise / span³; ∞ if the acceleration jumps inside"),
    LawsColumn("Torque", "Largest product of velocity and acceleration (inertia torque on the camshaft), a multiple of rise² / span³"),
    LawsColumn("Ends", "Quantities that are not 0 at the start (left) and at the end (right): they jump at a dwell"),
)  # fmt: skip


@frozen
class LawRow:
    """Row of a law.

    Attributes
    ----------
    numbers : peak coefficients of velocity, acceleration, jerk and torque; infinite where the quantity is unbounded
    starts, ends : symbols of the quantities, v and a, that are not 0 at the start and at the end
    """

    law: Law
    numbers: tuple[float, float, float, float]
    starts: str
    ends: str

    @property
    def slug(self) -> str:
        """Key of the law."""
        return self.law.slug

    @property
    def ends_text(self) -> str:
        """Quantities that jump at the start and at the end, such as ``a | a``; empty if none does."""
        return f"{self.starts or '–'} | {self.ends or '–'}" if self.starts or self.ends else ""

    @property
    def ends_help(self) -> str:
        """Sentence about the ends of the law."""
        names = {"v": "velocity", "a": "acceleration"}
        parts = [
            f"{' and '.join(names[symbol] for symbol in symbols.split())} {verb} at 0"
            for symbols, verb in ((self.starts, "does not start"), (self.ends, "does not end"))
            if symbols
        ]
        return "; ".join(parts).capitalize() if parts else "Starts and ends without velocity and acceleration"


@cache
def law_rows() -> tuple[LawRow, ...]:
    """Rows of all laws in their standard order."""
    rows = []
    for law in LAWS.values():
        peak = peaks(law)
        at_ends = law(np.array([0.0, 1.0]))[1:3]
        sizes = (peak.cv, peak.ca)
        starts, ends = (
            " ".join(
                symbol
                for symbol, value, size in zip("va", at_ends[:, side], sizes, strict=True)
                if abs(value) > ZERO * max(size, 1.0)
            )
            for side in (0, 1)
        )
        rows.append(LawRow(law, (peak.cv, peak.ca, peak.cj, peak.cm), starts, ends))
    return tuple(rows)


# -- table -----------------------------------------------------------------------------------------------


class LawsModel(QAbstractTableModel):
    """Table model of the laws in the order of the last sorting; each ticked law has its line style.

    ``ticked`` is emitted when the drawn laws change.
    """

    ticked = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.rows = list(law_rows())
        self._styles: dict[str, int] = {}  # slug -> number of its line style, in the order of ticking
        self._marked: tuple[str, str] = ("", "")  # slug, and the text next to it

    # -- ticked and marked laws --------------------------------------------------------------------------

    @property
    def drawn(self) -> list[tuple[Law, LineStyle]]:
        """Ticked laws with their line styles, in the order of ticking."""
        return [(LAWS[slug], line_style(number)) for slug, number in self._styles.items()]

    def tick(self, slug: str, on: bool) -> None:
        """Tick or untick a law; it gets the first unused line style."""
        if on == (slug in self._styles):
            return
        if on:
            used = set(self._styles.values())
            self._styles[slug] = next(i for i in count() if i not in used)
        else:
            del self._styles[slug]
        row = self.row_of(slug)
        self.dataChanged.emit(self.index(row, NAME), self.index(row, NAME))
        self.ticked.emit()

    def untick_all(self, *_: object) -> None:
        """Untick all laws."""
        self._styles.clear()
        self._all_changed()
        self.ticked.emit()

    def mark(self, slug: str, text: str) -> None:
        """Show a text next to one law, such as the segment that has it."""
        if (slug, text) != self._marked:
            self._marked = (slug, text)
            self._all_changed()

    def _all_changed(self) -> None:
        self.dataChanged.emit(self.index(0, 0), self.index(len(self.rows) - 1, ENDS))

    def row_of(self, slug: str) -> int:
        """Row of a law; -1 if it is not in the table."""
        return next((i for i, row in enumerate(self.rows) if row.slug == slug), -1)

    # -- interface of the Qt model -----------------------------------------------------------------------

    def rowCount(self, parent: Index | None = None) -> int:
        return 0 if parent is not None and parent.isValid() else len(self.rows)

    def columnCount(self, parent: Index | None = None) -> int:
        return len(COLUMNS)

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        if orientation == Qt.Orientation.Vertical:
            return None
        if role == Qt.ItemDataRole.DisplayRole:
            return COLUMNS[section].title
        if role in (Qt.ItemDataRole.ToolTipRole, Qt.ItemDataRole.StatusTipRole):
            return COLUMNS[section].help
        return _aligned(section) if role == Qt.ItemDataRole.TextAlignmentRole else None

    def flags(self, index: Index) -> Qt.ItemFlag:
        base = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        return base | Qt.ItemFlag.ItemIsUserCheckable if index.column() == NAME else base

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        row, column = self.rows[index.row()], index.column()
        marked = row.slug == self._marked[0]
        if role == Qt.ItemDataRole.DisplayRole:
            return self._text(row, column)
        if role == Qt.ItemDataRole.TextAlignmentRole:
            return _aligned(column)
        if role == Qt.ItemDataRole.ToolTipRole:
            return self._tip(row, column)
        if role == Qt.ItemDataRole.FontRole and marked and column == NAME:
            font = QFont()
            font.setBold(True)
            return font
        if role == Qt.ItemDataRole.ForegroundRole and column == ENDS:
            return QColor(SCREEN.quiet)
        if column == NAME and role == Qt.ItemDataRole.CheckStateRole:
            return Qt.CheckState.Checked if row.slug in self._styles else Qt.CheckState.Unchecked
        if column == NAME and role == Qt.ItemDataRole.DecorationRole:
            return line_icon(self._styles.get(row.slug, -1))
        return None

    def _text(self, row: LawRow, column: int) -> str:
        if column == NAME:
            return f"{row.law.label}  {self._marked[1]}" if row.slug == self._marked[0] else row.law.label
        return row.ends_text if column == ENDS else digits(row.numbers[column - VELOCITY], 4)

    def _tip(self, row: LawRow, column: int) -> str:
        """Tip of a cell: source, number with more digits, or sentence about the ends."""
        if column == NAME:
            return f"{row.law.label}: {row.law.source}"
        if column == ENDS:
            return row.ends_help
        return f"{digits(row.numbers[column - VELOCITY], 9)}\n{COLUMNS[column].help}"

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        if role != Qt.ItemDataRole.CheckStateRole or index.column() != NAME:
            return False
        self.tick(self.rows[index.row()].slug, Qt.CheckState(value) == Qt.CheckState.Checked)
        return True

    def sort(self, column: int, order: Qt.SortOrder = Qt.SortOrder.AscendingOrder) -> None:
        """Sort by a column, -1 for the standard order; the sort is stable."""
        self.layoutAboutToBeChanged.emit()
        before = [(index, self.rows[index.row()].slug) for index in self.persistentIndexList()]
        self.rows = self._sorted(column, order == Qt.SortOrder.DescendingOrder)
        for index, slug in before:
            self.changePersistentIndex(index, self.index(self.row_of(slug), index.column()))
        self.layoutChanged.emit()

    def _sorted(self, column: int, descending: bool) -> list[LawRow]:
        rows: Sequence[LawRow] = law_rows()
        if column == NAME:
            return sorted(rows, key=lambda row: row.law.label.casefold(), reverse=descending)
        if column == ENDS:
            return sorted(rows, key=lambda row: row.ends_text, reverse=descending)
        if column < 0:
            return list(rows)
        return sorted(rows, key=lambda row: row.numbers[column - VELOCITY], reverse=descending)

    def as_text(self) -> str:
        """Headings and rows for the clipboard, separated by tabs."""
        lines = [[column.title for column in COLUMNS]]
        lines += [[row.law.label, *(f"{n:.9g}" for n in row.numbers), row.ends_text] for row in self.rows]
        return "\n".join("\t".join(line) for line in lines)


def _aligned(column: int) -> Qt.AlignmentFlag:
    return LEFT if column == NAME else RIGHT if column < ENDS else Qt.AlignmentFlag.AlignCenter


@cached_by_theme
def line_icon(number: int) -> QIcon:
    """Icon with a line style; for -1 empty, so that all names are aligned."""
    pixmap = QPixmap(QSize(56, 24))
    pixmap.setDevicePixelRatio(2.0)
    pixmap.fill(Qt.GlobalColor.transparent)
    if number >= 0:
        style = line_style(number)
        painter = QPainter(pixmap)
        painter.setPen(SCREEN.pen(SCREEN.seen(style.colour), 2.0 * style.width, style.dash))
        painter.drawLine(QPointF(1.0, 6.0), QPointF(27.0, 6.0))
        painter.end()
    return QIcon(pixmap)


class LawsTable(QTableView):
    """Table of the laws: Space ticks the selected law, Enter uses it, Copy copies the full table."""

    def __init__(self, model: LawsModel) -> None:
        super().__init__()
        self._model = model
        self.setModel(model)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setTabKeyNavigation(False)
        self.setShowGrid(False)
        self.setAlternatingRowColors(True)
        self.setWordWrap(False)
        self.setIconSize(QSize(28, 12))
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setAccessibleName("Motion laws")
        self.verticalHeader().hide()
        header = self.horizontalHeader()
        header.setHighlightSections(False)
        header.setMinimumSectionSize(44)
        header.setSortIndicatorClearable(True)
        header.setSortIndicator(-1, Qt.SortOrder.AscendingOrder)
        self.setSortingEnabled(True)
        header.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.update_style()

    def update_style(self) -> None:
        """Fit rows and columns to the font size."""
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        number = self.fontMetrics().horizontalAdvance("Velocity") + 12
        for column in range(NAME + 1, ENDS + 1):
            self.horizontalHeader().resizeSection(column, number)

    def minimumSizeHint(self) -> QSize:
        rows = LEAST_ROWS * self.verticalHeader().defaultSectionSize()
        height = self.horizontalHeader().sizeHint().height() + rows + 2 * self.frameWidth()
        return QSize(super().minimumSizeHint().width(), height)

    @property
    def slug(self) -> str:
        """Law of the current row; empty without one."""
        row = self.currentIndex().row()
        return self._model.rows[row].slug if row >= 0 else ""

    def choose(self, slug: str) -> None:
        """Select the row of a law, if the table has it."""
        row = self._model.row_of(slug)
        if row >= 0:
            self.setCurrentIndex(self._model.index(row, NAME))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Give the remaining width to the names, but at least what they need."""
        super().resizeEvent(event)
        numbers = sum(self.columnWidth(column) for column in range(NAME + 1, ENDS + 1))
        self.horizontalHeader().resizeSection(NAME, max(LEAST_NAME_WIDTH, self.viewport().width() - numbers))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        index = self.currentIndex()
        if event.matches(QKeySequence.StandardKey.Copy):
            QApplication.clipboard().setText(self._model.as_text())
        elif event.key() == Qt.Key.Key_Space and index.isValid():
            cell = self._model.index(index.row(), NAME)
            on = self._model.data(cell, Qt.ItemDataRole.CheckStateRole) == Qt.CheckState.Checked
            self._model.tick(self.slug, not on)
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and index.isValid():
            self.activated.emit(index)
        else:
            super().keyPressEvent(event)


# -- view ------------------------------------------------------------------------------------------------


class LawsView(View):
    """View of the laws: table, plots, and ranking in the design."""

    arranges_itself = True

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.model = LawsModel(self)
        self.table = LawsTable(self.model)
        self.legend = LawsLegend()
        self.plots = [XYPlot("", "") for _ in QUANTITIES]
        self.empty = coloured(QLabel(EMPTY, alignment=Qt.AlignmentFlag.AlignCenter, wordWrap=True), SCREEN.quiet)
        self.use_button = QToolButton()
        self.clear_button = text_button("Untick all", flat=True)
        self.rank_button = text_button("In this design", checks=True)
        self.all_button = text_button("In all moving segments", checks=True)
        self.ranking = RankingPanel()
        self.note = QLabel()
        self._is_wide: bool | None = None
        self._splitter = QSplitter(childrenCollapsible=False)
        self._splitter.addWidget(self.table)
        self._splitter.addWidget(self._plot_pages())
        self.set_column(self._tools(), self._splitter, grows=self._splitter)
        for slug in FIRST_TICKED:
            self.model.tick(slug, True)
        connect_all(
            (self.model.ticked, self._draw),
            (self.table.selectionModel().currentRowChanged, self._name_button),
            (self.table.activated, self._use_current),
            (self.ranking.chosen, self.table.choose),
            (self.rank_button.toggled, self._choose_page),
            (self.all_button.toggled, self._offer),
            (session.segment_chosen, self._segment_chosen),
        )
        self._draw()

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.ranking.text.linkActivated.connect(window.do)

    def _plot_pages(self) -> QWidget:
        self._paper = QWidget(autoFillBackground=True)
        self._paper.setBackgroundRole(QPalette.ColorRole.Base)
        self._grid = fill(QGridLayout(self._paper), margins=(0, 4, 4, 4), spacing=2)
        self._grid.addWidget(self.legend, 0, 0, 1, 2)
        pages = QWidget(autoFillBackground=True)
        pages.setBackgroundRole(QPalette.ColorRole.Base)
        self._pages = fill(QStackedLayout(pages), self._paper, self.empty, self.ranking)
        return pages

    def _tools(self) -> QHBoxLayout:
        self.use_button.setIcon(icon("insert"))
        self.use_button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.use_button.setPopupMode(QToolButton.ToolButtonPopupMode.MenuButtonPopup)
        self.use_button.clicked.connect(self._use_current)
        menu = QMenu(self.use_button)
        menu.aboutToShow.connect(partial(self._fill_menu, menu))
        self.use_button.setMenu(menu)
        self.clear_button.setToolTip("Remove all curves")
        self.clear_button.clicked.connect(self.model.untick_all)
        self.rank_button.setToolTip(
            "Rank the laws in the selected segment by torque, vibration and contact at the current speed"
        )
        self.all_button.setToolTip("Use the law in every moving segment, not only in the selected one")
        coloured(self.note, SCREEN.limit)
        buttons = (self.use_button, self.clear_button, self.rank_button, self.all_button)
        for button in buttons:
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.all_button.hide()
        return fill(QHBoxLayout(), *buttons, (self.note, 1), margins=(6, 3, 6, 3), spacing=6)

    # -- display -----------------------------------------------------------------------------------------

    def refresh(self, study: Study) -> None:
        motion = motion_of(self.session.typed)
        segment = None if motion is None else motion.segments[self.session.segment]
        slug = "" if segment is None else segment.curve.law
        self.model.mark(slug, f"◂ segment {self.session.segment + 1}")
        if not self.table.currentIndex().isValid():
            if segment is not None and self.model.row_of(slug) >= 0 and not is_dwell(segment):
                self.model.tick(slug, True)
            self.table.choose(slug)
        self._name_button()
        self._offer()

    def _offer(self, *_: object) -> None:
        """Rank every law in the selected segment, or in all segments that move."""
        if not self.rank_button.isChecked():
            return
        design, chosen = self.session.design, self.session.segment
        moving = moving_segments(design)
        numbers = (chosen,) if chosen in moving and not self.all_button.isChecked() else moving
        motion = design.drive.motion
        laws = {motion.segments[number].curve.law for number in numbers} if motion is not None else set()
        current = next(iter(laws)) if len(laws) == 1 else ""
        self.ranking.offer(design, law_candidates(design, numbers) if numbers else {}, current)

    def _choose_page(self, ranks: bool) -> None:
        self.all_button.setVisible(ranks)
        self.ranking.stop()
        self._offer()
        self._draw()

    def _segment_chosen(self) -> None:
        """Follow the selected segment."""
        self.invalidate()
        motion = motion_of(self.session.typed)
        self.table.choose("" if motion is None else motion.segments[self.session.segment].curve.law)

    def _name_button(self, *_: object) -> None:
        """Name the segment on the button, and the law in its tip."""
        slug, number = self.table.slug, self.session.segment + 1
        self.use_button.setEnabled(bool(slug) and motion_of(self.session.typed) is not None)
        self.use_button.setText(f"Use in segment {number}")
        tip = f"Use {law_label(slug)} in segment {number}; the arrow lists the other segments" if slug else ""
        self.use_button.setToolTip(tip)
        self.use_button.setStatusTip(tip)

    def _draw(self) -> None:
        laws = self.model.drawn
        drawn = self._paper if laws else self.empty
        self._pages.setCurrentWidget(self.ranking if self.rank_button.isChecked() else drawn)
        self.legend.show_laws(laws)
        for order, plot in enumerate(self.plots):
            show_laws(plot, order, laws)

    @property
    def busy(self) -> bool:
        return super().busy or self.ranking.busy

    def leave(self) -> None:
        self.ranking.close_work()

    # -- use of a law ------------------------------------------------------------------------------------

    def use(self, number: int | None = None) -> None:
        """Use the current law in a segment by its number from 0, by default the selected one; show why if it is refused."""
        slug, index = self.table.slug, self.session.segment if number is None else number
        if not slug or motion_of(self.session.typed) is None:
            return
        path = f"motion.segments[{index}].law"
        text = f"Change law of segment {index + 1} to {law_label(slug)}"
        with self.session.one_step() as refusals:
            if self.session.incomplete is not None:
                done = self.session.edit(path, slug, text)
            else:
                done = self.session.put(edited(self.session.design, path, slug), text, path)
        reasons = [why for refusal in refusals for _, _, why in refusal.reasons]
        if not done:
            self.session.withdraw(path)  # no field shows the refused value
        self._show_text("" if done else f"Not in segment {index + 1}: {'; '.join(reasons)}")
        self.status_message.emit(
            f"Segment {index + 1}: {law_label(slug)}" if done else f"Refused: {'; '.join(reasons)}"
        )

    def _show_text(self, text: str) -> None:
        self.note.setText(text)
        self.note.setToolTip(text)

    def _fill_menu(self, menu: QMenu) -> None:
        clear_menu(menu)
        motion = motion_of(self.session.typed)
        for number, text in enumerate(segment_texts(motion) if motion is not None else ()):
            add_entry(menu, text, partial(self.use, number), checked=number == self.session.segment)

    def _use_current(self, *_: object) -> None:
        self.use()

    # -- picture, and layout -----------------------------------------------------------------------------

    def picture(self, ending: str) -> bytes:
        """Picture of the plots with their legend; of the full page if no law is drawn or the ranking is shown."""
        from kindyna_gui.pictures.painter import png, svg

        self.pull()
        sheet = self._paper if self.model.drawn and not self.rank_button.isChecked() else self.content
        return self.on_paper(sheet, partial(svg, title="Motion laws") if ending == ".svg" else png)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        is_wide = self.width() >= WIDE and self.height() >= self._column_height()
        if is_wide != self._is_wide:
            self._is_wide = is_wide
            self._arrange(is_wide)

    def _column_height(self) -> int:
        """Least height of the view with its plots in a column."""
        plots = sum(plot.least_height(numbered=plot is self.plots[-1]) for plot in self.plots)
        return plots + self.legend.sizeHint().height() + self._splitter.y() + AROUND_PLOTS

    def _arrange(self, is_wide: bool) -> None:
        """Arrange table and plots side by side, or one above the other."""
        for order, plot in enumerate(self.plots):
            row, column = (order, 0) if is_wide else divmod(order, 2)
            self._grid.addWidget(plot, 1 + row, column, 1, 2 if is_wide else 1)
            plot.show_numbers(order == 3 or (not is_wide and order == 2))
        for row in range(1, 5):
            self._grid.setRowStretch(row, 1 if is_wide or row < 3 else 0)
        self._splitter.setStretchFactor(1, 1 if is_wide else 0)  # 0: both parts keep their share
        if is_wide:
            self._splitter.setOrientation(Qt.Orientation.Horizontal)
            self._splitter.setSizes([TABLE_WIDTH, self.width() - TABLE_WIDTH])
        else:
            self._splitter.setOrientation(Qt.Orientation.Vertical)
            table = round(TABLE_SHARE * self.height())
            self._splitter.setSizes([table, self.height() - table])


def segment_texts(motion: Motion) -> list[str]:
    """Text of each segment, such as ``2  Modified sine, 35° … 76.5°, −150 mm``."""
    texts, start = [], 0.0
    for number, segment in enumerate(motion.segments, 1):
        end = start + segment.span_deg
        rise = f", {value_text(segment.rise, UNITS[motion.unit])}" if segment.rise else ""
        texts.append(
            f"{number}  {law_label(segment.curve.law)}, {shortest(round(start, 9))}° … {shortest(round(end, 9))}°{rise}"
        )
        start = end
    return texts
