"""Window with the figures, tables and equations of the papers, and the verdict on each.

The verdicts are calculated in the background while the window is open; the selected row comes first, with its drawing,
the statement of the paper and the result of this program.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from operator import attrgetter
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QSizeF, Qt
from PySide6.QtGui import QCloseEvent, QColor, QPixmap
from PySide6.QtWidgets import (
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QSplitter,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from core.output.stability_files import table_text, verdict_counts
from core.papers import PAPERS, VERDICTS, Claim, Examples, claims
from core.papers.claim import (
    AGREES,
    AS_SCANNED,
    CONTRADICTION,
    DIFFERS,
    METHOD,
    MISPRINT,
)
from kindyna_gui import dialogs
from kindyna_gui.background import Background, Job
from kindyna_gui.documents.texts import command_text, copy_button
from kindyna_gui.forms.tables import CopyKey
from kindyna_gui.look import coloured, described, scrolled
from kindyna_gui.pictures.painter import RATIO
from kindyna_gui.pictures.paper.paper_figures import paper_file
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import STRETCH, close_by_escape, fill, widget_with
from kindyna_gui.saving import written
from kindyna_gui.settings import Settings

CHOOSE = "Select a figure, a table or an equation of a paper. It is then computed and drawn from its example."
COMPUTING = "Computing …"
ROW = Qt.ItemDataRole.UserRole
TONES: Mapping[str, str] = MappingProxyType({
    AGREES: "good", DIFFERS: "limit", MISPRINT: "chosen", AS_SCANNED: "chosen", METHOD: "assumed", CONTRADICTION: "assumed",
})  # fmt: skip
"""Colour of the theme for each verdict; others are quiet."""
NONE = "no result"
LIST_WIDTH, LEAST_PICTURE = 460, 240


class _Picture(QLabel):
    """An image, reduced to the room of the label, never enlarged."""

    def __init__(self) -> None:
        super().__init__(alignment=Qt.AlignmentFlag.AlignCenter)
        self._image: QPixmap | None = None
        self.setMinimumSize(LEAST_PICTURE, LEAST_PICTURE)

    def show_png(self, data: bytes | None) -> None:
        """Show a PNG image; None: nothing."""
        self._image = None
        if data is not None:
            self._image = QPixmap()
            self._image.loadFromData(data)
        self.fit(self.width(), self.height())

    @property
    def empty(self) -> bool:
        """Whether no image is shown."""
        return self._image is None

    def fit(self, width: int, height: int) -> None:
        """Scale the image to a width and height in pixels."""
        if self._image is None:
            self.clear()
            return
        ratio = self.devicePixelRatioF()
        most = QSizeF(self._image.size()) * (1.0 / RATIO)
        fitted = most.scaled(max(width, 1), max(height, 1), Qt.AspectRatioMode.KeepAspectRatio)
        room = (most.boundedTo(fitted) * ratio).toSize()
        shown = self._image.scaled(room, Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation)
        shown.setDevicePixelRatio(ratio)
        self.setPixmap(shown)

    def resizeEvent(self, event: Any) -> None:
        super().resizeEvent(event)
        self.fit(event.size().width(), event.size().height())


class FiguresWindow(QWidget):
    """List of the claims at the left; drawing, statement, result and verdict of the selected one at the right.

    - ``open_design``: opens an example by the name of its file
    - ``computed``: number of selected rows that have been computed
    """

    def __init__(self, parent: QWidget, open_design: Callable[[str], None]) -> None:
        super().__init__(parent, Qt.WindowType.Window, windowTitle="Figures of the papers")
        dialogs.give_help(self, "papers#Kinds of verdict")
        self.resize(1180, 690)  # of a screen of 1280 x 720
        self._open_design = open_design
        self._examples, self._work = Examples(), Background(self)
        self._work.result.connect(self._take)
        self.claim: Claim | None = None  # the selected one
        self.busy = False  # whether it is being computed
        self._items: dict[Claim, QTreeWidgetItem] = {}
        self._tops: dict[str, QTreeWidgetItem] = {}
        self._judged: dict[Claim, str] = {}
        self.computed = 0
        self.list = described(QTreeWidget(), name="Figures, tables and statements of the papers")
        self.list.setHeaderLabels(["What the paper says", "Verdict"])
        CopyKey(self.list)
        self.list.setStyleSheet("QTreeWidget::item { padding: 2px 0 }")
        self.list.currentItemChanged.connect(lambda item, _: self._choose(None if item is None else item.data(0, ROW)))
        self.picture, self.heading, self.verdict = _Picture(), _text(), _text()
        self.says, self.result = _text(), _text()
        self.open_button, self.save_button = QPushButton("&Open the design"), QPushButton("&Save...")
        self.open_button.setToolTip("Open the example that this is computed from")
        self.save_button.setToolTip("Save the drawing as PNG or SVG, or its numbers as CSV")
        self.open_button.clicked.connect(self._open)
        self.save_button.clicked.connect(self._save)
        self._fill()
        self._lay_out()
        close_by_escape(self)
        self._show_words("", CHOOSE)

    def _fill(self) -> None:
        for paper in PAPERS.values():
            top = self._tops[paper.slug] = QTreeWidgetItem(self.list)
            top.setToolTip(0, paper.title)
            top.setFirstColumnSpanned(True)
            for claim in claims(paper.slug, self._examples):
                item = self._items[claim] = QTreeWidgetItem(top, [f"{claim.where}   {claim.says}"])
                item.setToolTip(0, claim.title)
                item.setData(0, ROW, claim)
            self._count(paper.slug)
        self.list.expandAll()
        header = self.list.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(1, QHeaderView.ResizeMode.Fixed)
        header.resizeSection(1, self.fontMetrics().horizontalAdvance(max(VERDICTS, key=len)) + 16)

    def _lay_out(self) -> None:
        buttons = fill(QHBoxLayout(), STRETCH, self.open_button, self.save_button, copy_button(self._as_command))
        words = fill(QVBoxLayout(), self.heading, self.says, self.result, self.verdict, buttons)
        below = widget_with(words)
        right = QSplitter(Qt.Orientation.Vertical)
        right.addWidget(self.picture)
        right.addWidget(scrolled(below))
        right.setStretchFactor(0, 1)
        right.setSizes([540, 200])
        sides = QSplitter()
        sides.addWidget(self.list)
        sides.addWidget(right)
        sides.setStretchFactor(1, 1)
        sides.setSizes([LIST_WIDTH, 850])
        fill(QHBoxLayout(self), sides, margins=6)

    # -- selected row ---------------------------------------------------------------------------------------

    @property
    def judged(self) -> int:
        """Number of rows that show their verdict."""
        return len(self._judged)

    def _choose(self, claim: Claim | None) -> None:
        self.claim, self.busy = claim, claim is not None
        self.picture.show_png(None)
        self._show_words("" if claim is None else claim.title, CHOOSE if claim is None else COMPUTING)
        self._compute()

    def _compute(self) -> None:
        """Compute the selected row with its drawing, then the missing verdicts of the list."""
        jobs: list[Job] = []
        if self.claim is not None and self.busy:
            jobs.append((self.claim, partial(attrgetter("judgement", "drawing"), self.claim)))
        jobs += [
            ((claim,), partial(attrgetter("verdict"), claim)) for claim in self._items if claim not in self._judged
        ]
        self._work.start(jobs)

    def _take(self, key: Claim | tuple[Claim], result: Any) -> None:
        if isinstance(key, tuple):
            self._judge(key[0], NONE if isinstance(result, Exception) else result)
        elif isinstance(result, Exception):
            self.busy = False
            self._show_words(key.title, str(result))
            coloured(self.says, SCREEN.limit)
        else:
            self.busy = False
            self.computed += 1
            (verdict, value), drawing = result
            self._judge(key, verdict)
            self.picture.show_png(paper_file(drawing, ".png"))
            self._show_words(key.title, f"The paper: {key.says}", f"Here: {value}", verdict)
            coloured(self.verdict, _colour(verdict))
            self.save_button.setEnabled(True)

    def _judge(self, claim: Claim, verdict: str) -> None:
        self._judged[claim] = verdict
        item = self._items[claim]
        item.setText(1, verdict)
        item.setToolTip(1, VERDICTS.get(verdict, ""))
        item.setForeground(1, QColor(_colour(verdict)))
        self._count(claim.paper)

    def _count(self, paper: str) -> None:
        """Write the number of each verdict below the name of the paper."""
        known = [claim for claim in self._judged if claim.paper == paper and self._judged[claim] in VERDICTS]
        words = ", ".join(f"{verdict} {count}" for verdict, count in verdict_counts(known))
        self._tops[paper].setText(0, f"{PAPERS[paper].label}\n{words or COMPUTING}")

    def _show_words(self, heading: str, says: str, result: str = "", verdict: str = "") -> None:
        verdict_text = f"{verdict.capitalize()}: {VERDICTS[verdict]}" if verdict else ""
        for label, text in (
            (self.heading, heading),
            (self.says, says),
            (self.result, result),
            (self.verdict, verdict_text),
        ):
            label.setText(text)
            label.setVisible(bool(text))
        coloured(self.heading, SCREEN.quiet)
        coloured(self.says, SCREEN.ink)
        self.open_button.setEnabled(self.claim is not None)
        self.save_button.setEnabled(False)

    # -- actions --------------------------------------------------------------------------------------------

    def _as_command(self) -> str:
        """Return the command for all figures of the selected paper."""
        item = self.list.currentItem()
        top = item if item is None or item.parent() is None else item.parent()
        paper = next((slug for slug, row in self._tops.items() if row is top), "all")
        return command_text("figures", [paper, "--out", "figures"])

    def _open(self) -> None:
        if self.claim is not None:
            self._open_design(self.claim.row.example)

    def _save(self) -> None:
        claim = self.claim
        if claim is None:
            return
        path = dialogs.figure_to_save(self, Settings().folder / f"{claim.paper}_{claim.name}.png")
        if path is not None:
            ending = path.suffix.lower()
            written(
                self,
                path,
                lambda: table_text(claim.table) if ending == ".csv" else paper_file(claim.drawing, ending),
                paints=True,
            )

    # -- window ---------------------------------------------------------------------------------------------

    def open(self) -> None:
        """Show the window in front of all others."""
        self._compute()
        self.show()
        self.raise_()
        self.activateWindow()

    def closeEvent(self, event: QCloseEvent) -> None:
        self._work.stop()
        super().closeEvent(event)

    def leave(self) -> None:
        """Stop the calculation in the background."""
        self._work.close()


def _colour(verdict: str) -> str:
    return str(getattr(SCREEN, TONES.get(verdict, "quiet")))


def _text() -> QLabel:
    label = QLabel(
        wordWrap=True,
        textFormat=Qt.TextFormat.PlainText,
        textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse,
    )
    return label


__all__ = ["FiguresWindow"]
