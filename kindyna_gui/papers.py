"""Figures of the papers: a list by paper with the verdict on each row, which come in beside the window while it is open; the row that is
chosen is computed first, with its picture, its statement and our number."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QSizeF, Qt
from PySide6.QtGui import QCloseEvent, QColor, QPixmap
from PySide6.QtWidgets import (
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QScrollArea,
    QSplitter,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from core.output.stability_files import table_text, verdict_counts
from core.papers import PAPERS, VERDICTS, Claim, Drawing, Examples, claims
from core.papers.claim import (
    AGREES,
    AS_SCANNED,
    CONTRADICTION,
    DIFFERS,
    METHOD,
    MISPRINT,
    Judgement,
)
from kindyna_gui import dialogs
from kindyna_gui.background import Background, Job
from kindyna_gui.documents.texts import command_text, copy_button
from kindyna_gui.forms.tables import CopyKey
from kindyna_gui.look import coloured
from kindyna_gui.pictures.painter import RATIO
from kindyna_gui.pictures.paper.paper_figures import paper_file
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.saving import written
from kindyna_gui.settings import Settings

CHOOSE = (
    "Choose a figure, a table or an equation of a paper: it is computed and drawn then, from the example beside it."
)
COMPUTING = "Computing …"
ROW = Qt.ItemDataRole.UserRole
TONES: Mapping[str, str] = MappingProxyType({
    AGREES: "good", DIFFERS: "limit", MISPRINT: "chosen", AS_SCANNED: "chosen", METHOD: "assumed", CONTRADICTION: "assumed",
})  # fmt: skip
"""Verdict -> the tone of the theme; others are quiet."""
NONE = "no answer"
LIST_WIDTH, LEAST_PICTURE = 460, 240


class _Picture(QLabel):
    """A picture, no larger than it is and no larger than there is room."""

    def __init__(self) -> None:
        super().__init__(alignment=Qt.AlignmentFlag.AlignCenter)
        self._whole: QPixmap | None = None
        self.setMinimumSize(LEAST_PICTURE, LEAST_PICTURE)

    def show_png(self, data: bytes | None) -> None:
        self._whole = None
        if data is not None:
            self._whole = QPixmap()
            self._whole.loadFromData(data)
        self.fit(self.width(), self.height())

    @property
    def empty(self) -> bool:
        return self._whole is None

    def fit(self, width: int, height: int) -> None:
        """Into so many pixels."""
        if self._whole is None:
            self.clear()
            return
        ratio = self.devicePixelRatioF()
        most = QSizeF(self._whole.size()) * (1.0 / RATIO)
        fitted = most.scaled(max(width, 1), max(height, 1), Qt.AspectRatioMode.KeepAspectRatio)
        room = (most.boundedTo(fitted) * ratio).toSize()
        shown = self._whole.scaled(room, Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation)
        shown.setDevicePixelRatio(ratio)
        self.setPixmap(shown)

    def resizeEvent(self, event: Any) -> None:
        super().resizeEvent(event)
        self.fit(event.size().width(), event.size().height())


class FiguresWindow(QWidget):
    """The list at the left; the picture, what the paper says, what comes out here and the verdict at the right.

    open_design  opens an example by the name of its file
    computed     how many rows have been chosen and computed
    """

    def __init__(self, parent: QWidget, open_design: Callable[[str], None]) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setWindowTitle("Figures of the papers")
        dialogs.give_help(self, "papers#Kinds of verdict")
        self.resize(1180, 690)  # of a screen of 1280 x 720
        self._open_design = open_design
        self._examples, self._work = Examples(), Background(self)
        self._work.result.connect(self._take)
        self._claim: Claim | None = None
        self._opening = False
        self._items: dict[Claim, QTreeWidgetItem] = {}
        self._tops: dict[str, QTreeWidgetItem] = {}
        self._judged: dict[Claim, str] = {}
        self.computed = 0
        self.list = QTreeWidget()
        self.list.setAccessibleName("Figures, tables and statements of the papers")
        self.list.setHeaderLabels(["What the paper says", "Verdict"])
        CopyKey(self.list)
        self.list.setStyleSheet("QTreeWidget::item { padding: 2px 0 }")
        self.list.currentItemChanged.connect(lambda item, _: self._choose(None if item is None else item.data(0, ROW)))
        self.picture, self.heading, self.verdict = _Picture(), _text(), _text()
        self.says, self.here = _text(), _text()
        self.open_button, self.save_button = QPushButton("&Open the design"), QPushButton("&Save...")
        self.open_button.setToolTip("Begin with the example that this is computed of")
        self.save_button.setToolTip("The picture as PNG or SVG, or its numbers as CSV")
        self.open_button.clicked.connect(self._open)
        self.save_button.clicked.connect(self._save)
        self._fill()
        self._lay_out()
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
        buttons = QHBoxLayout()
        buttons.addStretch(1)
        buttons.addWidget(self.open_button)
        buttons.addWidget(self.save_button)
        buttons.addWidget(copy_button(self._as_command))
        words = QVBoxLayout()
        for label in (self.heading, self.says, self.here, self.verdict):
            words.addWidget(label)
        words.addLayout(buttons)
        below = QWidget()
        below.setLayout(words)
        scrolled = QScrollArea()
        scrolled.setWidgetResizable(True)
        scrolled.setFrameShape(QScrollArea.Shape.NoFrame)
        scrolled.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        scrolled.setWidget(below)
        right = QSplitter(Qt.Orientation.Vertical)
        right.addWidget(self.picture)
        right.addWidget(scrolled)
        right.setStretchFactor(0, 1)
        right.setSizes([540, 200])
        whole = QSplitter()
        whole.addWidget(self.list)
        whole.addWidget(right)
        whole.setStretchFactor(1, 1)
        whole.setSizes([LIST_WIDTH, 850])
        layout = QHBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addWidget(whole)

    # -- what is chosen -------------------------------------------------------------------------------------

    @property
    def claim(self) -> Claim | None:
        """The row that is chosen."""
        return self._claim

    @property
    def busy(self) -> bool:
        """Whether it is being computed."""
        return self._opening

    @property
    def judged(self) -> int:
        """How many rows show their verdict."""
        return len(self._judged)

    def _choose(self, claim: Claim | None) -> None:
        self._claim, self._opening = claim, claim is not None
        self.picture.show_png(None)
        self._show_words("" if claim is None else claim.title, CHOOSE if claim is None else COMPUTING)
        self._compute()

    def _compute(self) -> None:
        """The chosen row with its drawing, then the verdicts that the list still lacks."""
        jobs: list[Job] = []
        if self._claim is not None and self._opening:
            jobs.append((self._claim, partial(_opened, self._claim)))
        jobs += [((each,), partial(_verdict, each)) for each in self._items if each not in self._judged]
        self._work.start(jobs)

    def _take(self, key: Claim | tuple[Claim], result: Any) -> None:
        if isinstance(key, tuple):
            self._judge(key[0], NONE if isinstance(result, Exception) else result)
        elif isinstance(result, Exception):
            self._opening = False
            self._show_words(key.title, str(result))
            coloured(self.says, SCREEN.limit)
        else:
            self._opening = False
            self.computed += 1
            (verdict, here), drawing = result
            self._judge(key, verdict)
            self.picture.show_png(paper_file(drawing, ".png"))
            self._show_words(key.title, f"The paper: {key.says}", f"Here: {here}", verdict)
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
        """How many there are of each verdict, below the name of the paper."""
        known = [claim for claim in self._judged if claim.paper == paper and self._judged[claim] in VERDICTS]
        words = ", ".join(f"{verdict} {count}" for verdict, count in verdict_counts(known))
        self._tops[paper].setText(0, f"{PAPERS[paper].label}\n{words or COMPUTING}")

    def _show_words(self, heading: str, says: str, here: str = "", verdict: str = "") -> None:
        judged = f"{verdict.capitalize()}: {VERDICTS[verdict]}" if verdict else ""
        for label, text in ((self.heading, heading), (self.says, says), (self.here, here), (self.verdict, judged)):
            label.setText(text)
            label.setVisible(bool(text))
        coloured(self.heading, SCREEN.quiet)
        coloured(self.says, SCREEN.ink)
        self.open_button.setEnabled(False)
        self.save_button.setEnabled(False)
        if self._claim is not None:
            self.open_button.setEnabled(True)

    # -- what can be done with it ---------------------------------------------------------------------------

    def _as_command(self) -> str:
        """All of the paper at hand."""
        at = self.list.currentItem()
        top = at if at is None or at.parent() is None else at.parent()
        paper = next((slug for slug, each in self._tops.items() if each is top), "all")
        return command_text("figures", [paper, "--out", "figures"])

    def _open(self) -> None:
        if self._claim is not None:
            self._open_design(self._claim.row.example)

    def _save(self) -> None:
        claim = self._claim
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
        """In front of everything."""
        self._compute()
        self.show()
        self.raise_()
        self.activateWindow()

    def closeEvent(self, event: QCloseEvent) -> None:
        self._work.stop()
        super().closeEvent(event)

    def leave(self) -> None:
        """Nothing of it is being computed any longer."""
        self._work.close()


def _opened(claim: Claim) -> tuple[Judgement, Drawing]:
    return claim.judgement, claim.drawing


def _verdict(claim: Claim) -> str:
    return claim.verdict


def _colour(verdict: str) -> str:
    return str(getattr(SCREEN, TONES.get(verdict, "quiet")))


def _text() -> QLabel:
    label = QLabel(wordWrap=True)
    label.setTextFormat(Qt.TextFormat.PlainText)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    return label


__all__ = ["FiguresWindow"]
