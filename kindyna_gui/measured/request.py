"""How the window requests a measured table to be read and fitted, and the answer: what was read, the fit, or what is wrong."""

from __future__ import annotations

import re
from dataclasses import replace

from core.frozen import frozen
from core.measured import (
    ALL_DETECTED,
    ColumnChoice,
    Contradiction,
    Fit,
    FitError,
    Layout,
    RowFault,
    Sheet,
    Table,
    TableError,
    fit,
    layout,
    read_sheet,
    read_table,
)

_POWERS = str.maketrans("135", "¹³⁵")
_SIGNS = {"um": "µm", "deg": "°", "rad": "rad"}


@frozen
class Request:
    """How a file shall be read and fitted; empty or None = as detected."""

    delimiter: str = ""
    decimal: str = ""
    columns: ColumnChoice = ALL_DETECTED
    error: float | None = None
    lowest: float | None = None
    keep_all: bool = False


@frozen(eq=False)
class Answer:
    """The answer to a request; what could not be computed is None.

    fit      where there are faults too: of all rows, only to be shown
    faults   why there is no motion to put into the design
    refused  the file can be read, but no motion can be made of it as requested
    """

    sheet: Sheet | None = None
    layout: Layout | None = None
    fit: Fit | None = None
    faults: tuple[RowFault, ...] = ()
    refused: bool = False


class Reader:
    """The bytes of one file for one follower; they are read anew only where delimiter, decimal sign or columns change."""

    def __init__(self, name: str, data: bytes, motion_unit: str, speed_rpm: float) -> None:
        self.name, self._data = name, data
        self._unit, self._speed = motion_unit, speed_rpm
        self._key: tuple[str, str, ColumnChoice] | None = None
        self._answer = Answer()
        self._table: Table | None = None

    def answer(self, request: Request) -> Answer:
        """Read and fit; faults of the file are part of the answer, not raised."""
        key = (request.delimiter, request.decimal, request.columns)
        if key != self._key:
            self._key, self._table = key, None
            self._answer = self._read(*key)
        if self._table is None:
            return self._answer
        try:
            return replace(self._answer, fit=fit(self._table, request.error, request.lowest, request.keep_all))
        except Contradiction as error:
            whole_fit = fit(self._table, request.error, request.lowest, keep_all=True)
            return replace(self._answer, fit=whole_fit, faults=(RowFault(0, str(error)),))
        except FitError as error:
            return replace(self._answer, faults=(RowFault(0, str(error)),), refused=True)

    def _read(self, delimiter: str, decimal: str, columns: ColumnChoice) -> Answer:
        answer = Answer()
        try:
            sheet = read_sheet(self._data, self.name, delimiter or None, decimal or None)
            answer = replace(answer, sheet=sheet)
            how = layout(sheet, columns, self._unit, self._speed)
            answer = replace(answer, layout=how)
            self._table = read_table(sheet, how, self._speed)
        except TableError as error:
            return replace(answer, faults=error.faults)
        return answer


def symbol(unit: str) -> str:
    """A unit of a table as it is written: ``mm/deg2`` -> ``mm/°²``."""
    base, _, per = unit.partition("/")
    power = "²" if per.endswith("2") else ""
    per = per.removesuffix("2")
    numerator = _SIGNS.get(base, base)
    return f"{numerator}/{_SIGNS.get(per, per)}{power}" if per else numerator


def spelled(text: str) -> str:
    """A sentence of the core with the printer's signs for its units: ``120 deg`` -> ``120°``."""
    text = re.sub(r" deg\^(\d)", lambda match: " °" + match[1].translate(_POWERS), text)
    text = re.sub(r"\b(um|mm|cm|m|in|deg|rad)/(deg|rad|s)2?\b", lambda match: symbol(match[0]), text)
    return re.sub(r"(?<=\d) deg\b", "°", text)
