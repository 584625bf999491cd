"""Findings, certificate."""

from __future__ import annotations

import math
from collections.abc import Mapping
from math import pi
from types import MappingProxyType

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtWidgets import QLabel, QPushButton, QStackedLayout

from core.design import Design
from core.findings import ERROR, Finding, Remedy, Residual
from core.study import STAGES, Study, certificate_of, findings_of
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import in_sentence, name_of, sentence
from kindyna_gui.look import coloured, sign
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.view import ExplainableNumber, View, ViewHost

# -- certificate view ------------------------------------------------------------------------------------

CERTIFICATE_HEADINGS = (
    TableHeading("Check"),
    TableHeading("Residual", number=True),
    TableHeading("Bound", number=True),
    TableHeading("Verdict"),
    TableHeading("What it proves", wide=True),
)

PROVES: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "motion_closure": (
            "back where it began",
            "after one turn the follower is back where it began, relative to the stroke",
        ),
        "loop_closure": (
            "the bodies fit together",
            "the bodies fit together at every cam angle, relative to their lengths",
        ),
        "instant_centre": (
            "sliding as Q asks",
            "cam and follower slide past each other as their instant centre asks, at every cam angle",
        ),
        "roller_tangency": (
            "touches, cuts nowhere",
            "the roller touches the profile and cuts into it nowhere, tried point by point; left out is what an undercut takes away",
        ),
        "face_tangency": (
            "touches, cuts nowhere",
            "the face touches the profile and cuts into it nowhere, tried point by point; left out is what an undercut takes away",
        ),
        "outer_tangency": (
            "touches, cuts nowhere",
            "the roller with its play touches the outer flank and cuts into it nowhere, tried point by point",
        ),
        "second_tangency": (
            "touches, cuts nowhere",
            "the second roller touches the second cam and cuts into it nowhere, tried point by point",
        ),
        "second_centre": (
            "sliding as Q asks",
            "the second roller and its cam slide past each other as their instant centre asks, at every cam angle",
        ),
        "power_balance": (
            "power in is power out",
            "what the cam puts in is what kinetic energy, weight, load and friction take, at every cam angle",
        ),
        "momentum_balance": (
            "forces add up",
            "all forces and their moments add up to the change of momentum, at every cam angle",
        ),
        "three_centres": (
            "three centres in line",
            "the instant centres of three links lie on one line, each centre in one such triple at least; of more than 12 bodies each "
            "centre on the frame and of two links that are joined",
        ),
    }
)
"""Residual -> what it proves: in few words for the table, and in full."""


def certificate_row(name: str, residual: Residual) -> TableRow:
    """A residual as a line of the table."""
    short, proves = PROVES.get(name.rpartition(".")[2], ("", ""))  # of a drive, its slug before it
    return TableRow(
        (
            sentence(name.replace("_", " ").replace(".", ": ")),
            f"{residual.value:.1e}" if residual.value else "0",
            f"{residual.bound:.1e}",
            "kept" if residual.kept else "not kept",
            sentence(", ".join(filter(None, (short, residual.note)))),
        ),
        sign("none" if residual.kept else ERROR),
        sentence(proves),
        "" if residual.kept else SCREEN.limit,
    )


class CertificateView(View):
    """The table of residuals."""

    is_design_wide = True
    stages = STAGES
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(CERTIFICATE_HEADINGS)
        self.table.setWordWrap(False)
        self.set_column(self.table, grows=self.table)
        self._names: tuple[str, ...] = ()
        self.offer_explanation(self.table, "Explain what it proves")

    def selected_number(self) -> ExplainableNumber | None:
        from core.output.explain import number_of_residual

        row = self.table.currentIndex().row()
        name = number_of_residual(self.session.study, self._names[row]) if 0 <= row < len(self._names) else ""
        return ExplainableNumber(name) if name else None

    def refresh(self, study: Study) -> None:
        proof = certificate_of(self.session.full_study)
        self._names = tuple(proof)
        self.table.show_rows([certificate_row(name, residual) for name, residual in proof.items()])


# -- findings view ---------------------------------------------------------------------------------------

FINDING_HEADINGS = (TableHeading("Finding", wide=True), TableHeading("Remedy"), TableHeading("Angle °", number=True))
REMEDY = 1  # column
GAP = 4  # pixels above and below the sentence
SHOWN, MOST = 2, 110  # findings that are seen at least, in so many pixels at most


class FindingsView(View):
    """The list of findings.

    field_requested   (path): a finding was clicked whose field this is
    remedy_chosen    (remedy): the button of one was
    height_wanted     (pixels, whole): what it has to show needs at least so much, and no more where that is the whole of it
    """

    is_design_wide = True
    stages = STAGES
    pause_ms = 150
    field_requested = Signal(str)
    remedy_chosen = Signal(object)
    height_wanted = Signal(int, bool)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(FINDING_HEADINGS)
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
        self.remedy_chosen.connect(window.apply_remedy)

    def selected_number(self) -> ExplainableNumber | None:
        from core.output.explain import number_of_finding

        row = self.table.currentIndex().row()
        name = number_of_finding(self.session.study, self._findings[row]) if 0 <= row < len(self._findings) else ""
        return ExplainableNumber(name) if name else None

    def refresh(self, study: Study) -> None:
        whole = self.session.full_study
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
        button.clicked.connect(lambda: self.remedy_chosen.emit(remedy))
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
