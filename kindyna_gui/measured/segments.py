"""Fit of a measured table: notes, plots of rows and residuals, and the table of segments."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from PySide6.QtCore import Signal

from core.findings import ERROR, NOTE, WARNING
from core.frozen import frozen
from core.laws import LAWS
from core.measured import QUANTITIES, MotionFit, RowFault, SegmentFit, Switches, segment_kinds
from core.measured.event import events
from core.output.drawing.turn import shown_range
from core.output.measured_text import (
    event_lines,
    notes,
    row_line,
    segment_lines,
    segment_residuals,
    segment_rows,
    wrong_rows,
)
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import sentence
from kindyna_gui.look import sign
from kindyna_gui.measured.form import symbol, with_symbols
from kindyna_gui.pictures.plots.xy import WHOLE_TURN, Dots, Line, Rule, XYPlot
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import readable, short, with_unit

MOST_NOTES = 200  # faults or wrong rows in the list
ANGLE = "Cam angle, °"
CURVE_ANGLES = np.linspace(0.0, 360.0, 1441)  # of the drawn curve [deg]
MOST_DOTS = 4000  # of a table; of a longer one every so many rows are shown
DOT, SMALL_DOT, BAD_DOT = 4.0, 2.5, 7.0  # pixels
MANY_ROWS = 400  # from this number on the dots are small
MARGIN = 1.15  # factor on the range of the residuals
BAND = np.array([-3.0, -1.0, 0.0, 1.0, 3.0])  # shaded multiples of the error around the curve
AS_DETECTED = ""
LAW = 2  # column of the boxes

# -- notes -----------------------------------------------------------------------------------------------


@frozen
class TableNote:
    """Note on a table: line of the file (0: none), text, severity, cam angle [deg] of that line."""

    line: int
    text: str
    severity: str
    angle: float | None = None


def fit_entries(fit: MotionFit) -> list[TableNote]:
    """Notes on a fit: wrong rows, the worst first, then ambiguous segments, events and assumptions."""
    rows = wrong_rows(fit)[:MOST_NOTES]
    wrong = [TableNote(int(fit.table.lines[i]), _row_text(fit, i), WARNING, float(fit.table.angles[i])) for i in rows]
    ambiguous = [
        TableNote(0, with_symbols(line), WARNING, segment.start_deg)
        for segment, line in zip(fit.segments, segment_lines(fit, fit.segments), strict=True)
        if segment.ambiguous
    ]
    jumps = [
        TableNote(0, with_symbols(line), NOTE, event.start)
        for event in events(fit)
        for line in event_lines(fit, (event,))
    ]
    general = [TableNote(0, with_symbols(note), WARNING if " contradicts " in note else NOTE) for note in notes(fit)]
    return [
        *wrong,
        *ambiguous,
        *(note for note in general if note.severity == WARNING),
        *jumps,
        *(note for note in general if note.severity == NOTE),
    ]


def _row_text(fit: MotionFit, row: int) -> str:
    """Text on a wrong row, without its line."""
    text = with_symbols(row_line(fit, row).partition("(")[2].replace("):", ":", 1))
    return f"{text}, left out" if row in fit.left_out else text


def fault_entries(faults: Sequence[RowFault]) -> list[TableNote]:
    """Notes on the faults of a file."""
    shown = [TableNote(fault.line, fault.text, ERROR) for fault in faults[:MOST_NOTES]]
    more = len(faults) - MOST_NOTES
    return [*shown, TableNote(0, f"and {more} more", ERROR)] if more > 0 else shown


def fault_summary(faults: Sequence[RowFault]) -> str:
    """Summary of all faults in one sentence."""
    rows = sum(fault.rows for fault in faults if fault.line)
    if not rows:
        return sentence(faults[0].text)
    return f"{rows} {'row is' if rows == 1 else 'rows are'} wrong: change the settings of reading, or correct the file and read it again."


class EntryTable(RowsTable):
    """List of the notes."""

    def __init__(self) -> None:
        super().__init__((TableHeading("Line", number=True), TableHeading("Note", wide=True)))
        self._entries: tuple[TableNote, ...] = ()

    def show_entries(self, entries: Sequence[TableNote]) -> None:
        """Show these notes."""
        self._entries = tuple(entries)
        tip = "Click to show it in the plots"
        self.show_rows(
            [
                TableRow(
                    (str(note.line or ""), sentence(note.text)), sign(note.severity), "" if note.angle is None else tip
                )
                for note in self._entries
            ]
        )

    def line(self, row: int) -> int:
        """Line of the file of a note; 0 if there is none."""
        return self._entries[row].line if 0 <= row < len(self._entries) else 0

    def angle(self, row: int) -> float | None:
        """Cam angle [deg] of a note; None if there is none."""
        return self._entries[row].angle if 0 <= row < len(self._entries) else None


# -- plots -----------------------------------------------------------------------------------------------


def show_rows(plot: XYPlot, fit: MotionFit, order: int = 0) -> None:
    """Draw the rows of a column and the fitted curve with its measuring error; without such a column the curve alone."""
    family = QUANTITIES[order]
    index = next((i for i, column_fit in enumerate(fit.columns) if column_fit.column.order == order), None)
    if index is None:
        error, values = 0.0, None
        unit = f"{fit.motion.unit}/deg{'2' if order == 2 else ''}" if order else fit.motion.unit
        curve = fit.derivative(CURVE_ANGLES, order)
    else:
        column, error = fit.columns[index].column, fit.columns[index].error
        unit, values, curve = column.unit, column.values / column.size, fit.curve(CURVE_ANGLES, index)
    display_unit = readable(symbol(unit), float(np.nanmax(np.abs(curve if values is None else values))))
    colour = SCREEN.family(family)
    plot.name_axes("", f"{family.capitalize()}, {display_unit.symbol}", colour)
    dots = () if values is None else _dots(fit, values / display_unit.size, order)
    band = (CURVE_ANGLES, (curve + error * BAND[:, None]) / display_unit.size) if error else None
    shaded = "± 1 and 3 measuring errors" if order == fit.columns[0].column.order else ""
    plot.show_lines([Line(CURVE_ANGLES, curve / display_unit.size, colour, band=band)], dots=dots, shaded=shaded)
    known = [] if values is None else [values[np.isfinite(values)] / display_unit.size]
    plot.show_range(WHOLE_TURN, shown_range([*known, curve / display_unit.size], {family}, ()))


def show_residuals(plot: XYPlot, fit: MotionFit, index: int = 0) -> None:
    """Draw the residuals of a column between lines at the measuring error; larger ones are drawn at the edge."""
    column_fit = fit.columns[index]
    order = column_fit.column.order
    used = np.delete(column_fit.residuals, fit.spoiled.get(order, ()) if index else fit.left_out)
    largest = MARGIN * max(float(np.nanmax(np.abs(used), initial=0.0)), 1.2 * column_fit.error) or 1.0
    display_unit = readable(symbol(column_fit.column.unit), largest)
    edge, error = largest / display_unit.size, column_fit.error / display_unit.size
    texts = (with_unit(f"± {short(error, 3)}", display_unit.symbol), "") if error else ()
    rules = [Rule(at, text, SCREEN.limit, level=True) for at, text in zip((error, -error), texts, strict=False)]
    colour = SCREEN.family(column_fit.column.quantity) if len(fit.columns) > 1 else ""
    plot.name_axes(ANGLE, f"Residual, {display_unit.symbol}", colour)
    dots = _dots(fit, np.clip(column_fit.residuals / display_unit.size, -0.97 * edge, 0.97 * edge), order)
    plot.show_lines([], rules=rules, dots=dots)
    plot.show_range(WHOLE_TURN, (-edge, edge))


def _dots(fit: MotionFit, values: np.ndarray, order: int) -> Sequence[Dots]:
    """Return the dots of the rows, and larger ones of the wrong rows."""
    angles = fit.table.angles
    step = -(-angles.size // MOST_DOTS)
    wrong = [*fit.outliers.wrong, *(row for stretch in fit.outliers.undecided for row in stretch)]
    if order != fit.columns[0].column.order:
        wrong = list(fit.spoiled.get(order, ()))
    size = DOT if angles.size < MANY_ROWS else SMALL_DOT
    return (
        Dots(angles[::step], values[::step], SCREEN.quiet, size, behind=True),
        Dots(angles[wrong], values[wrong], SCREEN.limit, BAD_DOT, behind=True),
    )


# -- segments --------------------------------------------------------------------------------------------


def is_within(segment: SegmentFit, angle: float) -> bool:
    """Whether a cam angle [deg] is inside a segment."""
    return (angle - segment.start_deg) % 360.0 < segment.span_deg


class SegmentTable(RowsTable):
    """Table of the segments, each with a box for its law; ``switched`` gives all segments that the user has changed."""

    switched = Signal(object)

    def __init__(self) -> None:
        super().__init__(
            (
                TableHeading("From", number=True),
                TableHeading("To", number=True),
                TableHeading("Law", wide=True, tip="Select a law, a table or a dwell for the segment"),
                TableHeading("Rise", number=True),
                TableHeading("Residual", number=True, tip="Largest residual of the rows"),
                TableHeading("Lines", number=True),
            )
        )
        self._segments: tuple[SegmentFit, ...] = ()
        self._switches: Switches = ()
        self.boxes: list[WordBox] = []
        self._last: WordBox | None = None

    def show_fit(self, fit: MotionFit | None, switches: Switches) -> None:
        """Show the segments of a fit with these switches; a spline has none."""
        self._segments, self._switches = fit.segments if fit is not None else (), switches
        focused = next((k for k, box in enumerate(self.boxes) if box.hasFocus()), None)
        self.show_rows([_row(fit, segment) for segment in self._segments] if fit is not None else [])
        self.boxes = [self._box(segment) for segment in self._segments]
        self._last = None
        self.show_buttons(LAW, self.boxes)
        for previous, following in pairwise((self, *self.boxes)):
            self.setTabOrder(previous, following)
        if focused is not None and focused < len(self.boxes):
            self.boxes[focused].setFocus()

    def refuse(self) -> None:
        """Mark the last switch as refused."""
        if self._last is not None:
            self._last.set_refused(True)

    def start(self, row: int) -> float | None:
        """Cam angle [deg] where a segment starts."""
        return self._segments[row].start_deg if 0 <= row < len(self._segments) else None

    def _box(self, segment: SegmentFit) -> WordBox:
        box = WordBox()
        for slug, text in _choices(segment):
            box.addItem(text, slug)
        if any(is_within(segment, angle) for angle, _ in self._switches):
            box.addItem("As detected", AS_DETECTED)
        box.setCurrentIndex(box.findData(segment.law))
        box.setToolTip(_ambiguity_text(segment))
        box.activated.connect(lambda _, box=box, segment=segment: self._switch(box, segment))
        return box

    def _switch(self, box: WordBox, segment: SegmentFit) -> None:
        self._last, law = box, box.currentData()
        switches = tuple(switch for switch in self._switches if not is_within(segment, switch[0]))
        middle = round((segment.start_deg + 0.5 * segment.span_deg) % 360.0, 6)
        self.switched.emit(switches if law in (AS_DETECTED, None) else (*switches, (middle, law)))


def _row(fit: MotionFit, segment: SegmentFit) -> TableRow:
    rows, (residual, _) = segment_rows(fit, segment), segment_residuals(fit, segment)
    lines = f"{fit.table.lines[rows[0]]}-{fit.table.lines[rows[-1]]}" if rows.size else ""
    ends = (f"{short(angle)}°" for angle in (segment.start_deg, segment.start_deg + segment.span_deg))
    rise = f"{short(segment.rise)} {symbol(fit.motion.unit)}"
    cells = (*ends, "", rise, f"{short(residual, 2)} {symbol(fit.table.unit)}", lines)
    return TableRow(cells, tip=_ambiguity_text(segment))


def _ambiguity_text(segment: SegmentFit) -> str:
    """Tip for a segment that several laws fit equally well."""
    names = ", ".join(_name(slug) for slug in segment.ambiguous)
    return f"{names} fit equally well: select one" if names else ""


def _choices(segment: SegmentFit) -> Sequence[tuple[str, str]]:
    """Laws and kinds that a segment can become, the current one first."""
    moves = segment.rise != 0.0
    slugs = [
        slug
        for slug in (*segment.ambiguous, *segment_kinds())
        if (slug != "dwell" if moves else slug in ("table", "dwell"))
    ]
    return [(slug, _name(slug)) for slug in dict.fromkeys((segment.law, *slugs))]


def _name(slug: str) -> str:
    return LAWS[slug].label if slug in LAWS else sentence(slug)
