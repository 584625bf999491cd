"""What changed from the pinned variant: inputs that differ, results of both, findings that came or went."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtWidgets import QComboBox, QHBoxLayout, QPushButton, QSizePolicy

from core.output.compare import Comparison, Side, as_csv, as_document, compared, side_of
from core.output.explain import explainable, labels_of
from core.output.lines import digits
from core.study import STAGES, Study
from core.units import split_unit
from kindyna_gui import dialogs
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import name_of, sentence
from kindyna_gui.look import sign
from kindyna_gui.player import Player
from kindyna_gui.requirements import NOT_PINNED, NotHere
from kindyna_gui.saving import written
from kindyna_gui.settings import Settings
from kindyna_gui.view import NumberAtHand, View

HEADINGS = (
    TableHeading("What", wide=True),
    TableHeading("of"),
    TableHeading("Pinned", number=True),
    TableHeading("Now", number=True),
    TableHeading("Change", number=True),
)
MOST = 9  # letters of a number


class CompareView(View):
    """The table of what changed, worst first."""

    of_whole = True
    stages = STAGES
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.pins = Pins.of(session)
        self.table = RowsTable(HEADINGS)
        self.table.setWordWrap(False)
        self.offer_explanation(self.table)
        self.choice = QComboBox()
        self.choice.setAccessibleName("Variant to compare with")
        self.choice.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.choice.activated.connect(self._choose)
        self.pin = QPushButton("Pin this variant")
        self.unpin = QPushButton("Unpin")
        self.save = QPushButton("Save...")
        self.pin.clicked.connect(lambda: self.pins.pin(self.session.whole))
        self.unpin.clicked.connect(self.pins.unpin)
        self.save.clicked.connect(self._save)
        self.found: Comparison | None = None
        self._side: tuple[Study, Side] | None = None  # of the variant, which an edit leaves as it is
        row = QHBoxLayout()
        row.setContentsMargins(6, 3, 6, 3)
        for widget in (self.choice, self.pin, self.unpin, self.save):
            row.addWidget(widget)
        self.set_column(row, self.table, grows=self.table)
        self.pins.changed.connect(self.invalidate)

    def number_at_hand(self) -> NumberAtHand | None:
        return self.table.number

    def refresh(self, study: Study) -> None:
        self.choice.clear()
        for each in reversed(self.pins.rows):
            self.choice.addItem(each.name, each)
        pinned = self.pins.whole_study
        if pinned is None:
            self.found = None
            raise NotHere(NOT_PINNED)
        now = side_of(self.session.whole_study)
        if self._side is None or self._side[0] is not pinned:
            with self.pins.named():
                self._side = pinned, side_of(pinned)
        self.found = compared(self._side[1], now)
        self.table.show_rows(_rows(self.found, self.session))

    def _choose(self, place: int) -> None:
        self.pins.bring(self.choice.itemData(place))

    def _save(self) -> None:
        path = dialogs.comparison_to_save(self, Settings().folder / "what_changed.html")
        found = self.found
        if path is None or found is None:
            return

        def made() -> bytes:
            if path.suffix.lower() == ".csv":
                return as_csv(found).encode()
            from core.output.report.document import html

            return html(as_document(found), {}).encode()

        self.status_message.emit(written(self, path, made))


def _rows(found: Comparison, session: Session) -> list[TableRow]:
    rows = [
        TableRow(
            (
                name_of(session.whole, row.quantity) or row.quantity,
                "input",
                *map(_brief, (row.a, row.b, row.change), row.texts),
            ),
            tip=f"{row.quantity}: {row.texts[0]} → {row.texts[1]}",
        )
        for row in found.inputs
    ]
    for mark, findings in (("gone", found.gone), ("new", found.new)):
        icons = (sign("none" if mark == "gone" else each.severity) for each in findings)
        rows += [
            TableRow((sentence(each.message), mark, "", "", ""), icon)
            for each, icon in zip(findings, icons, strict=True)
        ]
    known, labels = set(explainable(session.study)), labels_of(session.study)
    for row in found.changed:
        words = _in_words(row.quantity, labels)
        number = NumberAtHand(row.quantity) if row.quantity in known else None
        rows.append(TableRow((words, row.of, *row.texts), tip=f"{words} ({row.quantity})", number=number))
    return rows or [TableRow(("The design and its results are as pinned.", "", "", "", ""))]


def _brief(value: object, text: str) -> str:
    """An input as typed; one that was found, with all its digits, as results are: it would leave no room for names."""
    return digits(value) if isinstance(value, float) and len(text) > MOST else text


def _in_words(quantity: str, labels: Mapping[str, str]) -> str:
    """``Contact force, N`` of a column, ``feed: Contact force, N`` of one of a drive; the column itself where nobody has a word for it."""
    drive, dot, column = quantity.rpartition(".")
    label, unit = labels.get(column), split_unit(column)[1].symbol
    return quantity if label is None else f"{drive}{': ' if dot else ''}{label}{', ' if unit else ''}{unit}"


__all__ = ["CompareView"]
