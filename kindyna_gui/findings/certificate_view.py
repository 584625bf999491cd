"""The certificate: what proves the figures, each residual with the bound it must keep."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from core.findings import ERROR, Residual
from core.study import STAGES, Study, certificate_of
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import sentence
from kindyna_gui.look import sign
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.view import NumberAtHand, View

HEADINGS = (
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

    of_whole = True
    stages = STAGES
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.table = RowsTable(HEADINGS)
        self.table.setWordWrap(False)
        self.set_column(self.table, grows=self.table)
        self._names: tuple[str, ...] = ()
        self.offer_explanation(self.table, "Explain what it proves")

    def number_at_hand(self) -> NumberAtHand | None:
        from core.output.explain import number_of_residual

        row = self.table.currentIndex().row()
        name = number_of_residual(self.session.study, self._names[row]) if 0 <= row < len(self._names) else ""
        return NumberAtHand(name) if name else None

    def refresh(self, study: Study) -> None:
        proof = certificate_of(self.session.whole_study)
        self._names = tuple(proof)
        self.table.show_rows([certificate_row(name, residual) for name, residual in proof.items()])
