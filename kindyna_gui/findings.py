"""Views of the findings, with a button for each remedy, and of the certificate: residuals that prove the results."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from math import pi
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtWidgets import QLabel, QPushButton, QStackedLayout

from core.design import Design
from core.design.fields import in_sentence
from core.errors import KindynaError
from core.findings import ERROR, Finding, Remedy, Residual
from core.number_text import result_text
from core.study import STAGES, Study, findings_of
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import name_of, sentence
from kindyna_gui.look import coloured, described, sign
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import number
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import fill
from kindyna_gui.settings import point
from kindyna_gui.view import ExplainableNumber, View, ViewHost

# -- certificate view ------------------------------------------------------------------------------------

CERTIFICATE_HEADINGS = (
    TableHeading("Check", wide=True),
    TableHeading("Residual", number=True),
    TableHeading("Bound", number=True, spare=1),
    TableHeading("Verdict"),
    TableHeading("What it proves", wide=True, spare=2),
)

PROVES: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "motion_closure": (
            "returns to its start",
            "after one turn the follower returns to its start, relative to the stroke",
        ),
        "optimum_gap": (
            "no better law",
            "peak or root mean square of the optimal law of this segment, over the least that any law with its intervals has, less 1",
        ),
        "loop_closure": (
            "the bodies fit together",
            "the bodies fit together at every cam angle, relative to their lengths",
        ),
        "instant_centre": (
            "sliding about Q",
            "the sliding velocity of cam and follower agrees with their instant centre Q, at every cam angle",
        ),
        "roller_tangency": (
            "touches, cuts nowhere",
            "the roller touches the profile and cuts into it nowhere, checked point by point, except where the cam is undercut",
        ),
        "face_tangency": (
            "touches, cuts nowhere",
            "the face touches the profile and cuts into it nowhere, checked point by point, except where the cam is undercut",
        ),
        "outer_tangency": (
            "touches, cuts nowhere",
            "the roller with its play touches the outer flank and cuts into it nowhere, checked point by point",
        ),
        "second_tangency": (
            "touches, cuts nowhere",
            "the second roller touches the second cam and cuts into it nowhere, checked point by point",
        ),
        "second_centre": (
            "sliding about Q",
            "the sliding velocity of the second roller and its cam agrees with their instant centre Q, at every cam angle",
        ),
        "power_balance": (
            "power balance",
            "the power of the cam equals that of inertia, weight, load and friction, at every cam angle",
        ),
        "momentum_balance": (
            "forces add up",
            "all forces and their moments add up to the change of momentum, at every cam angle",
        ),
        "three_centres": (
            "three centres in line",
            "the instant centres of three links lie on one line, each centre in at least one such triple; with more than 12 bodies: "
            "the centres on the frame and those of joined links",
        ),
    }
)
"""What each residual proves: in few words for the table, and in full."""


def certificate_row(name: str, residual: Residual) -> TableRow:
    """Row of the table for a residual."""
    residual_name = name.rpartition(".")[2].rstrip("0123456789").rstrip("_")  # without drive and segment
    short, proves = PROVES.get(residual_name, ("", ""))
    return TableRow(
        (
            sentence(name.replace("_", " ").replace(".", ": ")),
            result_text(residual.value, 2).replace(".", point()) if residual.value else "0",
            result_text(residual.bound, 2).replace(".", point()),
            "kept" if residual.kept else "not kept",
            sentence(", ".join(filter(None, (short, residual.note)))),
        ),
        sign("none" if residual.kept else ERROR),
        sentence(proves),
        "" if residual.kept else SCREEN.limit,
    )


class CertificateView(View):
    """Table of the residuals."""

    is_design_wide = True
    stages = STAGES
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(CERTIFICATE_HEADINGS)
        self.set_column(self.table, grows=self.table)
        self._names: tuple[str, ...] = ()
        self.offer_explanation(self.table, "Explain what it proves")

    def selected_number(self) -> ExplainableNumber | None:
        from core.output.explain import number_of_residual  # loaded when a number is explained

        row = self.table.currentIndex().row()
        name = number_of_residual(self.session.study, self._names[row]) if 0 <= row < len(self._names) else ""
        return ExplainableNumber(name) if name else None

    def preparation(self) -> Callable[[], Any]:
        from core.study import certificate_of  # loaded when the certificate is first shown

        return partial(certificate_of, self.session.full_study)

    def refresh(self, study: Study) -> None:
        from core.study import certificate_of  # as above

        proof = certificate_of(self.session.full_study)
        self._names = tuple(proof)
        self.table.show_rows([certificate_row(name, residual) for name, residual in proof.items()])


# -- findings view ---------------------------------------------------------------------------------------

FINDING_HEADINGS = (TableHeading("Finding", wide=True), TableHeading("Remedy"), TableHeading("Angle °", number=True))
REMEDY = 1  # column
GAP = 4  # above and below the sentence, pixels
LEAST_ROWS, MOST_HEIGHT = 3, 260  # findings that the view shows at least; their largest height, pixels


class FindingsView(View):
    """List of the findings.

    - field_requested (path): a finding of this field was clicked
    - remedy_chosen (remedy): the button of a remedy was clicked
    - height_requested (pixels, is_fixed): least height of the content; is_fixed: the content needs no more
    """

    is_design_wide = True
    stages = STAGES
    pause_ms = 150
    field_requested = Signal(str)
    remedy_chosen = Signal(object)
    height_requested = Signal(int, bool)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(FINDING_HEADINGS)
        self.empty = coloured(
            QLabel("No limit is exceeded.", alignment=Qt.AlignmentFlag.AlignCenter, wordWrap=True), SCREEN.quiet
        )
        self.table.setMinimumHeight(1)
        self.findings: tuple[Finding, ...] = ()
        self._is_other_design = False  # than that of the findings
        # without a parent its first page would flash up as a window
        self._pages = fill(QStackedLayout(self.content), self.table, self.empty)
        self.table.clicked.connect(self._go)
        self.table.activated.connect(self._go)
        self.table.rows_resized.connect(self._request_height)
        session.started.connect(self._begin)
        self.offer_explanation(self.table)

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.field_requested.connect(window.focus_field)
        self.remedy_chosen.connect(window.apply_remedy)

    def selected_number(self) -> ExplainableNumber | None:
        from core.output.explain import number_of_finding  # loaded when a number is explained

        row = self.table.currentIndex().row()
        name = number_of_finding(self.session.study, self.findings[row]) if 0 <= row < len(self.findings) else ""
        return ExplainableNumber(name) if name else None

    def preparation(self) -> Callable[[], Any]:
        return partial(findings_of, self.session.full_study)

    def refresh(self, study: Study) -> None:
        study = self.session.full_study
        self.findings, self._is_other_design = findings_of(study), False
        rows, remedies = [], _remedies(study.design, self.findings)
        for f, remedy in zip(self.findings, remedies, strict=True):
            tip = f"{sentence(f.severity)}. Click to go to its cam angle and to: {name_of(study.design, f.field)}"
            label = remedy.label.format(name=in_sentence(name_of(study.design, remedy.field)))
            rows.append(TableRow((sentence(f.message), sentence(label), _angle(f)), sign(f.severity), tip))
        self.table.show_rows(rows)
        self.table.show_buttons(REMEDY, map(self._button, rows, remedies))
        self._pages.setCurrentWidget(self.table if rows else self.empty)
        self._request_height()

    def show_reason(self, error: KindynaError) -> None:
        super().show_reason(error)
        if self._trouble is not None and self.on_screen():
            self.height_requested.emit(min(self._trouble.height_for(self.width()), MOST_HEIGHT), True)

    def _begin(self) -> None:
        """Need no more room than without findings, until those of another design are known."""
        self._is_other_design = True
        self._request_height()

    def _request_height(self) -> None:
        if self._is_other_design or not self.findings:
            self.height_requested.emit(self.empty.sizeHint().height() + 2 * GAP, True)
        elif self.on_screen():  # behind another dock the rows have the width of an earlier layout
            self.height_requested.emit(self._height(), False)

    def _height(self) -> int:
        """Height of the header and the first findings, pixels."""
        rows = sum(self.table.rowHeight(row) for row in range(min(self.table.model().rowCount(), LEAST_ROWS)))
        return min(self.table.horizontalHeader().sizeHint().height() + rows + GAP, MOST_HEIGHT)

    def _button(self, row: TableRow, remedy: Remedy) -> QPushButton:
        button = described(
            QPushButton(row.cells[REMEDY], autoDefault=False),
            tip="Find the value that meets the limit" if remedy.find else "Go to the field",
        )
        button.clicked.connect(lambda: self.remedy_chosen.emit(remedy))
        return button

    def _go(self, index: QModelIndex) -> None:
        finding = self.findings[index.row()]
        self.field_requested.emit(finding.field)  # first, since it can select another drive
        if finding.cam_angle_deg is not None:
            self.player.play(False)
            go = self.player.set_machine if finding.field.startswith("shaft.") else self.player.set_theta
            go(finding.cam_angle_deg * pi / 180.0)


def _remedies(design: Design, findings: tuple[Finding, ...]) -> list[Remedy]:
    if not findings:  # without findings Find is not loaded
        return []
    from core.find import remedy_of

    return [remedy_of(design, finding) for finding in findings]


def _angle(finding: Finding) -> str:
    angle = finding.cam_angle_deg
    return "all" if angle is None or not math.isfinite(angle) else number(angle, 2)
