"""A measured cam: its table on the profile, deviations magnified, the verdict in words, the worst rows."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QModelIndex, QSize, Qt, QTimer
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from core.design import Design
from core.errors import KindynaError
from core.findings import ERROR
from core.output.files.inspection import ProfileComparison, compare, read_lift, set_up_probe
from core.output.files.probe import InspectionRequest
from core.project.files import read_bytes
from core.requests import command_words
from core.study import Study
from kindyna_gui import dialogs
from kindyna_gui.background import Background
from kindyna_gui.dialogs import give_help
from kindyna_gui.documents.as_command import add_copy
from kindyna_gui.forms.amount import Amount
from kindyna_gui.forms.computed_dialog import PAUSE_MS, WAITING
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.inspection.form import ProbeForm
from kindyna_gui.inspection.picture import DeviationPicture, ShownComparison, shown
from kindyna_gui.labels import reason, sentence
from kindyna_gui.look import coloured, sign
from kindyna_gui.pictures.style import SCREEN

LEFT_WIDTH, USUAL, LEAST = 340, QSize(1080, 700), QSize(880, 540)
MOST_ROWS = 100  # of the worst
TABLES = "Tables (*.csv *.txt *.dat *.tsv *.asc)"
HEADINGS = (
    TableHeading("Line", number=True), TableHeading("Cam angle, °", number=True), TableHeading("Normal, µm", number=True),
    TableHeading("In lift, µm", number=True),
)  # fmt: skip


class MeasuredCamDialog(QDialog):
    """``comparison`` is the last comparison, None while there is none; what was shown stays while a file cannot be read."""

    def __init__(self, parent: QWidget, design: Design, path: Path, data: bytes) -> None:
        super().__init__(parent)
        give_help(self, "tour#Inspect a measured cam")
        self.setWindowTitle("Inspect a measured cam")
        self.comparison: ProfileComparison | None = None
        self._over = parent
        self._design, self._path, self._data, self._work = design, path, data, Background(self)
        self._order: np.ndarray = np.zeros(0, dtype=int)
        self.form, self.factor, self.fit = (
            ProbeForm(design),
            Amount(),
            QCheckBox("Fit the zero marks of angle and lift"),
        )
        self.fit.setToolTip("By least squares, where the table counts its angles or its lift from another place")
        self.factor.setDecimals(0)
        self.factor.setRange(1.0, 1e5)
        self.factor.setPrefix("× ")
        self.factor.setValue(100.0)
        self.form.rows.setRowVisible(self.form.boxes["samples"], False)  # the table has its own
        self.form.rows.addRow("Drawn", self.factor)
        self.form.rows.addRow("", self.fit)
        self.verdict, self.notes = QLabel(wordWrap=True), QLabel(wordWrap=True)
        for label in (self.verdict, self.notes):
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        font = self.verdict.font()
        font.setBold(True)
        self.verdict.setFont(font)
        coloured(self.notes, SCREEN.quiet)
        self.picture, self.rows = DeviationPicture(), RowsTable(HEADINGS)
        self._lay_out()
        self._pause = QTimer(self, interval=PAUSE_MS, singleShot=True)
        self._pause.timeout.connect(self._compute)
        self._work.result.connect(self._take)
        self.form.changed.connect(self._changed)
        self.fit.toggled.connect(self._changed)
        self.factor.valueChanged.connect(self.picture.magnify)
        self.again.clicked.connect(self._read_again)
        self.rows.clicked.connect(self._point_out)
        self.rows.activated.connect(self._point_out)
        self.finished.connect(self._work.close)
        self._changed()

    def _lay_out(self) -> None:
        self.again = QPushButton("&Read again")
        self.again.setToolTip("After the file was mended, or measured anew")
        self.again.setAutoDefault(False)
        name = QLabel(self._path.name)
        name.setToolTip(str(self._path))
        head = QHBoxLayout()
        head.addWidget(name, 1)
        head.addWidget(self.again)
        left = QVBoxLayout()
        left.setContentsMargins(0, 0, 0, 0)
        left.addLayout(head)
        left.addWidget(self.form)
        left.addSpacing(6)
        left.addWidget(self.verdict)
        left.addWidget(self.notes)
        left.addWidget(self.rows, 1)
        side = QWidget()
        side.setLayout(left)
        side.setFixedWidth(LEFT_WIDTH)
        middle = QHBoxLayout()
        middle.setSpacing(12)
        middle.addWidget(side)
        middle.addWidget(self.picture, 1)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        add_copy(buttons, self._over, "inspection", self._asked, of_drive=True)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addLayout(middle, 1)
        column.addWidget(buttons)
        self.setMinimumSize(LEAST)
        self.resize(USUAL.boundedTo(self.screen().availableGeometry().size() - QSize(40, 60)))

    def _asked(self) -> tuple[str, list[str]]:
        from core.commands.cams import InspectionArguments

        own = {"measured": self._path, "fit": self.fit.isChecked(), "samples": None}  # the table has its own angles
        return ".csv", command_words(InspectionArguments, {**self.form.values, **own})

    # -- what comes of it ----------------------------------------------------------------------------------------

    def _changed(self) -> None:
        self._work.stop()
        self.picture.wait()
        self._tell(WAITING, SCREEN.quiet)
        self._pause.start()

    def _compute(self) -> None:
        job = partial(_compared, self._design, self.form.request, self._data, self._path.name, self.fit.isChecked())
        self._work.start([("", job)])

    def _read_again(self) -> None:
        try:
            self._data = read_bytes(self._path)
        except KindynaError as error:  # what is shown stays
            self._tell(reason(self._design, error), SCREEN.limit)
        else:
            self._changed()

    def _take(self, _: object, result: ShownComparison | KindynaError) -> None:
        if isinstance(result, ShownComparison):
            self._show(result)
            return
        self.comparison = None
        lines = str(result).splitlines()
        self._tell(lines[0], SCREEN.limit)
        self.notes.setText("\n".join(lines[1:6]) + (f"\nand {len(lines) - 6} more" if len(lines) > 6 else ""))
        self.rows.show_rows([])
        self.picture.show_comparison(None, "Nothing can be drawn before the table can be read and measured")

    def _show(self, made: ShownComparison) -> None:
        self.comparison = result = made.comparison
        self.picture.show_comparison(made)
        self._tell(verdict(result), SCREEN.good if result.is_in_tolerance else SCREEN.limit)
        self.notes.setText("\n".join(notes(result)))
        self._order = np.argsort(-np.abs(result.normal_deviation), kind="stable")[:MOST_ROWS]
        self.rows.show_rows(
            [
                TableRow(
                    (
                        str(result.lines[i]),
                        f"{result.table.degrees[i]:.6g}",
                        f"{1e3 * result.normal_deviation[i]:+.3f}",
                        f"{1e3 * result.deviation[i]:+.3f}",
                    ),
                    sign(ERROR) if result.is_outside[i] else None,
                    "Click to see it in the picture",
                )
                for i in self._order.tolist()
            ]
        )

    def _point_out(self, index: QModelIndex) -> None:
        self.picture.point_out(int(self._order[index.row()]))

    def _tell(self, text: str, colour: str) -> None:
        self.verdict.setText(text)
        coloured(self.verdict, colour)


def _compared(design: Design, request: InspectionRequest, data: bytes, name: str, fit: bool) -> ShownComparison:
    measured = read_lift(data, name)
    return shown(compare(set_up_probe(Study(design), request), measured, fit))


def verdict(result: ProfileComparison) -> str:
    """In words."""
    row, band = result.worst_row, 1e3 * result.setup.request.tolerance_mm
    deviation = f"{1e3 * result.normal_deviation[row]:+.4g} µm normal to the profile"
    largest = f"{deviation} at {result.table.degrees[row]:.5g}°, line {result.lines[row]}"
    if result.is_in_tolerance:
        return f"In tolerance, ± {band:g} µm: the largest deviation is {largest}."
    count = int(result.is_outside.sum())
    return (
        f"Out of tolerance, ± {band:g} µm, in {count} of {result.lines.size} rows: the largest deviation is {largest}."
    )


def notes(result: ProfileComparison) -> list[str]:
    """What was fitted, how the table was read, what was not measured."""
    lines = []
    if result.is_fitted:
        lines.append(
            f"Fitted: cam angle = angle {result.angle_offset:+.6g}°, lift = measured {-result.lift_offset:+.6g} mm."
        )
    lines += [f"{sentence(found.message)}." for found in result.findings if found.severity != ERROR]
    return lines + [f"{sentence(note)}." for note in result.notes]


def inspect_measured(parent: QWidget, design: Design) -> MeasuredCamDialog | None:
    """Ask for a table and open the dialog over a window; it is deleted once closed."""
    opened = dialogs.opened_file(parent, "Inspect a measured cam", TABLES)
    if opened is None:
        return None
    dialog = MeasuredCamDialog(parent, design, *opened)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    dialog.open()
    return dialog


__all__ = ["MeasuredCamDialog", "inspect_measured"]
