"""Figures of the papers: a list by paper; the one that is chosen is computed then, with its statement, our number and the verdict."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtGui import QCloseEvent, QPixmap
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSplitter,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from core.output.paper_files import table_text
from core.papers import AGREES, DIFFERS, MISPRINT, PAPERS, Claim, Examples, claims
from kindyna_gui import dialogs
from kindyna_gui.background import Background
from kindyna_gui.documents.exports import written
from kindyna_gui.look import INK, QUIET, WRONG, coloured
from kindyna_gui.pictures.files import RATIO
from kindyna_gui.pictures.paper_figures import paper_file
from kindyna_gui.pictures.style import BLUE, GREEN
from kindyna_gui.settings import Settings

CHOOSE = "Choose a figure, a table or an equation of a paper: it is computed then, from the example beside it."
COMPUTING = "Computing …"
ROW = Qt.ItemDataRole.UserRole
COLOURS: Mapping[str, str] = MappingProxyType({AGREES: GREEN, DIFFERS: WRONG, MISPRINT: BLUE})
"""Verdict -> its colour."""
LIST_WIDTH, LEAST_PICTURE = 330, 240


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
            self._whole.loadFromData(data, "PNG")
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
        most = self._whole.size() / RATIO
        room = most.boundedTo(most.scaled(max(width, 1), max(height, 1), Qt.AspectRatioMode.KeepAspectRatio)) * ratio
        shown = self._whole.scaled(room, Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation)
        shown.setDevicePixelRatio(ratio)
        self.setPixmap(shown)

    def resizeEvent(self, event: Any) -> None:
        super().resizeEvent(event)
        self.fit(event.size().width(), event.size().height())


class FiguresWindow(QWidget):
    """The list at the left; the picture, what the paper says, what comes out here and the verdict at the right.

    open_design  opens an example by the name of its file
    computed     how many rows have been computed
    """

    def __init__(self, parent: QWidget, open_design: Callable[[str], None]) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self.setWindowTitle("Figures of the papers")
        self.resize(1180, 690)  # of a screen of 1280 x 720
        self._open_design = open_design
        self._examples, self._work = Examples(), Background(self)
        self._work.result.connect(self._take)
        self._claim: Claim | None = None
        self.computed = 0
        self.list = QTreeWidget()
        self.list.setHeaderHidden(True)
        self.list.setStyleSheet("QTreeWidget::item { padding: 2px 0 }")  # room for the dots of derivatives
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
            top = QTreeWidgetItem(self.list, [paper.label])
            top.setToolTip(0, paper.title)
            for claim in claims(paper.slug, self._examples):
                item = QTreeWidgetItem(top, [f"{claim.where}   {claim.says}"])
                item.setToolTip(0, claim.title)
                item.setData(0, ROW, claim)
        self.list.expandAll()

    def _lay_out(self) -> None:
        buttons = QHBoxLayout()
        buttons.addStretch(1)
        buttons.addWidget(self.open_button)
        buttons.addWidget(self.save_button)
        words = QVBoxLayout()
        for label in (self.heading, self.says, self.here, self.verdict):
            words.addWidget(label)
        words.addLayout(buttons)
        below = QWidget()
        below.setLayout(words)
        scrolled = QScrollArea()
        scrolled.setWidgetResizable(True)
        scrolled.setFrameShape(QScrollArea.Shape.NoFrame)
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
        return self._work.busy

    def _choose(self, claim: Claim | None) -> None:
        self._work.stop()
        self._claim = claim
        self.picture.show_png(None)
        if claim is None:
            self._show_words("", CHOOSE)
            return
        self._show_words(claim.title, COMPUTING)
        self.open_button.setEnabled(True)
        self._work.start([(claim, lambda: (claim.judgement, claim.drawing))])

    def _take(self, claim: Claim, result: Any) -> None:
        if claim is not self._claim:
            return
        if isinstance(result, Exception):
            self._show_words(claim.title, str(result))
            coloured(self.says, WRONG)
            return
        self.computed += 1
        (verdict, here), drawing = result
        self.picture.show_png(paper_file(drawing, ".png"))
        self._show_words(claim.title, f"The paper: {claim.says}", f"Here: {here}", verdict)
        coloured(self.verdict, COLOURS[verdict])
        self.save_button.setEnabled(True)

    def _show_words(self, heading: str, says: str, here: str = "", verdict: str = "") -> None:
        for label, text in ((self.heading, heading), (self.says, says), (self.here, here), (self.verdict, verdict.capitalize())):
            label.setText(text)
            label.setVisible(bool(text))
        coloured(self.heading, QUIET)
        coloured(self.says, INK)
        self.open_button.setEnabled(False)
        self.save_button.setEnabled(False)
        if self._claim is not None:
            self.open_button.setEnabled(True)

    # -- what can be done with it ---------------------------------------------------------------------------

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
            written(self, path, lambda: table_text(claim.table) if ending == ".csv" else paper_file(claim.drawing, ending), paints=True)

    # -- window ---------------------------------------------------------------------------------------------

    def open(self) -> None:
        """In front of everything."""
        self.show()
        self.raise_()
        self.activateWindow()

    def closeEvent(self, event: QCloseEvent) -> None:
        self._work.stop()
        super().closeEvent(event)

    def leave(self) -> None:
        """Nothing of it is being computed any longer."""
        self._work.close()


def _text() -> QLabel:
    label = QLabel(wordWrap=True)
    label.setTextFormat(Qt.TextFormat.PlainText)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    return label


__all__ = ["FiguresWindow"]
