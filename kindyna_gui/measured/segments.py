"""Its segments."""

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
from core.output.measured_text import (
    digits,
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
from kindyna_gui.measured.form import spelled, symbol
from kindyna_gui.pictures.plots.plot import shown_range
from kindyna_gui.pictures.plots.xy import WHOLE_TURN, Dots, Line, Rule, XYPlot
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import readable, short, with_unit

# -- entries ---------------------------------------------------------------------------------------------

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
    rows = wrong_rows(fit)[:MOST]
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


# -- plot ------------------------------------------------------------------------------------------------

ANGLE = "Cam angle, °"
SMOOTH = np.linspace(0.0, 360.0, 1441)  # where the curve is drawn
MOST_DOTS = 4000  # of a table; of a longer one every so many rows are shown
DOT, SMALL_DOT, BAD_DOT = 4.0, 2.5, 7.0  # pixels
MANY = 400  # rows, from which on the small ones are drawn
ROOM = 1.15  # of the residuals' range, shown around it
BAND = np.array([-3.0, -1.0, 0.0, 1.0, 3.0])  # measuring errors around the curve that are shaded


def show_rows(plot: XYPlot, fit: MotionFit, order: int = 0) -> None:
    """The rows of a column and the curve of the motion through them; where the table has no such column, the curve alone.
    Around it the measuring error of the column is shaded."""
    family = QUANTITIES[order]
    index = next((i for i, each in enumerate(fit.columns) if each.column.order == order), None)
    if index is None:
        error, unit, values = (
            0.0,
            (f"{fit.motion.unit}/deg{'2' if order == 2 else ''}" if order else fit.motion.unit),
            None,
        )
        curve = fit.derivative(SMOOTH, order)
    else:
        column, error = fit.columns[index].column, fit.columns[index].error
        unit, values, curve = column.unit, column.values / column.size, fit.curve(SMOOTH, index)
    rung = readable(symbol(unit), float(np.nanmax(np.abs(curve if values is None else values))))
    colour = SCREEN.family(family)
    plot.name_axes("", f"{family.capitalize()}, {rung.symbol}", colour)
    dots = () if values is None else _dots(fit, values / rung.size, order)
    band = (SMOOTH, (curve + error * BAND[:, None]) / rung.size) if error else None
    shaded = "± 1 and 3 measuring errors" if order == fit.columns[0].column.order else ""
    plot.show_lines([Line(SMOOTH, curve / rung.size, colour, band=band)], dots=dots, shaded=shaded)
    known = [] if values is None else [values[np.isfinite(values)] / rung.size]
    plot.show_range(WHOLE_TURN, shown_range([*known, curve / rung.size], {family}, ()))


def show_residuals(plot: XYPlot, fit: MotionFit, index: int = 0) -> None:
    """What each row of a column is off the curve, between lines at the measuring error; rows far off stand at the edge."""
    each = fit.columns[index]
    order = each.column.order
    kept = np.delete(each.residuals, fit.spoiled.get(order, ()) if index else fit.left_out)
    far = ROOM * max(float(np.nanmax(np.abs(kept), initial=0.0)), 1.2 * each.error) or 1.0
    rung = readable(symbol(each.column.unit), far)
    edge, error = far / rung.size, each.error / rung.size
    texts = (with_unit(f"± {short(error, 3)}", rung.symbol), "") if error else ()
    rules = [Rule(at, text, SCREEN.limit, level=True) for at, text in zip((error, -error), texts, strict=False)]
    colour = SCREEN.family(each.column.quantity) if len(fit.columns) > 1 else ""
    plot.name_axes(ANGLE, f"Residual, {rung.symbol}", colour)
    dots = _dots(fit, np.clip(each.residuals / rung.size, -0.97 * edge, 0.97 * edge), order)
    plot.show_lines([], rules=rules, dots=dots)
    plot.show_range(WHOLE_TURN, (-edge, edge))


def _dots(fit: MotionFit, values: np.ndarray, order: int) -> Sequence[Dots]:
    """Of the rows, and larger ones of those that are wrong."""
    angles = fit.table.angles
    step = -(-angles.size // MOST_DOTS)
    wrong = [*fit.outliers.wrong, *(row for stretch in fit.outliers.undecided for row in stretch)]
    if order != fit.columns[0].column.order:
        wrong = list(fit.spoiled.get(order, ()))
    size = DOT if angles.size < MANY else SMALL_DOT
    return (
        Dots(angles[::step], values[::step], SCREEN.quiet, size, behind=True),
        Dots(angles[wrong], values[wrong], SCREEN.limit, BAD_DOT, behind=True),
    )


# -- segments --------------------------------------------------------------------------------------------

AS_FOUND = ""
LAW = 2  # the column of the boxes


def within(found: SegmentFit, angle: float) -> bool:
    """Whether a cam angle [deg] is one of the segment's."""
    return (angle - found.start_deg) % 360.0 < found.span_deg


class SegmentTable(RowsTable):
    """A row for each, with a box of what it is.

    switched   all switches from now on
    """

    switched = Signal(object)

    def __init__(self) -> None:
        super().__init__(
            (
                TableHeading("From", number=True),
                TableHeading("To", number=True),
                TableHeading("Is", wide=True, tip="What the segment becomes; what was found there, or another"),
                TableHeading("Rise", number=True),
                TableHeading("Off by", number=True, tip="The largest residual of its rows"),
                TableHeading("Lines", number=True),
            )
        )
        self._found: tuple[SegmentFit, ...] = ()
        self._switches: Switches = ()
        self.boxes: list[WordBox] = []
        self._last: WordBox | None = None

    def show_fit(self, fit: MotionFit | None, switches: Switches) -> None:
        """Show the segments of a fit, which was made with these switches; none of a spline."""
        self._found, self._switches = fit.segments if fit is not None else (), switches
        focused = next((k for k, box in enumerate(self.boxes) if box.hasFocus()), None)
        self.show_rows([_row(fit, found) for found in self._found] if fit is not None else [])
        self.boxes = [self._box(found) for found in self._found]
        self._last = None
        self.show_buttons(LAW, self.boxes)
        for before, after in pairwise((self, *self.boxes)):
            self.setTabOrder(before, after)
        if focused is not None and focused < len(self.boxes):
            self.boxes[focused].setFocus()

    def refuse(self) -> None:
        """What was switched last cannot be."""
        if self._last is not None:
            self._last.set_refused(True)

    def start(self, row: int) -> float | None:
        """Where a segment begins, cam angle [deg]."""
        return self._found[row].start_deg if 0 <= row < len(self._found) else None

    def _box(self, found: SegmentFit) -> WordBox:
        box = WordBox()
        for slug, text in _choices(found):
            box.addItem(text, slug)
        if any(within(found, angle) for angle, _ in self._switches):
            box.addItem("As found", AS_FOUND)
        box.setCurrentIndex(box.findData(found.law))
        box.setToolTip(_several(found))
        box.activated.connect(lambda _, box=box, found=found: self._switch(box, found))
        return box

    def _switch(self, box: WordBox, found: SegmentFit) -> None:
        self._last, wanted = box, box.currentData()
        kept = tuple(each for each in self._switches if not within(found, each[0]))
        middle = round((found.start_deg + 0.5 * found.span_deg) % 360.0, 6)
        self.switched.emit(kept if wanted in (AS_FOUND, None) else (*kept, (middle, wanted)))


def _row(fit: MotionFit, found: SegmentFit) -> TableRow:
    rows, (most, _) = segment_rows(fit, found), segment_residuals(fit, found)
    lines = f"{fit.table.lines[rows[0]]}-{fit.table.lines[rows[-1]]}" if rows.size else ""
    ends = (f"{digits(angle)}°" for angle in (found.start_deg, found.start_deg + found.span_deg))
    rise = f"{digits(found.rise)} {symbol(fit.motion.unit)}"
    return TableRow((*ends, "", rise, f"{digits(most, 2)} {symbol(fit.table.unit)}", lines), tip=_several(found))


def _several(found: SegmentFit) -> str:
    """Why none of several laws was taken."""
    names = ", ".join(_name(slug) for slug in found.ambiguous)
    return f"{names} fit as well as each other: choose one" if names else ""


def _choices(found: SegmentFit) -> Sequence[tuple[str, str]]:
    """What a segment can become, what it is first."""
    moves = found.rise != 0.0
    slugs = [
        slug
        for slug in (*found.ambiguous, *segment_kinds())
        if (slug != "dwell" if moves else slug in ("table", "dwell"))
    ]
    return [(slug, _name(slug)) for slug in dict.fromkeys((found.law, *slugs))]


def _name(slug: str) -> str:
    return LAWS[slug].label if slug in LAWS else sentence(slug)
