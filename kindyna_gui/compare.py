"""Views What changed, with the differences from the pinned variant, and Explain, with the calculation of a number."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import degrees
from typing import Any

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtWidgets import QCheckBox, QComboBox, QCompleter, QHBoxLayout, QLabel, QSizePolicy

from core.errors import KindynaError, ResultPending
from core.findings import Finding
from core.number_text import MOST_DIGITS, RESULT_DIGITS, digits_apart, result_text
from core.output.compare import (
    MOST,
    SAME,
    Comparison,
    Difference,
    compare_designs,
    compared_design,
    comparison_csv,
    comparison_document,
    different_inputs,
)
from core.output.explain import explainable, explained, labels_of
from core.output.lines import digits
from core.study import STAGES, Study
from core.study.symbols import DYNAMICS, LINKAGE
from kindyna_gui import dialogs
from kindyna_gui.documents.pins import Pins
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import name_of, sentence
from kindyna_gui.look import coloured, described, sign, text_button
from kindyna_gui.pictures.style import SCREEN, SERIF
from kindyna_gui.pictures.units import readable, short, with_unit
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import connect_all, fill
from kindyna_gui.requirements import NOT_PINNED, Unavailable
from kindyna_gui.saving import written
from kindyna_gui.settings import Settings
from kindyna_gui.view import ExplainableNumber, View, ViewHost

# -- compare view ----------------------------------------------------------------------------------------

COMPARE_HEADINGS = (
    TableHeading("What", wide=True),
    TableHeading("of", spare=1),
    TableHeading("Pinned", number=True),
    TableHeading("Now", number=True),
    TableHeading("Change", number=True),
)
LONGEST = 9  # characters of a number
PERCENT_DIGITS = 3
GO_TIP = "Click to see its curve"


def _compare(before: Study, now: Study) -> None:
    """Compute what the comparison of two designs reads, the slow results too."""
    for study in (now, before):
        compared_design(study)


class CompareView(View):
    """Table of the differences from the pinned variant: inputs, findings, then results, largest change first.

    A click on a row leads to the field of an input, or to the curve of a result.
    """

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
        self.choice.setMinimumContentsLength(6)
        self.pin, self.unpin = text_button("Pin this variant"), text_button("Unpin")
        self.save, self.all = text_button("Save..."), text_button("All", checks=True)
        self.comparison: Comparison | None = None
        connect_all(
            (self.choice.activated, self._choose),
            (self.pin.clicked, lambda: self.pins.pin(self.session.full_design)),
            (self.unpin.clicked, self.pins.unpin),
            (self.save.clicked, self._save),
            (self.all.toggled, self._show),
            (self.table.clicked, self._go),
            (self.table.activated, self._go),
            (self.pins.changed, self._begin_anew),
        )
        row = fill(QHBoxLayout(), self.choice, self.all, self.pin, self.unpin, self.save, margins=(6, 3, 6, 3))
        self.set_column(row, self.table, grows=self.table)

    def selected_number(self) -> ExplainableNumber | None:
        return self.table.number

    def _begin_anew(self) -> None:
        """Compare with another variant: what is known of the last one says nothing of it."""
        self.comparison = None
        self.invalidate()

    def preparation(self) -> Callable[[], Any] | None:
        pinned = self.pins.full_study
        if pinned is None:
            return None
        if self.comparison is None or not (self.comparison.inputs or self.comparison.changed):
            self.comparison = None
            self.save.setEnabled(False)
            self._list_pins()
            inputs = different_inputs(pinned.design, self.session.full_design)
            rows = [_input_row(row, self.session) for row in inputs]
            self.table.show_rows([*rows, TableRow(("Comparing with the pinned variant …", "", "", "", ""))])
        return partial(_compare, pinned, self.session.full_study)

    def refresh(self, study: Study) -> None:
        self._list_pins()
        pinned = self.pins.full_study
        if pinned is None:
            self.comparison = None
            self.table.show_rows([])
            raise Unavailable(NOT_PINNED)
        now = compared_design(self.session.full_study)
        with self.pins.named():
            before = compared_design(pinned)
        self.comparison = compare_designs(before, now)
        self.save.setEnabled(True)
        self._show()

    def _list_pins(self) -> None:
        self.choice.clear()
        for row in reversed(self.pins.rows):
            self.choice.addItem(row.name, row)

    @property
    def results(self) -> tuple[Difference, ...]:
        """Results on display, those that changed most, or all."""
        changed = () if self.comparison is None else self.comparison.changed
        return changed if self.all.isChecked() else changed[:MOST]

    def _show(self) -> None:
        comparison = self.comparison
        if comparison is None:
            return
        changed = len(comparison.changed)
        self.all.setEnabled(changed > MOST)
        self.all.setToolTip(f"Show all {changed} results that changed, or only the {MOST} that changed most")
        known = set(explainable(self.session.study))
        rows = [_input_row(row, self.session) for row in comparison.inputs]
        rows += [_finding_row(finding, mark) for mark, finding in self._findings]
        rows += [_result_row(row, row.quantity in known) for row in self.results]
        self.table.show_rows(rows or [TableRow(("No difference from the pinned variant.", "", "", "", ""))])

    @property
    def _findings(self) -> list[tuple[str, Finding]]:
        assert self.comparison is not None
        rows = ("gone", self.comparison.gone), ("new", self.comparison.new)
        return [(mark, finding) for mark, findings in rows for finding in findings]

    def _choose(self, row: int) -> None:
        self.pins.bring(self.choice.itemData(row))

    def _go(self, index: QModelIndex) -> None:
        """Show the field of an input or of a finding, or the curve of a result."""
        if self.comparison is None or self._host is None:
            return
        fields = [row.quantity for row in self.comparison.inputs] + [finding.field for _, finding in self._findings]
        number, results = index.row(), self.results
        if number < len(fields):
            self._host.focus_field(fields[number])
        elif number - len(fields) < len(results):
            self._host.show_result(results[number - len(fields)].quantity)

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


def _input_row(row: Difference, session: Session) -> TableRow:
    name = name_of(session.full_design, row.quantity) or row.quantity
    texts = map(_brief, (row.a, row.b, row.change), row.texts)
    return TableRow((name, "input", *texts), tip=f"{row.quantity}: {row.texts[0]} → {row.texts[1]}")


def _brief(value: object, text: str) -> str:
    """An input as typed; a long number from a search is shortened, to leave room for the names."""
    return digits(value, MOST_DIGITS) if isinstance(value, float) and len(text) > LONGEST else text


def _finding_row(finding: Finding, mark: str) -> TableRow:
    icon = sign("none" if mark == "gone" else finding.severity)
    return TableRow((sentence(finding.message), mark, "", "", ""), icon)


def _result_row(row: Difference, is_explainable: bool) -> TableRow:
    """A result in the unit of its plot; its change in percent where that says more."""
    unit = readable(row.unit.symbol, row.size)
    small = SAME * row.size
    a, b, change = (
        None if value is None else 0.0 if abs(value) <= small else value / unit.size
        for value in (row.a, row.b, row.change)
    )
    most = digits_apart([value for value in (a, b) if value is not None])
    difference = _number(change) if row.percent is None else with_unit(short(row.percent, PERCENT_DIGITS), "%")
    name = f"{row.label}, {unit.symbol}".removesuffix(", ")
    return TableRow(
        (name, row.of, _number(a, most), _number(b, most), difference),
        tip=f"{name} ({row.quantity}): {' → '.join(row.texts[:2])}. {GO_TIP}",
        number=ExplainableNumber(row.quantity) if is_explainable else None,
    )


def _number(value: float | None, most: int = RESULT_DIGITS) -> str:
    return "" if value is None else short(value, most)


# -- explain view ----------------------------------------------------------------------------------------

EXPLAIN_HEADINGS = (
    TableHeading("Symbol"),
    TableHeading("Value", number=True),
    TableHeading("Unit"),
    TableHeading("Meaning", wide=True),
    TableHeading("From", spare=1),
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
        self.header.setText("\n".join([number.headline(RESULT_DIGITS), *number.equations, f"source: {number.source}"]))
        self.table.update_rows(
            [
                TableRow(
                    (
                        symbol.symbol,
                        digits(symbol.value, MOST_DIGITS),  # with which the equation gives the digits of the number
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
