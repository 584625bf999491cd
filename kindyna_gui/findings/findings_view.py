"""What the design exceeds, the gravest first; a click leads to the cam angle and to the field that mends it."""

from __future__ import annotations

import math
from math import pi

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtWidgets import QLabel, QPushButton, QStackedLayout

from core.design import Design
from core.findings import Finding, Remedy
from core.study import STAGES, Study, findings_of
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import in_sentence, name_of, sentence
from kindyna_gui.look import coloured, sign
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.view import NumberAtHand, View, ViewHost

HEADINGS = (TableHeading("Finding", wide=True), TableHeading("Remedy"), TableHeading("Angle °", number=True))
REMEDY = 1  # column
GAP = 4  # pixels above and below the sentence
SHOWN, MOST = 2, 110  # findings that are seen at least, in so many pixels at most


class FindingsView(View):
    """The list of findings.

    field_requested   (path): a finding was clicked whose field this is
    mending_wanted    (remedy): the button of one was
    height_wanted     (pixels, whole): what it has to show needs at least so much, and no more where that is the whole of it
    """

    of_whole = True
    stages = STAGES
    pause_ms = 150
    field_requested = Signal(str)
    mending_wanted = Signal(object)
    height_wanted = Signal(int, bool)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(HEADINGS)
        self.empty = QLabel("No limit is exceeded.", alignment=Qt.AlignmentFlag.AlignCenter, wordWrap=True)
        coloured(self.empty, SCREEN.quiet)
        self.table.setMinimumHeight(1)
        self._findings: tuple[Finding, ...] = ()
        # of the content from the start: without a parent its first page would flash up as a window
        self._pages = QStackedLayout(self.content)
        self._pages.addWidget(self.table)
        self._pages.addWidget(self.empty)
        self.table.clicked.connect(self._go)
        self.table.activated.connect(self._go)
        self.offer_explanation(self.table)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is listed."""
        return self._findings

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.field_requested.connect(window.focus_field)
        self.mending_wanted.connect(window.mend)

    def number_at_hand(self) -> NumberAtHand | None:
        from core.output.explain import number_of_finding

        row = self.table.currentIndex().row()
        name = number_of_finding(self.session.study, self._findings[row]) if 0 <= row < len(self._findings) else ""
        return NumberAtHand(name) if name else None

    def refresh(self, study: Study) -> None:
        whole = self.session.whole_study
        self._findings = findings_of(whole)
        rows, remedies = [], _remedies(whole.design, self._findings)
        for f, remedy in zip(self._findings, remedies, strict=True):
            tip = f"{sentence(f.severity)}. Click to go to its cam angle and to: {name_of(whole.design, f.field)}"
            label = remedy.label.format(name=in_sentence(name_of(whole.design, remedy.field)))
            rows.append(TableRow((sentence(f.message), sentence(label), _angle(f)), sign(f.severity), tip))
        self.table.show_rows(rows)
        self.table.show_buttons(REMEDY, map(self._button, rows, remedies))
        self._pages.setCurrentWidget(self.table if rows else self.empty)
        self.height_wanted.emit(
            *((self._height(), False) if rows else (self.empty.sizeHint().height() + 2 * GAP, True))
        )

    def _height(self) -> int:
        """Pixels of the head and the first findings."""
        rows = sum(self.table.rowHeight(row) for row in range(min(self.table.model().rowCount(), SHOWN)))
        return min(self.table.horizontalHeader().sizeHint().height() + rows + GAP, MOST)

    def _button(self, row: TableRow, remedy: Remedy) -> QPushButton:
        button = QPushButton(row.cells[REMEDY], autoDefault=False)
        button.setToolTip("Search for the value that keeps the limit" if remedy.find else "Go to where it is typed")
        button.clicked.connect(lambda: self.mending_wanted.emit(remedy))
        return button

    def _go(self, index: QModelIndex) -> None:
        finding = self._findings[index.row()]
        self.field_requested.emit(finding.field)  # first: the angle is that of the drive which it shows
        if finding.cam_angle_deg is not None:
            self.player.play(False)
            go = self.player.set_machine if finding.field.startswith("shaft.") else self.player.set_theta
            go(finding.cam_angle_deg * pi / 180.0)


def _remedies(design: Design, findings: tuple[Finding, ...]) -> list[Remedy]:
    if not findings:  # then no search need be loaded
        return []
    from core.find import remedy_of

    return [remedy_of(design, finding) for finding in findings]


def _angle(finding: Finding) -> str:
    angle = finding.cam_angle_deg
    return "all" if angle is None or not math.isfinite(angle) else f"{angle:.2f}"
