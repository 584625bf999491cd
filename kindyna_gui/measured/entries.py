"""What was noticed of a measured table, as a list: wrong rows, events, notes; or why it cannot be read."""

from __future__ import annotations

from collections.abc import Sequence

from core.findings import ERROR, NOTE, WARNING
from core.frozen import frozen
from core.measured import MotionFit, RowFault
from core.measured.event import events
from core.output.measured_text import event_lines, notes, row_line, segment_lines, worst_first
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import sentence
from kindyna_gui.look import sign
from kindyna_gui.measured.request import spelled

MOST = 200  # faults or wrong rows in the list


@frozen
class TableNote:
    """What was noticed of a table: line of the file (0: none), text, severity, cam angle [deg] of that line."""

    line: int
    text: str
    severity: str
    angle: float | None = None


def fit_entries(fit: MotionFit) -> list[TableNote]:
    """Entries of a fit: wrong rows, the worst first, then the notes on what was assumed."""
    rows = worst_first(fit)[:MOST]
    wrong = [TableNote(int(fit.table.lines[i]), _off(fit, i), WARNING, float(fit.table.angles[i])) for i in rows]
    open_ones = [
        TableNote(0, spelled(line), WARNING, found.start_deg)
        for found, line in zip(fit.segments, segment_lines(fit, fit.segments), strict=True)
        if found.ambiguous
    ]
    found = [
        TableNote(0, spelled(line), NOTE, event.start) for event in events(fit) for line in event_lines(fit, (event,))
    ]
    told = [TableNote(0, spelled(note), WARNING if " contradicts " in note else NOTE) for note in notes(fit)]
    return [
        *wrong,
        *open_ones,
        *(n for n in told if n.severity == WARNING),
        *found,
        *(n for n in told if n.severity == NOTE),
    ]


def _off(fit: MotionFit, row: int) -> str:
    """What is wrong with a row; its line stands in the other column."""
    text = spelled(row_line(fit, row).partition("(")[2].replace("):", ":", 1))
    return f"{text}, left out" if row in fit.left_out else text


def fault_entries(faults: Sequence[RowFault]) -> list[TableNote]:
    """Entries for the faults of a file."""
    shown = [TableNote(fault.line, fault.text, ERROR) for fault in faults[:MOST]]
    more = len(faults) - MOST
    return [*shown, TableNote(0, f"and {more} more", ERROR)] if more > 0 else shown


def counted(faults: Sequence[RowFault]) -> str:
    """All faults in one sentence."""
    rows = sum(fault.rows for fault in faults if fault.line)
    if not rows:
        return sentence(faults[0].text)
    return f"{rows} {'row is' if rows == 1 else 'rows are'} wrong: correct how the file is read, or mend it and read it again."


class EntryTable(RowsTable):
    """The list of entries."""

    def __init__(self) -> None:
        super().__init__((TableHeading("Line", number=True), TableHeading("What was found", wide=True)))
        self._entries: tuple[TableNote, ...] = ()

    def show_entries(self, entries: Sequence[TableNote]) -> None:
        """Show these entries."""
        self._entries = tuple(entries)
        tip = "Click to see it in the plots"
        self.show_rows(
            [
                TableRow((str(f.line or ""), sentence(f.text)), sign(f.severity), "" if f.angle is None else tip)
                for f in self._entries
            ]
        )

    def line(self, row: int) -> int:
        """The line of the file that an entry is about, 0 of none."""
        return self._entries[row].line if 0 <= row < len(self._entries) else 0

    def angle(self, row: int) -> float | None:
        """The cam angle [deg] of an entry, None where it has none."""
        return self._entries[row].angle if 0 <= row < len(self._entries) else None


__all__ = ["EntryTable", "TableNote", "counted", "fault_entries", "fit_entries"]
