"""The segments that a measured motion is made of, each of which can be made a law, a table or a dwell before it is taken."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from PySide6.QtCore import Signal

from core.laws import LAWS
from core.measured import MotionFit, SegmentFit, Switches, segment_kinds
from core.output.measured_text import digits, rows_of, segment_fit
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.forms.tables import RowsTable, TableHeading, TableRow
from kindyna_gui.labels import sentence
from kindyna_gui.measured.request import symbol

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
    rows, (most, _) = rows_of(fit, found), segment_fit(fit, found)
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


__all__ = ["SegmentTable"]
