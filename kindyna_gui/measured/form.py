"""Reading of a measured table: request, background reader, and the form with the detected properties."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import field, fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QWidget

from core.commands.tables import MeasuredArguments
from core.frozen import frozen
from core.measured import (
    ALL_DETECTED,
    ANGLE_UNITS,
    DECIMALS,
    DELIMITERS,
    QUANTITIES,
    TIME_UNITS,
    ColumnChoice,
    ColumnLayout,
    Contradiction,
    FitError,
    MeasuredTable,
    MotionFit,
    OpenTurnError,
    RowFault,
    SwitchError,
    Switches,
    TableError,
    Worksheet,
    fit,
    is_workbook,
    layout,
    mirror_rows,
    read_sheet,
    read_table,
    read_workbook,
    value_units,
)
from core.measured.columns import LETTERS
from core.requests import command_words
from core.units import unit_symbol
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.labels import sentence
from kindyna_gui.rebuilt import fill

POWERS = str.maketrans("135", "¹³⁵")
UNIT_NAMES: Mapping[str, str] = MappingProxyType(
    {"deg": "degrees", "rad": "radians", "turns": "turns", "s": "seconds", "ms": "milliseconds"}
)
ROWS = (
    (("delimiter", "&Between cells"), ("decimal", "decimal")),
    (("angle_column", "Cam an&gle"), ("angle_unit", "in")),
    (("column", "&Values"), ("value_unit", "in")),
    (("quantity", "are"),),
    (("trust", "Tr&ust"),),
)
"""Rows of the form: property and label of each box."""

# -- request and reader ----------------------------------------------------------------------------------


@frozen
class TableRequest:
    """How a file is read and fitted; empty or None for the detected value.

    Attributes
    ----------
    errors : stated errors by quantity, in the unit of the column
    page, cells : sheet and cells of a workbook
    """

    delimiter: str = ""
    decimal: str = ""
    columns: ColumnChoice = ALL_DETECTED
    errors: Mapping[str, float] = field(default_factory=dict)
    lowest: float | None = None
    keep_all: bool = False
    mirror: bool = False
    leave_out: tuple[int, ...] = ()
    page: str = ""
    cells: str = ""
    laws: bool = True
    dwells: bool = True
    switches: Switches = ()


Key = tuple[str, str, ColumnChoice, tuple[int, ...], str, str, bool]
"""Settings of reading: delimiter, decimal mark, columns, lines left out, sheet and cells of a workbook, mirror."""


@frozen(eq=False)
class TableReading:
    """Result of a request; None for stages that failed.

    Attributes
    ----------
    key : settings of reading
    fit : the fitted motion; together with faults a fit of all rows, for display only
    faults : why there is no motion for the design
    is_refused : whether the file can be read but not fitted as requested
    is_switch_refused : whether a segment cannot be the requested kind
    is_open : whether the rows leave the turn open
    """

    key: Key | None = None
    sheet: Worksheet | None = None
    layout: ColumnLayout | None = None
    table: MeasuredTable | None = None
    fit: MotionFit | None = None
    faults: tuple[RowFault, ...] = ()
    is_refused: bool = False
    is_switch_refused: bool = False
    is_open: bool = False


@frozen(eq=False)
class TableReader:
    """Reader of a file for a follower that moves in ``motion_unit``; may be called from any thread."""

    name: str
    data: bytes
    motion_unit: str
    speed_rpm: float

    def read_and_fit(self, request: TableRequest, before: TableReading) -> TableReading:
        """Read and fit; the file is read again only if the settings of reading differ from those of the last result.

        Faults are part of the result, not raised.
        """
        cells = request.delimiter, request.decimal, request.columns, request.leave_out, request.page, request.cells
        key = (*cells, request.mirror)
        reading = before if key == before.key else self._read(key)
        table = reading.table
        if table is None:
            return reading
        reading = replace(reading, fit=None, faults=(), is_refused=False, is_switch_refused=False, is_open=False)
        try:
            return replace(reading, fit=_fit(table, request, request.keep_all))
        except Contradiction as error:
            return replace(reading, fit=_fit_of_all_rows(table, request), faults=(RowFault(0, str(error)),))
        except (FitError, SwitchError) as error:
            return replace(
                reading,
                faults=(RowFault(0, str(error)),),
                is_refused=True,
                is_switch_refused=isinstance(error, SwitchError),
                is_open=isinstance(error, OpenTurnError),
            )

    def _read(self, key: Key) -> TableReading:
        delimiter, decimal, columns, leave_out, page, cells, mirror = key
        reading = TableReading(key)
        try:
            if is_workbook(self.data):
                sheet = read_workbook(self.data, self.name, page, cells)
            else:
                sheet = read_sheet(self.data, self.name, delimiter or None, decimal or None)
            reading = replace(reading, sheet=sheet)
            column_layout = layout(sheet, columns, self.motion_unit, self.speed_rpm)
            reading = replace(reading, layout=column_layout)
            table = read_table(sheet, column_layout, self.speed_rpm, leave_out)
            return replace(reading, table=mirror_rows(table) if mirror else table)
        except TableError as error:
            return replace(reading, faults=error.faults)


def _fit(table: MeasuredTable, request: TableRequest, keep_all: bool) -> MotionFit:
    return fit(table, request.errors or None, request.lowest, keep_all, request.laws, request.dwells, request.switches)


def measured_command(request: TableRequest, table: Path, into: Path, drive: str) -> str:
    """Command line that does the same with the file of a design."""
    symbols = {quantity: key for key, quantity in LETTERS.items()}
    values = {
        "table": table,
        "into": into,
        "drive": drive,
        "sheet": request.page,
        "range": request.cells,
        "delimiter": request.delimiter or None,
        "decimal": request.decimal or None,
        **{option.name: getattr(request.columns, option.name) for option in fields(request.columns)},
        "error": ",".join(f"{symbols[quantity]}={error!r}" for quantity, error in request.errors.items()) or None,
        "leave_out": ",".join(map(str, request.leave_out)) or (),
        "lowest": request.lowest,
        "keep_all": request.keep_all,
        "mirror": request.mirror,
        "no_laws": not request.laws,
        "no_dwells": not request.dwells,
        "switch": ",".join(f"{angle!r}={kind}" for angle, kind in request.switches) or (),
    }
    return shlex.join(["kindyna", "--headless", "measured", *command_words(MeasuredArguments, values)])


def _fit_of_all_rows(table: MeasuredTable, request: TableRequest) -> MotionFit | None:
    """Fit contradicting rows for display; None if they scatter more than they move."""
    try:
        return _fit(table, request, True)
    except (FitError, SwitchError):
        return None


def symbol(unit: str) -> str:
    """Symbol of a unit of a table: ``mm/deg2`` -> ``mm/°²``."""
    base, _, per = unit.partition("/")
    power = {"2": "²", "3": "³"}.get(per[-1:], "")
    per = per.rstrip("23")
    text = unit_symbol(base) or base.replace("1e-4in", "10⁻⁴ in")
    return f"{text}/{unit_symbol(per)}{power}" if per else text


def with_symbols(text: str) -> str:
    """Replace the units in a text by their symbols: ``120 deg`` -> ``120°``."""
    text = re.sub(r" deg\^(\d)", lambda match: " °" + match[1].translate(POWERS), text)
    text = re.sub(r"\b(um|mm|cm|m|in|deg|rad)/(deg|rad|s)[23]?\b", lambda match: symbol(match[0]), text)
    return re.sub(r"(?<=\d) deg\b", "°", text)


# -- form ------------------------------------------------------------------------------------------------


class ReadingForm(QWidget):
    """Form with a box for each detected property; ``changed`` is emitted when the user corrects one."""

    changed = Signal()

    def __init__(self, motion_unit: str) -> None:
        super().__init__()
        self._motion_unit = motion_unit
        self._choices: dict[str, str] = {}
        self.boxes: dict[str, WordBox] = {}
        grid = fill(QGridLayout(self), margins=0, spacing=(8, 4))
        for row, labels in enumerate(ROWS):
            line = fill(QHBoxLayout(), spacing=6)
            grid.addLayout(line, row, 1)
            for name, label in labels:
                box = self.boxes[name] = WordBox()
                caption = QLabel(label)
                caption.setBuddy(box)
                if name == "trust":
                    self._trust_label = caption
                if line.count():
                    line.addWidget(caption)
                else:
                    grid.addWidget(caption, row, 0)
                line.addWidget(box, 2 if line.count() else 3)
                box.activated.connect(lambda _, name=name: self._correct(name))
        grid.setColumnStretch(1, 1)
        self._fill("delimiter", [(key, f"{key.capitalize()}") for key in DELIMITERS])
        self._fill("decimal", [(key, f"{key.capitalize()}  ( {mark} )") for key, mark in DECIMALS.items()])
        self._fill("angle_unit", [(unit, UNIT_NAMES[unit]) for unit in (*ANGLE_UNITS, *TIME_UNITS)])
        self._fill("quantity", [(name, f"{name}s" if name != "velocity" else "velocities") for name in QUANTITIES])

    def request(self, request: TableRequest) -> TableRequest:
        """Return the request with the corrections of the user."""
        choices = self._choices
        selected: dict[str, Any] = {
            name: choices.get(name, "")
            for name in ("column", "angle_column", "angle_unit", "value_unit", "quantity", "trust")
        }
        columns = ColumnChoice(**selected)
        return replace(
            request, delimiter=choices.get("delimiter", ""), decimal=choices.get("decimal", ""), columns=columns
        )

    def show_layout(self, sheet: Worksheet | None, detected: ColumnLayout | None) -> None:
        """Show the detected properties; guessed ones have a dashed frame until the user confirms or corrects them."""
        if sheet is not None:
            self._choose("delimiter", sheet.delimiter)
            self._choose("decimal", sheet.decimal)
            names = [(str(i + 1), f"{i + 1}  {name}".rstrip()) for i, name in enumerate(sheet.names)]
            for name in ("angle_column", "column"):
                self._fill(name, names)
        self._choose(
            "angle_column", str(detected.angle_column + 1) if detected else self._choices.get("angle_column", "")
        )
        self._choose("column", str(detected.value_column + 1) if detected else self._choices.get("column", ""))
        quantity = detected.quantity if detected else self._choices.get("quantity", "")
        self._choose("angle_unit", detected.angle_unit if detected else self._choices.get("angle_unit", ""))
        self._choose("quantity", quantity)
        units = value_units(quantity or QUANTITIES[0], self._motion_unit)
        self._fill("value_unit", [(unit, symbol(unit)) for unit in units])
        self._choose("value_unit", detected.unit.name if detected else self._choices.get("value_unit", ""))
        for name, box in self.boxes.items():
            box.set_waiting(detected is not None and name in detected.guessed_options)

    def ask_trust(self, detected: ColumnLayout | None, contradicted: bool) -> None:
        """Ask which column defines the motion where columns contradict each other, or where one is selected already."""
        quantities = (
            () if detected is None else (detected.quantity, *(column.quantity for column in detected.other_columns))
        )
        names = [(key, sentence(quantity)) for key, quantity in LETTERS.items() if quantity in quantities]
        self._fill("trust", [("", "Every column that agrees with the previous one"), *names])
        self._choose("trust", self._choices.get("trust", ""))
        for widget in (self._trust_label, self.boxes["trust"]):
            widget.setVisible(contradicted or bool(self._choices.get("trust")))
        self.boxes["trust"].set_waiting(contradicted and not self._choices.get("trust"))

    def forget(self) -> None:
        """Discard the corrections of the user."""
        self._choices.clear()

    def _correct(self, name: str) -> None:
        """Register a correction and discard those of the properties that depend on it."""
        self._choices[name] = self.boxes[name].currentData()
        dependent: Mapping[str, Sequence[str]] = {
            "delimiter": ("column", "angle_column", "angle_unit", "value_unit", "quantity", "trust"),
            "column": ("value_unit", "quantity", "trust"),
            "angle_column": ("angle_unit",),
            "quantity": ("value_unit", "trust"),
            "trust": ("column", "value_unit", "quantity"),
        }
        for property_name in dependent.get(name, ()):
            self._choices.pop(property_name, None)
        self.changed.emit()

    def _fill(self, name: str, rows: Sequence[tuple[str, str]]) -> None:
        box = self.boxes[name]
        if [(box.itemData(i), box.itemText(i)) for i in range(box.count())] != list(rows):
            box.clear()
            for data, text in rows:
                box.addItem(text, data)

    def _choose(self, name: str, data: str) -> None:
        self.boxes[name].setCurrentIndex(self.boxes[name].findData(data))
