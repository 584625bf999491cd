"""What was found in a measured table, line by line: faults, wrong rows, what was guessed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from core.findings import ERROR, NOTE, WARNING
from core.measured import Fit, RowFault
from core.output.measured_text import notes, row_line, worst_first
from kindyna_gui.forms.tables import Heading, Row, RowsTable
from kindyna_gui.labels import sentence
from kindyna_gui.look import sign
from kindyna_gui.measured.request import spelled

MOST = 200  # faults or wrong rows in the list


@dataclass(frozen=True)
class Entry:
    """One entry: the line of the file (0: none), what is told, how grave it is, the cam angle [deg] where it stands."""

    line: int
    text: str
    severity: str
    angle: float | None = None


def fit_entries(fit: Fit) -> list[Entry]:
    """Wrong rows, the worst first, then what was guessed and noticed."""
    rows = worst_first(fit)[:MOST]
    wrong = [Entry(int(fit.table.lines[i]), _off(fit, i), WARNING, float(fit.table.angles[i])) for i in rows]
    return wrong + [Entry(0, spelled(note), NOTE) for note in notes(fit)]


def _off(fit: Fit, row: int) -> str:
    """What is wrong with a row; its line stands in the other column."""
    text = spelled(row_line(fit, row).partition("(")[2].replace("):", ":", 1))
    return f"{text}, left out" if row in fit.left_out else text


def fault_entries(faults: Sequence[RowFault]) -> list[Entry]:
    """The faults of a file."""
    shown = [Entry(fault.line, fault.text, ERROR) for fault in faults[:MOST]]
    more = len(faults) - MOST
    return [*shown, Entry(0, f"and {more} more", ERROR)] if more > 0 else shown


def counted(faults: Sequence[RowFault]) -> str:
    """All faults in one sentence."""
    rows = sum(fault.rows for fault in faults if fault.line)
    if not rows:
        return sentence(faults[0].text)
    return f"{rows} {'row is' if rows == 1 else 'rows are'} wrong: correct how the file is read, or mend it and read it again."


class EntryTable(RowsTable):
    """The list of all that."""

    def __init__(self) -> None:
        super().__init__((Heading("Line", number=True), Heading("What was found", wide=True)))
        self._entries: tuple[Entry, ...] = ()

    def show_entries(self, entries: Sequence[Entry]) -> None:
        """Show these entries."""
        self._entries = tuple(entries)
        tip = "Click to see it in the plots"
        self.show_rows(
            [
                Row((str(f.line or ""), sentence(f.text)), sign(f.severity), "" if f.angle is None else tip)
                for f in self._entries
            ]
        )

    def angle(self, row: int) -> float | None:
        """The cam angle [deg] of an entry, None where it has none."""
        return self._entries[row].angle if 0 <= row < len(self._entries) else None
