"""How it is read."""

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

# -- request ---------------------------------------------------------------------------------------------

_POWERS = str.maketrans("135", "¹³⁵")


@frozen
class TableRequest:
    """How a file shall be read and fitted; empty or None = as detected. errors: by quantity, of those that are stated; page, cells: of a
    workbook."""

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
"""What a table is read by: delimiter, decimal mark, columns, lines that are left out, sheet of a workbook, cells of it, whether half a lobe
is mirrored."""


@frozen(eq=False)
class TableAnswer:
    """The answer to a request; what could not be computed is None.

    table    as it was read by ``key``
    fit      where there are faults too: of all rows, only to be shown
    faults   why there is no motion to put into the design
    refused  the file can be read, but no motion can be made of it as requested; of_switch: of the segments that are wanted; is_open: the
             rows leave the turn open
    """

    key: Key | None = None
    sheet: Worksheet | None = None
    layout: ColumnLayout | None = None
    table: MeasuredTable | None = None
    fit: MotionFit | None = None
    faults: tuple[RowFault, ...] = ()
    refused: bool = False
    of_switch: bool = False
    is_open: bool = False


@frozen(eq=False)
class TableReader:
    """The bytes of one file for one follower, which moves in ``motion_unit``; to be asked in any thread."""

    name: str
    data: bytes
    motion_unit: str
    speed_rpm: float

    def answer(self, request: TableRequest, before: TableAnswer) -> TableAnswer:
        """Read and fit, ``before`` being the last answer: only where delimiter, decimal mark or columns are others is the file read
        anew. Its faults are part of the answer, not raised."""
        cells = request.delimiter, request.decimal, request.columns, request.leave_out, request.page, request.cells
        key = (*cells, request.mirror)
        read = before if key == before.key else self._read(key)
        if read.table is None:
            return read
        table, read = read.table, replace(read, fit=None, faults=(), refused=False, of_switch=False, is_open=False)
        try:
            return replace(read, fit=_fit(table, request, request.keep_all))
        except Contradiction as error:
            return replace(read, fit=_of_all_rows(table, request), faults=(RowFault(0, str(error)),))
        except (FitError, SwitchError) as error:
            of_switch = isinstance(error, SwitchError)
            is_open = isinstance(error, OpenTurnError)
            return replace(read, faults=(RowFault(0, str(error)),), refused=True, of_switch=of_switch, is_open=is_open)

    def _read(self, key: Key) -> TableAnswer:
        delimiter, decimal, columns, leave_out, page, cells, mirror = key
        answer = TableAnswer(key)
        try:
            if is_workbook(self.data):
                sheet = read_workbook(self.data, self.name, page, cells)
            else:
                sheet = read_sheet(self.data, self.name, delimiter or None, decimal or None)
            answer = replace(answer, sheet=sheet)
            how = layout(sheet, columns, self.motion_unit, self.speed_rpm)
            answer = replace(answer, layout=how)
            table = read_table(sheet, how, self.speed_rpm, leave_out)
            return replace(answer, table=mirror_rows(table) if mirror else table)
        except TableError as error:
            return replace(answer, faults=error.faults)


def _fit(table: MeasuredTable, request: TableRequest, keep_all: bool) -> MotionFit:
    return fit(table, request.errors or None, request.lowest, keep_all, request.laws, request.dwells, request.switches)


def as_command(request: TableRequest, table: Path, into: Path, drive: str) -> str:
    """The command that does the same to the file of a design."""
    letters = {quantity: letter for letter, quantity in LETTERS.items()}
    values = {
        "table": table,
        "into": into,
        "drive": drive,
        "sheet": request.page,
        "range": request.cells,
        "delimiter": request.delimiter or None,
        "decimal": request.decimal or None,
        **{each.name: getattr(request.columns, each.name) for each in fields(request.columns)},
        "error": ",".join(f"{letters[quantity]}={error!r}" for quantity, error in request.errors.items()) or None,
        "leave_out": ",".join(map(str, request.leave_out)) or (),
        "lowest": request.lowest,
        "keep_all": request.keep_all,
        "mirror": request.mirror,
        "no_laws": not request.laws,
        "no_dwells": not request.dwells,
        "switch": ",".join(f"{angle!r}={kind}" for angle, kind in request.switches) or (),
    }
    return shlex.join(["kindyna", "--headless", "measured", *command_words(MeasuredArguments, values)])


def _of_all_rows(table: MeasuredTable, request: TableRequest) -> MotionFit | None:
    """What rows that contradict each other are shown with; None where they scatter more than they move."""
    try:
        return _fit(table, request, True)
    except (FitError, SwitchError):
        return None


def symbol(unit: str) -> str:
    """A unit of a table as it is written: ``mm/deg2`` -> ``mm/°²``."""
    base, _, per = unit.partition("/")
    power = {"2": "²", "3": "³"}.get(per[-1:], "")
    per = per.rstrip("23")
    own = unit_symbol(base) or base.replace("1e-4in", "10⁻⁴ in")
    return f"{own}/{unit_symbol(per)}{power}" if per else own


def spelled(text: str) -> str:
    """A sentence of the core with the printer's signs for its units: ``120 deg`` -> ``120°``."""
    text = re.sub(r" deg\^(\d)", lambda match: " °" + match[1].translate(_POWERS), text)
    text = re.sub(r"\b(um|mm|cm|m|in|deg|rad)/(deg|rad|s)[23]?\b", lambda match: symbol(match[0]), text)
    return re.sub(r"(?<=\d) deg\b", "°", text)


# -- form ------------------------------------------------------------------------------------------------

_WORDS: Mapping[str, str] = MappingProxyType(
    {"deg": "degrees", "rad": "radians", "turns": "turns", "s": "seconds", "ms": "milliseconds"}
)
_ROWS = (
    (("delimiter", "&Between cells"), ("decimal", "decimal")),
    (("angle_column", "Cam an&gle"), ("angle_unit", "in")),
    (("column", "&Values"), ("value_unit", "in")),
    (("quantity", "are"),),
    (("trust", "Tr&ust"),),
)


class ReadingForm(QWidget):
    """One box for each property that is detected.

    changed   the user has corrected one
    """

    changed = Signal()

    def __init__(self, motion_unit: str) -> None:
        super().__init__()
        self._motion_unit = motion_unit
        self._choices: dict[str, str] = {}
        self.boxes: dict[str, WordBox] = {}
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(4)
        for row, places in enumerate(_ROWS):
            line = QHBoxLayout()
            line.setSpacing(6)
            grid.addLayout(line, row, 1)
            for name, label in places:
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
                box.activated.connect(lambda _, name=name: self._choice_made(name))
        grid.setColumnStretch(1, 1)
        self._fill("delimiter", [(key, f"{key.capitalize()}") for key in DELIMITERS])
        self._fill("decimal", [(key, f"{key.capitalize()}  ( {mark} )") for key, mark in DECIMALS.items()])
        self._fill("angle_unit", [(unit, _WORDS[unit]) for unit in (*ANGLE_UNITS, *TIME_UNITS)])
        self._fill("quantity", [(name, f"{name}s" if name != "velocity" else "velocities") for name in QUANTITIES])

    def request(self, request: TableRequest) -> TableRequest:
        """The given request with the user's corrections in it."""
        choices = self._choices
        chosen: dict[str, Any] = {
            name: choices.get(name, "")
            for name in ("column", "angle_column", "angle_unit", "value_unit", "quantity", "trust")
        }
        columns = ColumnChoice(**chosen)
        return replace(
            request, delimiter=choices.get("delimiter", ""), decimal=choices.get("decimal", ""), columns=columns
        )

    def show_read(self, sheet: Worksheet | None, how: ColumnLayout | None) -> None:
        """Show what was detected in the boxes; what was guessed waits in a dashed frame to be confirmed, or corrected."""
        if sheet is not None:
            self._choose("delimiter", sheet.delimiter)
            self._choose("decimal", sheet.decimal)
            names = [(str(i + 1), f"{i + 1}  {name}".rstrip()) for i, name in enumerate(sheet.names)]
            for name in ("angle_column", "column"):
                self._fill(name, names)
        self._choose("angle_column", str(how.angle_column + 1) if how else self._choices.get("angle_column", ""))
        self._choose("column", str(how.value_column + 1) if how else self._choices.get("column", ""))
        quantity = how.quantity if how else self._choices.get("quantity", "")
        self._choose("angle_unit", how.angle_unit if how else self._choices.get("angle_unit", ""))
        self._choose("quantity", quantity)
        units = value_units(quantity or QUANTITIES[0], self._motion_unit)
        self._fill("value_unit", [(unit, symbol(unit)) for unit in units])
        self._choose("value_unit", how.unit.name if how else self._choices.get("value_unit", ""))
        for name, box in self.boxes.items():
            box.set_waiting(how is not None and name in how.guessed_options)

    def ask_trust(self, how: ColumnLayout | None, contradicted: bool) -> None:
        """Ask which column makes the motion where they contradict each other; go on asking where one was chosen."""
        read = () if how is None else (how.quantity, *(each.quantity for each in how.other_columns))
        names = [(letter, sentence(quantity)) for letter, quantity in LETTERS.items() if quantity in read]
        self._fill("trust", [("", "Each that agrees with the one before"), *names])
        self._choose("trust", self._choices.get("trust", ""))
        for widget in (self._trust_label, self.boxes["trust"]):
            widget.setVisible(contradicted or bool(self._choices.get("trust")))
        self.boxes["trust"].set_waiting(contradicted and not self._choices.get("trust"))

    def forget(self) -> None:
        """Drop the corrections: all as detected."""
        self._choices.clear()

    def _choice_made(self, name: str) -> None:
        """A correction voids the corrections of the properties that depend on it."""
        self._choices[name] = self.boxes[name].currentData()
        void: Mapping[str, Sequence[str]] = {
            "delimiter": ("column", "angle_column", "angle_unit", "value_unit", "quantity", "trust"),
            "column": ("value_unit", "quantity", "trust"),
            "angle_column": ("angle_unit",),
            "quantity": ("value_unit", "trust"),
            "trust": ("column", "value_unit", "quantity"),
        }
        for other in void.get(name, ()):
            self._choices.pop(other, None)
        self.changed.emit()

    def _fill(self, name: str, rows: Sequence[tuple[str, str]]) -> None:
        box = self.boxes[name]
        if [(box.itemData(i), box.itemText(i)) for i in range(box.count())] != list(rows):
            box.clear()
            for data, text in rows:
                box.addItem(text, data)

    def _choose(self, name: str, data: str) -> None:
        self.boxes[name].setCurrentIndex(self.boxes[name].findData(data))
