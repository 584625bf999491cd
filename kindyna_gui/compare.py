"""Views What changed, with the differences from the pinned variant, and Explain, with the calculation of a number."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees
from typing import Any

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QComboBox, QCompleter, QHBoxLayout, QLabel, QPushButton, QSizePolicy

from core.errors import KindynaError, ResultPending
from core.number_text import MOST_DIGITS, result_text
from core.output.compare import (
    ComparedDesign,
    Comparison,
    compare_designs,
    compared_design,
    comparison_csv,
    comparison_document,
)
from core.output.explain import explainable, explained, labels_of
from core.output.lines import digits
from core.study import STAGES, Study
from core.study.symbols import DYNAMICS, LINKAGE
from core.units import split_unit
from kindyna_gui import dialogs
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import name_of, sentence
from kindyna_gui.look import coloured, described, sign
from kindyna_gui.pictures.style import SCREEN, SERIF
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import connect_all, fill
from kindyna_gui.requirements import NOT_PINNED, Unavailable
from kindyna_gui.saving import written
from kindyna_gui.settings import Settings
from kindyna_gui.view import ExplainableNumber, View, ViewHost

# -- compare view ----------------------------------------------------------------------------------------

COMPARE_HEADINGS = (
    TableHeading("What", wide=True),
    TableHeading("of"),
    TableHeading("Pinned", number=True),
    TableHeading("Now", number=True),
    TableHeading("Change", number=True),
)
MOST = 9  # characters of a number


class CompareView(View):
    """Table of the differences from the pinned variant, largest first."""

    is_design_wide = True
    stages = STAGES
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.pins = Pins.of(session)
        self.table = RowsTable(COMPARE_HEADINGS)
        self.table.setWordWrap(False)
        self.offer_explanation(self.table)
        self.choice = described(QComboBox(), name="Variant to compare with")
        self.choice.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.choice.activated.connect(self._choose)
        self.pin = QPushButton("Pin this variant")
        self.unpin = QPushButton("Unpin")
        self.save = QPushButton("Save...")
        self.pin.clicked.connect(lambda: self.pins.pin(self.session.full_design))
        self.unpin.clicked.connect(self.pins.unpin)
        self.save.clicked.connect(self._save)
        self.comparison: Comparison | None = None
        self._pinned: tuple[Study, ComparedDesign] | None = None  # of the pinned variant, which edits do not change
        row = fill(QHBoxLayout(), self.choice, self.pin, self.unpin, self.save, margins=(6, 3, 6, 3))
        self.set_column(row, self.table, grows=self.table)
        self.pins.changed.connect(self.invalidate)

    def selected_number(self) -> ExplainableNumber | None:
        return self.table.number

    def refresh(self, study: Study) -> None:
        self.choice.clear()
        for row in reversed(self.pins.rows):
            self.choice.addItem(row.name, row)
        pinned = self.pins.full_study
        if pinned is None:
            self.comparison = None
            raise Unavailable(NOT_PINNED)
        now = compared_design(self.session.full_study)
        if self._pinned is None or self._pinned[0] is not pinned:
            with self.pins.named():
                self._pinned = pinned, compared_design(pinned)
        self.comparison = compare_designs(self._pinned[1], now)
        self.table.show_rows(_rows(self.comparison, self.session))

    def _choose(self, row: int) -> None:
        self.pins.bring(self.choice.itemData(row))

    def _save(self) -> None:
        path = dialogs.comparison_to_save(self, Settings().folder / "what_changed.html")
        comparison = self.comparison
        if path is None or comparison is None:
            return

        def content() -> bytes:
            if path.suffix.lower() == ".csv":
                return comparison_csv(comparison).encode()
            from core.output.report.document import html  # loaded when a file is written

            return html(comparison_document(comparison), {}).encode()

        self.status_message.emit(written(self, path, content))


def _rows(comparison: Comparison, session: Session) -> list[TableRow]:
    rows = [
        TableRow(
            (
                name_of(session.full_design, row.quantity) or row.quantity,
                "input",
                *map(_brief, (row.a, row.b, row.change), row.texts),
            ),
            tip=f"{row.quantity}: {row.texts[0]} → {row.texts[1]}",
        )
        for row in comparison.inputs
    ]
    for mark, findings in (("gone", comparison.gone), ("new", comparison.new)):
        for finding in findings:
            icon = sign("none" if mark == "gone" else finding.severity)
            rows.append(TableRow((sentence(finding.message), mark, "", "", ""), icon))
    known, labels = set(explainable(session.study)), labels_of(session.study)
    for row in comparison.changed:
        words = _quantity_text(row.quantity, labels)
        number = ExplainableNumber(row.quantity) if row.quantity in known else None
        rows.append(TableRow((words, row.of, *row.texts), tip=f"{words} ({row.quantity})", number=number))
    return rows or [TableRow(("No difference from the pinned variant.", "", "", "", ""))]


def _brief(value: object, text: str) -> str:
    """An input as typed; a long number from a search is shortened, to leave room for the names."""
    return digits(value, MOST_DIGITS) if isinstance(value, float) and len(text) > MOST else text


def _quantity_text(quantity: str, labels: Mapping[str, str]) -> str:
    """Label of a column, ``Contact force, N`` or ``feed: Contact force, N``; the column where it has no label."""
    drive, dot, column = quantity.rpartition(".")
    label, unit = labels.get(column), split_unit(column)[1].symbol
    return quantity if label is None else f"{drive}{': ' if dot else ''}{label}{', ' if unit else ''}{unit}"


# -- explain view ----------------------------------------------------------------------------------------

EXPLAIN_HEADINGS = (
    TableHeading("Symbol"),
    TableHeading("Value", number=True),
    TableHeading("Unit"),
    TableHeading("What it is", wide=True),
    TableHeading("From"),
)
FIRST = ("drive_torque_nm", "driver_torque_nm", "torque_nm")


class ExplainView(View):
    """Equation and symbols of one number, selected in the box above or by a right click on a plot.

    - field_requested (path): a symbol was clicked that is an input, or follows from a section of the inputs
    """

    stages = STAGES
    pause_ms = 150
    reading_ms = 60
    field_requested = Signal(str)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.choice = described(
            QComboBox(editable=True, insertPolicy=QComboBox.InsertPolicy.NoInsert), name="Number to explain"
        )
        if (line := self.choice.lineEdit()) is not None:
            line.setAccessibleName("Number to explain")
        self.choice.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.choice.setMinimumContentsLength(16)
        if (completer := self.choice.completer()) is not None:
            completer.setFilterMode(Qt.MatchFlag.MatchContains)
            completer.setCompletionMode(QCompleter.CompletionMode.PopupCompletion)
        self.largest = QCheckBox("Where it is largest")
        self.header = QLabel(
            wordWrap=True,
            textFormat=Qt.TextFormat.PlainText,
            textInteractionFlags=Qt.TextInteractionFlag.TextSelectableByMouse,
            margin=6,
        )
        font = self.header.font()
        font.setFamilies([*SERIF, *font.families()])
        self.header.setFont(font)
        self.proof = coloured(QLabel(wordWrap=True, textFormat=Qt.TextFormat.PlainText, margin=6), SCREEN.quiet)
        self.table = RowsTable(EXPLAIN_HEADINGS)
        self.table.setFont(font)
        row = fill(QHBoxLayout(), self.choice, self.largest, margins=(6, 3, 6, 0))
        self.set_column(row, self.header, self.table, self.proof, grows=self.table)
        self._names: list[str] = []
        self._chosen = ""
        self._machine_names: frozenset[str] = frozenset()  # numbers of all drives, by machine angle
        connect_all(
            (self.choice.activated, self._choose),
            (self.largest.toggled, self.invalidate),
            (self.table.clicked, self._go),
            (self.table.activated, self._go),
        )

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.field_requested.connect(window.focus_field)

    def explain(self, number: ExplainableNumber) -> None:
        """Show how this number is calculated, at its angle where it has one."""
        self._chosen = number.name
        if number.theta is not None:
            self.largest.setChecked(False)
            self.player.play(False)
            go = self.player.set_machine if number.name in self._machine_numbers() else self.player.set_theta
            go(number.theta)
        self.invalidate()

    def _machine_numbers(self) -> list[str]:
        """Numbers of the shaft with all its drives; none while they are being calculated."""
        try:
            return explainable(self.session.full_study) if self.session.has_several_drives else []
        except ResultPending:
            return []

    def refresh(self, study: Study) -> None:
        labels = labels_of(study)
        self._machine_names = frozenset(self._machine_numbers())
        names = [name for name in explainable(study) if name not in self._machine_names] + sorted(self._machine_names)
        if names != self._names:
            self._names = names
            self.choice.clear()
            self.choice.addItems([f"{labels.get(name, name)}  ({name})" for name in names])
        if self._chosen not in names:
            self._chosen = next((name for name in FIRST if name in names), names[0])
        self.choice.setCurrentIndex(names.index(self._chosen))

    def follow(self, theta: float) -> None:
        """Explain the number at the current angle, or where it is largest."""
        by_machine = self._chosen in self._machine_names
        at = None if self.largest.isChecked() else degrees(self.player.machine_of(theta) if by_machine else theta)
        try:
            number = explained(self.session.full_study if by_machine else self.session.study, self._chosen, at)
        except KindynaError as error:
            self.header.setText(str(error))
            self.table.show_rows([])
            self.proof.clear()
            return
        self.header.setText("\n".join([number.headline(MOST_DIGITS), *number.equations, f"after {number.source}"]))
        self.table.update_rows(
            [
                TableRow(
                    (
                        symbol.symbol,
                        digits(symbol.value, MOST_DIGITS),
                        symbol.unit,
                        sentence(symbol.meaning),
                        symbol.origin,
                    ),
                    number=ExplainableNumber(symbol.column) if symbol.column else None,
                )
                for symbol in number.letters
            ]
        )
        self.proof.setText("" if number.residual is None else _residual_text(*number.residual))

    def _choose(self, row: int) -> None:
        if 0 <= row < len(self._names):
            self.explain(ExplainableNumber(self._names[row]))

    def _go(self, index: QModelIndex) -> None:
        """Show the source of a symbol: its explanation, its field, or the fields of its stage."""
        row = self.table.rows.rows[index.row()]
        origin = row.cells[-1]
        if row.number is not None and row.number.name in self._names:
            self.explain(row.number)
        elif origin != DYNAMICS:
            follower = origin == LINKAGE and not self.session.design.drive.links
            self.field_requested.emit("follower" if follower else origin)


def _residual_text(name: str, residual: Any) -> str:
    return f"Proved by {name.replace('_', ' ')}: residual {result_text(residual.value, 2)}, bound {result_text(residual.bound, 2)}."
