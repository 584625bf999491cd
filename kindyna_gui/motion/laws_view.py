"""Law table."""

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
from core.output.lines import shortest
from core.study import Study
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import law_label, value_text
from kindyna_gui.look import coloured, icon, text_button
from kindyna_gui.motion.laws_plot import QUANTITIES, LawsLegend, LineStyle, RankingPanel, show_laws, stroke_of
from kindyna_gui.pictures.plots.xy import XYPlot
from kindyna_gui.pictures.style import SCREEN, cached_by_theme
from kindyna_gui.pictures.units import digits
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import clear_menu
from kindyna_gui.view import View, ViewHost

# -- laws model ------------------------------------------------------------------------------------------

Index = QModelIndex | QPersistentModelIndex
NAME, VELOCITY, ACCELERATION, JERK, TORQUE, ENDS = range(6)
_RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
_LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
NOTHING = 1e-9  # an end value below this, as a share of the peak, is 0


@frozen
class LawsColumn:
    """Heading, and what its numbers mean."""

    title: str
    help: str


COLUMNS = (
    LawsColumn("Law", "Tick laws to draw them over each other"),
    LawsColumn("Velocity", "Largest velocity: times rise / span"),
    LawsColumn("Accel.", "Largest acceleration: times rise / span²"),
    LawsColumn("Jerk", "Largest jerk inside the law: times rise / span³; ∞ where the acceleration jumps inside"),
    LawsColumn("Torque", "Largest velocity times acceleration, the torque that inertia asks of the camshaft: times rise² / span³"),
    LawsColumn("Ends", "What is not 0 where the law starts (left) and ends (right): next to a dwell it jumps there"),
)  # fmt: skip


@frozen
class LawRow:
    """One law: its four peak coefficients, infinite where there is no end to it, and which of v and a do not start and
    end at 0."""

    law: Law
    numbers: tuple[float, float, float, float]
    starts: str
    ends: str

    @property
    def slug(self) -> str:
        return self.law.slug

    @property
    def ends_text(self) -> str:
        """``a | a``: left what jumps at the start, right what jumps at the end; empty where nothing does."""
        return f"{self.starts or '–'} | {self.ends or '–'}" if self.starts or self.ends else ""

    @property
    def ends_help(self) -> str:
        """What jumps at the ends of the law, in a sentence."""
        names = {"v": "velocity", "a": "acceleration"}
        parts = [
            f"{' and '.join(names[letter] for letter in letters.split())} {verb} at 0"
            for letters, verb in ((self.starts, "does not start"), (self.ends, "does not end"))
            if letters
        ]
        return "; ".join(parts).capitalize() if parts else "Starts and ends without velocity and acceleration"


@cache
def law_rows() -> tuple[LawRow, ...]:
    """Every law, in the order of the table of laws."""
    rows = []
    for law in LAWS.values():
        peak = peaks(law)
        at_ends = law(np.array([0.0, 1.0]))[1:3]
        sizes = (peak.cv, peak.ca)
        starts, ends = (
            " ".join(
                letter
                for letter, value, size in zip("va", at_ends[:, side], sizes, strict=True)
                if abs(value) > NOTHING * max(size, 1.0)
            )
            for side in (0, 1)
        )
        rows.append(LawRow(law, (peak.cv, peak.ca, peak.cj, peak.cm), starts, ends))
    return tuple(rows)


class LawsModel(QAbstractTableModel):
    """The laws in the order last sorted by; ticked ones have a stroke of their own.

    ticked   the laws that are drawn have changed
    """

    ticked = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.rows = list(law_rows())
        self._strokes: dict[str, int] = {}  # slug -> number of its stroke, in the order of ticking
        self._marked: tuple[str, str] = ("", "")  # slug, and the text beside it

    # -- what is ticked and marked --------------------------------------------------------------------------

    @property
    def drawn(self) -> list[tuple[Law, LineStyle]]:
        """The laws that are ticked, in the order of ticking."""
        return [(LAWS[slug], stroke_of(number)) for slug, number in self._strokes.items()]

    def tick(self, slug: str, on: bool) -> None:
        """Draw a law, or draw it no longer; it takes the first stroke that is free."""
        if on == (slug in self._strokes):
            return
        if on:
            taken = set(self._strokes.values())
            self._strokes[slug] = next(i for i in count() if i not in taken)
        else:
            del self._strokes[slug]
        row = self.row_of(slug)
        self.dataChanged.emit(self.index(row, NAME), self.index(row, NAME))
        self.ticked.emit()

    def untick_all(self, *_: object) -> None:
        """Draw none."""
        self._strokes.clear()
        self._all_changed()
        self.ticked.emit()

    def mark(self, slug: str, text: str) -> None:
        """Show a text beside one law: which segment has it."""
        if (slug, text) != self._marked:
            self._marked = (slug, text)
            self._all_changed()

    def _all_changed(self) -> None:
        self.dataChanged.emit(self.index(0, 0), self.index(len(self.rows) - 1, ENDS))

    def row_of(self, slug: str) -> int:
        """Where a law stands; -1 where it is none of the table."""
        return next((i for i, row in enumerate(self.rows) if row.slug == slug), -1)

    # -- the table ------------------------------------------------------------------------------------------

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
            return Qt.CheckState.Checked if row.slug in self._strokes else Qt.CheckState.Unchecked
        if column == NAME and role == Qt.ItemDataRole.DecorationRole:
            return swatch(self._strokes.get(row.slug, -1))
        return None

    def _text(self, row: LawRow, column: int) -> str:
        if column == NAME:
            return f"{row.law.label}  {self._marked[1]}" if row.slug == self._marked[0] else row.law.label
        return row.ends_text if column == ENDS else digits(row.numbers[column - VELOCITY], 4)

    def _tip(self, row: LawRow, column: int) -> str:
        """Formula; all digits; what the ends are like."""
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
        """By a column, -1: as the table of laws has them; laws alike in it stay in that order."""
        self.layoutAboutToBeChanged.emit()
        before = [(index, self.rows[index.row()].slug) for index in self.persistentIndexList()]
        self.rows = self._sorted(column, order == Qt.SortOrder.DescendingOrder)
        for index, slug in before:
            self.changePersistentIndex(index, self.index(self.row_of(slug), index.column()))
        self.layoutChanged.emit()

    def _sorted(self, column: int, downwards: bool) -> list[LawRow]:
        rows: Sequence[LawRow] = law_rows()
        if column == NAME:
            return sorted(rows, key=lambda row: row.law.label.casefold(), reverse=downwards)
        if column == ENDS:
            return sorted(rows, key=lambda row: row.ends_text, reverse=downwards)
        if column < 0:
            return list(rows)
        return sorted(rows, key=lambda row: row.numbers[column - VELOCITY], reverse=downwards)

    def as_text(self) -> str:
        """Headings and rows for the clipboard, cells apart by tabs."""
        lines = [[column.title for column in COLUMNS]]
        lines += [[row.law.label, *(f"{n:.9g}" for n in row.numbers), row.ends_text] for row in self.rows]
        return "\n".join("\t".join(line) for line in lines)


def _aligned(column: int) -> Qt.AlignmentFlag:
    return _LEFT if column == NAME else _RIGHT if column < ENDS else Qt.AlignmentFlag.AlignCenter


@cached_by_theme
def swatch(number: int) -> QIcon:
    """A short line in a stroke; a blank of the same size for -1, so that names stand below each other."""
    picture = QPixmap(QSize(56, 24))
    picture.setDevicePixelRatio(2.0)
    picture.fill(Qt.GlobalColor.transparent)
    if number >= 0:
        stroke = stroke_of(number)
        painter = QPainter(picture)
        pen = SCREEN.pen(SCREEN.seen(stroke.colour), 2.0 * stroke.width, stroke.dash)
        painter.setPen(pen)
        painter.drawLine(QPointF(1.0, 6.0), QPointF(27.0, 6.0))
        painter.end()
    return QIcon(picture)


# -- laws view -------------------------------------------------------------------------------------------

EMPTY = "Tick laws in the table on the left to draw them here"
FIRST = ("cycloidal", "modified-sine", "modified-trapezoid", "3-4-5")
"""Ticked at first, and the law of the chosen segment."""
BESIDE = 900  # pixels: a page that is narrower has its plots two by two below the table, else in a column beside it
LEAST_NAME = 160  # pixels for the names of laws
PLOTS_LEAST = 100  # pixels: plots give way before the window grows beyond a small screen
TABLE_WIDTH, TABLE_SHARE = 560, 0.42  # pixels beside, share of the height above the plots


class LawsTable(QTableView):
    """The table; Space ticks the chosen law, Enter uses it, Copy takes the whole table."""

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
        head = self.horizontalHeader()
        head.setHighlightSections(False)
        head.setMinimumSectionSize(44)
        head.setSortIndicatorClearable(True)
        head.setSortIndicator(-1, Qt.SortOrder.AscendingOrder)
        self.setSortingEnabled(True)
        head.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.update_style()

    def update_style(self) -> None:
        """As high and wide as its letters want it."""
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 6)
        number = self.fontMetrics().horizontalAdvance("Velocity") + 12
        for column in range(NAME + 1, ENDS + 1):
            self.horizontalHeader().resizeSection(column, number)

    @property
    def slug(self) -> str:
        """The law of the current row; empty where there is none."""
        row = self.currentIndex().row()
        return self._model.rows[row].slug if row >= 0 else ""

    def choose(self, slug: str) -> None:
        """Make a law the current row, if the table has it."""
        row = self._model.row_of(slug)
        if row >= 0:
            self.setCurrentIndex(self._model.index(row, NAME))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Names take the room that is left, but never less than they need to be told apart."""
        super().resizeEvent(event)
        numbers = sum(self.columnWidth(column) for column in range(NAME + 1, ENDS + 1))
        self.horizontalHeader().resizeSection(NAME, max(LEAST_NAME, self.viewport().width() - numbers))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        index = self.currentIndex()
        if event.matches(QKeySequence.StandardKey.Copy):
            QApplication.clipboard().setText(self._model.as_text())
        elif event.key() == Qt.Key.Key_Space and index.isValid():
            place = self._model.index(index.row(), NAME)
            on = self._model.data(place, Qt.ItemDataRole.CheckStateRole) == Qt.CheckState.Checked
            self._model.tick(self.slug, not on)
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and index.isValid():
            self.activated.emit(index)
        else:
            super().keyPressEvent(event)


class LawsView(View):
    """The page of the laws. It reads the design for nothing but the chosen segment."""

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.model = LawsModel(self)
        self.table = LawsTable(self.model)
        self.legend = LawsLegend()
        self.plots = [XYPlot("", "") for _ in QUANTITIES]
        self.empty = QLabel(EMPTY, alignment=Qt.AlignmentFlag.AlignCenter, wordWrap=True)
        coloured(self.empty, SCREEN.quiet)
        self.use_button = QToolButton()
        self.clear_button = text_button("Untick all", flat=True)
        self.rank_button = text_button("In this design", checks=True)
        self.all_button = text_button("In all that move", checks=True)
        self.ranking = RankingPanel()
        self.note = QLabel()
        self._used = ""
        self._laid: bool | None = None  # beside each other
        self._parted = parted = QSplitter(childrenCollapsible=False)
        parted.addWidget(self.table)
        parted.addWidget(self._drawing())
        parted.setStretchFactor(1, 1)
        self.set_column(self._tools(), parted, grows=parted)
        for slug in FIRST:
            self.model.tick(slug, True)
        self.model.ticked.connect(self._draw)
        self.table.selectionModel().currentRowChanged.connect(self._name_button)
        self.table.activated.connect(self._use_chosen)
        self.ranking.chosen.connect(self.table.choose)
        self.rank_button.toggled.connect(self._choose_page)
        self.all_button.toggled.connect(self._offer)
        session.segment_chosen.connect(self._segment_chosen)
        self._draw()

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.ranking.text.linkActivated.connect(window.do)

    def _drawing(self) -> QWidget:
        self._paper = QWidget()
        self._paper.setBackgroundRole(QPalette.ColorRole.Base)
        self._paper.setAutoFillBackground(True)
        self._grid = QGridLayout(self._paper)
        self._grid.setContentsMargins(0, 4, 4, 4)
        self._grid.setSpacing(2)
        self._grid.addWidget(self.legend, 0, 0, 1, 2)
        pages = QWidget()
        pages.setMinimumHeight(PLOTS_LEAST)
        pages.setBackgroundRole(QPalette.ColorRole.Base)
        pages.setAutoFillBackground(True)
        self._pages = QStackedLayout(pages)
        self._pages.addWidget(self._paper)
        self._pages.addWidget(self.empty)
        self._pages.addWidget(self.ranking)
        return pages

    def _tools(self) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setContentsMargins(6, 3, 6, 3)
        row.setSpacing(6)
        self.use_button.setIcon(icon("insert"))
        self.use_button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.use_button.setPopupMode(QToolButton.ToolButtonPopupMode.MenuButtonPopup)
        self.use_button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.use_button.clicked.connect(self._use_chosen)
        menu = QMenu(self.use_button)
        menu.aboutToShow.connect(partial(self._fill_menu, menu))
        self.use_button.setMenu(menu)
        self.clear_button.setToolTip("Draw no law")
        self.clear_button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.clear_button.clicked.connect(self.model.untick_all)
        self.rank_button.setToolTip(
            "Each law in place of that of the chosen segment: torque, vibration and contact at this speed"
        )
        self.all_button.setToolTip("In every segment that moves, not in the chosen one alone")
        coloured(self.note, SCREEN.limit)
        row.addWidget(self.use_button)
        row.addWidget(self.clear_button)
        for button in (self.rank_button, self.all_button):
            button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            row.addWidget(button)
        self.all_button.hide()
        row.addWidget(self.note, 1)
        return row

    # -- showing --------------------------------------------------------------------------------------------

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
        """What is ranked: every law in place of that of the chosen segment, or of all that move."""
        if not self.rank_button.isChecked():
            return
        design, chosen = self.session.design, self.session.segment
        moving = moving_segments(design)
        numbers = (chosen,) if chosen in moving and not self.all_button.isChecked() else moving
        motion = design.drive.motion
        laws = {motion.segments[number].curve.law for number in numbers} if motion is not None else set()
        own = next(iter(laws)) if len(laws) == 1 else ""
        self.ranking.offer(design, law_candidates(design, numbers) if numbers else {}, own)

    def _choose_page(self, ranks: bool) -> None:
        self.all_button.setVisible(ranks)
        self.ranking.stop()
        self._offer()
        self._draw()

    def _segment_chosen(self) -> None:
        """Another segment, another mark, as for another design."""
        self.invalidate()
        motion = motion_of(self.session.typed)
        self.table.choose("" if motion is None else motion.segments[self.session.segment].curve.law)

    def _name_button(self, *_: object) -> None:
        """What the button would do."""
        slug, number = self.table.slug, self.session.segment + 1
        self.use_button.setEnabled(bool(slug) and motion_of(self.session.typed) is not None)
        self.use_button.setText(f"Use in segment {number}")
        tip = f"Give segment {number} the law {law_label(slug)}; the arrow lists the other segments" if slug else ""
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

    # -- using ----------------------------------------------------------------------------------------------

    def use(self, number: int | None = None) -> None:
        """Give a segment, by its number from 0, or the chosen one, the current law; where that is refused, show why."""
        slug, index = self.table.slug, self.session.segment if number is None else number
        if not slug or motion_of(self.session.typed) is None:
            return
        path = f"motion.segments[{index}].law"
        reasons: list[str] = []

        def listen(refusal: Refusal) -> None:
            reasons.extend(text for _, _, text in refusal.reasons)

        self.session.refused.connect(listen)
        text = f"Change law of segment {index + 1} to {law_label(slug)}"
        if self.session.incomplete is not None:
            done = self.session.edit(path, slug, text)
        else:  # nothing was typed that would have to stay
            done = self.session.put(edited(self.session.design, path, slug), text, path)
        self.session.refused.disconnect(listen)
        self.session.end_gesture()
        if not done:
            self.session.withdraw(path)  # no field holds what was refused
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
            action = menu.addAction(text)
            action.setCheckable(True)
            action.setChecked(number == self.session.segment)
            action.triggered.connect(partial(self._use_in, number))

    def _use_chosen(self, *_: object) -> None:
        self.use()

    def _use_in(self, number: int, *_: object) -> None:
        self.use(number)

    # -- as a file, and sizes -------------------------------------------------------------------------------

    def picture(self, ending: str) -> bytes:
        """The plots with their legend; the page as it is where nothing is drawn."""
        from kindyna_gui.pictures.painter import png, svg

        self.pull()
        sheet = self._paper if self.model.drawn and not self.rank_button.isChecked() else self.content
        return self.on_paper(sheet, partial(svg, title="Motion laws") if ending == ".svg" else png)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        beside = self.width() >= BESIDE
        if beside != self._laid:
            self._laid = beside
            self._lay(beside)

    def _lay(self, beside: bool) -> None:
        """Table and plots beside each other or one above the other."""
        for order, plot in enumerate(self.plots):
            row, column = (order, 0) if beside else divmod(order, 2)
            self._grid.addWidget(plot, 1 + row, column, 1, 2 if beside else 1)
            plot.show_numbers(order == 3 or (not beside and order == 2))
        for row in range(1, 5):
            self._grid.setRowStretch(row, 1 if beside or row < 3 else 0)
        if beside:
            self._parted.setOrientation(Qt.Orientation.Horizontal)
            self._parted.setSizes([TABLE_WIDTH, self.width() - TABLE_WIDTH])
        else:
            self._parted.setOrientation(Qt.Orientation.Vertical)
            table = round(TABLE_SHARE * self.height())
            self._parted.setSizes([table, self.height() - table])


def segment_texts(motion: Motion) -> list[str]:
    """``2  Modified sine, 35° … 76.5°, −150 mm`` for each segment."""
    texts, at = [], 0.0
    for number, segment in enumerate(motion.segments, 1):
        end = at + segment.span_deg
        rise = f", {value_text(segment.rise, UNITS[motion.unit])}" if segment.rise else ""
        texts.append(
            f"{number}  {law_label(segment.curve.law)}, {shortest(round(at, 9))}° … {shortest(round(end, 9))}°{rise}"
        )
        at = end
    return texts
