"""What changed, explain."""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees
from typing import Any

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QComboBox, QCompleter, QHBoxLayout, QLabel, QPushButton, QSizePolicy

from core.errors import KindynaError, ResultPending
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
from kindyna_gui.look import coloured, sign
from kindyna_gui.pictures.style import SCREEN, SERIF
from kindyna_gui.player import Player
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
MOST = 9  # letters of a number


class CompareView(View):
    """The table of what changed, worst first."""

    is_design_wide = True
    stages = STAGES
    pause_ms = 150

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.pins = Pins.of(session)
        self.table = RowsTable(COMPARE_HEADINGS)
        self.table.setWordWrap(False)
        self.offer_explanation(self.table)
        self.choice = QComboBox()
        self.choice.setAccessibleName("Variant to compare with")
        self.choice.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.choice.activated.connect(self._choose)
        self.pin = QPushButton("Pin this variant")
        self.unpin = QPushButton("Unpin")
        self.save = QPushButton("Save...")
        self.pin.clicked.connect(lambda: self.pins.pin(self.session.full_design))
        self.unpin.clicked.connect(self.pins.unpin)
        self.save.clicked.connect(self._save)
        self.found: Comparison | None = None
        self._side: tuple[Study, ComparedDesign] | None = None  # of the variant, which an edit leaves as it is
        row = QHBoxLayout()
        row.setContentsMargins(6, 3, 6, 3)
        for widget in (self.choice, self.pin, self.unpin, self.save):
            row.addWidget(widget)
        self.set_column(row, self.table, grows=self.table)
        self.pins.changed.connect(self.invalidate)

    def selected_number(self) -> ExplainableNumber | None:
        return self.table.number

    def refresh(self, study: Study) -> None:
        self.choice.clear()
        for each in reversed(self.pins.rows):
            self.choice.addItem(each.name, each)
        pinned = self.pins.full_study
        if pinned is None:
            self.found = None
            raise Unavailable(NOT_PINNED)
        now = compared_design(self.session.full_study)
        if self._side is None or self._side[0] is not pinned:
            with self.pins.named():
                self._side = pinned, compared_design(pinned)
        self.found = compare_designs(self._side[1], now)
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
                return comparison_csv(found).encode()
            from core.output.report.document import html

            return html(comparison_document(found), {}).encode()

        self.status_message.emit(written(self, path, made))


def _rows(found: Comparison, session: Session) -> list[TableRow]:
    rows = [
        TableRow(
            (
                name_of(session.full_design, row.quantity) or row.quantity,
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
        number = ExplainableNumber(row.quantity) if row.quantity in known else None
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
    """One number at a time, chosen in the box above, or by a right click on a plot.

    field_requested   (path): a letter was clicked that is typed, or follows from a section of what is
    """

    stages = STAGES
    pause_ms = 150
    reading_ms = 60
    field_requested = Signal(str)

    def __init__(self, session: Session, player: Player) -> None:
        super().__init__(session, player)
        self.choice = QComboBox(editable=True)
        self.choice.setInsertPolicy(QComboBox.InsertPolicy.NoInsert)
        self.choice.setAccessibleName("Number to explain")
        if (line := self.choice.lineEdit()) is not None:
            line.setAccessibleName("Number to explain")
        self.choice.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.choice.setMinimumContentsLength(16)
        if (completer := self.choice.completer()) is not None:
            completer.setFilterMode(Qt.MatchFlag.MatchContains)
            completer.setCompletionMode(QCompleter.CompletionMode.PopupCompletion)
        self.largest = QCheckBox("Where it is largest")
        self.head = QLabel(wordWrap=True, textFormat=Qt.TextFormat.PlainText)
        self.head.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.head.setMargin(6)
        written = self.head.font()
        written.setFamilies([*SERIF, *written.families()])
        self.head.setFont(written)
        self.proof = QLabel(wordWrap=True, textFormat=Qt.TextFormat.PlainText)
        self.proof.setMargin(6)
        coloured(self.proof, SCREEN.quiet)
        self.table = RowsTable(EXPLAIN_HEADINGS)
        self.table.setFont(written)
        row = QHBoxLayout()
        row.setContentsMargins(6, 3, 6, 0)
        row.addWidget(self.choice)
        row.addWidget(self.largest)
        self.set_column(row, self.head, self.table, self.proof, grows=self.table)
        self._names: list[str] = []
        self._chosen = ""
        self._whole: frozenset[str] = frozenset()
        self.choice.activated.connect(self._choose)
        self.largest.toggled.connect(self.invalidate)
        self.table.clicked.connect(self._go)
        self.table.activated.connect(self._go)

    def belong_to(self, window: ViewHost) -> None:
        super().belong_to(window)
        self.field_requested.connect(window.focus_field)

    def explain(self, number: ExplainableNumber) -> None:
        """Show where this number comes from, at its own angle where it has one."""
        self._chosen = number.name
        if number.theta is not None:
            self.largest.setChecked(False)
            self.player.play(False)
            go = self.player.set_machine if number.name in self._of_whole() else self.player.set_theta
            go(number.theta)
        self.invalidate()

    def _of_whole(self) -> list[str]:
        """What is one of the whole shaft, where several drives turn with it; nothing while that is being looked for."""
        try:
            return explainable(self.session.full_study) if self.session.several else []
        except ResultPending:
            return []

    def refresh(self, study: Study) -> None:
        labels = labels_of(study)
        self._whole = frozenset(self._of_whole())
        names = [name for name in explainable(study) if name not in self._whole] + sorted(self._whole)
        if names != self._names:
            self._names = names
            self.choice.clear()
            self.choice.addItems([f"{labels.get(name, name)}  ({name})" for name in names])
        if self._chosen not in names:
            self._chosen = next((name for name in FIRST if name in names), names[0])
        self.choice.setCurrentIndex(names.index(self._chosen))

    def follow(self, theta: float) -> None:
        """At the angle at hand, else at the largest value."""
        whole = self._chosen in self._whole
        at = None if self.largest.isChecked() else degrees(self.player.machine_of(theta) if whole else theta)
        try:
            made = explained(self.session.full_study if whole else self.session.study, self._chosen, at)
        except KindynaError as error:
            self.head.setText(str(error))
            self.table.show_rows([])
            self.proof.clear()
            return
        self.head.setText("\n".join([made.headline(7), *made.equations, f"after {made.source}"]))
        self.table.update_rows(
            [
                TableRow(
                    (each.symbol, digits(each.value, 7), each.unit, sentence(each.meaning), each.origin),
                    number=ExplainableNumber(each.column) if each.column else None,
                )
                for each in made.letters
            ]
        )
        self.proof.setText("" if made.residual is None else _told(*made.residual))

    def _choose(self, place: int) -> None:
        if 0 <= place < len(self._names):
            self.explain(ExplainableNumber(self._names[place]))

    def _go(self, index: QModelIndex) -> None:
        """To where a letter comes from: its own explanation, else its field, or those of its stage."""
        row = self.table.rows.rows[index.row()]
        origin = row.cells[-1]
        if row.number is not None and row.number.name in self._names:
            self.explain(row.number)
        elif origin != DYNAMICS:
            follower = origin == LINKAGE and not self.session.design.drive.links
            self.field_requested.emit("follower" if follower else origin)


def _told(name: str, residual: Any) -> str:
    return f"Proved by {name.replace('_', ' ')}: residual {residual.value:.2g}, bound {residual.bound:.2g}."
