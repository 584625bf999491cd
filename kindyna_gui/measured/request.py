"""How the window requests a measured table to be read and fitted, and the answer: what was read, the fit, or what is wrong."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from dataclasses import field, fields, replace
from pathlib import Path

from core.commands.tables import MeasuredArguments
from core.frozen import frozen
from core.measured import (
    ALL_DETECTED,
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
    mirrored,
    read_sheet,
    read_table,
    read_workbook,
)
from core.measured.columns import LETTERS
from core.requests import command_words
from core.units import unit_symbol

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
            return replace(answer, table=mirrored(table) if mirror else table)
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
